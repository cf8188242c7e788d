// The clamped cosine H(ω) = max(0, n·ω) in spherical harmonics, all bands exact.
#pragma once

#include <span>

#include "precompute/math/vec.h"

namespace prt {

/// A_l with E_lm = A_l L_lm for irradiance of an unoccluded surface: π, 2π/3, π/4, 0, −π/24, …
/// @param band  0..kMaxShOrder−1
/// @source [RamamoorthiHanrahan2001, Eq. 19]
double clampedCosineBand(int band);

/// Coefficients of max(0, n·ω): A_l Y_lm(n).
/// @param bands   number of bands, 1..kMaxShOrder
/// @param normal  unit
/// @param out     [bands²]
void evalClampedCosineSh(int bands, const Vec3f& normal, std::span<float> out);

}  // namespace prt
