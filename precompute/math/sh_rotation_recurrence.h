// One step of Ivanic and Ruedenberg's recurrence: a band of a rotation matrix from the band below and band 1.
// Internal; constexpr, so that the tables of the fast rotation are made by the compiler from the same lines.
#pragma once

#include <cmath>
#include <type_traits>

#include "precompute/math/sh.h"

namespace prt::detail {

/// √x of x >= 0, also at compile time.
constexpr double recurrenceSqrt(double x) {
    if (!std::is_constant_evaluated()) return std::sqrt(x);
    if (x == 0) return 0;
    double root = x > 1 ? x : 1;
    for (double next = 0.5 * (root + x / root); next < root; next = 0.5 * (root + x / root)) root = next;
    return root;
}

/// A band of a matrix by rows: entry (row, column) with −band <= row, column <= band.
template <typename T>
struct BandView {
    T* data;
    int band;
    constexpr T& operator()(int row, int column) const {
        return data[(row + band) * (2 * band + 1) + column + band];
    }
};

/// P of the recurrence: a product of an entry of band 1 with one of band l − 1, two at the outer columns.
/// @source [IvanicRuedenberg1996, Table 2]
constexpr double recurrenceP(const BandView<const double>& one, const BandView<const double>& below, int i,
                             int row, int column) {
    const int l = below.band + 1;
    if (column == l) return one(i, 1) * below(row, l - 1) - one(i, -1) * below(row, 1 - l);
    if (column == -l) return one(i, 1) * below(row, 1 - l) + one(i, -1) * below(row, l - 1);
    return one(i, 0) * below(row, column);
}

/// out += weight · (the band above `below`). The step is linear in `one` and in `below`, which is why it also
/// serves for derivatives, by Leibniz's rule [Krivanek2006, App. A]. Its signs hold with the Condon-Shortley
/// phase as without: it multiplies every term by the same (−1)^(row + column). It holds for reflections too.
/// @param one    band 1: the 3×3 matrix in the order (−y, z, −x)
/// @param below  band l − 1 >= 1
/// @source [IvanicRuedenberg1996, Eq. 8.1 and Table 1] with [IvanicRuedenberg1998] for V of negative rows
constexpr void addNextBand(const BandView<const double>& one, const BandView<const double>& below,
                           double weight, const BandView<double>& out) {
    const int l = below.band + 1;
    const auto p = [&](int i, int row, int column) { return recurrenceP(one, below, i, row, column); };
    const double root = recurrenceSqrt(2.0);
    double inverse[2 * kMaxShOrder - 1] = {};
    for (int c = 0; c <= l; ++c)
        inverse[l + c] = inverse[l - c] =
            weight / recurrenceSqrt(double(c == l ? 2 * l * (2 * l - 1) : (l + c) * (l - c)));
    for (int row = -l; row <= l; ++row) {
        const int m = row < 0 ? -row : row;
        const double u = recurrenceSqrt(double((l + m) * (l - m)));
        const double v = 0.5 * recurrenceSqrt(double((m == 0 ? 2 : 1) * (l + m - 1) * (l + m)));
        const double w = -0.5 * recurrenceSqrt(double((l - m - 1) * (l - m)));
        for (int column = -l; column <= l; ++column) {
            double sum = m < l ? u * p(0, row, column) : 0;
            if (row == 0)
                sum -= v * (p(1, 1, column) + p(-1, -1, column));
            else if (m == 1)
                sum += v * root * p(row, 0, column);
            else if (row > 0)
                sum += v * (p(1, row - 1, column) - p(-1, 1 - row, column));
            else
                sum += v * (p(1, row + 1, column) + p(-1, -row - 1, column));
            if (row > 0 && m < l - 1) sum += w * (p(1, row + 1, column) + p(-1, -row - 1, column));
            if (row < 0 && m < l - 1) sum += w * (p(1, row - 1, column) - p(-1, 1 - row, column));
            out(row, column) += inverse[l + column] * sum;
        }
    }
}

}  // namespace prt::detail
