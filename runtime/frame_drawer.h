// Draws what a camera sees of a scene: first the surface, then its light. Internal.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/camera_frame.h"
#include "runtime/coefficient_images.h"
#include "runtime/display_pass.h"
#include "runtime/frame_targets.h"
#include "runtime/gl_context.h"
#include "runtime/gl_objects.h"
#include "runtime/light_program.h"
#include "runtime/renderer.h"
#include "runtime/scene_images.h"

namespace prt {

/// The second pass of a frame.
struct LightPass {
    bool suns = true;
    bool background = true;
    /// Of several samples to a pixel: how they are shown before they are averaged; none: they are linear.
    const DisplayOptions* shown = nullptr;
};

/// Needs the context to be current. The order of a frame is begin, drawSurface, drawLight.
class FrameDrawer {
  public:
    /// @param context      outlives this object
    /// @throws InputError  as SceneImages
    FrameDrawer(const GlContext& context, const Scene& scene);

    /// Lights besides a program's own, at most kMostSuns. Shadows that are there already are not sent again.
    /// @throws InputError  larger than OpenGL takes
    void setSuns(std::span<const SunLight> suns, const PointGrid& grid);
    /// An image that is there already is not sent again.
    /// @throws InputError  larger than OpenGL takes
    void setBackground(const FloatImage& latLong, double rotationRad);

    /// Backgrounds and shadows that were sent.
    uint64_t uploads() const { return uploads_; }

    /// Readies images of a size.
    /// @throws InputError  a size or a camera that cannot be; more samples than OpenGL takes
    CameraFrame begin(const Camera& camera, const RenderOptions& options);
    /// The images of the last begin().
    const FrameTargets& targets() const { return *targets_; }
    void drawSurface(const CameraFrame& camera, bool normalMap);
    /// @param use  brings light.frag for these pixels into use, with its own uniforms and textures set
    void drawLight(const CameraFrame& camera, const std::function<const GlProgram&(Pixels)>& use,
                   const LightPass& pass);

  private:
    void classify();
    void drawPixels(const GlProgram& program, const CameraFrame& camera, const LightPass& pass) const;
    void drawBackground(const CameraFrame& camera, const LightPass& pass);
    void setEnvironment(const GlProgram& program, const CameraFrame& camera) const;

    const GlContext& context_;
    const GlFunctions& gl_;
    SceneImages scene_;
    Bounds bounds_;
    std::vector<SunLight> suns_;  // without their shadows
    CoefficientImage sunShadows_;
    GlObject background_;
    std::string shadowsHash_, backgroundHash_;  // of what these hold
    uint64_t uploads_ = 0;
    float backgroundRotationRad_ = 0;
    GlProgram backgroundProgram_;
    /// Of several samples; made when first drawn with.
    std::optional<GlProgram> shownBackgroundProgram_, classesProgram_;
    GlObject vertexArray_;
    std::unique_ptr<FrameTargets> single_, several_;
    FrameTargets* targets_ = nullptr;  // one of these
};

}  // namespace prt
