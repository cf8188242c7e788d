// Sources: OpenGL 4.5 core profile, section 8.19 (multisampled textures).
#include "runtime/frame_targets.h"

#include <fmt/format.h>

#include <algorithm>

#include "precompute/base/error.h"

namespace prt {
namespace {

void checkSamples(const GlFunctions& gl, int samples) {
    GLint most = samples;
    for (const GLenum limit :
         {GL_MAX_COLOR_TEXTURE_SAMPLES, GL_MAX_DEPTH_TEXTURE_SAMPLES, GL_MAX_INTEGER_SAMPLES})
        most = std::min(most, glInteger(gl, limit));
    if (samples > most && samples > 1)
        throw InputError(
            "image",
            fmt::format("{} samples of a pixel are more than the {} that OpenGL takes here", samples, most),
            "use 1 sample");
}

}  // namespace

FrameTargets::FrameTargets(const GlContext& context, int imageWidth, int imageHeight, int samplesOfPixel)
    : width(imageWidth), height(imageHeight), samples(samplesOfPixel) {
    const GlFunctions& gl = context.gl();
    checkSamples(gl, samples);
    for (GlObject* image : {&place, &normal, &albedo})
        *image = makeSampledImage(gl, GL_RGBA32F, width, height, samples);
    triangle = makeSampledImage(gl, GL_R32UI, width, height, samples);
    depth = makeSampledImage(gl, GL_DEPTH_COMPONENT32F, width, height, samples);
    for (GlObject* image : {&radiance, &irradiance}) *image = makeImage(gl, GL_RGBA32F, width, height);
    if (samples > 1) classes = makeImage(gl, GL_DEPTH_COMPONENT32F, width, height);
    context.check("making the image");
    surfaceFrame =
        makeFramebufferOver(gl, {place.name(), normal.name(), albedo.name(), triangle.name()}, depth.name());
    if (samples > 1) classFrame = makeFramebufferOver(gl, {}, classes.name());
    lightFrame = makeFramebufferOver(gl, {radiance.name(), irradiance.name()},
                                     samples > 1 ? classes.name() : depth.name());
}

}  // namespace prt
