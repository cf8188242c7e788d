// Distant light as an image over the sphere, and as spherical harmonics.
//
// Latitude-longitude images are oriented as in OpenEXR's ImfEnvmap: the top row looks up (+Y), the centre
// column along +Z, the left edge is longitude +π. Texels are areas: column x covers longitudes π − 2πx/w … π
// − 2π(x+1)/w,
//   ω = (sin λ cos β, sin β, cos λ cos β), latitude β, longitude λ.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "precompute/math/vec.h"

namespace prt {

/// A latitude-longitude image, linear RGB radiance, rows from the top.
struct LatLongView {
    int width = 0, height = 0;
    std::span<const float> rgb;  ///< [height×width×3]
};

/// Direction of an image point; x, y in texels with centres at half-integers.
Vec3d latLongDirection(double x, double y, int width, int height);
/// Image point (x, y in texels) that a direction falls on.
std::array<double, 2> latLongPoint(const Vec3d& direction, int width, int height);
/// Exact solid angle of every texel of row y, sr.
double latLongTexelSolidAngle(int y, int width, int height);

/// Radiance in spherical harmonics, one vector per colour.
struct EnvironmentSh {
    int shOrder = 0;
    std::array<std::vector<float>, 3> rgb;  ///< each [n²]
};

/// Projects an environment: Σ_texels L ΔΩ Y, with Y at texel centres and exact solid angles, rows in
/// parallel.
/// @param shOrder  1..kMaxShOrder
EnvironmentSh projectEnvironment(const LatLongView& image, int shOrder);

/// The same light turned about the up axis by angleRad (see rotationAboutUp): light at longitude λ moves to
/// λ + angleRad. Turning by 2πk/width equals rolling the image by k columns to the left: the light of column
/// x moves to column x − k, so that afterwards column x shows what column x + k (modulo width) showed.
EnvironmentSh rotateEnvironmentAboutUp(const EnvironmentSh& environment, double angleRad);

/// Σ_k weight_k · environment_k; all of one order.
EnvironmentSh blendEnvironments(std::span<const EnvironmentSh> environments, std::span<const double> weights);

}  // namespace prt
