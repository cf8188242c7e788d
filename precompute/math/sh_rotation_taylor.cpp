// Rotation with the turn about y by its truncated Taylor series [Krivanek2006] "Fast Approximation to
// Spherical Harmonic Rotation", Sec. 3, in our orientation.
#include "precompute/math/sh_rotation_taylor.h"

#include <cmath>

#include "precompute/base/parallel.h"
#include "precompute/math/sh_rotation_lanes.h"
#include "precompute/math/sh_rotation_single.h"
#include "precompute/math/sh_rotation_taylor_bands.h"

namespace prt {
namespace {

using namespace detail;

template <int kTwiceOrder>
[[gnu::always_inline]] inline void rotateBands(const FirstMultiples& first, float beta, int shOrder,
                                               const float* in, float* out) {
    ZyzMultiples<float> angles;
    ZyzMultiples<double> exact;
    fillMultiples(first, shOrder, angles, exact);
    rotateUnrolledTaylorBands<float, kTwiceOrder, float>(shOrder, angles, beta, CoefficientSource<float>{in},
                                                         CoefficientTarget<float>{out},
                                                         std::make_index_sequence<kUnrolledBands>());
    for (int l = kUnrolledBands; l < shOrder; ++l) {
        float v[2 * kMaxShOrder - 1];
        for (int i = 0; i < 2 * l + 1; ++i) v[i] = in[l * l + i];
        rotateTableTaylorBand<float, kTwiceOrder>(l, angles, beta, v);
        for (int i = 0; i < 2 * l + 1; ++i) out[l * l + i] = v[i];
    }
}

/// @param matrix  [9] by columns
/// @return its deviation from a rotation
PRT_TARGET_CLONES double rotateFloats(const double* matrix, ShTaylorOrder order, int shOrder, const float* in,
                                      float* out) {
    const MatrixRows rows(matrix);
    FirstMultiples first;
    firstMultiples(rows.r, first);
    double deviation, beta;
    rotationDeviation(rows.r, deviation);
    turnAngle(double(first.cosine[kBeta]), first.halfTangent, beta);
    if (order == ShTaylorOrder::One) rotateBands<2>(first, float(beta), shOrder, in, out);
    if (order == ShTaylorOrder::OneAndHalf) rotateBands<3>(first, float(beta), shOrder, in, out);
    if (order == ShTaylorOrder::Two) rotateBands<4>(first, float(beta), shOrder, in, out);
    return deviation;
}

template <int kTwiceOrder>
[[gnu::always_inline]] inline void rotateLanesBy(const ZyzMultiples<Lanes>& angles, const Lanes& beta,
                                                 int shOrder, const ConstLaneRows& in, const LaneRows& out) {
    rotateUnrolledTaylorBands<float, kTwiceOrder, Lanes>(shOrder, angles, beta, in, out,
                                                         std::make_index_sequence<kUnrolledBands>());
    for (int l = kUnrolledBands; l < shOrder; ++l) {
        Lanes v[2 * kMaxShOrder - 1];
        for (int i = 0; i < 2 * l + 1; ++i) in(size_t(l * l + i), v[i]);
        rotateTableTaylorBand<float, kTwiceOrder>(l, angles, beta, v);
        for (int i = 0; i < 2 * l + 1; ++i) out(size_t(l * l + i), v[i]);
    }
}

PRT_TARGET_CLONES void rotateEach(ShTaylorOrder order, int shOrder, const ConstLaneRows& rotations,
                                  const ConstLaneRows& in, const LaneRows& out, LaneBits& allRotations) {
    Lanes r[9], beta;
    loadRotations(rotations, r, allRotations);
    LaneTurns turns;
    decompose(r, turns);
    turnAngle(turns.cosine[kBeta], turns.halfTangent, beta);
    ZyzMultiples<Lanes> angles;
    fillLaneMultiples(turns, shOrder, angles);
    switch (order) {
        case ShTaylorOrder::One:
            return rotateLanesBy<2>(angles, beta, shOrder, in, out);
        case ShTaylorOrder::OneAndHalf:
            return rotateLanesBy<3>(angles, beta, shOrder, in, out);
        case ShTaylorOrder::Two:
            return rotateLanesBy<4>(angles, beta, shOrder, in, out);
    }
}

template <int kTwiceOrder, typename T>
void turnAboutY(double beta, int shOrder, const T* in, T* out) {
    for (int l = 0; l < shOrder; ++l) {
        T v[2 * kMaxShOrder - 1];
        for (int i = 0; i < 2 * l + 1; ++i) v[i] = in[l * l + i];
        turnTableBandByTaylor<T, kTwiceOrder>(l, T(beta), v);
        for (int i = 0; i < 2 * l + 1; ++i) out[l * l + i] = v[i];
    }
}

template <typename T>
void turnAboutY(double beta, ShTaylorOrder order, int shOrder, std::span<const T> in, std::span<T> out) {
    checkRotationSizes(shOrder, in.size(), out.size());
    switch (order) {
        case ShTaylorOrder::One:
            return turnAboutY<2>(beta, shOrder, in.data(), out.data());
        case ShTaylorOrder::OneAndHalf:
            return turnAboutY<3>(beta, shOrder, in.data(), out.data());
        case ShTaylorOrder::Two:
            return turnAboutY<4>(beta, shOrder, in.data(), out.data());
    }
}

/// Turns about z by an angle, in place.
void turnAboutZ(double angle, int shOrder, std::span<double> v) {
    for (int l = 1; l < shOrder; ++l)
        for (int m = 1; m <= l; ++m)
            turnPair(std::cos(m * angle), std::sin(m * angle), v[size_t(shIndex(l, m))],
                     v[size_t(shIndex(l, -m))]);
}

/// The product of two band matrices.
ShBandMatrix product(const ShBandMatrix& a, const ShBandMatrix& b) {
    ShBandMatrix result(a.shOrder());
    for (int l = 0; l < a.shOrder(); ++l) {
        const size_t size = size_t(2 * l + 1);
        for (size_t r = 0; r < size; ++r)
            for (size_t k = 0; k < size; ++k)
                for (size_t c = 0; c < size; ++c)
                    result.block(l)[r * size + c] += a.block(l)[r * size + k] * b.block(l)[k * size + c];
    }
    return result;
}

}  // namespace

void rotateShYTaylor(double betaRad, ShTaylorOrder order, int shOrder, std::span<const float> in,
                     std::span<float> out) {
    turnAboutY(betaRad, order, shOrder, in, out);
}

void rotateShYTaylor(double betaRad, ShTaylorOrder order, int shOrder, std::span<const double> in,
                     std::span<double> out) {
    turnAboutY(betaRad, order, shOrder, in, out);
}

void rotateShTaylor(const Mat3d& targetFromSource, ShTaylorOrder order, int shOrder,
                    std::span<const float> in, std::span<float> out) {
    checkRotationSizes(shOrder, in.size(), out.size());
    const double deviationFromRotation =
        rotateFloats(targetFromSource.data(), order, shOrder, in.data(), out.data());
    PRT_CHECK_LT(deviationFromRotation, kMaxRotationDeviation);
}

void rotateShTaylor(const ZyzAngles& angles, ShTaylorOrder order, int shOrder, std::span<const float> in,
                    std::span<float> out) {
    rotateShTaylor(rotationFromZyz(angles), order, shOrder, in, out);
}

void rotateShTaylor(const ZyzAngles& angles, ShTaylorOrder order, int shOrder, std::span<const double> in,
                    std::span<double> out) {
    double v[shCount(kMaxShOrder)];
    checkRotationSizes(shOrder, in.size(), out.size());
    std::copy(in.begin(), in.end(), v);
    const std::span<double> work(v, in.size());
    turnAboutZ(angles.gammaRad, shOrder, work);
    turnAboutY(angles.betaRad, order, shOrder, std::span<const double>(work), work);
    turnAboutZ(angles.alphaRad, shOrder, work);
    std::copy(work.begin(), work.end(), out.begin());
}

void rotateShTaylorSoa(std::span<const float> rotations, ShTaylorOrder order, int shOrder, size_t count,
                       size_t stride, std::span<const float> in, std::span<float> out) {
    LaneBits allRotations = ~LaneBits{};
    if (count > 0) PRT_CHECK(!rotations.empty());
    forEachLanes(rotations, shOrder, count, stride, in, out,
                 [&](const ConstLaneRows& r, const ConstLaneRows& from, const LaneRows& to) {
                     rotateEach(order, shOrder, r, from, to, allRotations);
                 });
    checkAllRotations(allRotations);
}

ShBandMatrix shYRotationGenerator(int shOrder) {
    ShBandMatrix result(shOrder);
    for (int l = 0; l < shOrder; ++l)
        for (int i = 1; i < 2 * l + 1; ++i) {
            const double lower = kGenerator.lower[size_t(l)][size_t(i)];
            result.block(l)[size_t(i * (2 * l + 1) + i - 1)] = lower;
            result.block(l)[size_t((i - 1) * (2 * l + 1) + i)] = -lower;
        }
    return result;
}

ShBandMatrix shYTaylorMatrix(double betaRad, ShTaylorOrder order, int shOrder) {
    ShBandMatrix result = shYTaylorSeries(betaRad, order == ShTaylorOrder::Two ? 2 : 1, shOrder);
    if (order == ShTaylorOrder::OneAndHalf)
        for (int l = 0; l < shOrder; ++l)
            for (int i = 0; i < 2 * l + 1; ++i)
                result.block(l)[size_t(i * (2 * l + 2))] +=
                    0.5 * betaRad * betaRad * generatorSquareDiagonal(l, i);
    return result;
}

ShBandMatrix shYTaylorSeries(double betaRad, int lastTerm, int shOrder) {
    PRT_CHECK_LE(0, lastTerm);
    const ShBandMatrix generator = shYRotationGenerator(shOrder);
    ShBandMatrix result = ShBandMatrix::identity(shOrder);
    ShBandMatrix power = result;
    double factor = 1;
    for (int k = 1; k <= lastTerm; ++k) {
        power = product(power, generator);
        factor *= betaRad / k;
        result.add(factor, power);
    }
    return result;
}

}  // namespace prt
