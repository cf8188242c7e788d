// Real spherical harmonics: indices, evaluation and projection.
//
// Convention of the whole project: orthonormal on the sphere, with the Condon-Shortley phase, polar axis +Z:
//   Y_1,-1 = -sqrt(3/4pi) y,  Y_1,0 = sqrt(3/4pi) z,  Y_1,1 = -sqrt(3/4pi) x.
// shOrder n is the number of bands: n^2 coefficients, in the order of shIndex.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "precompute/math/vec.h"

namespace prt {

/// Largest number of bands the mathematics goes to (products, exact cosine).
inline constexpr int kMaxShOrder = 24;
/// Largest number of bands a bundle holds.
inline constexpr int kMaxBundleShOrder = 10;

/// @param band  l >= 0     @param m  -l..l
constexpr int shIndex(int band, int m) { return band * (band + 1) + m; }
/// Coefficients of shOrder bands.
constexpr int shCount(int shOrder) { return shOrder * shOrder; }
/// The shOrder that a number of coefficients belongs to; 0 where it is not the square of 1..kMaxShOrder.
constexpr int shOrderFromCount(size_t count) {
    for (int n = 1; n <= kMaxShOrder; ++n)
        if (size_t(shCount(n)) == count) return n;
    return 0;
}

/// Evaluates all basis functions in one direction. In float a function of band l errs by at most 5e-6 of the
/// largest value its band has, sqrt((2l + 1) / 4π), to the last band; in double by 1e-14.
/// @param shOrder    1..kMaxShOrder
/// @param direction  unit
/// @param out        [n²]
/// @source [Sloan2008, A.2]: polynomials and recurrences in z, with cos/sin(m phi) times sin^m(theta) as
/// polynomials in x and y
void evalSh(int shOrder, const Vec3f& direction, std::span<float> out);
void evalSh(int shOrder, const Vec3d& direction, std::span<double> out);

/// Evaluates many directions, with the precision of evalSh in float.
/// @param out  [N×n²], one row per direction
void evalShBatch(int shOrder, std::span<const Vec3f> directions, std::span<float> out);

/// Evaluates many directions as a structure of arrays, with the precision of evalSh in float; several times
/// faster per direction. Allocates nothing.
/// @param x, y, z  [N] coordinates of unit directions
/// @param out      function i in direction k at out[i·stride + k]; at least (n² − 1)·stride + N floats, apart
///                 from x, y and z. What lies between the rows is left alone. Fastest where rows begin at
///                 multiples of 64 bytes that share no cache sets.
/// @param stride   >= N
/// @source as evalSh
void evalShSoa(int shOrder, std::span<const float> x, std::span<const float> y, std::span<const float> z,
               std::span<float> out, size_t stride);

/// Projects samples of equal weight: c_i = (4π/N) Σ_k f_k Y_i(ω_k).
/// @param directions  [N] unit, uniform over the sphere
/// @param values      [N]
/// @return [n²]
/// @throws InputError  no directions
std::vector<float> projectShSamples(int shOrder, std::span<const Vec3f> directions,
                                    std::span<const float> values);

/// Projects a function by a product quadrature that is exact for polynomials up to `degree` (see
/// sphereQuadrature).
/// @return [n²]
std::vector<double> projectSh(int shOrder, const std::function<double(const Vec3d&)>& function,
                              int degree = 127);

/// Value of an expansion in one direction: Σ_i c_i Y_i(ω).
double evalShExpansion(int shOrder, std::span<const float> coefficients, const Vec3d& direction);

/// A node of a quadrature over the sphere.
struct SphereNode {
    Vec3d direction;  ///< unit
    double weightSr;  ///< all weights sum to 4π
};
/// Gauss-Legendre in z times the trapezoid rule in azimuth: exact for polynomials up to `degree`.
std::vector<SphereNode> sphereQuadrature(int degree);

}  // namespace prt
