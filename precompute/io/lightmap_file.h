// lightmaps/ENV.exr: the light that arrives at the points of a bundle under one environment.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "precompute/io/image.h"
#include "precompute/io/visibility_file.h"

namespace prt {

/// Bands of a lightmap, and their coefficients.
inline constexpr int kLightmapShOrder = 3;
inline constexpr int kLightmapCoefficients = 9;

/// Incident radiance in spherical harmonics. Irradiance at a shading normal n, per colour:
///   E(n) = Σ_i L_i A_i Y_i(n),
/// A_i Y_i(n) what evalClampedCosineSh(kLightmapShOrder, n) gives.
struct Lightmap {
    PointGrid grid;  ///< that of visibility.exr
    /// [count][3 colours][9] radiance in the environment's unit, index shIndex(band, m), world space
    std::vector<float> coefficients;
    int bounces = 0;         ///< diffuse reflections that are in it, 0..kMaxLightmapBounces
    double rotationDeg = 0;  ///< of the environment about the up axis, as in prt relight
    /// Estimated RMS sampling error of irradiance, as a share of its RMS over the valid points
    double relativeError = 0;
    Projection projection = kPlainProjection;       ///< how the coefficients were made
    std::map<std::string, std::string> attributes;  ///< environmentName, environmentHash
};
inline constexpr int kMaxLightmapBounces = 64;

/// Irradiance as a picture of the grid, 3 channels, its last row filled with zeros; 0 where there is no
/// normal. Not negative: three bands of a strong light may dip below 0 beside it.
/// @param normals  [count] unit or zero; of visibility.exr for the geometric ones
/// @source [RamamoorthiHanrahan2001, Eq. 11]
FloatImage lightmapIrradiance(const Lightmap& map, std::span<const Vec3f> normals);

/// lightmaps/ENV.exr (characters outside [A-Za-z0-9_-] become '_').
std::string lightmapFileName(const std::string& environmentName);

/// Channels R.00 … R.08, G.00 … B.08: half, or float where a value is beyond half's range; ZIP, scanlines.
/// @throws OutputError
void writeLightmapFile(const std::string& path, const Lightmap& map);
/// Checks conventions, channels and sizes before it allocates.
/// @throws InputError  another content or order, attributes missing or out of range, channels missing, pixels
///                     damaged or not finite
Lightmap readLightmapFile(const std::string& path);

}  // namespace prt
