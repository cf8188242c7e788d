// Figs. 5 and 6 and the table of frame times of [IwanickiSloan2012, Sec. 5].
#include "tools/measure/compression_images.h"

#include <fmt/format.h>

#include <algorithm>

#include "compress/tables/normal_tables.h"
#include "precompute/base/atomic_file.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/math/sh.h"
#include "runtime/reference/reference.h"
#include "runtime/renderer.h"
#include "tools/background.h"
#include "tools/comparison.h"
#include "tools/exposure.h"
#include "tools/measure/compression_sheet.h"
#include "tools/picture.h"

namespace prt::tools {
namespace {

NormalTable lightCosineTable(const EnvironmentSh& light, int shOrder, int size) {
    NormalTable table;
    table.kind = TableKind::LightCosine;
    table.size = size;
    table.shOrder = shOrder;
    table.layers = shCount(shOrder);
    table.values = buildLightCosineTable(light, shOrder, size);
    return table;
}

NormalTable tripleProductTable(NormalTable table, const PcaMap& pca) {
    table.kind = TableKind::TripleProduct;
    table.layers = pca.components + 1;
    table.values = buildTripleProductTable(table.values, pca.shOrder, table.size, pca.mean, pca.basis);
    return table;
}

// Draws one view of the scene under one environment.
class View {
  public:
    View(const CompressionScene& scene, const Environment& environment, const CompressionView& view)
        : scene_(scene), environment_(environment), view_(view), options_{view.width, view.height, true} {}

    Picture uncompressed(const VisibilityMap& map) {
        Renderer renderer(context_, scene_.scene(), &map, nullptr);
        renderer.setTable(lightCosine(map.shOrder));
        return draw(renderer, Technique::Unc);
    }
    Picture compressed(const PcaMap& pca) {
        Renderer renderer(context_, scene_.scene(), nullptr, &pca);
        renderer.setTable(tripleProductTable(lightCosine(pca.shOrder), pca));
        return draw(renderer, Technique::Pca);
    }
    SurfaceImage surface(const VisibilityMap& map) {
        return Renderer(context_, scene_.scene(), &map, nullptr).surface(view_.camera, options_);
    }
    Picture traced(const SurfaceImage& surface) const {
        const std::vector<double> rotations{0.0};
        const ReferenceDirections directions =
            makeReferenceDirections({&environment_, 1}, rotations, view_.referenceRays);
        Picture picture;
        picture.irradiance = traceReference(scene_.caster(), surface, directions)[0];
        picture.radiance = radianceOf(picture.irradiance, surface);
        paintBackground(picture.radiance, surface, view_.camera, sceneBounds(scene_.scene()),
                        environment_.image, 0);
        return picture;
    }

    NormalTable lightCosine(int shOrder) const {
        return lightCosineTable(projectEnvironment(environment_.view(), tableEnvironmentShOrder(shOrder)),
                                shOrder, view_.tableSize);
    }
    GlContext& context() { return context_; }
    const RenderOptions& options() const { return options_; }

  private:
    Picture draw(Renderer& renderer, Technique technique) {
        renderer.setBackground(environment_.image, 0);
        RenderedFrame frame = renderer.render(view_.camera, technique, options_);
        return {std::move(frame.radiance), std::move(frame.irradiance.pixels)};
    }

    const CompressionScene& scene_;
    const Environment& environment_;
    const CompressionView& view_;
    RenderOptions options_;
    GlContext context_;
};

// A figure as it grows: pictures above, differences below.
class FigureSheet {
  public:
    FigureSheet(std::string name, const SurfaceImage& surface, double exposureStops,
                const std::filesystem::path& folder)
        : name_(std::move(name)), surface_(surface), exposureStops_(exposureStops), folder_(folder) {}

    /// @param against  what it is compared with; null: nothing
    void add(const std::string& picture, const std::string& label, const Picture& image,
             const std::string& againstName, const Picture* against, std::vector<PictureRow>& rows) {
        PictureRow row{name_, picture, againstName, fmt::format("{}-{}.png", name_, picture), {}, 0};
        const ByteImage shown = toDisplay(image.radiance, exposureStops_);
        write(row.file, shown);
        SheetCell difference;
        std::string error;
        if (against) {
            row.relativeRmse =
                compareIrradiance(image.irradiance, against->irradiance, surface_).relativeRmse;
            row.differenceFile = fmt::format("{}-{}-difference.png", name_, picture);
            difference = {
                fmt::format("4 x difference to {}, RMSE {:.2f} %", againstName, 100 * row.relativeRmse),
                toDisplay(scaledDifference(image.radiance, against->radiance, surface_), exposureStops_)};
            write(row.differenceFile, difference.image);
        }
        cells_[0].push_back({label, shown});
        cells_[1].push_back(std::move(difference));
        rows.push_back(std::move(row));
    }
    void writeSheet(const std::string& title) const { write(name_ + ".png", composeSheet(title, cells_)); }

  private:
    void write(const std::string& file, const ByteImage& image) const { writePng(folder_ / file, image); }

