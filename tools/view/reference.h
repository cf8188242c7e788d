// The ray-traced truth of the viewer's picture, traced while the viewer goes on.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "precompute/io/environment_file.h"
#include "precompute/io/surface_image.h"
#include "precompute/rays/ray_caster.h"
#include "tools/view/state.h"

namespace prt::tools {

/// What a reference is of.
struct ReferencePicture {
    OrbitCamera camera;
    int width = 0, height = 0;  ///< pixels
    bool normalMap = true;
    double rotationRad = 0;            ///< of the environments about the up axis
    std::vector<size_t> environments;  ///< that shine, by number, rising

    bool operator==(const ReferencePicture&) const = default;
    /// Whether it can be lit by those weights: it has all environments of weight > 0.
    /// @param weights  [environments]
    bool covers(std::span<const double> weights) const;
};

struct TracedReference {
    ReferencePicture picture;
    SurfaceImage surface;
    std::vector<std::vector<float>> irradiance;  ///< [picture.environments][pixels×3]
    /// Σ weight · irradiance.
    /// @param weights  [environments] of which the picture covers all
    /// @return [pixels×3]
    std::vector<float> blend(std::span<const double> weights) const;
};

/// Traces one picture at a time, in a thread of its own.
class ReferenceTracer {
  public:
    /// @param caster, environments  must outlive the object
    /// @param rays    directions, as makeReferenceDirections
    /// @param wake    called from the thread after every few rows and at the end; may be empty
    ReferenceTracer(const RayCaster& caster, const std::vector<Environment>& environments, int rays,
                    std::function<void()> wake);
    ~ReferenceTracer();  ///< stops what is under way

    /// Begins, unless just this picture is under way or done; stops what else is.
    /// @param surface  called if it is to begin: what the camera sees
    void start(const ReferencePicture& picture, const std::function<SurfaceImage()>& surface);
    void stop();
    /// Takes what was finished since the last call.
    /// @return whether there was something
    /// @throws  what the thread threw
    bool poll();
    /// The picture under way; null where there is none.
    const ReferencePicture* underWay() const;
    double progress() const;  ///< of it, 0..1
    /// The last picture that was finished; null before there was one.
    const TracedReference* result() const { return result_.get(); }

  private:
    struct Job;
    static void run(Job& job, const RayCaster& caster, const std::vector<Environment>& environments, int rays,
                    const std::function<void()>& wake);

    const RayCaster& caster_;
    const std::vector<Environment>& environments_;
    int rays_;
    std::function<void()> wake_;
    std::unique_ptr<Job> job_;
    std::vector<std::unique_ptr<Job>> stopping_;
    std::unique_ptr<TracedReference> result_;
};

}  // namespace prt::tools
