// prt lightmap: light of one environment with its bounces, for a bundle.
#include <fmt/format.h>

#include <filesystem>
#include <numbers>
#include <span>

#include "compress/renewal_command.h"
#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/io/bundle.h"
#include "precompute/io/lightmap_file.h"
#include "precompute/visibility/lightmap_job.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/environment_arguments.h"
#include "tools/report.h"

namespace prt::tools {
namespace {

std::string renewal(const LightmapSettings& settings, const std::string& source,
                    const EnvironmentOptions& reading) {
    return fmt::format("prt lightmap {} --env {} --rotate {} --bounces {} --rays {}{}{}",
                       shellWord(settings.bundlePath), shellWord(source), settings.rotationDeg,
                       settings.options.bounces, settings.options.rays,
                       settings.options.projection.kind == ProjectionKind::Plain ? " --projection plain" : "",
                       environmentWords(reading));
}

void print(const LightmapReport& report) {
    if (report.upToDate) {
        fmt::print("{}: current, nothing to do\n", report.file);
        return;
    }
    fmt::print("{}: {:.1f} MB, {:.1f} s, {:.3g} Mrays, noise of irradiance {:.2g} % (estimated)\n",
               report.file, double(report.bytes) * 1e-6, report.seconds, double(report.rays) * 1e-6,
               100 * report.relativeError);
}

void checkImageName(const std::string& file) {
    const std::string extension = std::filesystem::path(file).extension().string();
    if (!file.empty() && extension != ".png" && extension != ".exr")
        throw UsageError("--image", fmt::format("'{}' is no picture that can be written", file),
                         "name a .png or .exr file");
}

// Radiance of white surfaces along the geometric normals, as a picture of the atlas (or of rows of vertices).
void writeImage(const std::string& file, const std::string& bundlePath, const std::string& lightmap,
                double exposureStops) {
    const Bundle bundle = Bundle::open(bundlePath);
    FloatImage image =
        lightmapIrradiance(readLightmapFile(bundle.pathOf(lightmap).string()),
                           readVisibilityFile(bundle.pathOf("visibility.exr").string()).normals);
    for (float& value : image.pixels) value /= std::numbers::pi_v<float>;
    if (std::filesystem::path(file).extension() == ".exr") {
        writeExrImage(file, image);
        return;
    }
    const std::vector<uint8_t> png = encodePng(toDisplay(image, exposureStops));
    writeFileAtomically(file, std::as_bytes(std::span(png)));
}

}  // namespace

void runLightmapCommand(int argc, char** argv) {
    LightmapSettings settings;
    std::string source, projection = "irradiance", image;
    double exposureStops = 0;
    EnvironmentOptions reading;
    CommandLine line(
        "prt lightmap",
        "Bakes the light of one environment, with diffuse bounces, into a bundle: lightmaps/ENV.exr, nine\n"
        "spherical-harmonic coefficients of incident radiance per colour and point.",
        "Example:\n  prt lightmap out/house.prt --env sky:sunset --rotate 30 --bounces 2");
    line.positional("BUNDLE", settings.bundlePath, "bundle made by prt precompute");
    line.text("--env", source, "ENV", "environment: .exr, .hdr or sky:NAME", true);
    line.real("--rotate", settings.rotationDeg, -3600, 3600,
              "turns the environment about the up axis, degrees: +Z towards +X");
    line.integer("--bounces", settings.options.bounces, 0, kMaxLightmapBounces,
                 "diffuse reflections; 0: direct light only");
    line.integer("--rays", settings.options.rays, kMinLightmapRays, kMaxLightmapRays,
                 "over the hemisphere of each point, and as many towards the light");
    line.choice("--projection", projection, {"irradiance", "plain"},
                "expansion that irradiance sees best, or the plain one");
    line.text("--image", image, "FILE",
              "also writes the radiance of white surfaces in the atlas: .png (sRGB) or .exr (linear)");
    line.real("--exposure", exposureStops, -64, 64, "brightness of a .png, stops");
    addEnvironmentOptions(line, reading);
    line.flag("--force", settings.force, "also where the bundle has just that already");
    if (!line.parse(argc, argv)) return;

    checkImageName(image);
    if (projection == "plain") settings.options.projection = kPlainProjection;
    settings.command = renewal(settings, source, reading);
    const LightmapReport result = runLightmap(settings, loadEnvironment(source, reading));
    if (line.common().json != "-") print(result);
    if (!image.empty()) writeImage(image, settings.bundlePath, result.file, exposureStops);
    Report report;
    report.set("bundle", settings.bundlePath)
        .set("file", result.file)
        .set("bytes", uint64_t(result.bytes))
        .set("up_to_date", result.upToDate)
        .set("bounces", settings.options.bounces)
        .set("rotation_deg", settings.rotationDeg)
        .set("rays", result.rays)
        .set("seconds", result.seconds)
        .set("relative_error", result.relativeError);
    report.write(line.common().json);
}

}  // namespace prt::tools
