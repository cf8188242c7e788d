// Rotation of spherical-harmonic expansions with the turn about y replaced by its truncated Taylor series:
// fast, and right for small angles only.
#pragma once

#include <cstddef>
#include <span>

#include "precompute/math/sh_rotation.h"
#include "precompute/math/sh_rotation_matrix.h"

namespace prt {

/// Where the series of R_y(β) = exp(βG) ends: after βG; with the diagonal of β²G²/2 ("order 1.5"); with all
/// of it.
enum class ShTaylorOrder { One, OneAndHalf, Two };

/// Rotates about y (+Z turns towards +X) by the truncated series. The error of the longest vector of band l
/// is that of its largest eigenvalue lβ: (lβ)²/2, (lβ)³/6 after the first and second term; more terms do not
/// help where lβ > 2.
/// @param shOrder  n, 1..kMaxShOrder
/// @param betaRad  angle
/// @param in, out  [n²]; the same memory, or apart
/// @source [Krivanek2006, Sec. 3] in our orientation: theirs is the inverse rotation
void rotateShYTaylor(double betaRad, ShTaylorOrder order, int shOrder, std::span<const float> in,
                     std::span<float> out);
void rotateShYTaylor(double betaRad, ShTaylorOrder order, int shOrder, std::span<const double> in,
                     std::span<double> out);

/// Rotates about z, y and z, the turn about y by the truncated series: (Rf)(ω) ≈ f(Rᵀω).
/// @param targetFromSource  rotation matrix R, checked to 1e-3
/// @param angles   instead of the matrix; −π <= β <= π
/// @param shOrder  n, 1..kMaxShOrder
/// @param in, out  [n²]; the same memory, or apart
/// @source [Krivanek2006, Sec. 3] in our orientation, the order of the steps included
void rotateShTaylor(const Mat3d& targetFromSource, ShTaylorOrder order, int shOrder,
                    std::span<const float> in, std::span<float> out);
void rotateShTaylor(const ZyzAngles& angles, ShTaylorOrder order, int shOrder, std::span<const float> in,
                    std::span<float> out);
void rotateShTaylor(const ZyzAngles& angles, ShTaylorOrder order, int shOrder, std::span<const double> in,
                    std::span<double> out);

/// Every vector by its own rotation, as a structure of arrays: parameters as for rotateShSoa. Allocates
/// nothing.
/// @param rotations  [9×stride] entry (row, column) of rotation k at rotations[(3·row + column)·stride + k]
void rotateShTaylorSoa(std::span<const float> rotations, ShTaylorOrder order, int shOrder, size_t count,
                       size_t stride, std::span<const float> in, std::span<float> out);

/// G = dR_y/dβ at β = 0: antisymmetric, not zero only next to the diagonal.
/// @source [Krivanek2006, Fig. 2, left] with the opposite sign: theirs is the inverse rotation
ShBandMatrix shYRotationGenerator(int shOrder);
/// The truncated series as a matrix.
ShBandMatrix shYTaylorMatrix(double betaRad, ShTaylorOrder order, int shOrder);
/// The series with terms up to (βG)^lastTerm/lastTerm!, which goes to R_y(β) as lastTerm grows, for any β.
/// @param lastTerm  >= 0
ShBandMatrix shYTaylorSeries(double betaRad, int lastTerm, int shOrder);

/// Multiplications of a rotation with the Taylor series of order 1.5 by the paper's count: two turns about z
/// of 2n(n − 1), and five for every coefficient.
/// @source [Krivanek2006, Sec. 3.2]
constexpr int taylorMultiplications(int shOrder) { return 9 * shOrder * shOrder - 4 * shOrder; }

}  // namespace prt
