// Pictures of a relit scene, and what differs between two of them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "precompute/io/image.h"
#include "precompute/io/surface_image.h"

namespace prt::tools {

struct Picture {
    FloatImage radiance;            ///< 3 channels, over the background
    std::vector<float> irradiance;  ///< [pixels×3]; 0 where nothing is seen
};

/// albedo/π · E of every covered pixel; 0 elsewhere.
/// @param irradiance  [pixels×3]
/// @return 3 channels
FloatImage radianceOf(const std::vector<float>& irradiance, const SurfaceImage& surface);

/// Differences are shown so many times as large [IwanickiSloan2012, Figs. 5 and 6].
inline constexpr float kDifferenceScale = 4;
/// kDifferenceScale × |a − b| of what is shown (nothing is darker than black); 0 where nothing is seen.
/// @param image, against  3 channels of the surface's size
FloatImage scaledDifference(const FloatImage& image, const FloatImage& against, const SurfaceImage& surface);

/// @throws OutputError
void writePng(const std::filesystem::path& path, const ByteImage& image);

}  // namespace prt::tools
