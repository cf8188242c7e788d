// How bright pictures are shown.
#pragma once

#include "precompute/io/image.h"
#include "precompute/io/surface_image.h"

namespace prt::tools {

/// The exposure, stops, at which nine tenths of the covered pixels are below 0.6 of white; 0 where none is
/// covered or all are black.
/// @param radiance  [3 channels] of the surface's size
double autoExposure(const FloatImage& radiance, const SurfaceImage& surface);

}  // namespace prt::tools
