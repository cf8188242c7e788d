// Projection as a sparse matrix product: a visible direction adds its row of basis functions.
#include "precompute/visibility/accumulate.h"

#include "precompute/base/parallel.h"

namespace prt {
namespace {

// The partial sums of `Width` columns stay in registers over all rows.
template <size_t Width, bool kWeighted>
inline __attribute__((always_inline)) void addColumns(const float* table, size_t stride, const uint16_t* rows,
                                                      const float* weights, size_t rowCount, float* sum) {
    float partial[Width] = {};
    for (size_t j = 0; j < rowCount; ++j) {
        const float* row = table + size_t(rows[j]) * stride;
        if constexpr (kWeighted) {
            const float weight = weights[j];
            for (size_t c = 0; c < Width; ++c) partial[c] += weight * row[c];
        } else {
            for (size_t c = 0; c < Width; ++c) partial[c] += row[c];
        }
    }
    for (size_t c = 0; c < Width; ++c) sum[c] += partial[c];
}

template <bool kWeighted>
inline __attribute__((always_inline)) void addRows(const float* table, size_t stride, const uint16_t* rows,
                                                   const float* weights, size_t rowCount, float* sum) {
    size_t column = 0;
    for (; column + 16 <= stride; column += 16)
        addColumns<16, kWeighted>(table + column, stride, rows, weights, rowCount, sum + column);
    for (; column + 4 <= stride; column += 4)
        addColumns<4, kWeighted>(table + column, stride, rows, weights, rowCount, sum + column);
}

}  // namespace

PRT_TARGET_CLONES
void addTableRows(const float* table, size_t stride, const uint16_t* rows, size_t rowCount, float* sum) {
    addRows<false>(table, stride, rows, nullptr, rowCount, sum);
}

PRT_TARGET_CLONES
void addWeightedTableRows(const float* table, size_t stride, const uint16_t* rows, const float* weights,
                          size_t rowCount, float* sum) {
    addRows<true>(table, stride, rows, weights, rowCount, sum);
}

PRT_TARGET_CLONES
void weighRows(const DirectionColumns& directions, const float* normal, const CosineTable& f,
               const uint16_t* rows, size_t rowCount, float* cosines, float* weights) {
    const float *x = directions.x, *y = directions.y, *z = directions.z, *values = f.values();
    const float nx = normal[0], ny = normal[1], nz = normal[2], half = 0.5f * float(f.steps());
    for (size_t j = 0; j < rowCount; ++j) {
        const size_t k = rows[j];
        const float cosine = nx * x[k] + ny * y[k] + nz * z[k];
        cosines[j] = cosine < -1 ? -1 : cosine > 1 ? 1 : cosine;
    }
    for (size_t j = 0; j < rowCount; ++j) {
        const float place = (cosines[j] + 1) * half;
        const int step = int(place);
        weights[j] = values[step] + (place - float(step)) * (values[step + 1] - values[step]);
    }
}

}  // namespace prt
