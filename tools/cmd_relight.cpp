// prt relight: a picture of a bundle under environments, and its distance from ray-traced truth.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "compress/tabulate_job.h"
#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/bundle.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/glb.h"
#include "precompute/io/table_file.h"
#include "precompute/io/visibility_file.h"
#include "runtime/live_light.h"
#include "runtime/reference/reference.h"
#include "runtime/renderer.h"
#include "tools/background.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/comparison.h"
#include "tools/relight_arguments.h"
#include "tools/relight_suns.h"
#include "tools/report.h"

namespace prt::tools {
namespace {

/// What is read from the bundle for one run.
struct RelightData {
    Bundle bundle;
    Scene scene;
    std::optional<VisibilityMap> visibility;
    std::optional<PcaMap> pca;
    std::vector<Environment> environments;
    std::vector<double> weights;
    int shOrder = 0;
};

RelightData loadData(const RelightArguments& arguments) {
    RelightData data{Bundle::open(arguments.bundlePath), {}, {}, {}, {}, {}, 0};
    const std::string precompute = fmt::format("prt precompute MESH -o {}", arguments.bundlePath);
    data.bundle.require("mesh.glb", precompute);
    data.scene = readGltf(data.bundle.pathOf("mesh.glb").string());
    const bool compare = arguments.compareReference;
    if (arguments.technique == "unc" || compare) {
        data.bundle.require("visibility.exr", precompute);
        data.visibility = readVisibilityFile(data.bundle.pathOf("visibility.exr").string());
        data.shOrder = data.visibility->shOrder;
    }
    // A comparison measures what is there; asking for pca itself insists on it.
    const bool pcaCurrent = data.bundle.find("pca.exr") && data.bundle.staleReason("pca.exr", false).empty();
    if (arguments.technique == "pca" || (compare && pcaCurrent)) {
        data.bundle.require("pca.exr", fmt::format("prt compress {}", arguments.bundlePath));
        data.pca = readPcaFile(data.bundle.pathOf("pca.exr").string());
        data.shOrder = data.pca->shOrder;
    } else if (compare && data.bundle.find("pca.exr")) {
        logWarning("pca.exr is stale and is not compared; renew it with: prt compress " +
                   arguments.bundlePath);
    }
    for (const EnvironmentArgument& argument : arguments.environments) {
        data.environments.push_back(loadEnvironment(argument.source, arguments.environmentOptions));
        data.weights.push_back(argument.weight);
    }
    return data;
}

/// Tables from the bundle when all of them are there, current and of the right environment; else built here.
class TableSource {
  public:
    TableSource(const RelightArguments& arguments, const RelightData& data)
        : arguments_(arguments), data_(data), rotationRad_(arguments.rotateDeg * std::numbers::pi / 180) {}

    NormalTable make(Technique technique, const std::vector<double>& weights) {
        if (auto stored = blendStored(technique, weights)) {
            fromBundle_ = true;
            return std::move(*stored);
        }
        fromBundle_ = false;
        if (!live_) live_.emplace(data_.environments, data_.shOrder, arguments_.tables);
        return technique == Technique::Unc ? live_->lightCosineTable(weights, rotationRad_)
                                           : live_->tripleProductTable(weights, rotationRad_, *data_.pca);
    }
    double rotationRad() const { return rotationRad_; }
    const char* origin() const { return fromBundle_ ? "bundle" : "built"; }

  private:
    std::optional<NormalTable> blendStored(Technique technique, const std::vector<double>& weights) const {
        if (rotationRad_ != 0) return std::nullopt;
        const TableKind kind =
            technique == Technique::Unc ? TableKind::LightCosine : TableKind::TripleProduct;
        std::optional<NormalTable> blend;
        for (size_t e = 0; e < weights.size(); ++e) {
            if (weights[e] == 0) continue;
            auto table = stored(kind, data_.environments[e]);
            if (!table) return std::nullopt;
            for (float& value : table->values) value *= float(weights[e]);
            if (!blend) {
                blend = std::move(table);
                continue;
            }
            if (blend->layers != table->layers) return std::nullopt;
            for (size_t i = 0; i < blend->values.size(); ++i) blend->values[i] += table->values[i];
        }
        return blend;
    }

