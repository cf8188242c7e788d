// Figs. 4 to 7 of [IwanickiSloan2012, Sec. 5].
#include "tools/measure/technique_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "precompute/base/error.h"
#include "runtime/reference/reference.h"
#include "tools/background.h"
#include "tools/exposure.h"
#include "tools/measure/compression_sheet.h"
#include "tools/measure/output.h"
#include "tools/measure/view_arguments.h"
#include "tools/picture.h"

namespace prt::tools {
namespace {

constexpr size_t kColumns = 4;

// What the camera sees with or without normal maps, and its truth under every environment.
struct Traced {
    SurfaceImage surface;
    std::vector<std::vector<float>> truth, floor;  // [environments][pixels×3]
};

// One technique as it is shown.
struct Drawn {
    std::string name;
    Technique technique;
    ByteImage shown, toTruth, toUncompressed;
    IrradianceError error;
    double differenceRmse = std::numeric_limits<double>::quiet_NaN();
};

class Figures {
  public:
    Figures(GlContext& context, const RelightArguments& arguments, const RelightData& data,
            const std::filesystem::path& folder)
        : arguments_(arguments),
          data_(data),
          folder_(folder),
          techniques_(arguments, data),
          named_(withoutTwins(data, techniques_)),
          camera_(arguments.camera(sceneBounds(data.scene))),
          renderer_(context, data.scene, nullptr, nullptr) {
        techniques_.addTo(renderer_);
        const RayCaster caster(data.scene.positions, data.scene.indices);
        const std::vector<double> rotations(data.environments.size(), arguments.rotationRad());
        const ReferenceDirections directions =
            makeReferenceDirections(data.environments, rotations, arguments.referenceRays);
        const Projection& projection = data.visibility ? data.visibility->projection : data.pca->projection;
        for (const bool normalMap : {true, false}) {
            Traced& traced = traced_[normalMap];
            traced.surface = renderer_.surface(camera_, options(normalMap));
            TruncationFloor floor(traced.surface, directions, data.shOrder, projection);
            traced.truth = traceReference(caster, traced.surface, directions, floor.visitor());
            traced.floor = floor.irradiance();
        }
        if (std::ranges::all_of(traced_[1].surface.triangle, [](uint32_t t) { return t == kNoTriangle; }))
            throw InputError("camera", "sees nothing of the scene", "move it with --eye or --azimuth");
    }

    TechniqueFigures draw() {
        for (size_t e = 0; e < data_.environments.size(); ++e) drawEnvironment(e);
        return std::move(result_);
    }

  private:
    RenderOptions options(bool normalMap) const { return {arguments_.width, arguments_.height, normalMap}; }

    void drawEnvironment(size_t index) {
        const Environment& environment = data_.environments[index];
        std::vector<double> weights(data_.environments.size(), 0.0);
        weights[index] = data_.weights[index];
        background_ = blendImages(data_.environments, weights);
        renderer_.setBackground(background_, arguments_.rotationRad());
        scale_ = float(weights[index]);
        std::vector<Drawn> drawn[2];
        ByteImage truth[2];
        double floor[2] = {};
        for (const bool normalMap : {true, false}) {
            const Traced& traced = traced_[normalMap];
            const std::vector<float> irradiance = scaled(traced.truth[index]);
            FloatImage radiance = radianceOf(irradiance, traced.surface);
            paintBackground(radiance, traced.surface, camera_, sceneBounds(data_.scene), background_,
                            arguments_.rotationRad());
            if (normalMap) exposureStops_ = autoExposure(radiance, traced.surface);
            truth[normalMap] = toDisplay(radiance, exposureStops_);
            floor[normalMap] =
                compareIrradiance(scaled(traced.floor[index]), irradiance, traced.surface).relativeRmse;
            drawn[normalMap] = drawAll(weights, traced, {std::move(radiance), irradiance}, normalMap);
            for (const Drawn& d : drawn[normalMap])
                result_.errors.push_back(
                    {environment.name, d.technique, normalMap, d.error, floor[normalMap], d.differenceRmse});
        }
        writeFigure4(environment.name, drawn[1], truth[1], floor[1]);
        writeAgainstUncompressed(environment.name, drawn[1]);
        writeFigure7(environment.name, drawn, truth);
    }

    std::vector<float> scaled(std::vector<float> values) const {
        for (float& value : values) value *= scale_;
        return values;
    }

