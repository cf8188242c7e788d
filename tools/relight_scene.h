// A bundle that is ready to be drawn under changing light: what prt relight's pictures and sequences share.
#pragma once

#include <optional>
#include <vector>

#include "precompute/io/surface_image.h"
#include "runtime/gl_context.h"
#include "runtime/renderer.h"
#include "tools/relight_arguments.h"
#include "tools/relight_suns.h"
#include "tools/relight_techniques.h"

namespace prt::tools {

/// The light of the moment.
struct RelightLight {
    std::vector<double> weights;  ///< [environments]
    double rotationRad = 0;       ///< turn of the environments about the up axis
    bool operator==(const RelightLight&) const = default;
};

class RelightScene {
  public:
    /// Loads the bundle and uploads what the arguments' techniques take.
    /// @param arguments  must outlive the object
    /// @throws InputError  as loadRelightData, GlContext and Renderer
    explicit RelightScene(const RelightArguments& arguments);

    /// Background, unless the arguments have none or no picture is written, and suns, where the arguments
    /// have them. Does nothing where light is what it was.
    /// @return suns
    size_t setLight(const RelightLight& light);
    /// What is behind the scene under the light of setLight(); nothing without a background.
    const FloatImage& background() const { return background_; }
    /// Under the light of setLight(), where technique is one of data().techniques.
    /// @param origin  as RelightTechniques::setLight gives it; may be null
    RenderedFrame render(Technique technique, const Camera& camera, const char** origin = nullptr);

    /// The frame of render() as .png files and videos show it. Of four samples, exposure and tone curve come
    /// before their mean.
    /// @param radiance  that frame's
    /// @return 3 channels
    ByteImage picture(Technique technique, const Camera& camera, const FloatImage& radiance,
                      double exposureStops);
    /// Of the pixels' centres.
    SurfaceImage surface(const Camera& camera);

    const RelightData& data() const { return data_; }
    RelightTechniques& techniques() { return techniques_; }
    const GlContext& context() const { return context_; }
    Renderer& renderer() { return renderer_; }
    const RenderOptions& options() const { return options_; }
    const Bounds& bounds() const { return bounds_; }

  private:
    const RelightArguments& arguments_;
    RelightData data_;
    RelightTechniques techniques_;
    RelightSuns suns_;
    RenderOptions options_;
    Bounds bounds_;
    GlContext context_;
    Renderer renderer_;
    std::optional<RelightLight> light_;
    FloatImage background_;
    size_t sunCount_ = 0;
};

}  // namespace prt::tools