    std::optional<NormalTable> stored(TableKind kind, const Environment& environment) const {
        const std::string name =
            tableFileName(environment.name, tableKindName(kind), arguments_.tables.layout);
        if (!data_.bundle.find(name) || !data_.bundle.staleReason(name, false).empty()) return std::nullopt;
        NormalTable table = readTableFile(data_.bundle.pathOf(name).string());
        const TableOptions& wanted = arguments_.tables;
        const auto is = [&](const char* attribute, const std::string& value) {
            const auto found = table.attributes.find(attribute);
            return found != table.attributes.end() && found->second == value;
        };
        const bool fits = table.size == wanted.size && table.shOrder == data_.shOrder &&
                          is("environmentHash", environment.contentHash) &&
                          is("cosineBands", std::to_string(wanted.cosineBands())) &&
                          is("window", wanted.window) && is("extractSun", wanted.extractSun ? "yes" : "no");
        return fits ? std::optional(std::move(table)) : std::nullopt;
    }

    const RelightArguments& arguments_;
    const RelightData& data_;
    double rotationRad_;
    bool fromBundle_ = false;
    std::optional<LiveLight> live_;
};

/// The exposure at which the brightest tenth of the covered pixels is just below white.
double autoExposure(const FloatImage& radiance, const SurfaceImage& surface) {
    std::vector<float> luminance;
    for (size_t p = 0; p < surface.pixels(); ++p)
        if (surface.triangle[p] != kNoTriangle) {
            const float* v = radiance.pixels.data() + 3 * p;
            luminance.push_back(0.2126f * v[0] + 0.7152f * v[1] + 0.0722f * v[2]);
        }
    if (luminance.empty()) return 0;
    const auto at = luminance.begin() + std::ptrdiff_t(luminance.size() * 9 / 10);
    std::nth_element(luminance.begin(), at, luminance.end());
    return *at > 0 ? std::log2(0.6 / double(*at)) : 0;
}

std::string fileFor(const std::string& pattern, const std::string& environment) {
    std::string name = pattern;
    const size_t at = name.find("{env}");
    if (at != std::string::npos) name.replace(at, 5, environment);
    return name;
}

void writeImage(const std::string& file, const FloatImage& image, double exposureStops) {
    if (file.empty()) return;
    if (file.ends_with(".exr")) {
        writeExrImage(file, image);
    } else {
        const std::vector<uint8_t> png = encodePng(toDisplay(image, exposureStops));
        writeFileAtomically(file, std::as_bytes(std::span(png)));
    }
    logNote("wrote " + file);
}

/// albedo/π · E, over the background.
FloatImage radianceFromIrradiance(const std::vector<float>& irradiance, const SurfaceImage& surface) {
    FloatImage image{surface.width, surface.height, 3, {}};
    image.pixels.assign(surface.pixels() * 3, 0.0f);
    for (size_t p = 0; p < surface.pixels(); ++p) {
        if (surface.triangle[p] == kNoTriangle) continue;
        for (size_t c = 0; c < 3; ++c)
            image.pixels[3 * p + c] =
                surface.albedo[p][int(c)] * irradiance[3 * p + c] / std::numbers::pi_v<float>;
    }
    return image;
}

/// One relit picture, or one per environment: everything that has been traced and loaded, ready to light.
class Relight {
  public:
    /// @param printText  errors also go to standard output as text
    Relight(const RelightArguments& arguments, bool printText)
        : arguments_(arguments),
          printText_(printText),
          data_(loadData(arguments)),
          tables_(arguments_, data_),
          suns_(data_.bundle, data_.scene, data_.environments, tables_.rotationRad()),
          camera_(arguments.camera(sceneBounds(data_.scene))),
          options_{arguments.width, arguments.height, !arguments.noNormalMap},
          context_(arguments.context.kind()),
          renderer_(context_, data_.scene, data_.visibility ? &*data_.visibility : nullptr,
                    data_.pca ? &*data_.pca : nullptr) {}

