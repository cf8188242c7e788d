// What the rotations of a single vector share: multiples of its angles, and its coefficients. Internal.
#pragma once

#include <cstddef>

#include "precompute/base/check.h"
#include "precompute/math/sh_rotation_angles.h"
#include "precompute/math/sh_rotation_bands.h"

namespace prt::detail {

/// The three angles side by side.
typedef double ThreeAngles __attribute__((vector_size(32)));

/// Multiples of the angles to shOrder − 1 or one more, in double and rounded to T. Two chains, because the
/// first band has to wait for them.
template <typename T>
[[gnu::always_inline]] inline void fillMultiples(const ZyzTurns<double>& turns, int shOrder,
                                                 ZyzMultiples<T>& result, ZyzMultiples<double>& exact) {
    const auto store = [&](int m, const ThreeAngles& c, const ThreeAngles& s) __attribute__((always_inline)) {
        for (int a = 0; a < 4; ++a) {
            result.cosine[m][a] = T(c[a]);
            result.sine[m][a] = T(s[a]);
        }
        if (shOrder <= kUnrolledBands) return;
        for (int a = 0; a < 4; ++a) {
            exact.cosine[m][a] = c[a];
            exact.sine[m][a] = s[a];
        }
    };
    ThreeAngles oddCosine = {turns.cosAlpha, turns.cosBeta, turns.cosGamma, 1};
    ThreeAngles oddSine = {turns.sinAlpha, turns.sinBeta, turns.sinGamma, 0};
    const ThreeAngles c2 = oddCosine * oddCosine - oddSine * oddSine, s2 = 2 * oddSine * oddCosine;
    ThreeAngles evenCosine = c2, evenSine = s2;
    for (int m = 1; m < shOrder; m += 2) {
        store(m, oddCosine, oddSine);
        store(m + 1, evenCosine, evenSine);
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
        // near it.
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
