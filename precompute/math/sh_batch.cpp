// Spherical harmonics of many directions, sixteen at once: straight-line code for few bands, loops from the
// bottom band up for many, so that all m of a band are independent chains. Rows come from a transposition in
// 4×4 tiles. Recurrences as in sh.cpp [Sloan2008, A2].
#include <algorithm>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_lanes.h"
#include "precompute/math/sh_legendre.h"
#include "precompute/math/sh_straight_line.h"

namespace prt {
namespace {

using detail::kLanes;
using detail::Lanes;
using detail::lanesAt;
using detail::quadAt;

/// Any number of bands.
[[gnu::always_inline]] inline void evalByTable(int shOrder, const float* xIn, const float* yIn,
                                               const float* zIn, float* out, size_t stride) {
    const LegendreRecurrence<float>& t = kLegendreRecurrence<float>;
    const Lanes x = lanesAt(xIn).value, y = lanesAt(yIn).value, z = lanesAt(zIn).value;
    Lanes q[legendreCount(kMaxShOrder)];
    Lanes cosPart[kMaxShOrder], sinPart[kMaxShOrder];
    cosPart[0] = Lanes{} + 1.0f;
    sinPart[0] = Lanes{};
    for (int m = 1; m < shOrder; ++m) {
        cosPart[m] = x * cosPart[m - 1] - y * sinPart[m - 1];
        sinPart[m] = x * sinPart[m - 1] + y * cosPart[m - 1];
    }
    for (int l = 0; l < shOrder; ++l)
        for (int m = 0; m <= l; ++m) {
            const int i = legendreIndex(l, m);
            if (m == l) {
                q[i] = Lanes{} + t.diagonal[l];
            } else {
                const Lanes& one = q[legendreIndex(l - 1, m)];
                // fall is 0 where there is no second function below.
                const Lanes& two = m < l - 1 ? q[legendreIndex(l - 2, m)] : one;
                q[i] = t.rise[i] * z * one - t.fall[i] * two;
            }
            // For m = 0 the first store is overwritten by the second.
            lanesAt(out + size_t(shIndex(l, -m)) * stride) = q[i] * sinPart[m];
            lanesAt(out + size_t(shIndex(l, m)) * stride) = q[i] * cosPart[m];
        }
}

/// The code for one direction as the body of a loop, which becomes vectors of whatever width the machine has.
template <int N>
[[gnu::always_inline]] inline void evalByStraightLine(const float* x, const float* y, const float* z,
                                                      size_t blocks, float* out, size_t stride) {
    for (size_t first = 0; first < blocks * kLanes; first += kLanes) {
        PRT_INDEPENDENT_LOOP
        for (size_t lane = 0; lane < kLanes; ++lane) {
            const size_t k = first + lane;
            detail::evalShStraightLine<N, float>(
                x[k], y[k], z[k], [&](int i, float value) __attribute__((always_inline)) {
                    out[size_t(i) * stride + k] = value;
                });
        }
    }
}

/// Directions in blocks of sixteen.
/// @param x, y, z  [blocks·16]   @param out  [n²] rows of as many, stride apart
PRT_TARGET_CLONES void evalBlocks(int shOrder, const float* x, const float* y, const float* z, size_t blocks,
                                  float* out, size_t stride) {
    static_assert(detail::kMaxStraightLineOrder == 10);
    switch (shOrder) {
        case 1:
            return evalByStraightLine<1>(x, y, z, blocks, out, stride);
        case 2:
            return evalByStraightLine<2>(x, y, z, blocks, out, stride);
        case 3:
            return evalByStraightLine<3>(x, y, z, blocks, out, stride);
        case 4:
            return evalByStraightLine<4>(x, y, z, blocks, out, stride);
        case 5:
            return evalByStraightLine<5>(x, y, z, blocks, out, stride);
        case 6:
            return evalByStraightLine<6>(x, y, z, blocks, out, stride);
        case 7:
            return evalByStraightLine<7>(x, y, z, blocks, out, stride);
        case 8:
            return evalByStraightLine<8>(x, y, z, blocks, out, stride);
        case 9:
            return evalByStraightLine<9>(x, y, z, blocks, out, stride);
        case 10:
            return evalByStraightLine<10>(x, y, z, blocks, out, stride);
        default:
            break;
    }
    for (size_t k = 0; k < blocks * kLanes; k += kLanes)
        evalByTable(shOrder, x + k, y + k, z + k, out + k, stride);
}

/// rows[k·columns + i] = lanes[i·16 + k] for k < rowCount.
void transposeBlock(const float* lanes, int columns, int rowCount, float* rows) {
    constexpr int kWidth = int(kLanes);
    for (int k = 0; k < rowCount; k += 4) {
        const bool wholeRows = k + 4 <= rowCount;
        int i = 0;
        for (; wholeRows && i + 4 <= columns; i += 4) {
            const float* p = lanes + i * kWidth + k;
            const detail::Quad a = quadAt(p).value, b = quadAt(p + kWidth).value,
                               c = quadAt(p + 2 * kWidth).value, d = quadAt(p + 3 * kWidth).value;
            const auto abLow = __builtin_shufflevector(a, b, 0, 4, 1, 5);
            const auto abHigh = __builtin_shufflevector(a, b, 2, 6, 3, 7);
            const auto cdLow = __builtin_shufflevector(c, d, 0, 4, 1, 5);
            const auto cdHigh = __builtin_shufflevector(c, d, 2, 6, 3, 7);
            float* r = rows + k * columns + i;
            quadAt(r) = __builtin_shufflevector(abLow, cdLow, 0, 1, 4, 5);
            quadAt(r + columns) = __builtin_shufflevector(abLow, cdLow, 2, 3, 6, 7);
            quadAt(r + 2 * columns) = __builtin_shufflevector(abHigh, cdHigh, 0, 1, 4, 5);
            quadAt(r + 3 * columns) = __builtin_shufflevector(abHigh, cdHigh, 2, 3, 6, 7);
        }
        for (; i < columns; ++i)
            for (int r = k; r < std::min(k + 4, rowCount); ++r) rows[r * columns + i] = lanes[i * kWidth + r];
    }
}

}  // namespace

void evalShSoa(int shOrder, std::span<const float> x, std::span<const float> y, std::span<const float> z,
               std::span<float> out, size_t stride) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxShOrder);
    const size_t count = x.size(), functions = size_t(shCount(shOrder));
    PRT_CHECK_EQ(y.size(), count);
    PRT_CHECK_EQ(z.size(), count);
    PRT_CHECK_LE(count, stride);
    if (count == 0) return;
    PRT_CHECK_LE((functions - 1) * stride + count, out.size());
    const size_t blocks = count / kLanes, k = blocks * kLanes;
    evalBlocks(shOrder, x.data(), y.data(), z.data(), blocks, out.data(), stride);
    if (k == count) return;
    // The rest goes through a block of its own.
    float rest[3][kLanes] = {};
    float block[shCount(kMaxShOrder) * kLanes];
    std::copy(x.begin() + ptrdiff_t(k), x.end(), rest[0]);
    std::copy(y.begin() + ptrdiff_t(k), y.end(), rest[1]);
    std::copy(z.begin() + ptrdiff_t(k), z.end(), rest[2]);
    evalBlocks(shOrder, rest[0], rest[1], rest[2], 1, block, kLanes);
    for (size_t i = 0; i < functions; ++i) std::copy_n(block + i * kLanes, count - k, &out[i * stride + k]);
}

void evalShBatch(int shOrder, std::span<const Vec3f> directions, std::span<float> out) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxShOrder);
    PRT_CHECK_EQ(out.size(), directions.size() * size_t(shCount(shOrder)));
    const size_t columns = size_t(shCount(shOrder));
    float xyz[3][kLanes];
    float block[shCount(kMaxShOrder) * kLanes];
    for (size_t first = 0; first < directions.size(); first += kLanes) {
        const size_t n = std::min(kLanes, directions.size() - first);
        for (size_t k = 0; k < kLanes; ++k) {
            const Vec3f& d = directions[first + std::min(k, n - 1)];
            for (int axis = 0; axis < 3; ++axis) xyz[axis][k] = d[axis];
        }
        evalBlocks(shOrder, xyz[0], xyz[1], xyz[2], 1, block, kLanes);
        transposeBlock(block, int(columns), int(n), out.data() + first * columns);
    }
}

}  // namespace prt