    std::string name_;
    const SurfaceImage& surface_;
    double exposureStops_;
    std::filesystem::path folder_;
    std::vector<std::vector<SheetCell>> cells_{2};
};

PcaMap shippedPca(const VisibilityMap& map, int components, WeightsFit fit, const std::string& encoding) {
    PcaMap pca = compressMap(map, components, fit);
    pca.weights = shippedWeights(pca, validPoints(map), encoding);
    return pca;
}

// The first vectors alone.
PcaMap firstVectors(const PcaMap& pca, int components) {
    PcaMap result = pca;
    const size_t from = size_t(pca.components), to = size_t(components);
    result.components = components;
    result.basis.resize(to * pca.mean.size());
    result.variance.resize(to);
    result.weights.resize(pca.grid.count * to);
    for (size_t i = 0; i < pca.grid.count; ++i)
        std::copy_n(&pca.weights[i * from], to, &result.weights[i * to]);
    return result;
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + ptrdiff_t(values.size() / 2), values.end());
    return values[values.size() / 2];
}

}  // namespace

void checkCompressionFigures(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw OutputError(folder.string(), "cannot be made: " + error.message());
    const AtomicFile file((folder / "figure5.png").string());  // gone again at once
    const GlContext context;
}

std::vector<PictureRow> drawCompressionFigures(CompressionScene& scene, const std::vector<int>& orders,
                                               const std::string& encoding, const Environment& environment,
                                               const CompressionView& view,
                                               const std::filesystem::path& folder) {
    PRT_CHECK(!orders.empty());
    View pictures(scene, environment, view);
    const int highest = orders.back();
    const VisibilityMap& map = scene.visibility(highest);
    const SurfaceImage surface = pictures.surface(map);
    const Picture traced = pictures.traced(surface), uncompressed = pictures.uncompressed(map);
    const double exposureStops = autoExposure(traced.radiance, surface);
    std::vector<PictureRow> rows;

    FigureSheet figure5("figure5", surface, exposureStops, folder);
    for (const int components : kFigure5Components) {
        if (components >= shCount(highest)) continue;
        throwIfInterrupted();
        const PcaMap pca = shippedPca(map, components, scene.fit(), encoding);
        figure5.add(fmt::format("pca{}", components), fmt::format("{} vectors, {}", components, encoding),
                    pictures.compressed(pca), "uncompressed", &uncompressed, rows);
    }
    figure5.add("uncompressed", fmt::format("uncompressed, {} coefficients", shCount(highest)), uncompressed,
                "", nullptr, rows);
    figure5.writeSheet(fmt::format("Order {} compressed, {}", highest, environment.name));

    FigureSheet figure6("figure6", surface, exposureStops, folder);
    for (const int shOrder : orders) {
        throwIfInterrupted();
        figure6.add(fmt::format("order{}", shOrder), fmt::format("order {}, uncompressed", shOrder),
                    shOrder == highest ? uncompressed : pictures.uncompressed(scene.visibility(shOrder)),
                    "ray tracing", &traced, rows);
    }
    figure6.add("reference", "ray tracing", traced, "", nullptr, rows);
    figure6.writeSheet(fmt::format("Orders of visibility, {}", environment.name));
    return rows;
}

std::vector<FrameTime> timeCompressionFrames(CompressionScene& scene, const std::vector<int>& orders,
                                             const std::vector<int>& components,
                                             const Environment& environment, const CompressionView& view,
                                             int frames) {
    PRT_CHECK(!orders.empty());
    PRT_CHECK_LE(1, frames);
    View pictures(scene, environment, view);
    const int highest = orders.back();
    Renderer best(pictures.context(), scene.scene(), &scene.visibility(highest), nullptr);
    best.setTable(pictures.lightCosine(highest));
    std::vector<FrameTime> times;
    const auto time = [&](Renderer& renderer, Technique technique, FrameTime row) {
        std::vector<double> milliseconds, ratios;
        for (int k = 0; k < frames; ++k) {
            throwIfInterrupted();
            const double base = best.frameMilliseconds(view.camera, Technique::Unc, pictures.options(), 1);
            milliseconds.push_back(renderer.frameMilliseconds(view.camera, technique, pictures.options(), 1));
            ratios.push_back(milliseconds.back() / base);
        }
        row.milliseconds = median(milliseconds);
        row.ratio = median(ratios);
        times.push_back(row);
    };
    for (const int shOrder : orders) {
        Renderer renderer(pictures.context(), scene.scene(), &scene.visibility(shOrder), nullptr);
        renderer.setTable(pictures.lightCosine(shOrder));
        time(renderer, Technique::Unc, {shOrder, 0});
    }
    const PcaMap all = compressMap(scene.visibility(highest), shCount(highest), scene.fit());
    for (const int count : components) {
        if (count > shCount(highest)) continue;
        const PcaMap pca = firstVectors(all, count);
        Renderer renderer(pictures.context(), scene.scene(), nullptr, &pca);
        renderer.setTable(tripleProductTable(pictures.lightCosine(highest), pca));
        time(renderer, Technique::Pca, {0, count});
    }
    return times;
}

}  // namespace prt::tools
