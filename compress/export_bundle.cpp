// A bundle in the containers of graphics interfaces. E = Σ weights · tables + mean [IwanickiSloan2012, Sec.
// 3].
#include "compress/export_bundle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "compress/export_shaders.h"
#include "compress/export_textures.h"
#include "compress/shipped_bytes.h"
#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/bundle.h"
#include "precompute/io/dds.h"
#include "precompute/io/ktx2.h"
#include "precompute/io/projection_attributes.h"
#include "precompute/io/sun_shadow_file.h"
#include "precompute/math/sphere_map.h"

namespace prt {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kVisibility = "visibility.exr";
constexpr const char* kPca = "pca.exr";
constexpr const char* kTableFolder = "tables/";
constexpr const char* kCubeEnding = ".cube.exr";
constexpr const char* kSunEnding = ".sun.exr";
constexpr int kFormatVersion = 1;
constexpr size_t kErrorPoints = 4096;

void checkChoice(const std::string& option, const std::string& value,
                 const std::vector<std::string>& choices) {
    if (std::find(choices.begin(), choices.end(), value) != choices.end()) return;
    throw UsageError(option, fmt::format("there is no choice called '{}'", value),
                     fmt::format("use {}", fmt::join(choices, ", ")));
}

void checkSettings(const ExportSettings& settings) {
    checkChoice("--container", settings.container, {"ktx2", "dds"});
    checkChoice("--weights", settings.weights, pointEncodings());
    checkChoice("--tables", settings.tables, tableEncodings());
    checkChoice("--visibility", settings.visibility, {"auto", "half", "float", "none"});
}

// NAME of NAME.prt, however the path is written.
std::string bundleName(const std::string& path) {
    fs::path normal = fs::absolute(path).lexically_normal();
    if (normal.filename().empty()) normal = normal.parent_path();
    return normal.stem().string();
}

// What is exported, in memory.
struct Source {
    std::string name;
    VisibilityMap visibility;
    std::optional<PcaMap> pca;
    std::vector<std::string> tables, suns;  ///< names of files of the bundle
    bool hasVisibilityTables = false;
    std::vector<uint8_t> used;   ///< [count] whatever a lookup may reach
    std::vector<uint8_t> valid;  ///< [count]
};

Source readSource(const Bundle& bundle, const ExportSettings& settings, ExportReport& report) {
    Source source;
    source.name = bundleName(settings.bundlePath);
    bundle.require(kVisibility, "prt precompute");
    if (bundle.find(kPca)) bundle.require(kPca, fmt::format("prt compress {}", settings.bundlePath));
    for (const BundleFile& file : bundle.files()) {
        if (!file.name.starts_with(kTableFolder)) continue;
        if (file.name.ends_with(kSunEnding)) {
            bundle.require(file.name, file.madeBy);
            source.suns.push_back(file.name);
            continue;
        }
        if (!file.name.ends_with(kCubeEnding)) {
            report.notExported.push_back(file.name);
            logWarning(fmt::format("{} is no table in a cube and is not exported", file.name));
            continue;
        }
        bundle.require(file.name, fmt::format("prt tabulate {}", settings.bundlePath));
        source.tables.push_back(file.name);
        source.hasVisibilityTables =
            source.hasVisibilityTables || file.name.find(".light-cosine.") != std::string::npos;
    }
    source.visibility = readVisibilityFile(bundle.pathOf(kVisibility).string());
    if (bundle.find(kPca)) source.pca = readPcaFile(bundle.pathOf(kPca).string());
    for (const Validity validity : source.visibility.validity) {
        source.used.push_back(validity != Validity::Empty);
        source.valid.push_back(validity == Validity::Valid);
    }
    if (source.pca && source.pca->grid.count != source.visibility.grid.count)
        throw InputError(bundle.pathOf(kPca).string(),
                         fmt::format("has {} points, visibility.exr {}", source.pca->grid.count,
                                     source.visibility.grid.count),
                         fmt::format("make it again: prt compress {}", settings.bundlePath));
    return source;
}

// Writes textures and keeps account of them.
class TextureFolder {
  public:
    TextureFolder(const ExportSettings& settings, const PointGrid& grid, ExportReport& report)
        : folder_(settings.folder), container_(settings.container), report_(report) {
        gridTexels_ = double(grid.width) * double(grid.height);
        std::error_code error;
        fs::create_directories(folder_, error);
        if (!fs::is_directory(folder_))
            throw OutputError(settings.folder, "cannot be made a folder", "name another one");
    }
    /// @return what the description says of every texture
    json write(const std::string& part, const std::string& stem, const TextureImage& image) {
        throwIfInterrupted();
        const std::string file = stem + "." + container_;
        if (container_ == "ktx2")
            writeKtx2(folder_ / file, image, {{"prtPart", part}});
        else
            writeDds(folder_ / file, image);
        const std::string format = texelFormatName(image.format);
        const size_t bytes = image.bytes.size();
        report_.rows.push_back({part, file, format, image.layers, bytes, double(bytes) / gridTexels_});
        report_.bytes += bytes;
        report_.bytesPerTexel += double(bytes) / gridTexels_;
        if (part != "table" && part != "sun") report_.bytesPerPointTexel += double(bytes) / gridTexels_;
        return {{"file", file},           {"format", format},       {"width", image.width},
                {"height", image.height}, {"layers", image.layers}, {"bytes", bytes}};
    }
    void writeText(const std::string& file, const std::string& text) const {
        writeFileAtomically(folder_ / file, std::string_view(text));
    }

