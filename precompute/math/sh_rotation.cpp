// Rotation of spherical-harmonic expansions by zyz Euler angles, with the turn about y as a turn about z
// between two constant matrices [Kautz2002] "Fast, arbitrary BRDF shading...", [Krivanek2006, Sec. 2.2],
// [PinchonHoggan2007].
#include "precompute/math/sh_rotation.h"

#include <cmath>

#include "precompute/base/parallel.h"
#include "precompute/math/sh_rotation_single.h"

namespace prt {
namespace {

using namespace detail;

/// @param r  [9] by rows
template <typename T>
[[gnu::always_inline]] inline void rotateBands(const double* r, int shOrder, const T* in, T* out) {
    ZyzMultiples<T> angles;
    ZyzMultiples<double> exact;
    ZyzTurns<double> turns;
    zyzTurns(r, turns);
    fillMultiples(turns, shOrder, angles, exact);
    rotateUnrolledBands<T, T>(shOrder, angles, CoefficientSource<T>{in}, CoefficientTarget<T>{out},
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

}  // namespace

void rotateSh(const Mat3d& targetFromSource, int shOrder, std::span<const float> in, std::span<float> out) {
    checkRotationSizes(shOrder, in.size(), out.size());
    const CheckedRows rows(targetFromSource);
    rotateFloats(rows.r, shOrder, in.data(), out.data());
}

void rotateSh(const Mat3d& targetFromSource, int shOrder, std::span<const double> in, std::span<double> out) {
    checkRotationSizes(shOrder, in.size(), out.size());
    const CheckedRows rows(targetFromSource);
    rotateDoubles(rows.r, shOrder, in.data(), out.data());
}

ZyzAngles zyzFromRotation(const Mat3d& rotation) {
    const CheckedRows rows(rotation);
    ZyzTurns<double> t;
    zyzTurns(rows.r, t);
    return {std::atan2(t.sinAlpha, t.cosAlpha), std::atan2(std::abs(t.sinBeta), t.cosBeta),
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
