// The truncated Taylor series of the turn about y, band by band, on one value or on many lanes. Internal.
#pragma once

#include <array>

#include "precompute/math/sh_rotation_bands.h"

namespace prt::detail {

/// G of all bands by its subdiagonal: lower[band][i] is the entry in row i, column i − 1 of the band; zero at
/// both ends, so that row i of G has lower[i] on the left and −lower[i + 1] on the right. Half the root of
/// the ladder operators, √((l − m)(l + m + 1)), and √2 times that next to m = 0, where the cosines end;
/// nothing joins m = −1 to m = 0.
struct GeneratorTable {
    std::array<std::array<double, 2 * kMaxShOrder>, kMaxShOrder> lower{};
};
constexpr GeneratorTable makeGeneratorTable() {
    GeneratorTable table;
    for (int l = 1; l < kMaxShOrder; ++l)
        for (int m = 0; m < l; ++m) {
            const double half = 0.5 * recurrenceSqrt(double((l - m) * (l + m + 1)));
            table.lower[size_t(l)][size_t(l + m + 1)] = m == 0 ? -half * recurrenceSqrt(2.0) : -half;
            if (m > 0) table.lower[size_t(l)][size_t(l - m)] = half;
        }
    return table;
}
inline constexpr GeneratorTable kGenerator = makeGeneratorTable();

/// (βG)² has this on its diagonal, over β².
constexpr double generatorSquareDiagonal(int band, int row) {
    const auto& lower = kGenerator.lower[size_t(band)];
    const double left = lower[size_t(row)], right = lower[size_t(row) + 1];
    return -(left * left + right * right);
}

/// out = row kRow of G times v.
template <typename Scalar, int kBand, int kRow, typename V>
[[gnu::always_inline]] inline void generatorRow(const V* v, V& out) {
    constexpr double kLeft = kGenerator.lower[kBand][kRow], kRight = kGenerator.lower[kBand][kRow + 1];
    if constexpr (kLeft != 0 && kRight != 0)
        out = Scalar(kLeft) * v[kRow - 1] - Scalar(kRight) * v[kRow + 1];
    else if constexpr (kLeft != 0)
        out = Scalar(kLeft) * v[kRow - 1];
    else if constexpr (kRight != 0)
        out = Scalar(-kRight) * v[kRow + 1];
    else
        out = V{};
}

/// How the series ends; `first` holds G v where it goes to order two.
template <typename Scalar, int kBand, int kRow, int kTwiceOrder, typename V, typename A>
[[gnu::always_inline]] inline void taylorRow(const A& beta, const A& halfSquare, const V* v, const V* first,
                                             V& out) {
    V last;
    if constexpr (kTwiceOrder == 4) {
        generatorRow<Scalar, kBand, kRow>(first, last);
        out = v[kRow] + (beta * first[kRow] + halfSquare * last);
    } else {
        constexpr Scalar kDiagonal = kTwiceOrder == 3 ? Scalar(generatorSquareDiagonal(kBand, kRow)) : 0;
        generatorRow<Scalar, kBand, kRow>(v, last);
        if constexpr (kDiagonal != 0)
            out = v[kRow] * (Scalar(1) + kDiagonal * halfSquare) + beta * last;
        else
            out = v[kRow] + beta * last;
    }
}

/// w = the series of exp(βG) v.
template <typename Scalar, int kBand, int kTwiceOrder, typename V, typename A, size_t... kRow>
[[gnu::always_inline]] inline void taylorRows(const A& beta, const A& halfSquare, const V* v, V* w,
                                              std::index_sequence<kRow...>) {
    V first[2 * kBand + 1];
    if constexpr (kTwiceOrder == 4) (generatorRow<Scalar, kBand, int(kRow)>(v, first[kRow]), ...);
    (taylorRow<Scalar, kBand, int(kRow), kTwiceOrder>(beta, halfSquare, v, first, w[kRow]), ...);
}

/// Rotates one unrolled band, in and out as for rotateOneBand.
template <typename Scalar, int kBand, int kTwiceOrder, typename V, typename A, typename In, typename Out,
          size_t... kRow>
[[gnu::always_inline]] inline void rotateOneTaylorBand(const ZyzMultiples<A>& angles, const A& beta,
                                                       const A& halfSquare, const In& in, const Out& out,
                                                       std::index_sequence<kRow...> rows) {
    V v[2 * kBand + 1], w[2 * kBand + 1];
    (in(size_t(kBand * kBand) + kRow, v[kRow]), ...);
    if constexpr (kBand == 0) {
        w[0] = v[0];
    } else {
        constexpr auto kOrders = std::make_index_sequence<size_t(kBand)>();
        turnAboutZ<kGamma>(angles, v + kBand, kOrders);
        taylorRows<Scalar, kBand, kTwiceOrder>(beta, halfSquare, v, w, rows);
        turnAboutZ<kAlpha>(angles, w + kBand, kOrders);
    }
    (out(size_t(kBand * kBand) + kRow, w[kRow]), ...);
}

/// v = the series of exp(βG) v with loops, for any band.
template <typename Scalar, int kTwiceOrder, typename V, typename A>
[[gnu::always_inline]] inline void turnTableBandByTaylor(int band, const A& beta, V* v) {
    constexpr int kMaxSize = 2 * kMaxShOrder + 1;
    // One more on either side, where G has zeros.
    V padded[kMaxSize] = {}, first[kMaxSize] = {};
    const int size = 2 * band + 1;
    const auto& lower = kGenerator.lower[size_t(band)];
    const auto row = [&](const V* from, int i, V& out) __attribute__((always_inline)) {
        out = Scalar(lower[size_t(i)]) * from[i] - Scalar(lower[size_t(i) + 1]) * from[i + 2];
    };
    const A halfSquare = Scalar(0.5) * beta * beta;
    for (int i = 0; i < size; ++i) padded[i + 1] = v[i];
    for (int i = 0; i < size; ++i) row(padded, i, first[i + 1]);
    for (int i = 0; i < size; ++i) {
        V last{};
        if constexpr (kTwiceOrder == 4) row(first, i, last);
        if constexpr (kTwiceOrder == 3) last = Scalar(generatorSquareDiagonal(band, i)) * v[i];
        v[i] += beta * first[i + 1] + halfSquare * last;
    }
}

/// Rotates a band above the unrolled ones.
template <typename Scalar, int kTwiceOrder, typename V, typename A>
[[gnu::always_inline]] inline void rotateTableTaylorBand(int band, const ZyzMultiples<A>& angles,
                                                         const A& beta, V* v) {
    turnTableBand<kGamma>(band, angles, v);
    turnTableBandByTaylor<Scalar, kTwiceOrder>(band, beta, v);
    turnTableBand<kAlpha>(band, angles, v);
}

/// Rotates the bands below min(shOrder, kUnrolledBands), as rotateUnrolledBands.
template <typename Scalar, int kTwiceOrder, typename V, typename A, typename In, typename Out,
          size_t... kBand>
[[gnu::always_inline]] inline void rotateUnrolledTaylorBands(int shOrder, const ZyzMultiples<A>& angles,
                                                             const A& beta, const In& in, const Out& out,
                                                             std::index_sequence<kBand...>) {
    const A halfSquare = Scalar(0.5) * beta * beta;
    (void)(... && (int(kBand) < shOrder &&
                   (rotateOneTaylorBand<Scalar, int(kBand), kTwiceOrder, V>(
                        angles, beta, halfSquare, in, out, std::make_index_sequence<2 * kBand + 1>()),
                    true)));
}

}  // namespace prt::detail