  private:
    fs::path folder_;
    std::string container_;
    ExportReport& report_;
    double gridTexels_ = 1;
};

// ‖Δw‖ / ‖mean + Σ w b‖ over valid points: rows of the basis are orthonormal.
double weightsRelativeRmse(const PcaMap& pca, const std::vector<float>& decoded,
                           const std::vector<uint8_t>& valid) {
    const auto components = size_t(pca.components), n2 = pca.mean.size();
    double meanSquared = 0, difference = 0, total = 0;
    std::vector<double> along(components);
    for (size_t k = 0; k < n2; ++k) {
        meanSquared += double(pca.mean[k]) * double(pca.mean[k]);
        for (size_t m = 0; m < components; ++m)
            along[m] += double(pca.mean[k]) * double(pca.basis[m * n2 + k]);
    }
    for (size_t i = 0; i < valid.size(); ++i) {
        if (!valid[i]) continue;
        total += meanSquared;
        for (size_t m = 0; m < components; ++m) {
            const double weight = double(pca.weights[i * components + m]);
            const double error = double(decoded[i * components + m]) - weight;
            total += weight * (weight + 2 * along[m]);
            difference += error * error;
        }
    }
    return total > 0 ? std::sqrt(difference / total) : 0;
}

// Irradiance of points from a table: Σ_i k_i T_ci(n) (+ mean_c(n)).
class Relighter {
  public:
    Relighter(const Source& source, int size) {
        std::vector<size_t> valid;
        for (size_t i = 0; i < source.valid.size(); ++i)
            if (source.valid[i]) valid.push_back(i);
        const size_t stride = std::max<size_t>(1, (valid.size() + kErrorPoints - 1) / kErrorPoints);
        for (size_t i = 0; i < valid.size(); i += stride) {
            const Vec3f normal = source.visibility.normals[valid[i]];
            if (!(normal.squaredNorm() > 0)) continue;
            points_.push_back(valid[i]);
            taps_.push_back(cubeSeamlessTaps(normal.cast<double>(), size));
        }
    }
    /// @param values  [3][layers][6·size²]   @param coefficients  [count×perPoint]; the layer behind is the
    /// mean
    /// @return        [points][3]
    std::vector<double> irradiance(const std::vector<float>& values, const NormalTable& shape,
                                   const std::vector<float>& coefficients, size_t perPoint) const {
        const auto size = size_t(shape.size), layers = size_t(shape.layers);
        std::vector<double> result;
        for (size_t p = 0; p < points_.size(); ++p)
            for (size_t c = 0; c < 3; ++c) {
                double sum = 0;
                for (size_t m = 0; m < layers; ++m) {
                    const float* plane = values.data() + (c * layers + m) * shape.texels();
                    double value = 0;
                    for (const CubeTap& tap : taps_[p])
                        value +=
                            double(tap.weight) *
                            double(plane[(size_t(tap.face) * size + size_t(tap.y)) * size + size_t(tap.x)]);
                    sum += m < perPoint ? value * double(coefficients[points_[p] * perPoint + m]) : value;
                }
                result.push_back(sum);
            }
        return result;
    }

  private:
    std::vector<size_t> points_;
    std::vector<std::array<CubeTap, 4>> taps_;
};

double relativeRmse(const std::vector<double>& values, const std::vector<double>& truth) {
    double difference = 0, total = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        difference += (values[i] - truth[i]) * (values[i] - truth[i]);
        total += truth[i] * truth[i];
    }
    return total > 0 ? std::sqrt(difference / total) : 0;
}

