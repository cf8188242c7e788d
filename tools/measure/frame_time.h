// Time of a frame by technique: frames of all techniques and of the base pass in turn, and what they say.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/renderer.h"
#include "runtime/technique.h"

namespace prt::tools {

/// Frames of one size, in milliseconds. Every round drew every technique once, each right after a base pass
/// of its own: what a machine does besides falls on both alike.
struct FrameSamples {
    std::vector<std::vector<double>> base;        ///< [techniques][rounds]
    std::vector<std::vector<double>> techniques;  ///< [techniques][rounds]
};

/// Draws `rounds` rounds, after one that is not counted. Every round starts with another technique, so that
/// none always follows the same one.
/// @param techniques  as the renderer has them, each with its light
/// @param rounds      at least 1
/// @throws Interrupted; InputError  as Renderer::render
FrameSamples sampleFrames(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                          const std::vector<Technique>& techniques, int rounds);

/// Median and quartiles, by linear interpolation between sorted values.
struct Spread {
    double median = 0, low = 0, high = 0;
};
/// @param values  at least one
Spread spreadOf(std::vector<double> values);

struct TechniqueTime {
    double frameMs = 0;  ///< median of whole frames
    Spread lightMs;      ///< of the same frames less the base pass right before each
    /// lightMs to that of the reference technique: of the medians, and quartiles of the rounds' own; NaN
    /// without one
    Spread ratio;
};
struct FrameTimes {
    Spread baseMs;
    std::vector<TechniqueTime> techniques;
};
/// @param reference  index of the technique that ratios are taken to
FrameTimes summarizeFrames(const FrameSamples& samples, std::optional<size_t> reference);

/// Distance at which a view covers enough of the picture: the largest of 1, 1/1.1, 1/1.1² … ≥ 0.1 that does;
/// else the one that covers most.
/// @param coverage  share of covered pixels, 0..1, at a distance
/// @param wanted    0..1
double coveringDistance(const std::function<double(double distance)>& coverage, double wanted);

/// Share of the pixels that show the scene, 0..1.
double coveredShare(const SurfaceImage& surface);

/// @param name  "osmesa", "egl" or "window" (a hidden one)
/// @throws InputError  there is none
std::unique_ptr<GlContext> makeContext(std::string_view name);

/// Milliseconds of the paper's table, 1280×800, GeForce GTX 295, base pass included; NaN where it has none.
/// @param name  as techniqueName
/// @source [IwanickiSloan2012, Sec. 5]
double paperMilliseconds(std::string_view name);

}  // namespace prt::tools
