// Zonal maps of many expansions at once, sixteen side by side.
#include "precompute/math/zonal_map.h"

#include "precompute/base/parallel.h"

namespace prt {
namespace {

constexpr size_t kAtOnce = 16;

// One block of the map: functions of one m, from one band on.
inline __attribute__((always_inline)) void applyBlock(const double* block, int size, int firstBand, int m,
                                                      size_t stride, const float* in, float* out) {
    for (int a = 0; a < size; ++a) {
        double sums[kAtOnce] = {};
        for (int b = 0; b < size; ++b) {
            const float* from = in + size_t(shIndex(firstBand + b, m)) * stride;
            for (size_t i = 0; i < kAtOnce; ++i) sums[i] += block[a * size + b] * double(from[i]);
        }
        float* to = out + size_t(shIndex(firstBand + a, m)) * stride;
        for (size_t i = 0; i < kAtOnce; ++i) to[i] = float(sums[i]);
    }
}

PRT_TARGET_CLONES void applyBlocks(const double* values, int shOrder, size_t count, size_t stride,
                                   const float* in, float* out) {
    for (size_t start = 0; start < count; start += kAtOnce) {
        const double* block = values;
        for (int m = 0; m < shOrder; ++m) {
            const int size = shOrder - m;
            applyBlock(block, size, m, m, stride, in + start, out + start);
            if (m > 0) applyBlock(block, size, m, -m, stride, in + start, out + start);
            block += size * size;
        }
    }
}

}  // namespace

void ZonalMap::applySoa(size_t count, size_t stride, const float* in, float* out) const {
    applyBlocks(values_.data(), shOrder_, count, stride, in, out);
}

LocalRotations::LocalRotations(std::span<const Vec3f> normals, size_t stride)
    : fromWorld(9 * stride), toWorld(9 * stride) {
    for (size_t k = 0; k < normals.size(); ++k) {
        const Mat3d rotation = localFromWorld(normals[k]);
        for (size_t row = 0; row < 3; ++row)
            for (size_t column = 0; column < 3; ++column) {
                const auto entry = float(rotation(Eigen::Index(row), Eigen::Index(column)));
                fromWorld[(3 * row + column) * stride + k] = entry;
                toWorld[(3 * column + row) * stride + k] = entry;
            }
    }
}

}  // namespace prt
