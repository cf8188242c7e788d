// prt relight: a picture of a bundle under environments, and its distance from ray-traced truth.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/environment_file.h"
#include "runtime/reference/reference.h"
#include "tools/background.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/comparison.h"
#include "tools/exposure.h"
#include "tools/file_names.h"
#include "tools/picture.h"
#include "tools/relight_arguments.h"
#include "tools/relight_scene.h"
#include "tools/relight_sequence.h"
#include "tools/report.h"

namespace prt::tools {
namespace {

/// One relit picture, or one per environment: everything that has been traced and loaded, ready to light.
class Relight {
  public:
    /// @param printText  errors also go to standard output as text
    Relight(const RelightArguments& arguments, bool printText)
        : arguments_(arguments),
          printText_(printText),
          scene_(arguments),
          data_(scene_.data()),
          camera_(arguments.camera(scene_.bounds())) {}

    Report run() {
        const bool reference = arguments_.compareReference || arguments_.reference;
        surface_ = scene_.surface(camera_);
        covered_ = size_t(std::count_if(surface_.triangle.begin(), surface_.triangle.end(),
                                        [](uint32_t t) { return t != kNoTriangle; }));
        if (covered_ == 0)
            logWarning("the camera sees nothing of the scene; move it with --eye or --azimuth");
        if (reference) trace();

        Report report;
        report.set("bundle", arguments_.bundlePath)
            .set("technique", fmt::format("{}", fmt::join(arguments_.techniqueNames, ",")))
            .set("width", arguments_.width)
            .set("height", arguments_.height)
            .set("covered_pixels", uint64_t(covered_))
            .set("rotate_deg", arguments_.rotateDeg)
            .set("context", glContextKindName(scene_.context().kind()))
            .set("renderer", scene_.context().rendererName());
        if (reference)
            report.set("reference_directions", uint64_t(directions_.direction.size()))
                .set("bounces", arguments_.bounces);
        if (!noise_.empty())
            report.set("reference_paths", arguments_.referencePaths)
                .set("reference_noise", *std::ranges::max_element(noise_));
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
        const std::vector<double> rotations(data_.environments.size(), arguments_.rotationRad());
        directions_ = makeReferenceDirections(data_.environments, rotations, arguments_.referenceRays);
        if (!arguments_.compareReference) {
            traceTruth(caster, {});
            return;
        }
        const Projection& projection =
            data_.visibility ? data_.visibility->projection : data_.pca->projection;
        TruncationFloor floor(surface_, directions_, data_.shOrder, projection);
        traceTruth(caster, floor.visitor());
        floor_ = floor.irradiance();
    }

    void traceTruth(const RayCaster& caster, const ReferenceVisitor& visitor) {
        if (arguments_.bounces == 0) {
            truth_ = traceReference(caster, surface_, directions_, visitor);
            return;
        }
        BounceResult result =
            traceReferenceBounces(caster, surface_, directions_, SurfaceAlbedo(data_.scene),
                                  {arguments_.bounces, arguments_.referencePaths, 1}, visitor);
        truth_ = std::move(result.irradiance);
        noise_ = std::move(result.relativeError);
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
        const size_t suns = scene_.setLight({weights, arguments_.rotationRad()});
        std::vector<float> truth;
        if (!truth_.empty()) truth = blend(truth_, weights);
        FloatImage referenceImage;
        if (!truth.empty()) {
            referenceImage = radianceOf(truth, surface_);
            if (!scene_.background().pixels.empty())
                paintBackground(referenceImage, surface_, camera_, scene_.bounds(), scene_.background(),
                                arguments_.rotationRad());
        }
        if (arguments_.tables.extractSun && !data_.techniques.empty()) report.set("suns", uint64_t(suns));
        if (arguments_.reference) writeImages(referenceImage, referenceImage, name, std::nullopt);

        std::vector<Report> rows;
        for (const Technique technique : data_.techniques)
            draw(technique, truth, referenceImage, name, report, rows);
        if (arguments_.compareReference) {
            const IrradianceError error = compareIrradiance(blend(floor_, weights), truth, surface_);
            report.set("floor_rmse", error.relativeRmse).set("rows", rows);
            print(name, "floor", error);
        }
    }

    Technique firstAsked() const {
        return *std::ranges::find_if(data_.techniques,
                                     [&](Technique technique) { return arguments_.isAsked(technique); });
    }

