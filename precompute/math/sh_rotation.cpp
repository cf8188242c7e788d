// Rotation of spherical-harmonic expansions by zyz Euler angles, with the turn about y as a turn about z
// between two constant matrices [Kautz2002] "Fast, arbitrary BRDF shading...", [Krivanek2006, Sec. 2.2],
// [PinchonHoggan2007].
#include "precompute/math/sh_rotation.h"

#include <cmath>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation_angles.h"
#include "precompute/math/sh_rotation_bands.h"

namespace prt {
namespace {

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

/// @param r  [9] by rows
template <typename T>
[[gnu::always_inline]] inline void rotateBands(const double* r, int shOrder, const T* in, T* out) {
    ZyzMultiples<T> angles;
    ZyzMultiples<double> exact;
    fillMultiples(zyzTurnsSoon(r), shOrder, angles, exact);
    rotateUnrolledBands<T, T>(
        shOrder, angles, [&](size_t i) __attribute__((always_inline)) { return in[i]; },
        [&](size_t i, T value) __attribute__((always_inline)) {
            out[i] = value;
            // Keeps the compiler from gathering a band into one 512-bit store, which slows down all of
            // AVX-512 code.
            asm volatile("" ::: "memory");
        },
        std::make_index_sequence<kUnrolledBands>());
    for (int l = kUnrolledBands; l < shOrder; ++l) {
        double v[2 * kMaxShOrder - 1];
        for (int i = 0; i < 2 * l + 1; ++i) v[i] = double(in[l * l + i]);
        rotateTableBand<double>(l, exact, v);
        for (int i = 0; i < 2 * l + 1; ++i) out[l * l + i] = T(v[i]);
    }
}

PRT_TARGET_CLONES void rotateFloats(const double* r, int shOrder, const float* in, float* out) {
    rotateBands(r, shOrder, in, out);
}
PRT_TARGET_CLONES void rotateDoubles(const double* r, int shOrder, const double* in, double* out) {
    rotateBands(r, shOrder, in, out);
}

/// The entries by rows, after a check that they are a rotation.
struct CheckedRows {
    double r[9];
    explicit CheckedRows(const Mat3d& m)
        : r{m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)} {
        const double deviationFromRotation = rotationDeviation(r);
        PRT_CHECK_LT(deviationFromRotation, kMaxRotationDeviation);
    }
};

void checkSizes(int shOrder, size_t in, size_t out) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxShOrder);
    PRT_CHECK_EQ(in, size_t(shCount(shOrder)));
    PRT_CHECK_EQ(out, in);
}

}  // namespace

void rotateSh(const Mat3d& targetFromSource, int shOrder, std::span<const float> in, std::span<float> out) {
    checkSizes(shOrder, in.size(), out.size());
    const CheckedRows rows(targetFromSource);
    rotateFloats(rows.r, shOrder, in.data(), out.data());
}

void rotateSh(const Mat3d& targetFromSource, int shOrder, std::span<const double> in, std::span<double> out) {
    checkSizes(shOrder, in.size(), out.size());
    const CheckedRows rows(targetFromSource);
    rotateDoubles(rows.r, shOrder, in.data(), out.data());
}

ZyzAngles zyzFromRotation(const Mat3d& rotation) {
    const CheckedRows rows(rotation);
    const ZyzTurns<double> t = zyzTurns(rows.r);
    return {std::atan2(t.sinAlpha, t.cosAlpha), std::atan2(t.sinBeta, t.cosBeta),
            std::atan2(t.sinGamma, t.cosGamma)};
}

Mat3d rotationFromZyz(const ZyzAngles& angles) {
    const auto aboutZ = [](double angle) {
        Mat3d r;
        r << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
        return r;
    };
    return aboutZ(angles.alphaRad) * rotationAboutUp(angles.betaRad) * aboutZ(angles.gammaRad);
}

Mat3d rotationAboutUp(double angleRad) {
    const double c = std::cos(angleRad), s = std::sin(angleRad);
    Mat3d r;
    r << c, 0, s, 0, 1, 0, -s, 0, c;
    return r;
}

}  // namespace prt
