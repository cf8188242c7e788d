// Sources: [IEC61966-2-1]; the tone curves are those of precompute/io/image.h. sRGB is encoded in the shader,
// because a window's own framebuffer need not be able to.
#include "runtime/display_pass.h"

#include <fmt/format.h>

#include <cmath>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "runtime/renderer.h"

namespace prt {

void checkImageSize(const GlFunctions& gl, const char* where, int width, int height, const char* remedy) {
    const GLint edge = glInteger(gl, GL_MAX_TEXTURE_SIZE);
    if (width < 1 || height < 1 || width > edge || height > edge)
        throw InputError(where, fmt::format("size {}x{} is outside 1x1 to {}x{}", width, height, edge, edge),
                         remedy);
}

DisplayPass::DisplayPass(const GlContext& context)
    : context_(context),
      program_(context.gl(), "screen.vert", "display.frag", ""),
      vertexArray_(makeVertexArray(context.gl())) {}

void DisplayPass::draw(GLuint image, int width, int height, const DisplayOptions& options,
                       const DrawTarget& target) const {
    const GlFunctions& gl = context_.gl();
    if (gl.CheckNamedFramebufferStatus(target.framebuffer, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw InputError("draw target",
                         target.framebuffer == 0
                             ? "the context has no framebuffer of its own to draw into"
                             : fmt::format("framebuffer {} cannot be drawn into", target.framebuffer),
                         "give a complete framebuffer object");
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, target.framebuffer);
    gl.Viewport(target.x, target.y, width, height);
    gl.ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    gl.Disable(GL_DEPTH_TEST);
    const bool encodes = gl.IsEnabled(GL_FRAMEBUFFER_SRGB);
    if (encodes) gl.Disable(GL_FRAMEBUFFER_SRGB);
    program_.use();
    program_.set("corner", target.x, target.y);
    program_.set("exposure", float(std::exp2(options.exposureStops)));
    program_.set("toneCurve", int(options.toneCurve));
    gl.BindTextureUnit(0, image);
    gl.BindVertexArray(vertexArray_.name());
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    if (encodes) gl.Enable(GL_FRAMEBUFFER_SRGB);
}

void DisplayPass::draw(const FloatImage& image, const DisplayOptions& options, const DrawTarget& target) {
    PRT_CHECK(image.channels == 3 || image.channels == 4);
    PRT_CHECK_EQ(image.pixels.size(), size_t(image.width) * size_t(image.height) * size_t(image.channels));
    const GlFunctions& gl = context_.gl();
    checkImageSize(gl, "image", image.width, image.height, "scale it down");
    if (uploadedWidth_ != image.width || uploadedHeight_ != image.height) {
        uploaded_ = makeImage(gl, GL_RGBA32F, image.width, image.height);
        uploadedWidth_ = image.width;
        uploadedHeight_ = image.height;
    }
    gl.TextureSubImage2D(uploaded_.name(), 0, 0, 0, image.width, image.height,
                         image.channels == 3 ? GL_RGB : GL_RGBA, GL_FLOAT, image.pixels.data());
    draw(uploaded_.name(), image.width, image.height, options, target);
}

}  // namespace prt
