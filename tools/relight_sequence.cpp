#include "tools/relight_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/environment_file.h"
#include "precompute/math/sh_rotation.h"
#include "tools/exposure.h"
#include "tools/file_names.h"
#include "tools/picture.h"
#include "tools/video.h"

namespace prt::tools {
namespace {

// By name, else by number from 1.
std::optional<size_t> findEnvironment(const std::string& text, const std::vector<std::string>& names) {
    for (size_t e = 0; e < names.size(); ++e)
        if (text == names[e]) return e;
    for (size_t e = 0; e < names.size(); ++e)
        if (text == std::to_string(e + 1)) return e;
    return std::nullopt;
}

// The two ends of "A:B"; names may hold colons.
std::pair<size_t, size_t> transitionEnds(const std::string& text, const std::vector<std::string>& names) {
    for (size_t colon = text.find(':'); colon != std::string::npos; colon = text.find(':', colon + 1)) {
        const auto from = findEnvironment(text.substr(0, colon), names),
                   to = findEnvironment(text.substr(colon + 1), names);
        if (!from || !to) continue;
        if (*from == *to)
            throw UsageError("--transition", fmt::format("'{}' goes from an environment to itself", text));
        return {*from, *to};
    }
    throw UsageError("--transition", fmt::format("'{}' is not two of the environments", text),
                     fmt::format("use two of {}, or their numbers from 1", fmt::join(names, ", ")));
}

// Where the frames of one technique go.
class FrameSink {
  public:
    FrameSink(const RelightArguments& arguments, Technique technique, size_t frames)
        : pattern_(fileNamed(arguments.output, {{"{technique}", techniqueName(technique)}})),
          digits_(std::max<size_t>(4, std::to_string(frames - 1).size())) {
        makeFolder();
        if (isVideoName(pattern_))
            video_ = std::make_unique<VideoWriter>(pattern_, arguments.width, arguments.height,
                                                   arguments.framesPerSecond);
    }
    bool isLinear() const { return pattern_.ends_with(".exr"); }
    void add(size_t frame, const FloatImage& radiance) { writeExrImage(fileOf(frame), radiance); }
    void add(size_t frame, const ByteImage& picture) {
        if (video_)
            video_->add(picture);
        else
            writePng(fileOf(frame), picture);
    }
    void finish() {
        if (video_) video_->finish();
        logNote("wrote " + pattern_);
    }
    const std::string& pattern() const { return pattern_; }

  private:
    std::string fileOf(size_t frame) const {
        return fileNamed(pattern_, {{"{frame}", fmt::format("{:0{}}", frame, digits_)}});
    }
    void makeFolder() const {
        const std::filesystem::path folder = std::filesystem::path(pattern_).parent_path();
        std::error_code error;
        if (!folder.empty()) std::filesystem::create_directories(folder, error);
        if (error) throw OutputError(folder.string(), fmt::format("cannot be made: {}", error.message()));
        // A killed run may have left half a video.
        removeStaleTemporaries(folder.empty() ? std::filesystem::path(".") : folder);
    }

    std::string pattern_;
    size_t digits_;
    std::unique_ptr<VideoWriter> video_;
};

}  // namespace

std::vector<SequenceFrame> sequenceFrames(const RelightArguments& arguments,
                                          const std::vector<std::string>& names,
                                          const std::vector<double>& weights) {
    std::optional<std::pair<size_t, size_t>> ends;
    if (arguments.transitionFrames > 0) ends = transitionEnds(arguments.transitionEnds, names);
    const int count = arguments.sequenceFrames();
    std::vector<SequenceFrame> frames;
    for (int i = 0; i < count; ++i) {
        const double turn = 2 * std::numbers::pi * i / count;
        SequenceFrame frame;
        frame.light = {weights, arguments.rotationRad()};
        if (arguments.turntableFrames > 0) frame.cameraTurnRad = turn;
        if (arguments.rotateLightFrames > 0) frame.light.rotationRad += turn;
        if (ends) {
            const double share = double(i) / (count - 1);
            std::ranges::fill(frame.light.weights, 0.0);
            frame.light.weights[ends->first] = (1 - share) * weights[ends->first];
            frame.light.weights[ends->second] = share * weights[ends->second];
        }
        frames.push_back(std::move(frame));
    }
    return frames;
}

Camera turnedCamera(const Camera& camera, double turnRad) {
    Camera turned = camera;
    const Vec3d offset = (camera.eye - camera.target).cast<double>();
    turned.eye = camera.target + Vec3f((rotationAboutUp(turnRad) * offset).cast<float>());
    return turned;
}

Report runSequence(const RelightArguments& arguments) {
    const Stopwatch watch;
    RelightScene scene(arguments);
    std::vector<std::string> names;
    for (const Environment& environment : scene.data().environments) names.push_back(environment.name);
    const std::vector<SequenceFrame> frames = sequenceFrames(arguments, names, scene.data().weights);
    const Camera camera = arguments.camera(scene.bounds());
    std::vector<Technique> techniques;
    for (const Technique technique : scene.data().techniques)
        if (arguments.isAsked(technique)) techniques.push_back(technique);
    std::vector<std::unique_ptr<FrameSink>> sinks;
    for (const Technique technique : techniques)
        sinks.push_back(std::make_unique<FrameSink>(arguments, technique, frames.size()));

    std::optional<double> exposure = arguments.exposureStops;
    {
        Progress progress("drawing", frames.size() * techniques.size(), "frames");
        for (size_t i = 0; i < frames.size(); ++i) {
            scene.setLight(frames[i].light);
            const Camera view = turnedCamera(camera, frames[i].cameraTurnRad);
            for (size_t t = 0; t < techniques.size(); ++t) {
                const FloatImage radiance = scene.render(techniques[t], view).radiance;
                if (!exposure) exposure = autoExposure(radiance, scene.surface(view));
                if (sinks[t]->isLinear())
                    sinks[t]->add(i, radiance);
                else
                    sinks[t]->add(i, scene.picture(techniques[t], view, radiance, *exposure));
                progress.advance(1);
            }
        }
    }
    std::vector<std::string> outputs;
    for (const auto& sink : sinks) {
        sink->finish();
        outputs.push_back(sink->pattern());
    }
    Report report;
    report.set("bundle", arguments.bundlePath)
        .set("technique", fmt::format("{}", fmt::join(arguments.techniqueNames, ",")))
        .set("width", arguments.width)
        .set("height", arguments.height)
        .set("frames", uint64_t(frames.size()))
        .set("fps", arguments.framesPerSecond)
        .set("exposure_stops", *exposure)
        .set("outputs", fmt::format("{}", fmt::join(outputs, ",")))
        .set("context", glContextKindName(scene.context().kind()))
        .set("renderer", scene.context().rendererName())
        .set("seconds", watch.seconds());
    return report;
}

}  // namespace prt::tools
