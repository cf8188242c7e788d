#include "tools/relight_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "precompute/base/error.h"
#include "tools/command_line.h"
#include "tools/environment_arguments.h"
#include "tools/table_arguments.h"
#include "tools/video.h"

namespace prt::tools {
namespace {

std::optional<double> parseNumber(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

bool endsWith(const std::string& text, std::string_view suffix) {
    return text.size() > suffix.size() &&
           text.compare(text.size() - suffix.size(), suffix.size(), suffix) == 0;
}

void checkImageName(const std::string& option, const std::string& file) {
    if (!file.empty() && !endsWith(file, ".png") && !endsWith(file, ".exr"))
        throw UsageError(option, fmt::format("'{}' is neither .png nor .exr", file), "name one of these");
}

}  // namespace

std::string techniqueHelp() {
    std::string text = "Techniques (unc, pca and vertex-pca take any number that the bundle has):\n";
    for (const Technique technique : listedTechniques())
        text += fmt::format("  {:<16} {}\n", techniqueName(technique), techniqueSummary(technique));
    return text + "  reference        ray tracing\n";
}

EnvironmentArgument parseEnvironmentArgument(const std::string& text) {
    EnvironmentArgument argument{text, 1};
    const size_t colon = text.rfind(':');
    if (colon != std::string::npos) {
        if (const auto weight = parseNumber(std::string_view(text).substr(colon + 1))) {
            argument = {text.substr(0, colon), *weight};
            if (!std::isfinite(*weight) || *weight < 0)
                throw UsageError("--env", fmt::format("weight of '{}' is not a number >= 0", text));
        }
    }
    if (argument.source.empty())
        throw UsageError("--env", "no environment is named", "for example sky:clear");
    return argument;
}

void RelightArguments::addTo(CommandLine& line) {
    line.positional("BUNDLE", bundlePath, "bundle made by prt precompute");
    line.textList("--env", environmentTexts, "ENV[:WEIGHT]",
                  "environment and its weight (1); repeat to blend; none: sky:clear");
    addEnvironmentOptions(line, environmentOptions);
    line.real("--rotate", rotateDeg, -1e6, 1e6, "turn of the environments about the up axis, degrees");
    line.textList(
        "--technique", techniqueNames, "NAME",
        fmt::format("repeat to draw several; {{technique}} in file names becomes the name [{}, reference "
                    "| all; default unc]",
                    listedTechniqueNames()));
    line.text(
        "-o,--output", output, "FILE",
        "image to write: .png (sRGB) or .exr (linear); of a sequence with {frame} in its name, or a video: "
        ".mp4, .mkv, .webm, .gif");
    line.text("--size", sizeText, "WIDTHxHEIGHT", "pixels");
    line.integer("--samples", samples, 1, 4, "of a pixel: 1, or 4 for smooth edges");
    line.text("--exposure", exposureText, "STOPS|auto", "brightness of .png output");
    line.choice("--tone", toneText, {"none", "filmic", "neutral"}, "tone curve of .png output and videos");
    line.choice(
        "--blend", blendText, {"cpu", "gpu"},
        "where tables of several environments are blended: before they are made, or from one of each");
    line.text("--eye", eyeText, "X,Y,Z", "camera position; else it is placed by the next three");
    line.text("--target", targetText, "X,Y,Z", "point looked at; else the middle of the scene");
    line.real("--azimuth", azimuthDeg, -1e6, 1e6,
              "of the camera around the scene, degrees from +Z towards +X");
    line.real("--elevation", elevationDeg, -89, 89, "of the camera above the horizon, degrees");
    line.real("--distance", distance, 0.01, 100,
              "of the camera, 1 = the scene's bounding sphere fills the picture");
    line.real("--fov", fovDeg, 1, 160, "vertical field of view, degrees");
    line.integer("--turntable", turntableFrames, 0, 100000,
                 "frames of a sequence: the camera goes once around its target");
    line.text("--transition", transitionText, "A:B:FRAMES",
              "sequence from environment A to B, named as in --env's files, or by their numbers from 1");
    line.integer("--rotate-light", rotateLightFrames, 0, 100000,
                 "frames of a sequence: the environments turn once about the up axis");
    line.real("--fps", framesPerSecond, 0.1, 1000, "frames a second of a video");
    line.flag("--no-normal-map", noNormalMap, "shade with the mesh's own normals");
    line.flag("--no-background", noBackground, "black where nothing is seen");
    addTableOptions(line, "--table-", tables);
    addSunOption(line, tables);
    line.flag("--compare-reference", compareReference,
              "print the errors of unc, pca and every --technique against ray tracing");
    line.flag("--each", each,
              "treat every environment by itself instead of blending; {env} in file names becomes its name");
    line.integer("--reference-rays", referenceRays, 64, 1 << 20,
                 "directions of the reference, before refinement");
    line.integer("--bounces", bounces, 0, 8,
                 "diffuse reflections in the reference; techniques but sh-lightmap have none");
    line.integer("--reference-paths", referencePaths, 2, 1 << 16,
                 "of light that bounces, per pixel of the reference; an even number");
    line.text("--reference-output", referenceOutput, "FILE",
              "with --compare-reference: the ray-traced image");
    line.text("--difference-output", differenceOutput, "FILE",
              "with --compare-reference: 4 x |image - reference|");
    context.addTo(line);
    line.integer("--time-frames", timeFrames, 0, 10000, "measure the median time of so many frames");
}

void RelightArguments::parseTechniques() {
    if (techniqueNames.empty()) techniqueNames.push_back("unc");
    for (const std::string& name : techniqueNames) {
        const auto technique = techniqueFromName(name);
        if (technique)
            techniques.push_back(*technique);
        else if (name == "reference")
            reference = true;
        else if (name == "all")
            allTechniques = true;
        else
            throw UsageError("--technique", fmt::format("there is no technique called '{}'", name),
                             fmt::format("use one of {}, reference, all", listedTechniqueNames()));
    }
    if (!allTechniques && techniqueNames.size() == 1) return;
    for (const std::string& file : {output, differenceOutput})
        if (!file.empty() && file.find("{technique}") == std::string::npos)
            throw UsageError("--technique", fmt::format("'{}' would be written once per technique", file),
                             "put {technique} into the name");
}

double RelightArguments::rotationRad() const { return rotateDeg * std::numbers::pi / 180; }

int RelightArguments::sequenceFrames() const {
    return std::max({turntableFrames, rotateLightFrames, transitionFrames});
}

void RelightArguments::parseSequence() {
    if (!transitionText.empty()) {
        const size_t colon = transitionText.rfind(':');
        const auto frames = colon == std::string::npos
                                ? std::nullopt
                                : parseNumber(std::string_view(transitionText).substr(colon + 1));
        if (!frames || *frames != std::floor(*frames) || *frames < 2 || *frames > 100000)
            throw UsageError("--transition", fmt::format("'{}' is not A:B:FRAMES", transitionText),
                             "for example 1:2:48; at least 2 frames");
        transitionEnds = transitionText.substr(0, colon);
        transitionFrames = int(*frames);
    }
    const int frames = sequenceFrames();
    for (const auto& [option, own] :
         {std::pair{"--turntable", turntableFrames}, std::pair{"--rotate-light", rotateLightFrames},
          std::pair{"--transition", transitionFrames}})
        if (own > 0 && own != frames)
            throw UsageError(option, fmt::format("has {} frames, another motion {}", own, frames),
                             "motions run at the same time: give all the same number");
    const bool video = isVideoName(output), numbered = output.find("{frame}") != std::string::npos;
    if (frames == 0) {
        if (video || numbered)
            throw UsageError("--output", fmt::format("'{}' is for several frames", output),
                             "give --turntable, --transition or --rotate-light");
        return;
    }
    if (output.empty()) throw UsageError("--output", "is missing", "for example -o frames/{frame}.png");
    if (!video && !numbered)
        throw UsageError("--output", fmt::format("'{}' would be written once per frame", output),
                         "put {frame} into the name, or name a video");
    const bool light = std::ranges::find(techniques, Technique::ShLightmap) != techniques.end();
    if (rotateLightFrames > 0 && light)
        throw UsageError("--rotate-light", "sh-lightmap holds light of one turn", "choose other techniques");
    for (const auto& [option, given] :
         {std::pair{"--each", each}, std::pair{"--compare-reference", compareReference},
          std::pair{"--technique reference", reference}, std::pair{"--time-frames", timeFrames > 0}})
        if (given) throw UsageError(option, "is for single pictures, not for sequences", "leave it out");
}

bool RelightArguments::isAsked(Technique technique) const {
    return allTechniques || std::ranges::find(techniques, technique) != techniques.end();
}

void RelightArguments::finish() {
    parseTechniques();
    if (environmentTexts.empty()) environmentTexts.push_back("sky:clear");
    for (const std::string& text : environmentTexts) environments.push_back(parseEnvironmentArgument(text));
    parseSize("--size", sizeText, width, height);
    if (exposureText != "auto") {
        exposureStops = parseNumber(exposureText);
        if (!exposureStops || !(std::abs(*exposureStops) <= 64))
            throw UsageError("--exposure",
                             fmt::format("'{}' is neither a number of stops nor auto", exposureText));
    }
    checkTableOptions(tables, "--table-");
    if (samples != 1 && samples != 4)
        throw UsageError("--samples", fmt::format("{} is neither 1 nor 4", samples));
    if (samples > 1 && (compareReference || reference))
        throw UsageError("--samples", "the reference has one sample to a pixel", "leave out one of the two");
    toneCurve = toneCurveFromName(toneText).value();
    blendOn = blendText == "gpu" ? BlendOn::Gpu : BlendOn::Cpu;
    parseSequence();
    checkOutputs();
    float unused[3];
    if (!eyeText.empty()) parseVector("--eye", eyeText, unused);
    if (!targetText.empty()) parseVector("--target", targetText, unused);
}

void RelightArguments::checkOutputs() const {
    if (isVideoName(output))
        checkVideoSize(output, width, height);
    else
        checkImageName("--output", output);
    checkImageName("--reference-output", referenceOutput);
    checkImageName("--difference-output", differenceOutput);
    if (output.empty() && !compareReference && timeFrames == 0)
        throw UsageError("--output", "nothing to do", "name an image with -o, or give --compare-reference");
    if (!compareReference && !(referenceOutput.empty() && differenceOutput.empty()))
        throw UsageError("--reference-output", "needs --compare-reference");
    if (bounces > 0 && !compareReference && !reference)
        throw UsageError("--bounces", "is of the reference, which was not asked for",
                         "give --compare-reference or --technique reference");
    if (referencePaths % 2 != 0)
        throw UsageError("--reference-paths", fmt::format("{} is not even", referencePaths));
    if (each && environments.size() > 1)
        for (const std::string& file : {output, referenceOutput, differenceOutput})
            if (!file.empty() && file.find("{env}") == std::string::npos)
                throw UsageError("--each", fmt::format("'{}' would be written once per environment", file),
                                 "put {env} into the name");
}

Camera RelightArguments::camera(const Bounds& bounds) const {
    Camera camera;
    camera.verticalFovDeg = float(fovDeg);
    camera.target = 0.5f * (bounds.low + bounds.high);
    if (!targetText.empty()) parseVector("--target", targetText, camera.target.data());
    if (!eyeText.empty()) {
        parseVector("--eye", eyeText, camera.eye.data());
    } else {
        const double radius = 0.5 * double((bounds.high - bounds.low).norm());
        const double halfFov = fovDeg * std::numbers::pi / 360;
        const double range = distance * radius / std::sin(halfFov);
        const double azimuth = azimuthDeg * std::numbers::pi / 180,
                     elevation = elevationDeg * std::numbers::pi / 180;
        camera.eye = camera.target + float(range) * Vec3f(float(std::sin(azimuth) * std::cos(elevation)),
                                                          float(std::sin(elevation)),
                                                          float(std::cos(azimuth) * std::cos(elevation)));
    }
    if ((camera.eye - camera.target).norm() == 0)
        throw UsageError("--eye", "is the same point as the target", "move one of them");
    // Looking straight up or down leaves +Y undefined as the picture's up.
    const Vec3f forward = (camera.target - camera.eye).normalized();
    if (std::abs(forward.y()) > 0.9999f) camera.up = Vec3f(0, 0, -1);
    return camera;
}

}  // namespace prt::tools
