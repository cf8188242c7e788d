// Spherical harmonics of many directions: blocks of 16, structure of arrays, bands from the bottom up so that
// all m of a band are independent chains; then a transposition in 4×4 tiles into rows.
// Recurrences as in sh.cpp [Sloan2008, A2].
#include <algorithm>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"

namespace prt {
namespace {

constexpr int kLanes = 16;
constexpr int kMaxFloatShOrder = 10;  // as in evalSh: above it the recurrences run in double

/// @param xyz  [3][kLanes]   @param out  [n²][kLanes]
template <typename T>
[[gnu::always_inline]] inline void evalBlock(const LegendreRecurrence<T>& t, int shOrder,
                                             const T* __restrict xyz, float* __restrict out) {
    T q[legendreCount(kMaxShOrder)][kLanes];
    T cosPart[kMaxShOrder][kLanes], sinPart[kMaxShOrder][kLanes];
    const T *x = xyz, *y = xyz + kLanes, *z = xyz + 2 * kLanes;
    for (int k = 0; k < kLanes; ++k) {
        cosPart[0][k] = 1;
        sinPart[0][k] = 0;
    }
    for (int m = 1; m < shOrder; ++m)
        for (int k = 0; k < kLanes; ++k) {
            cosPart[m][k] = x[k] * cosPart[m - 1][k] - y[k] * sinPart[m - 1][k];
            sinPart[m][k] = x[k] * sinPart[m - 1][k] + y[k] * cosPart[m - 1][k];
        }
    for (int l = 0; l < shOrder; ++l) {
        float* const middle = out + shIndex(l, 0) * kLanes;
        for (int m = 0; m <= l; ++m) {
            const int i = legendreIndex(l, m);
            const T *one = q[l > m ? legendreIndex(l - 1, m) : i],
                    *two = q[l > m + 1 ? legendreIndex(l - 2, m) : i];
            const T rise = t.rise[i], fall = t.fall[i], diagonal = t.diagonal[m];
            if (m == l)
                for (int k = 0; k < kLanes; ++k) q[i][k] = diagonal;
            else if (m == l - 1)
                for (int k = 0; k < kLanes; ++k) q[i][k] = rise * z[k] * one[k];
            else
                for (int k = 0; k < kLanes; ++k) q[i][k] = rise * z[k] * one[k] - fall * two[k];
            if (m > 0)
                for (int k = 0; k < kLanes; ++k) middle[-m * kLanes + k] = float(q[i][k] * sinPart[m][k]);
            for (int k = 0; k < kLanes; ++k) middle[m * kLanes + k] = float(q[i][k] * cosPart[m][k]);
        }
    }
}

PRT_TARGET_CLONES void evalBlockFloat(const LegendreRecurrence<float>& t, int shOrder, const float* xyz,
                                      float* out) {
    evalBlock<float>(t, shOrder, xyz, out);
}
PRT_TARGET_CLONES void evalBlockDouble(const LegendreRecurrence<double>& t, int shOrder, const double* xyz,
                                       float* out) {
    evalBlock<double>(t, shOrder, xyz, out);
}

/// rows[k·columns + i] = lanes[i·kLanes + k] for k < rowCount.
void transposeBlock(const float* lanes, int columns, int rowCount, float* rows) {
    using Vec4 [[gnu::vector_size(16), gnu::aligned(4)]] = float;
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

template <typename T>
void evalBatch(int shOrder, std::span<const Vec3f> directions, float* out,
               void (*evalLanes)(const LegendreRecurrence<T>&, int, const T*, float*)) {
    const LegendreRecurrence<T>& t = legendreRecurrence<T>();
    const int columns = shCount(shOrder);
    alignas(64) T xyz[3 * kLanes];
    alignas(64) float lanes[shCount(kMaxShOrder) * kLanes];
    for (size_t first = 0; first < directions.size(); first += kLanes) {
        const int n = int(std::min<size_t>(kLanes, directions.size() - first));
        for (int k = 0; k < kLanes; ++k) {
            const Vec3f& d = directions[first + size_t(std::min(k, n - 1))];
            for (int axis = 0; axis < 3; ++axis) xyz[axis * kLanes + k] = T(d[axis]);
        }
        evalLanes(t, shOrder, xyz, lanes);
        transposeBlock(lanes, columns, n, out + first * size_t(columns));
    }
}

}  // namespace

void evalShBatch(int shOrder, std::span<const Vec3f> directions, std::span<float> out) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxShOrder);
    PRT_CHECK_EQ(out.size(), directions.size() * size_t(shCount(shOrder)));
    if (shOrder <= kMaxFloatShOrder)
        evalBatch<float>(shOrder, directions, out.data(), &evalBlockFloat);
    else
        evalBatch<double>(shOrder, directions, out.data(), &evalBlockDouble);
}

}  // namespace prt
