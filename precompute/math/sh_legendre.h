// What the spherical harmonics are made of: normalised Legendre functions and Gauss-Legendre nodes.
#pragma once

#include <numbers>
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

/// √a at compile time, a > 0, by Newton's iteration.
constexpr double constantSquareRoot(double a) {
    double root = a > 1 ? a : 1;
    for (;;) {  // falls until rounding stops it
        const double next = 0.5 * (root + a / root);
        if (next >= root) return root;
        root = next;
    }
}

template <typename T>
constexpr LegendreRecurrence<T> makeLegendreRecurrence() {
    LegendreRecurrence<T> t{};
    double diagonal = constantSquareRoot(1 / (4 * std::numbers::pi));
    for (int m = 0; m < kMaxShOrder; ++m) {
        // the sign is Condon-Shortley's
        if (m > 0) diagonal *= -constantSquareRoot((2.0 * m + 1) / (2.0 * m));
        t.diagonal[m] = T(m > 0 ? diagonal * std::numbers::sqrt2 : diagonal);
        for (int l = m + 1; l < kMaxShOrder; ++l) {
            const double p = l - 1.0;
            const double rise = constantSquareRoot((4.0 * l * l - 1) / (double(l) * l - double(m) * m));
            const double ratio = (p * p - double(m) * m) / (4 * p * p - 1);
            t.rise[legendreIndex(l, m)] = T(rise);
            t.fall[legendreIndex(l, m)] = T(l > m + 1 ? rise * constantSquareRoot(ratio) : 0);
        }
    }
    return t;
}
/// The constants for T float and double.
template <typename T>
inline constexpr LegendreRecurrence<T> kLegendreRecurrence = makeLegendreRecurrence<T>();

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