    /// One technique: its picture where it was asked for, its error where there is truth.
    void draw(Technique technique, const std::vector<float>& truth, const FloatImage& referenceImage,
              const std::string& environment, Report& report, std::vector<Report>& rows) {
        const std::string name = techniqueName(technique);
        const char* origin = nullptr;
        const RenderedFrame frame = scene_.render(technique, camera_, &origin);
        if (arguments_.isAsked(technique)) {
            if (technique == firstAsked()) report.set("tables", origin);
            writeImages(frame.radiance, referenceImage, environment, technique);
        }
        if (!arguments_.compareReference) return;
        const int bounces = scene_.techniques().bounces(technique);
        if (bounces != arguments_.bounces && bounces > 0)
            logWarning(fmt::format("{} holds {} bounces, the reference {}; compare with --bounces {}", name,
                                   bounces, arguments_.bounces, bounces));
        const IrradianceError error = compareIrradiance(frame.irradiance.pixels, truth, surface_);
        const TechniqueCost cost =
            techniqueCost(technique, data_.source(), data_.domain(), arguments_.tables.cosineBands());
        Report row;
        row.set("technique", name)
            .set("bounces", bounces)
            .set("relative_rmse", error.relativeRmse)
            .set("psnr_db", error.psnrDb)
            .set("fetches", cost.fetches)
            .set("multiply_adds", cost.multiplyAdds);
        rows.push_back(std::move(row));
        print(environment, name, error);
    }

    void print(const std::string& name, const std::string& technique, const IrradianceError& error) const {
        if (!printText_) return;
        fmt::print("{:<16} {:<16} relative RMSE {:.4f}   PSNR {:.1f} dB\n", name, technique,
                   error.relativeRmse, error.psnrDb);
    }

    /// @param technique  that the image was drawn by; none: it is the reference
    void writeImages(const FloatImage& image, const FloatImage& reference, const std::string& environment,
                     std::optional<Technique> technique) {
        const double exposure = arguments_.exposureStops
                                    ? *arguments_.exposureStops
                                    : autoExposure(reference.pixels.empty() ? image : reference, surface_);
        const std::string name = technique ? techniqueName(*technique) : "reference";
        const auto write = [&](const std::string& pattern, const FloatImage& linear, const auto& shown) {
            if (pattern.empty()) return;
            const std::string file = fileNamed(pattern, {{"{env}", environment}, {"{technique}", name}});
            if (file.ends_with(".exr"))
                writeExrImage(file, linear);
            else
                writePng(file, shown());
            logNote("wrote " + file);
        };
        write(arguments_.output, image, [&] {
            return technique ? scene_.picture(*technique, camera_, image, exposure)
                             : toDisplay(image, exposure, arguments_.toneCurve);
        });
        write(arguments_.referenceOutput, reference,
              [&] { return toDisplay(reference, exposure, arguments_.toneCurve); });
        if (arguments_.differenceOutput.empty()) return;
        const FloatImage difference = scaledDifference(image, reference, surface_);
        write(arguments_.differenceOutput, difference, [&] { return toDisplay(difference, exposure); });
    }

    void timeFrames(Report& report) {
        if (arguments_.timeFrames == 0) return;
        scene_.setLight({data_.weights, arguments_.rotationRad()});
        std::vector<Report> rows;
        for (const Technique technique : data_.techniques) {
            if (!arguments_.isAsked(technique)) continue;
            scene_.render(technique, camera_);
            const double ms = scene_.renderer().frameMilliseconds(
                camera_, scene_.techniques().drawn(technique), scene_.options(), arguments_.timeFrames);
            if (rows.empty()) report.set("frame_ms", ms);
            Report row;
            row.set("technique", techniqueName(technique)).set("frame_ms", ms);
            rows.push_back(std::move(row));
            if (printText_) fmt::print("{:<16} {:<16} {:.1f} ms a frame\n", "", techniqueName(technique), ms);
        }
        if (rows.size() > 1) report.set("frame_times", rows);
    }

    const RelightArguments& arguments_;
    const bool printText_;
    RelightScene scene_;
    const RelightData& data_;
    Camera camera_;
    SurfaceImage surface_;
    size_t covered_ = 0;
    ReferenceDirections directions_;
    std::vector<std::vector<float>> truth_, floor_;
    std::vector<double> noise_;  // [environments] of light that bounced; empty without
};

}  // namespace

void runRelightCommand(int argc, char** argv) {
    RelightArguments arguments;
    CommandLine line(
        "prt relight", "Draws a bundle under any blend of environments, and compares with ray-traced truth.",
        "Environments: .exr or .hdr in any layout of --env-layout, or sky:clear, sky:overcast, "
        "sky:sunset, sky:uniform.\n" +
            techniqueHelp() +
            "Examples:\n"
            "  prt relight out/house.prt --env sunset.exr:0.7 --env night.exr:0.3 --rotate 40 "
            "--technique pca -o frame.png\n"
            "  prt relight out/house.prt --env sky:sunset --env sky:clear --transition 1:2:100 --turntable "
            "100 "
            "-o film.mp4\n"
            "  prt relight out/house.prt --env city.exr --env forest.exr --each --compare-reference "
            "--technique all --json errors.json");
    arguments.addTo(line);
    if (!line.parse(argc, argv)) return;
    arguments.finish();
    const Report report =
        arguments.isSequence() ? runSequence(arguments) : Relight(arguments, line.common().json != "-").run();
    report.write(line.common().json);
}

}  // namespace prt::tools
