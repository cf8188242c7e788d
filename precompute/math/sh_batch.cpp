// Spherical harmonics of many directions: blocks of 32, structure of arrays, bands from the bottom up so that
// all m of a band are independent chains; then a transposition in 4×4 tiles into rows.
// Recurrences as in sh.cpp [Sloan2008, A2].
#include <algorithm>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"

namespace prt {
namespace {

// More than 16, or GCC unrolls the loops over lanes completely before it could vectorise them.
constexpr int kLanes = 32;

/// One function pair ±m: q = (rise z) one − fall two, and its products with the two parts of (x + iy)^m.
[[gnu::always_inline]] inline void evalStep(float rise, float fall, const float* __restrict z,
                                            const float* __restrict one, const float* __restrict two,
                                            const float* __restrict cosPart, const float* __restrict sinPart,
                                            float* __restrict q, float* __restrict outCos,
                                            float* __restrict outSin) {
    for (int k = 0; k < kLanes; ++k) {
        const float value = rise * z[k] * one[k] - fall * two[k];
        q[k] = value;
        outSin[k] = value * sinPart[k];
        outCos[k] = value * cosPart[k];
    }
}

[[gnu::always_inline]] inline void evalDiagonal(float diagonal, const float* __restrict cosPart,
                                                const float* __restrict sinPart, float* __restrict q,
                                                float* __restrict outCos, float* __restrict outSin) {
    for (int k = 0; k < kLanes; ++k) {
        q[k] = diagonal;
        outSin[k] = diagonal * sinPart[k];
        outCos[k] = diagonal * cosPart[k];
    }
}

/// (c', s') = (x + iy) (c + is).
[[gnu::always_inline]] inline void raisePower(const float* __restrict x, const float* __restrict y,
                                              const float* __restrict c, const float* __restrict s,
                                              float* __restrict cNext, float* __restrict sNext) {
    for (int k = 0; k < kLanes; ++k) {
        cNext[k] = x[k] * c[k] - y[k] * s[k];
        sNext[k] = x[k] * s[k] + y[k] * c[k];
    }
}

/// @param xyz  [3][kLanes]   @param out  [n²][kLanes]
PRT_TARGET_CLONES void evalBlock(const LegendreRecurrence<float>& t, int shOrder, const float* __restrict xyz,
                                 float* __restrict out) {
    alignas(64) float q[legendreCount(kMaxShOrder)][kLanes];
    alignas(64) float cosPart[kMaxShOrder][kLanes], sinPart[kMaxShOrder][kLanes];
    alignas(64) float unused[kLanes];  // where the sine part of m = 0 goes
    const float *x = xyz, *y = xyz + kLanes, *z = xyz + 2 * kLanes;
    for (int k = 0; k < kLanes; ++k) {
        cosPart[0][k] = 1;
        sinPart[0][k] = 0;
    }
    for (int m = 1; m < shOrder; ++m)
        raisePower(x, y, cosPart[m - 1], sinPart[m - 1], cosPart[m], sinPart[m]);
    for (int l = 0; l < shOrder; ++l) {
        float* const middle = out + shIndex(l, 0) * kLanes;
        for (int m = 0; m < l; ++m) {
            const int i = legendreIndex(l, m);
            const float* one = q[legendreIndex(l - 1, m)];
            // fall is 0 where there is no second function below.
            const float* two = m < l - 1 ? q[legendreIndex(l - 2, m)] : one;
            evalStep(t.rise[i], t.fall[i], z, one, two, cosPart[m], sinPart[m], q[i], middle + m * kLanes,
                     m > 0 ? middle - m * kLanes : unused);
        }
        evalDiagonal(t.diagonal[l], cosPart[l], sinPart[l], q[legendreIndex(l, l)], middle + l * kLanes,
                     l > 0 ? middle - l * kLanes : unused);
    }
}

/// rows[k·columns + i] = lanes[i·kLanes + k] for k < rowCount.
void transposeBlock(const float* lanes, int columns, int rowCount, float* rows) {
    using Vec4 [[gnu::vector_size(16), gnu::aligned(4), gnu::may_alias]] = float;
    const auto load = [](const float* p) { return *reinterpret_cast<const Vec4*>(p); };
    for (int k = 0; k < rowCount; k += 4) {
        const bool wholeRows = k + 4 <= rowCount;
        int i = 0;
        for (; wholeRows && i + 4 <= columns; i += 4) {
            const float* p = lanes + i * kLanes + k;
            const auto a = load(p), b = load(p + kLanes), c = load(p + 2 * kLanes), d = load(p + 3 * kLanes);
            const auto abLow = __builtin_shufflevector(a, b, 0, 4, 1, 5);
            const auto abHigh = __builtin_shufflevector(a, b, 2, 6, 3, 7);
            const auto cdLow = __builtin_shufflevector(c, d, 0, 4, 1, 5);
            const auto cdHigh = __builtin_shufflevector(c, d, 2, 6, 3, 7);
            float* r = rows + k * columns + i;
            *reinterpret_cast<Vec4*>(r) = __builtin_shufflevector(abLow, cdLow, 0, 1, 4, 5);
            *reinterpret_cast<Vec4*>(r + columns) = __builtin_shufflevector(abLow, cdLow, 2, 3, 6, 7);
            *reinterpret_cast<Vec4*>(r + 2 * columns) = __builtin_shufflevector(abHigh, cdHigh, 0, 1, 4, 5);
            *reinterpret_cast<Vec4*>(r + 3 * columns) = __builtin_shufflevector(abHigh, cdHigh, 2, 3, 6, 7);
        }
        for (; i < columns; ++i)
            for (int r = k; r < std::min(k + 4, rowCount); ++r) rows[r * columns + i] = lanes[i * kLanes + r];
    }
}

}  // namespace

void evalShBatch(int shOrder, std::span<const Vec3f> directions, std::span<float> out) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxShOrder);
    PRT_CHECK_EQ(out.size(), directions.size() * size_t(shCount(shOrder)));
    const LegendreRecurrence<float>& t = legendreRecurrence<float>();
    const int columns = shCount(shOrder);
    alignas(64) float xyz[3 * kLanes];
    alignas(64) float lanes[shCount(kMaxShOrder) * kLanes];
    for (size_t first = 0; first < directions.size(); first += kLanes) {
        const int n = int(std::min<size_t>(kLanes, directions.size() - first));
        for (int k = 0; k < kLanes; ++k) {
            const Vec3f& d = directions[first + size_t(std::min(k, n - 1))];
            for (int axis = 0; axis < 3; ++axis) xyz[axis * kLanes + k] = d[axis];
        }
        evalBlock(t, shOrder, xyz, lanes);
        transposeBlock(lanes, columns, n, out.data() + first * size_t(columns));
    }
}

}  // namespace prt
