// What the spherical harmonics are made of: normalised Legendre functions and Gauss-Legendre nodes.
#pragma once

#include <span>
#include <vector>

#include "precompute/math/sh.h"

namespace prt {

/// Index of (band, m) with 0 <= m <= band among functions of non-negative m.
constexpr int legendreIndex(int band, int m) { return band * (band + 1) / 2 + m; }
constexpr int legendreCount(int shOrder) { return shOrder * (shOrder + 1) / 2; }

/// Constants of the recurrences for Q_lm, with Y_lm = Q_lm(z) Re (x + iy)^m for m >= 0 and
/// Y_l,-m = Q_lm(z) Im (x + iy)^m:
///   Q_mm = diagonal[m],  Q_lm = rise[lm] z Q_l-1,m − fall[lm] Q_l-2,m  (fall = 0 for l = m + 1).
template <typename T>
struct LegendreRecurrence {
    T diagonal[kMaxShOrder];
    T rise[legendreCount(kMaxShOrder)];
    T fall[legendreCount(kMaxShOrder)];
};
template <typename T>
const LegendreRecurrence<T>& legendreRecurrence();

/// N_lm(z) with Y_lm = N_lm cos(m φ) and Y_l,-m = N_lm sin(m φ), sign and √2 included.
/// @param z    −1..1
/// @param out  [legendreCount(shOrder)]
void evalShLegendre(int shOrder, double z, std::span<double> out);

/// Node and weight of a quadrature over [−1, 1].
struct LineNode {
    double z, weight;
};
/// @param count  >= 1; exact for polynomials up to degree 2·count − 1; nodes rise
std::vector<LineNode> gaussLegendre(int count);

}  // namespace prt