// What each table is multiplied with: as the bundle has it, and as the textures have it.
struct Coefficients {
    const std::vector<float>* exact = nullptr;
    std::vector<float> decoded;
};

json pointJson(json description, const char* meaning, size_t perPoint,
               const std::vector<UnormRange>& ranges) {
    description["meaning"] = meaning;
    description["count"] = perPoint;
    if (ranges.empty()) return description;
    std::vector<float> scale, bias;
    for (size_t k = 0; k < perPoint; ++k) {
        scale.push_back(ranges[k].scale);
        bias.push_back(ranges[k].bias);
    }
    description["scale"] = scale;
    description["bias"] = bias;
    return description;
}

json validityJson(json description) {
    description["meaning"] = "reason code: 255 times the texel";
    for (int i = 0; i < kValidityCount; ++i) description["codes"][validityName(Validity(i))] = i;
    return description;
}

// One byte of every point.
template <class Value, class ToByte>
TextureImage byteTexture(const PointGrid& grid, const std::vector<Value>& values, const ToByte& toByte) {
    TextureImage image{TexelFormat::R8Unorm, grid.width, grid.height, 0, false, {}};
    image.bytes.resize(textureBytes(image));
    std::transform(values.begin(), values.end(), image.bytes.begin(), toByte);
    return image;
}

TextureImage validityTexture(const VisibilityMap& map) {
    return byteTexture(map.grid, map.validity, [](Validity validity) { return uint8_t(validity); });
}

json exportSun(const Bundle& bundle, const std::string& name, TextureFolder& folder) {
    const SunShadowMap sun = readSunShadowFile(bundle.pathOf(name).string());
    const std::string file = name.substr(std::string(kTableFolder).size());
    json text = folder.write("sun", file.substr(0, file.size() - std::string(".exr").size()),
                             byteTexture(sun.grid, sun.shadow, [](float share) {
                                 return uint8_t(std::lround(255 * std::clamp(share, 0.0f, 1.0f)));
                             }));
    text["meaning"] = "share of the sun's disc that the point sees";
    text["direction"] = {sun.direction.x(), sun.direction.y(), sun.direction.z()};
    text["irradiance"] = sun.irradiance;
    text["angular_radius_rad"] = sun.angularRadiusRad;
    text["attributes"] = sun.attributes;
    return text;
}

json rowsOf(const std::vector<float>& values, size_t columns) {
    json rows = json::array();
    for (size_t i = 0; i < values.size(); i += columns)
        rows.push_back(
            std::vector<float>(values.begin() + ptrdiff_t(i), values.begin() + ptrdiff_t(i + columns)));
    return rows;
}

json describeBundle(const Source& source, const Bundle& bundle) {
    const VisibilityMap& map = source.visibility;
    json text = {{"format", "prt-export"},
                 {"format_version", kFormatVersion},
                 {"name", source.name},
                 {"conventions", bundle.conventions()},
                 {"domain", pointDomainName(map.grid.domain)},
                 {"width", map.grid.width},
                 {"height", map.grid.height},
                 {"points", map.grid.count},
                 {"sh_order", map.shOrder}};
    text["conventions"]["rows"] =
        "the first row is the top, v = 0; cube faces as OpenGL and Direct3D take them";
    text["conventions"]["irradiance"] =
        "E = mean + sum of weight times table; reflected: albedo / pi * max(E, 0)";
    std::map<std::string, std::string> projection;
    setProjection(map.projection, projection);
    text["projection"] = projection;
    if (source.pca) {
        text["components"] = source.pca->components;
        text["mean"] = source.pca->mean;
        text["basis"] = rowsOf(source.pca->basis, source.pca->mean.size());
    }
    return text;
}

