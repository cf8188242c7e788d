// Rotation of spherical-harmonic expansions.
#pragma once

#include <span>

#include "precompute/math/vec.h"

namespace prt {

/// Rotates an expansion: (Rf)(ω) = f(Rᵀω), by the decomposition Z·X₋₉₀·Z·X₊₉₀·Z.
/// @param targetFromSource  rotation matrix R
/// @param shOrder           1..kMaxShOrder
/// @param in, out           [n²]; may be the same memory
/// @source [Kautz2002], [Krivanek2006, Sec. 2.2] in our own orientation (see the errata in
/// tools/docs/papers.md)
void rotateSh(const Mat3d& targetFromSource, int shOrder, std::span<const float> in, std::span<float> out);
void rotateSh(const Mat3d& targetFromSource, int shOrder, std::span<const double> in, std::span<double> out);

/// Rotation about the up axis (+Y) by angleRad, counter-clockwise seen from above: +Z turns towards +X.
Mat3d rotationAboutUp(double angleRad);

}  // namespace prt