    Report run() {
        const bool reference = arguments_.compareReference || arguments_.technique == "reference";
        surface_ = renderer_.surface(camera_, options_);
        covered_ = size_t(std::count_if(surface_.triangle.begin(), surface_.triangle.end(),
                                        [](uint32_t t) { return t != kNoTriangle; }));
        if (covered_ == 0)
            logWarning("the camera sees nothing of the scene; move it with --eye or --azimuth");
        if (reference) trace();

        Report report;
        report.set("bundle", arguments_.bundlePath)
            .set("technique", arguments_.technique)
            .set("width", options_.width)
            .set("height", options_.height)
            .set("covered_pixels", uint64_t(covered_))
            .set("rotate_deg", arguments_.rotateDeg)
            .set("context", glContextKindName(context_.kind()))
            .set("renderer", context_.rendererName());
        if (reference) report.set("reference_directions", uint64_t(directions_.direction.size()));
        if (!arguments_.each) {
            light(data_.weights, "blend", report);
        } else {
            std::vector<Report> rows;
            for (size_t e = 0; e < data_.environments.size(); ++e) {
                std::vector<double> only(data_.environments.size(), 0.0);
                only[e] = data_.weights[e];
                Report row;
                row.set("environment", data_.environments[e].name)
                    .set("has_sun", hasSun(data_.environments[e].view()));
                light(only, data_.environments[e].name, row);
                rows.push_back(std::move(row));
            }
            report.set("environments", rows);
        }
        timeFrames(report);
        return report;
    }

  private:
    void trace() {
        const RayCaster caster(data_.scene.positions, data_.scene.indices);
        const std::vector<double> rotations(data_.environments.size(), tables_.rotationRad());
        directions_ = makeReferenceDirections(data_.environments, rotations, arguments_.referenceRays);
        if (!arguments_.compareReference) {
            truth_ = traceReference(caster, surface_, directions_);
            return;
        }
        const Projection& projection =
            data_.visibility ? data_.visibility->projection : data_.pca->projection;
        TruncationFloor floor(surface_, directions_, data_.shOrder, projection);
        truth_ = traceReference(caster, surface_, directions_, floor.visitor());
        floor_ = floor.irradiance();
    }

    /// Σ_e weight_e · images[e]
    std::vector<float> blend(const std::vector<std::vector<float>>& images,
                             const std::vector<double>& weights) const {
        std::vector<float> sum(surface_.pixels() * 3, 0.0f);
        for (size_t e = 0; e < images.size(); ++e)
            if (weights[e] != 0)
                for (size_t i = 0; i < sum.size(); ++i) sum[i] += float(weights[e]) * images[e][i];
        return sum;
    }

    /// Draws, compares and writes under one choice of weights.
    void light(const std::vector<double>& weights, const std::string& name, Report& report) {
        const bool needBackground = !arguments_.noBackground && !arguments_.output.empty();
        const FloatImage background =
            needBackground ? blendImages(data_.environments, weights) : FloatImage{};
        if (needBackground) renderer_.setBackground(background, tables_.rotationRad());

        std::vector<float> truth;
        if (!truth_.empty()) truth = blend(truth_, weights);
        FloatImage image, referenceImage;
        if (!truth.empty()) {
            referenceImage = radianceFromIrradiance(truth, surface_);
            if (needBackground)
                paintBackground(referenceImage, surface_, camera_, sceneBounds(data_.scene), background,
                                tables_.rotationRad());
        }
        if (arguments_.technique == "reference") image = referenceImage;

        if (arguments_.tables.extractSun && arguments_.technique != "reference") {
            const std::vector<SunLight> suns = suns_.make(weights);
            renderer_.setSuns(suns, suns_.grid());
            report.set("suns", uint64_t(suns.size()));
        }

        std::vector<Report> rows;
        for (const Technique technique : {Technique::Unc, Technique::Pca}) {
            const bool asked = arguments_.technique == techniqueName(technique);
            const bool available =
                technique == Technique::Unc ? data_.visibility.has_value() : data_.pca.has_value();
            if (!available || !(asked || arguments_.compareReference)) continue;
            renderer_.setTable(tables_.make(technique, weights));
            const RenderedFrame frame = renderer_.render(camera_, technique, options_);
            if (asked) {
                image = frame.radiance;
                report.set("tables", tables_.origin());
            }
            if (!arguments_.compareReference) continue;
            const IrradianceError error = compareIrradiance(frame.irradiance.pixels, truth, surface_);
            Report row;
            row.set("technique", techniqueName(technique))
                .set("relative_rmse", error.relativeRmse)
                .set("psnr_db", error.psnrDb);
            rows.push_back(std::move(row));
            print(name, techniqueName(technique), error);
        }
        if (arguments_.compareReference) {
            const IrradianceError error = compareIrradiance(blend(floor_, weights), truth, surface_);
            report.set("floor_rmse", error.relativeRmse).set("rows", rows);
            print(name, "floor", error);
        }
        writeImages(image, referenceImage, name);
    }

