// Environments as the picture's background.
#pragma once

#include <vector>

#include "precompute/io/environment_file.h"
#include "precompute/io/scene.h"
#include "precompute/io/surface_image.h"

namespace prt::tools {

/// Σ weight · image, at the size of the largest, 3 channels.
FloatImage blendImages(const std::vector<Environment>& environments, const std::vector<double>& weights);

/// Fills the pixels in which nothing is seen.
/// @param image        [3 channels] of the surface's size
/// @param bounds       of the scene, as the camera frame takes them
/// @param rotationRad  turn of the environment about the up axis
void paintBackground(FloatImage& image, const SurfaceImage& surface, const Camera& camera,
                     const Bounds& bounds, const FloatImage& latLong, double rotationRad);

}  // namespace prt::tools
