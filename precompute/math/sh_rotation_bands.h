// The fast rotation, band by band, on one value or on many lanes at a time. Internal.
//
// R = Rz(α) Ry(β) Rz(γ), and Ry(β) = S Rz(−β) S, where S exchanges y and z: the reflection turns the axis y
// into z and the angle around. S is constant, symmetric, and as sparse as the quarter turns about x of the
// Z·X₋₉₀·Z·X₊₉₀·Z rotation [Kautz2002] [Krivanek2006, Sec. 2.2], which is S Rz(−β) S up to turns about z; one
// table serves both places [PinchonHoggan2007].
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation_recurrence.h"

namespace prt::detail {

/// Bands below this one are code without loops; those above go through tables. Under sanitizers straight-line
/// code takes minutes to compile: there are fewer, and what is undefined in it would be so in the tables too.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr int kUnrolledBands = 6;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr int kUnrolledBands = 6;
#else
inline constexpr int kUnrolledBands = 10;
#endif
#else
inline constexpr int kUnrolledBands = 10;
#endif

/// S of all unrolled bands: entry (band, row + band, column + band).
/// Entries that are zero come out as zero or as rounding; the smallest other one of band 23 is 2^-23.
inline constexpr double kSwapZero = 1e-11;
using SwapTables = std::array<std::array<std::array<double, 2 * kUnrolledBands - 1>, 2 * kUnrolledBands - 1>,
                              kUnrolledBands>;

/// S of band 1 in the order (−y, z, −x).
inline constexpr double kSwapOfBandOne[9] = {0, -1, 0, -1, 0, 0, 0, 0, 1};

constexpr SwapTables makeSwapTables() {
    SwapTables tables{};
    double below[(2 * kUnrolledBands - 1) * (2 * kUnrolledBands - 1)] = {};
    double here[(2 * kUnrolledBands - 1) * (2 * kUnrolledBands - 1)] = {};
    tables[0][0][0] = 1;
    for (int i = 0; i < 9; ++i) below[i] = kSwapOfBandOne[i];
    for (int l = 1; l < kUnrolledBands; ++l) {
        const size_t size = size_t(2 * l + 1);
        if (l > 1) {
            for (size_t i = 0; i < size * size; ++i) here[i] = 0;
            addNextBand({kSwapOfBandOne, 1}, {below, l - 1}, 1, {here, l});
            for (size_t i = 0; i < size * size; ++i) below[i] = here[i];
        }
        for (size_t i = 0; i < size * size; ++i) {
            const double value = below[i];
            tables[size_t(l)][i / size][i % size] = value < kSwapZero && value > -kSwapZero ? 0 : value;
        }
    }
    return tables;
}
inline constexpr SwapTables kSwapTables = makeSwapTables();

/// Entries of a row of S that are not zero.
constexpr int swapRowCount(int band, int row) {
    int count = 0;
    for (const double value : kSwapTables[size_t(band)][size_t(row + band)]) count += value != 0;
    return count;
}
template <int kBand, int kRow>
constexpr auto swapRowColumns() {
    std::array<int, swapRowCount(kBand, kRow)> columns{};
    size_t count = 0;
    for (int c = 0; c < 2 * kBand + 1; ++c)
        if (kSwapTables[kBand][kRow + kBand][size_t(c)] != 0) columns[count++] = c;
    return columns;
}

template <typename Scalar, int kBand, int kRow, typename V, size_t... kTerm>
[[gnu::always_inline]] inline void swapRow(const V* in, V& out, std::index_sequence<kTerm...>) {
    constexpr auto kColumns = swapRowColumns<kBand, kRow>();
    out = (... + (Scalar(kSwapTables[kBand][kRow + kBand][size_t(kColumns[kTerm])]) * in[kColumns[kTerm]]));
}

/// out = S in, both [2 kBand + 1].
template <typename Scalar, int kBand, typename V, size_t... kRow>
[[gnu::always_inline]] inline void swapAxes(const V* in, V* out, std::index_sequence<kRow...>) {
    (swapRow<Scalar, kBand, int(kRow) - kBand>(
         in, out[kRow], std::make_index_sequence<size_t(swapRowCount(kBand, int(kRow) - kBand))>()),
     ...);
}

/// The angles of R = Rz(α) Ry(β) Rz(γ) as indices of ZyzMultiples.
enum ZyzAngle { kAlpha, kBeta, kGamma };

/// cos(m a) and sin(m a) of the three angles a. The fourth column is padding: one value's three angles are
/// computed as one short vector.
template <typename A>
struct ZyzMultiples {
    alignas(4 * sizeof(A)) A cosine[kMaxShOrder + 1][4];
    alignas(4 * sizeof(A)) A sine[kMaxShOrder + 1][4];
};

/// Turns the pair (m, −m) about z: (c even − s odd, s even + c odd).
template <typename V, typename A>
[[gnu::always_inline]] inline void turnPair(const A& c, const A& s, V& even, V& odd) {
    const V turned = c * even - s * odd;
    odd = s * even + c * odd;
    even = turned;
}
/// Turns the pair back.
template <typename V, typename A>
[[gnu::always_inline]] inline void turnPairBack(const A& c, const A& s, V& even, V& odd) {
    const V turned = c * even + s * odd;
    odd = c * odd - s * even;
    even = turned;
}
/// Turns one band about z by an angle, or back by it; v points at its m = 0. Indices are constants, so that
/// the compiler keeps the band in registers.
template <ZyzAngle kAngle, typename V, typename A, size_t... kOrder>
[[gnu::always_inline]] inline void turnAboutZ(const ZyzMultiples<A>& angles, V* v,
                                              std::index_sequence<kOrder...>) {
    (turnPair(angles.cosine[kOrder + 1][kAngle], angles.sine[kOrder + 1][kAngle], v[int(kOrder) + 1],
              v[-int(kOrder) - 1]),
     ...);
}
template <ZyzAngle kAngle, typename V, typename A, size_t... kOrder>
[[gnu::always_inline]] inline void turnBackAboutZ(const ZyzMultiples<A>& angles, V* v,
                                                  std::index_sequence<kOrder...>) {
    (turnPairBack(angles.cosine[kOrder + 1][kAngle], angles.sine[kOrder + 1][kAngle], v[int(kOrder) + 1],
                  v[-int(kOrder) - 1]),
     ...);
}

/// Rotates band kBand < kUnrolledBands in place.
template <typename Scalar, int kBand, typename V, typename A>
[[gnu::always_inline]] inline void rotateUnrolledBand([[maybe_unused]] const ZyzMultiples<A>& angles,
                                                      [[maybe_unused]] V* v) {
    if constexpr (kBand > 0) {
        V w[2 * kBand + 1];
        constexpr auto kRows = std::make_index_sequence<size_t(2 * kBand + 1)>();
        constexpr auto kOrders = std::make_index_sequence<size_t(kBand)>();
        turnAboutZ<kGamma>(angles, v + kBand, kOrders);
        swapAxes<Scalar, kBand>(v, w, kRows);
        turnBackAboutZ<kBeta>(angles, w + kBand, kOrders);
        swapAxes<Scalar, kBand>(w, v, kRows);
        turnAboutZ<kAlpha>(angles, v + kBand, kOrders);
    }
}

/// S of a band above the unrolled ones, sparse, by rows.
struct SparseSwap {
    std::vector<int> rowStart, column;
    std::vector<double> value;
};
/// @param band  kUnrolledBands <= band < kMaxShOrder
const SparseSwap& sparseSwap(int band);

/// Turns a band above the unrolled ones about z.
template <ZyzAngle kAngle, typename V, typename A>
[[gnu::always_inline]] inline void turnTableBand(int band, const ZyzMultiples<A>& angles, V* v) {
    for (int m = 1; m <= band; ++m)
        turnPair(angles.cosine[m][kAngle], angles.sine[m][kAngle], v[band + m], v[band - m]);
}

/// Rotates a band above the unrolled ones in place.
template <typename Scalar, typename V, typename A>
[[gnu::always_inline]] inline void rotateTableBand(int band, const ZyzMultiples<A>& angles, V* v) {
    V w[2 * kMaxShOrder - 1];
    const SparseSwap& s = sparseSwap(band);
    const auto swap = [&](const V* from, V* to) __attribute__((always_inline)) {
        for (int r = 0; r < 2 * band + 1; ++r) {
            V sum{};
            for (int e = s.rowStart[size_t(r)]; e < s.rowStart[size_t(r) + 1]; ++e)
                sum += Scalar(s.value[size_t(e)]) * from[s.column[size_t(e)]];
            to[r] = sum;
        }
    };
    turnTableBand<kGamma>(band, angles, v);
    swap(v, w);
    for (int m = 1; m <= band; ++m)
        turnPairBack(angles.cosine[m][kBeta], angles.sine[m][kBeta], w[band + m], w[band - m]);
    swap(w, v);
    turnTableBand<kAlpha>(band, angles, v);
}

/// Loads, rotates and stores one unrolled band; in and out point at coefficient 0 and may be the same.
template <typename Scalar, int kBand, typename V, typename A, typename In, typename Out, size_t... kRow>
[[gnu::always_inline]] inline void rotateOneBand(const ZyzMultiples<A>& angles, const In& in, const Out& out,
                                                 std::index_sequence<kRow...>) {
    V v[2 * kBand + 1];
    (in(size_t(kBand * kBand) + kRow, v[kRow]), ...);
    rotateUnrolledBand<Scalar, kBand>(angles, v);
    (out(size_t(kBand * kBand) + kRow, v[kRow]), ...);
}

/// Rotates the bands below min(shOrder, kUnrolledBands).
/// @param in   in(i, value) sets the value to coefficient i
/// @param out  out(i, value) takes it
template <typename Scalar, typename V, typename A, typename In, typename Out, size_t... kBand>
[[gnu::always_inline]] inline void rotateUnrolledBands(int shOrder, const ZyzMultiples<A>& angles,
                                                       const In& in, const Out& out,
                                                       std::index_sequence<kBand...>) {
    // && ends at the first band that is not there.
    (void)(... && (int(kBand) < shOrder && (rotateOneBand<Scalar, int(kBand), V>(
                                                angles, in, out, std::make_index_sequence<2 * kBand + 1>()),
                                            true)));
}

}  // namespace prt::detail
