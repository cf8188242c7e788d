// The images of a frame. Internal.
#pragma once

#include "runtime/gl_context.h"
#include "runtime/gl_objects.h"

namespace prt {

/// Everything drawn for one image size, row 0 at the top.
struct FrameTargets {
    /// @param samples  of a pixel, 1 or more
    /// @throws InputError  more samples than OpenGL takes here
    FrameTargets(const GlContext& context, int imageWidth, int imageHeight, int samplesOfPixel);

    int width, height, samples;
    GlObject place, normal, albedo, triangle, depth;  ///< what is seen, by every sample
    GlObject radiance, irradiance;                    ///< of pixels
    GlObject classes;       ///< depth of pixels of several samples, by what they see (classes.frag)
    GlObject surfaceFrame;  ///< over place, normal, albedo, triangle and depth
    GlObject classFrame;    ///< over classes, if there are several samples
    GlObject lightFrame;    ///< over radiance and irradiance, and over the depth, or classes
};

}  // namespace prt