// One table: its texture, its description, its error.
json exportTable(const Bundle& bundle, const std::string& name, const ExportSettings& settings,
                 const Source& source, const Coefficients& weights, const Coefficients& visibility,
                 TextureFolder& folder, ShaderSettings& shader, ExportReport& report) {
    const NormalTable table = readTableFile(bundle.pathOf(name).string());
    const TableTexture texture = encodeTable(table, settings.tables);
    const std::string file = name.substr(std::string(kTableFolder).size());
    json text =
        folder.write("table", file.substr(0, file.size() - std::string(kCubeEnding).size()), texture.image);
    text["kind"] = tableKindName(table.kind);
    text["functions"] = table.kind == TableKind::TripleProduct ? table.layers - 1 : table.layers;
    text["packing"] = texture.packing;
    text["attributes"] = table.attributes;
    if (!texture.ranges.empty()) text["range"] = texture.ranges;
    const bool isTriple = table.kind == TableKind::TripleProduct;
    (isTriple ? shader.hasWeightTables : shader.hasVisibilityTables) = true;
    if (!texture.ranges.empty())
        (isTriple ? shader.hasWeightTableRanges : shader.hasVisibilityTableRanges) = true;
    shader.isRgbPerLayer = texture.packing == "rgb-per-layer";
    const Coefficients& coefficients = isTriple ? weights : visibility;
    const auto perPoint = size_t(isTriple ? table.layers - 1 : table.layers);
    if (!coefficients.exact || coefficients.exact->size() != perPoint * source.valid.size()) return text;
    const Relighter relighter(source, table.size);
    const double error =
        relativeRmse(relighter.irradiance(texture.decoded, table, coefficients.decoded, perPoint),
                     relighter.irradiance(table.values, table, *coefficients.exact, perPoint));
    report.errors.push_back({report.rows.back().file, error});
    text["irradiance_relative_rmse"] = error;
    return text;
}

// Tables of a kind that need ranges must all have them: the snippet knows one form.
void giveAllTablesRanges(json& tables, const ShaderSettings& shader) {
    for (json& table : tables) {
        const bool isTriple = table["kind"] == tableKindName(TableKind::TripleProduct);
        if (!(isTriple ? shader.hasWeightTableRanges : shader.hasVisibilityTableRanges)) continue;
        if (!table.contains("range"))
            table["range"] = std::vector<std::array<float, 4>>(table["layers"].get<size_t>(), {0, 0, 0, 1});
    }
}

std::string visibilityEncoding(const ExportSettings& settings, const Source& source) {
    if (settings.visibility != "auto") return settings.visibility;
    return source.hasVisibilityTables || !source.pca ? "half" : "none";
}

}  // namespace

ExportReport runExport(const ExportSettings& settings) {
    const Stopwatch watch;
    checkSettings(settings);
    ExportReport report;
    const Bundle bundle = Bundle::open(settings.bundlePath);
    const Source source = readSource(bundle, settings, report);
    const VisibilityMap& map = source.visibility;
    report.points = map.grid.count;
    TextureFolder folder(settings, map.grid, report);
    json text = describeBundle(source, bundle);
    ShaderSettings shader;
    shader.name = source.name;
    shader.isPerVertex = map.grid.domain == PointDomain::Vertex;
    shader.rowLength = map.grid.width;
    Coefficients weights, visibility;
    PointTexture weightTexture;
    if (source.pca) {
        const auto components = size_t(source.pca->components);
        weightTexture =
            encodePoints(source.pca->weights, components, source.pca->grid, settings.weights, source.used);
        report.weightsRelativeRmse = weightsRelativeRmse(*source.pca, weightTexture.decoded, source.valid);
        text["weights"] = pointJson(folder.write("weights", "weights", weightTexture.image),
                                    "weight 4 * layer + channel", components, weightTexture.ranges);
        text["weights"]["relative_rmse"] = report.weightsRelativeRmse;
        weights = {&source.pca->weights, std::move(weightTexture.decoded)};
        shader.components = source.pca->components;
        shader.weightRanges = weightTexture.ranges;
    }
    text["validity"] = validityJson(folder.write("validity", "validity", validityTexture(map)));
    if (const std::string encoding = visibilityEncoding(settings, source); encoding != "none") {
        const size_t coefficients = size_t(map.shOrder) * size_t(map.shOrder);
        PointTexture texture = encodePoints(map.coefficients, coefficients, map.grid, encoding, source.used);
        text["visibility"] = pointJson(folder.write("visibility", "visibility", texture.image),
                                       "SH coefficient 4 * layer + channel", coefficients, {});
        visibility = {&map.coefficients, std::move(texture.decoded)};
        shader.shCoefficients = int(coefficients);
    }
    text["tables"] = json::array();
    for (const std::string& name : source.tables)
        text["tables"].push_back(
            exportTable(bundle, name, settings, source, weights, visibility, folder, shader, report));
    giveAllTablesRanges(text["tables"], shader);
    text["suns"] = json::array();
    for (const std::string& name : source.suns) text["suns"].push_back(exportSun(bundle, name, folder));
    shader.hasSuns = !source.suns.empty();
    folder.writeText("prt_shade.glsl", glslSnippet(shader));
    folder.writeText("prt_shade.hlsl", hlslSnippet(shader));
    folder.writeText(source.name + ".json", text.dump(1) + "\n");
    report.seconds = watch.seconds();
    return report;
}

}  // namespace prt
