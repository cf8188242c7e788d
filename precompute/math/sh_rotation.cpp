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

/// @param matrix  [9] by columns
/// @return its deviation from a rotation
template <typename T>
[[gnu::always_inline]] inline double rotateBands(const double* matrix, int shOrder, const T* in, T* out) {
    const MatrixRows rows(matrix);
    double deviation;
    rotationDeviation(rows.r, deviation);
    ZyzMultiples<T> angles;
    ZyzMultiples<double> exact;
    FirstMultiples first;
    firstMultiples(rows.r, first);
    fillMultiples(first, shOrder, angles, exact);
    rotateUnrolledBands<T, T>(shOrder, angles, CoefficientSource<T>{in}, CoefficientTarget<T>{out},
                              std::make_index_sequence<kUnrolledBands>());
    for (int l = kUnrolledBands; l < shOrder; ++l) {
        double v[2 * kMaxShOrder - 1];
        for (int i = 0; i < 2 * l + 1; ++i) v[i] = double(in[l * l + i]);
        rotateTableBand<double>(l, exact, v);
        for (int i = 0; i < 2 * l + 1; ++i) out[l * l + i] = T(v[i]);
    }
    return deviation;
}

PRT_TARGET_CLONES double rotateFloats(const double* matrix, int shOrder, const float* in, float* out) {
    return rotateBands(matrix, shOrder, in, out);
}
PRT_TARGET_CLONES double rotateDoubles(const double* matrix, int shOrder, const double* in, double* out) {
    return rotateBands(matrix, shOrder, in, out);
}

}  // namespace

void rotateSh(const Mat3d& targetFromSource, int shOrder, std::span<const float> in, std::span<float> out) {
    checkRotationSizes(shOrder, in.size(), out.size());
    // Checked at the end: nothing has to wait for it.
    const double deviationFromRotation =
        rotateFloats(targetFromSource.data(), shOrder, in.data(), out.data());
    PRT_CHECK_LT(deviationFromRotation, kMaxRotationDeviation);
}

void rotateSh(const Mat3d& targetFromSource, int shOrder, std::span<const double> in, std::span<double> out) {
    checkRotationSizes(shOrder, in.size(), out.size());
    // Checked at the end: nothing has to wait for it.
    const double deviationFromRotation =
        rotateDoubles(targetFromSource.data(), shOrder, in.data(), out.data());
    PRT_CHECK_LT(deviationFromRotation, kMaxRotationDeviation);
}

ZyzAngles zyzFromRotation(const Mat3d& rotation) {
    const CheckedRows rows(rotation);
    FirstMultiples first;
    firstMultiples(rows.r, first);
    const auto angle = [&](ZyzAngle a) { return std::atan2(first.sine[a], first.cosine[a]); };
    return {angle(kAlpha), angle(kBeta), angle(kGamma)};
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
