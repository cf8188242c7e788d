// Rotations of sixteen vectors at once, and the way through a structure of arrays of any length. Internal.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "precompute/base/check.h"
#include "precompute/math/sh_lanes.h"
#include "precompute/math/sh_rotation_angles.h"
#include "precompute/math/sh_rotation_bands.h"

namespace prt::detail {

/// Lanes anywhere in an array of floats. A structure, because clang takes a reference to a vector type of
/// lower alignment, once a function returns it, for one of full alignment.
struct [[gnu::packed, gnu::may_alias]] UnalignedLanes {
    Lanes value;
};

/// Sixteen columns of a matrix whose row i begins at data + i·stride.
struct ConstLaneRows {
    const float* data;
    size_t stride;
    [[gnu::always_inline]] void operator()(size_t i, Lanes& value) const {
        value = reinterpret_cast<const UnalignedLanes*>(data + i * stride)->value;
    }
};
struct LaneRows {
    float* data;
    size_t stride;
    [[gnu::always_inline]] void operator()(size_t i, const Lanes& value) const {
        reinterpret_cast<UnalignedLanes*>(data + i * stride)->value = value;
    }
};

typedef int32_t LaneBits __attribute__((vector_size(sizeof(int32_t) * kLanes)));

/// 1/√x of 0 and of normal numbers: an estimate from the exponent, good to 4 %, and three steps of Newton, to
/// 2e-7. 0 gives something finite.
[[gnu::always_inline]] inline void inverseSqrt(const Lanes& x, Lanes& y) {
    y = reinterpret_cast<Lanes>(0x5f375a86 - (reinterpret_cast<LaneBits>(x) >> 1));
    const Lanes half = 0.5f * x;
    for (int step = 0; step < 3; ++step) y *= 1.5f - half * y * y;
}

/// Cosines and sines of R = Rz(α) Ry(β) Rz(γ), in columns of ZyzAngle.
struct LaneTurns {
    Lanes cosine[3], sine[3];
    Lanes halfTangent;  ///< for turnAngle
};

/// Decomposes matrices, as firstMultiples does one.
/// @param r  [9] by rows
[[gnu::always_inline]] inline void decompose(const Lanes* r, LaneTurns& t) {
    const Lanes square = r[2] * r[2] + r[5] * r[5];
    // Below it sin²β counts as 0: the angles then differ by 1e-8.
    const LaneBits atPole = square < Lanes{} + 1e-16f;
    Lanes inverse;
    inverseSqrt(square, inverse);
    const Lanes cosAlpha = atPole ? Lanes{} + 1.0f : r[2] * inverse,
                sinAlpha = atPole ? Lanes{} : r[5] * inverse;
    Lanes cosBeta = r[8], sinBeta = cosAlpha * r[2] + sinAlpha * r[5];
    const Lanes side = r[8] < Lanes{} ? Lanes{} - 1.0f : Lanes{} + 1.0f;
    Lanes cosSum = r[4] + side * r[0], sinSum = side * r[3] - r[1], inverseOfSum;
    inverseSqrt(cosSum * cosSum + sinSum * sinSum, inverseOfSum);
    cosSum *= inverseOfSum;
    sinSum *= inverseOfSum;
    t.halfTangent = sinBeta * inverseOfSum;  // the sum has length 1 + |cosβ|
    normaliseTurn(cosBeta, sinBeta);
    t.cosine[kAlpha] = cosAlpha;
    t.sine[kAlpha] = sinAlpha;
    t.cosine[kBeta] = cosBeta;
    t.sine[kBeta] = sinBeta;
    t.cosine[kGamma] = cosSum * cosAlpha + sinSum * sinAlpha;
    t.sine[kGamma] = side * (sinSum * cosAlpha - cosSum * sinAlpha);
}

/// Multiples of the angles to shOrder − 1.
[[gnu::always_inline]] inline void fillLaneMultiples(const LaneTurns& t, int shOrder,
                                                     ZyzMultiples<Lanes>& angles) {
    for (int a = 0; a < 3; ++a) {
        const Lanes c = t.cosine[a], s = t.sine[a];
        Lanes cosine = c, sine = s;
        for (int m = 1; m < shOrder; ++m) {
            angles.cosine[m][a] = cosine;
            angles.sine[m][a] = sine;
            const Lanes next = c * cosine - s * sine;
            sine = s * cosine + c * sine;
            cosine = next;
        }
    }
}

/// Reads sixteen matrices and takes note of those that are no rotations.
[[gnu::always_inline]] inline void loadRotations(const ConstLaneRows& rotations, Lanes* r,
                                                 LaneBits& allRotations) {
    for (size_t i = 0; i < 9; ++i) rotations(i, r[i]);
    Lanes deviation;
    rotationDeviation(r, deviation);
    allRotations &= deviation < Lanes{} + float(kMaxRotationDeviation);
}

inline void checkAllRotations(const LaneBits& allRotations) {
    for (size_t k = 0; k < kLanes; ++k) {
        const bool matricesAreRotations = allRotations[k] != 0;
        PRT_CHECK(matricesAreRotations);
    }
}

/// Every lane its band, in place or apart: unrolled bands, then the others by tables.
template <typename A>
[[gnu::always_inline]] inline void rotateLanes(int shOrder, const ZyzMultiples<A>& angles,
                                               const ConstLaneRows& in, const LaneRows& out) {
    rotateUnrolledBands<float, Lanes>(shOrder, angles, in, out, std::make_index_sequence<kUnrolledBands>());
    for (int l = kUnrolledBands; l < shOrder; ++l) {
        Lanes v[2 * kMaxShOrder - 1];
        for (int i = 0; i < 2 * l + 1; ++i) in(size_t(l * l + i), v[i]);
        rotateTableBand<float>(l, angles, v);
        for (int i = 0; i < 2 * l + 1; ++i) out(size_t(l * l + i), v[i]);
    }
}

/// What a structure of arrays has to hold: `rows` rows of `count` values, `stride` apart.
inline void checkSoa(size_t rows, size_t count, size_t stride, size_t size) {
    PRT_CHECK_LE(count, stride);
    PRT_CHECK_LE((rows - 1) * stride + count, size);
}

/// Calls kernel(rotations, in, out) for every sixteen vectors; the rest is padded with copies of the last
/// one.
/// @param rotations  nine rows, or empty
template <typename Kernel>
void forEachLanes(std::span<const float> rotations, int shOrder, size_t count, size_t stride,
                  std::span<const float> in, std::span<float> out, const Kernel& kernel) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxShOrder);
    if (count == 0) return;
    const size_t rows = size_t(shCount(shOrder)), turnRows = rotations.empty() ? 0 : 9;
    checkSoa(rows, count, stride, in.size());
    checkSoa(rows, count, stride, out.size());
    if (turnRows > 0) checkSoa(turnRows, count, stride, rotations.size());
    size_t k = 0;
    for (; k + kLanes <= count; k += kLanes)
        kernel(ConstLaneRows{rotations.data() + (turnRows > 0 ? k : 0), stride},
               ConstLaneRows{in.data() + k, stride}, LaneRows{out.data() + k, stride});
    if (k == count) return;
    float turnBlock[9 * kLanes], block[shCount(kMaxShOrder) * int(kLanes)];
    const size_t rest = count - k;
    const auto gather = [&](std::span<const float> from, size_t rowCount, float* to) {
        for (size_t i = 0; i < rowCount * kLanes; ++i)
            to[i] = from[i / kLanes * stride + k + std::min(i % kLanes, rest - 1)];
    };
    gather(rotations, turnRows, turnBlock);
    gather(in, rows, block);
    kernel(ConstLaneRows{turnBlock, kLanes}, ConstLaneRows{block, kLanes}, LaneRows{block, kLanes});
    for (size_t i = 0; i < rows; ++i) std::copy_n(block + i * kLanes, rest, &out[i * stride + k]);
}

}  // namespace prt::detail