    std::vector<Drawn> drawAll(const std::vector<double>& weights, const Traced& traced, const Picture& truth,
                               bool normalMap) {
        const SurfaceImage& surface = traced.surface;
        const auto render = [&](Technique technique) {
            throwIfInterrupted();
            techniques_.setLight(renderer_, technique, weights, arguments_.rotationRad());
            RenderedFrame frame = renderer_.render(camera_, techniques_.drawn(technique), options(normalMap));
            return Picture{std::move(frame.radiance), std::move(frame.irradiance.pixels)};
        };
        std::optional<Picture> uncompressed;
        if (const auto all = uncompressedTechnique()) uncompressed = render(*all);
        std::vector<Drawn> drawn;
        for (const Technique technique : named_) {
            const Picture picture = render(technique);
            Drawn d{techniqueName(technique),
                    technique,
                    toDisplay(picture.radiance, exposureStops_),
                    {},
                    {},
                    compareIrradiance(picture.irradiance, truth.irradiance, surface)};
            d.toTruth = difference(picture, truth, surface);
            if (uncompressed) {
                d.toUncompressed = difference(picture, *uncompressed, surface);
                d.differenceRmse =
                    compareIrradiance(picture.irradiance, uncompressed->irradiance, surface).relativeRmse;
            }
            drawn.push_back(std::move(d));
        }
        return drawn;
    }

    // Of all bands, as it was named.
    std::optional<Technique> uncompressedTechnique() const {
        for (const Technique technique : named_)
            if (techniques_.drawn(technique) == Technique::Unc) return technique;
        return std::nullopt;
    }

    ByteImage difference(const Picture& picture, const Picture& against, const SurfaceImage& surface) const {
        return toDisplay(scaledDifference(picture.radiance, against.radiance, surface), exposureStops_);
    }

    void writeFigure4(const std::string& environment, const std::vector<Drawn>& drawn, const ByteImage& truth,
                      double floor) {
        std::vector<SheetCell> pictures, differences;
        const std::string floorNote = fmt::format("order {} at its best: RMSE {:.3f}", data_.shOrder, floor);
        pictures.push_back({"ray tracing", truth, floorNote});
        differences.push_back({});
        for (const Drawn& d : drawn) {
            pictures.push_back(
                {d.name, d.shown,
                 fmt::format("RMSE {:.3f}, PSNR {:.1f} dB", d.error.relativeRmse, d.error.psnrDb)});
            differences.push_back({"4 x difference to ray tracing", d.toTruth});
        }
        write("figure4", environment, "Techniques", {pictures});
        write("difference", environment, "Techniques, 4 x difference to ray tracing",
              {pictures, differences});
    }

    void writeAgainstUncompressed(const std::string& environment, const std::vector<Drawn>& drawn) {
        const auto all = uncompressedTechnique();
        if (!all) return;
        const std::string name = techniqueName(*all);
        for (const TechniqueKind kind : {TechniqueKind::Pca, TechniqueKind::Unc}) {
            std::vector<SheetCell> pictures, differences;
            const auto add = [&](const Drawn& d) {
                pictures.push_back({d.name, d.shown});
                differences.push_back({fmt::format("4 x difference to {}", name), d.toUncompressed,
                                       fmt::format("RMSE to {}: {:.4f}", name, d.differenceRmse)});
            };
            for (const Drawn& d : drawn)
                if (d.technique.kind == kind && d.technique != *all) add(d);
            if (pictures.empty()) continue;
            for (const Drawn& d : drawn)
                if (d.technique == *all) add(d);
            if (kind == TechniqueKind::Pca)
                write("figure5", environment, "Visibility compressed to vectors", {pictures, differences});
            else
                write("figure6", environment, "Bands of visibility", {pictures, differences});
        }
    }

    void writeFigure7(const std::string& environment, const std::vector<Drawn> (&drawn)[2],
                      const ByteImage (&truth)[2]) {
        std::vector<SheetCell> without = {{"ray tracing, no normal map", truth[0]}},
                               with = {{"ray tracing, normal map", truth[1]}};
        for (const bool normalMap : {false, true})
            for (const Drawn& d : drawn[normalMap])
                (normalMap ? with : without)
                    .push_back({d.name + (normalMap ? ", normal map" : ", no normal map"), d.shown,
                                fmt::format("RMSE {:.3f}", d.error.relativeRmse)});
        write("figure7", environment, "Without and with normal maps", {without, with});
    }

    void write(const std::string& figure, const std::string& environment, const std::string& title,
               const std::vector<std::vector<SheetCell>>& stacked) {
        result_.files.push_back(folder_ / fmt::format("{}-{}.png", figure, fileStem(environment)));
        writePng(result_.files.back(),
                 composeSheet(fmt::format("{}, {}", title, environment), inColumns(stacked, kColumns)));
    }

    const RelightArguments& arguments_;
    const RelightData& data_;
    std::filesystem::path folder_;
    RelightTechniques techniques_;
    std::vector<Technique> named_;
    Camera camera_;
    Renderer renderer_;
    Traced traced_[2];  // without and with normal maps
    FloatImage background_;
    float scale_ = 1;
    double exposureStops_ = 0;
    TechniqueFigures result_;
};

}  // namespace

TechniqueFigures drawTechniqueFigures(GlContext& context, const RelightArguments& arguments,
                                      const RelightData& data, const std::filesystem::path& folder) {
    return Figures(context, arguments, data, folder).draw();
}

}  // namespace prt::tools
