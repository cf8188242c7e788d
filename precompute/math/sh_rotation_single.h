// What the rotations of a single vector share: multiples of its angles, and its coefficients. Internal.
#pragma once

#include <cmath>
#include <cstddef>

#include "precompute/base/check.h"
#include "precompute/math/sh_rotation_angles.h"
#include "precompute/math/sh_rotation_bands.h"

namespace prt::detail {

/// The three angles side by side.
typedef double ThreeAngles __attribute__((vector_size(32)));
typedef double ThreeAnglesInArray __attribute__((vector_size(32), may_alias));
typedef float ThreeFloatAngles __attribute__((vector_size(16), may_alias));

/// The angles and their doubles in columns of ZyzAngle, and sinβ/(1 + |cosβ|) for turnAngle.
struct FirstMultiples {
    ThreeAngles cosine, sine, cosine2, sine2;
    double halfTangent;
};

/// Angles of R = Rz(α) Ry(β) Rz(γ), 0 <= β <= π. γ follows from α and from α + γ or α − γ, whichever the
/// matrix knows well, so that the product is right where β is near 0 or π and α is arbitrary: the upper left
/// 2×2 block is (1 + cosβ)/2 times a turn by α + γ, plus (1 − cosβ)/2 times a mirrored turn by α − γ. All
/// bands wait for the result: cos 2α = (x² − y²)/(x² + y²) comes from one division, and γ from a product
/// whose length is divided off last.
/// @param r  [9] by rows
[[gnu::always_inline]] inline void firstMultiples(const double* r, FirstMultiples& result) {
    const double square = r[2] * r[2] + r[5] * r[5];
    const bool atPole = square < 1e-30;  // the angles then differ by 1e-15
    const double x = atPole ? 1 : r[2], y = atPole ? 0 : r[5], alphaSquare = atPole ? 1 : square;
    const double side = std::copysign(1.0, r[8]);
    const double cosSum = r[4] + side * r[0], sinSum = side * r[3] - r[1];
    const double gammaX = cosSum * x + sinSum * y, gammaY = side * (sinSum * x - cosSum * y);
    const double gammaSquare = alphaSquare * (cosSum * cosSum + sinSum * sinSum);
    double cosBeta = r[8], sinBeta = atPole ? 0 : std::sqrt(square);
    normaliseTurn(cosBeta, sinBeta);
    const double alphaScale = 1 / alphaSquare, gammaScale = 1 / gammaSquare;
    const double alphaRoot = std::sqrt(alphaSquare) * alphaScale,
                 gammaRoot = std::sqrt(gammaSquare) * gammaScale;
    result.cosine = ThreeAngles{x * alphaRoot, cosBeta, gammaX * gammaRoot, 1};
    result.sine = ThreeAngles{y * alphaRoot, sinBeta, gammaY * gammaRoot, 0};
    result.cosine2 = ThreeAngles{(x * x - y * y) * alphaScale, cosBeta * cosBeta - sinBeta * sinBeta,
                                 (gammaX * gammaX - gammaY * gammaY) * gammaScale, 1};
    result.sine2 =
        ThreeAngles{2 * x * y * alphaScale, 2 * cosBeta * sinBeta, 2 * gammaX * gammaY * gammaScale, 0};
    result.halfTangent = sinBeta / (1 + std::abs(cosBeta));
}

/// Stores the angles to an aligned row of four.
[[gnu::always_inline]] inline void roundTo(const ThreeAngles& from, double* to) {
    *reinterpret_cast<ThreeAnglesInArray*>(to) = from;
}
[[gnu::always_inline]] inline void roundTo(const ThreeAngles& from, float* to) {
    *reinterpret_cast<ThreeFloatAngles*>(to) = __builtin_convertvector(from, ThreeFloatAngles);
}

/// Multiples of the angles to shOrder − 1 or one more, in double and rounded to T, in two chains.
template <typename T>
[[gnu::always_inline]] inline void fillMultiples(const FirstMultiples& first, int shOrder,
                                                 ZyzMultiples<T>& result, ZyzMultiples<double>& exact) {
    const auto store = [&](int m, const ThreeAngles& c, const ThreeAngles& s) __attribute__((always_inline)) {
        roundTo(c, result.cosine[m]);
        roundTo(s, result.sine[m]);
        if (shOrder <= kUnrolledBands) return;
        roundTo(c, exact.cosine[m]);
        roundTo(s, exact.sine[m]);
    };
    const ThreeAngles c2 = first.cosine2, s2 = first.sine2;
    ThreeAngles oddCosine = first.cosine, oddSine = first.sine, evenCosine = c2, evenSine = s2;
    for (int m = 1;; m += 2) {
        store(m, oddCosine, oddSine);
        store(m + 1, evenCosine, evenSine);
        if (m + 2 >= shOrder) return;
        const ThreeAngles odd = c2 * oddCosine - s2 * oddSine, even = c2 * evenCosine - s2 * evenSine;
        oddSine = s2 * oddCosine + c2 * oddSine;
        evenSine = s2 * evenCosine + c2 * evenSine;
        oddCosine = odd;
        evenCosine = even;
    }
}

/// Coefficients of one vector as the bands read and write them.
template <typename T>
struct CoefficientSource {
    const T* data;
    [[gnu::always_inline]] void operator()(size_t i, T& value) const { value = data[i]; }
};
template <typename T>
struct CoefficientTarget {
    T* data;
    [[gnu::always_inline]] void operator()(size_t i, T value) const {
        data[i] = value;
        // Keeps the compiler from gathering a band into one 512-bit store, which slows down all AVX-512 code
        // near it, and from mixing bands until registers run out.
        asm volatile("" ::: "memory");
    }
};

inline void checkRotationSizes(int shOrder, size_t in, size_t out) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxShOrder);
    PRT_CHECK_EQ(in, size_t(shCount(shOrder)));
    PRT_CHECK_EQ(out, in);
}

}  // namespace prt::detail
