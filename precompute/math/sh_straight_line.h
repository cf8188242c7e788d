// Spherical harmonics of few bands as straight-line code, for one direction or as the body of a loop over
// many, which compilers vectorise. Internal to prt_math; included by the .cpp files that evaluate.
#pragma once

#include <array>

#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"

namespace prt::detail {

/// Bands that evalShStraightLine goes to; beyond, loops over tables are used.
inline constexpr int kMaxStraightLineOrder = 10;
/// Q_lm of a degree l − m up to this is evaluated by Horner's rule, above by the recurrence in l. Horner
/// costs about half a multiplication per degree, the recurrence three, but loses digits as coefficients grow:
/// to degree 5 they stay below 9 times the largest value.
inline constexpr int kMaxHornerDegree = 5;

/// Q_lm = z^(d mod 2) (a[0] + a[1] z² + a[2] z⁴), d = l − m <= kMaxHornerDegree.
struct HornerTable {
    float a[legendreCount(kMaxStraightLineOrder)][kMaxHornerDegree / 2 + 1];
};

constexpr HornerTable makeHornerTable() {
    HornerTable table{};
    constexpr int kDegrees = kMaxHornerDegree + 1;
    for (int m = 0; m < kMaxStraightLineOrder; ++m) {
        std::array<double, kDegrees> before{}, here{};  // coefficients of z^0 … z^5
        here[0] = kLegendreRecurrence<double>.diagonal[m];
        for (int l = m; l < kMaxStraightLineOrder && l - m < kDegrees; ++l) {
            if (l > m) {
                std::array<double, kDegrees> next{};
                const int i = legendreIndex(l, m);
                for (size_t p = 0; p < kDegrees; ++p)
                    next[p] = (p > 0 ? kLegendreRecurrence<double>.rise[i] * here[p - 1] : 0) -
                              kLegendreRecurrence<double>.fall[i] * before[p];
                before = here;
                here = next;
            }
            for (int p = (l - m) % 2; p < kDegrees; p += 2)
                table.a[legendreIndex(l, m)][p / 2] = float(here[size_t(p)]);
        }
    }
    return table;
}
inline constexpr HornerTable kHorner = makeHornerTable();

/// Q_lm of one m from band l upwards, times the parts of (x + iy)^m.
template <int N, int M, int L, typename T, typename Store>
[[gnu::always_inline]] inline void evalColumn(const T& z, const T& zz, const T& cosPart, const T& sinPart,
                                              const T& two, const T& one, const Store& store) {
    constexpr int kDegree = L - M, kIndex = legendreIndex(L, M);
    constexpr const float(&a)[kMaxHornerDegree / 2 + 1] = kHorner.a[kIndex];
    T q;
    if constexpr (kDegree > kMaxHornerDegree)
        q = (kLegendreRecurrence<float>.rise[kIndex] * z) * one -
            kLegendreRecurrence<float>.fall[kIndex] * two;
    else if constexpr (kDegree < 2)
        q = a[0];
    else if constexpr (kDegree < 4)
        q = a[1] * zz + a[0];
    else
        q = (a[2] * zz + a[1]) * zz + a[0];
    if constexpr (kDegree <= kMaxHornerDegree && kDegree % 2 == 1) q = q * z;
    if constexpr (M == 0) {
        store(shIndex(L, 0), q);
    } else {
        store(shIndex(L, -M), q * sinPart);
        store(shIndex(L, M), q * cosPart);
    }
    if constexpr (L + 1 < N) evalColumn<N, M, L + 1>(z, zz, cosPart, sinPart, one, q, store);
}

/// All columns from m upwards, with (x + iy)^m from the powers m − 1 and m/2 below.
template <int N, int M, typename T, typename Store>
[[gnu::always_inline]] inline void evalColumns(const T& z, const T& zz, T* cosPart, T* sinPart,
                                               const Store& store) {
    if constexpr (M > 1) {
        constexpr int kLow = M / 2, kHigh = M - kLow;
        cosPart[M] = cosPart[kHigh] * cosPart[kLow] - sinPart[kHigh] * sinPart[kLow];
        sinPart[M] = cosPart[kHigh] * sinPart[kLow] + sinPart[kHigh] * cosPart[kLow];
    }
    evalColumn<N, M, M>(z, zz, cosPart[M], sinPart[M], T{}, T{}, store);
    if constexpr (M + 1 < N) evalColumns<N, M + 1>(z, zz, cosPart, sinPart, store);
}

/// Calls store(i, Y_i) for all i < N².
template <int N, typename T, typename Store>
[[gnu::always_inline]] inline void evalShStraightLine(const T& x, const T& y, const T& z,
                                                      const Store& store) {
    static_assert(N >= 1 && N <= kMaxStraightLineOrder);
    T cosPart[N < 2 ? 2 : N], sinPart[N < 2 ? 2 : N];
    cosPart[0] = 1;
    sinPart[0] = 0;
    cosPart[1] = x;
    sinPart[1] = y;
    evalColumns<N, 0>(z, T(z * z), cosPart, sinPart, store);
}

}  // namespace prt::detail
