// Shows linear images on displays. Internal.
#pragma once

#include "precompute/io/image.h"
#include "runtime/gl_context.h"
#include "runtime/gl_objects.h"

namespace prt {

struct DisplayOptions;
struct DrawTarget;

/// Exposure, tone curve and sRGB encoding on the way into a framebuffer. Needs the context to be current.
class DisplayPass {
  public:
    /// @param context  outlives this object
    explicit DisplayPass(const GlContext& context);

    /// @param image  texture of that size, top row first
    /// @throws InputError  the target is no framebuffer that can be drawn into
    void draw(GLuint image, int width, int height, const DisplayOptions& options,
              const DrawTarget& target) const;
    /// Uploads the image first.
    /// @param image  3 or 4 channels
    /// @throws InputError  larger than OpenGL takes, or the target as above
    void draw(const FloatImage& image, const DisplayOptions& options, const DrawTarget& target);

  private:
    const GlContext& context_;
    GlProgram program_;
    GlObject vertexArray_, uploaded_;
    int uploadedWidth_ = 0, uploadedHeight_ = 0;
};

/// Of images that somebody asks for or brings.
/// @throws InputError  (of `where`) smaller than 1x1 or larger than OpenGL takes
void checkImageSize(const GlFunctions& gl, const char* where, int width, int height, const char* remedy);

}  // namespace prt