    void print(const std::string& name, const std::string& technique, const IrradianceError& error) const {
        if (!printText_) return;
        fmt::print("{:<16} {:<10} relative RMSE {:.4f}   PSNR {:.1f} dB\n", name, technique,
                   error.relativeRmse, error.psnrDb);
    }

    void writeImages(const FloatImage& image, const FloatImage& reference, const std::string& name) const {
        const double exposure = arguments_.exposureStops
                                    ? *arguments_.exposureStops
                                    : autoExposure(reference.pixels.empty() ? image : reference, surface_);
        writeImage(fileFor(arguments_.output, name), image, exposure);
        writeImage(fileFor(arguments_.referenceOutput, name), reference, exposure);
        if (arguments_.differenceOutput.empty()) return;
        FloatImage difference = image;
        for (size_t p = 0; p < surface_.pixels(); ++p)
            for (size_t c = 3 * p; c < 3 * p + 3; ++c)
                difference.pixels[c] = surface_.triangle[p] == kNoTriangle
                                           ? 0.0f
                                           : 4 * std::abs(image.pixels[c] - reference.pixels[c]);
        writeImage(fileFor(arguments_.differenceOutput, name), difference, exposure);
    }

    void timeFrames(Report& report) {
        if (arguments_.timeFrames == 0 || arguments_.technique == "reference") return;
        const Technique technique = arguments_.technique == "unc" ? Technique::Unc : Technique::Pca;
        renderer_.setTable(tables_.make(technique, data_.weights));
        if (arguments_.tables.extractSun) renderer_.setSuns(suns_.make(data_.weights), suns_.grid());
        const double ms = renderer_.frameMilliseconds(camera_, technique, options_, arguments_.timeFrames);
        report.set("frame_ms", ms);
        if (printText_) fmt::print("{:<16} {:<10} {:.1f} ms a frame\n", "", arguments_.technique, ms);
    }

    const RelightArguments& arguments_;
    const bool printText_;
    RelightData data_;
    TableSource tables_;
    RelightSuns suns_;
    Camera camera_;
    RenderOptions options_;
    GlContext context_;
    Renderer renderer_;
    SurfaceImage surface_;
    size_t covered_ = 0;
    ReferenceDirections directions_;
    std::vector<std::vector<float>> truth_, floor_;
};

}  // namespace

void runRelightCommand(int argc, char** argv) {
    RelightArguments arguments;
    CommandLine line("prt relight",
                     "Draws a bundle under any blend of environments, and compares with ray-traced truth.",
                     "Environments: .exr or .hdr in any layout of --env-layout, or sky:clear, sky:overcast, "
                     "sky:sunset, sky:uniform.\n"
                     "Examples:\n"
                     "  prt relight out/house.prt --env sunset.exr:0.7 --env night.exr:0.3 --rotate 40 "
                     "--technique pca -o frame.png\n"
                     "  prt relight out/house.prt --env city.exr --env forest.exr --each --compare-reference "
                     "--json errors.json");
    arguments.addTo(line);
    if (!line.parse(argc, argv)) return;
    arguments.finish();
    Relight(arguments, line.common().json != "-").run().write(line.common().json);
}

}  // namespace prt::tools
