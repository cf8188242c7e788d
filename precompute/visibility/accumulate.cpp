// Projection as a sparse matrix product: a visible direction adds its row of basis functions.
#include "precompute/visibility/accumulate.h"

#include "precompute/base/parallel.h"

namespace prt {
namespace {

constexpr int kWeightSteps = 1024;

constexpr size_t kLanes = 16;
typedef float Lanes __attribute__((vector_size(kLanes * sizeof(float)), aligned(alignof(float))));

// By reference: passing vectors by value depends on the instruction set.
inline __attribute__((always_inline)) void load(const float* from, Lanes& lanes) {
    __builtin_memcpy(&lanes, from, sizeof lanes);
}

// The partial sums of `Groups` times 16 columns stay in registers over all rows. One group alone waits for
// its own additions: several side by side hide that.
template <size_t Groups, bool kWeighted>
inline __attribute__((always_inline)) void addColumns(const float* table, size_t stride, const uint16_t* rows,
                                                      const float* weights, size_t rowCount, float* sum) {
    Lanes partial[Groups] = {};
    for (size_t j = 0; j < rowCount; ++j) {
        const float* row = table + size_t(rows[j]) * stride;
        for (size_t g = 0; g < Groups; ++g) {
            Lanes values;
            load(row + g * kLanes, values);
            if constexpr (kWeighted)
                partial[g] += weights[j] * values;
            else
                partial[g] += values;
        }
    }
    for (size_t g = 0; g < Groups; ++g) {
        Lanes total;
        load(sum + g * kLanes, total);
        total += partial[g];
        __builtin_memcpy(sum + g * kLanes, &total, sizeof total);
    }
}

template <bool kWeighted>
inline __attribute__((always_inline)) void addRows(const float* table, size_t stride, const uint16_t* rows,
                                                   const float* weights, size_t rowCount, float* sum) {
    size_t column = 0;
    for (; column + 4 * kLanes <= stride; column += 4 * kLanes)
        addColumns<4, kWeighted>(table + column, stride, rows, weights, rowCount, sum + column);
    table += column;
    sum += column;
    switch ((stride - column) / kLanes) {
        case 3:
            addColumns<3, kWeighted>(table, stride, rows, weights, rowCount, sum);
            break;
        case 2:
            addColumns<2, kWeighted>(table, stride, rows, weights, rowCount, sum);
            break;
        case 1:
            addColumns<1, kWeighted>(table, stride, rows, weights, rowCount, sum);
            break;
        default:
            break;
    }
}

}  // namespace

CosineTable irradianceWeightTable(const IrradianceWeight& weight) {
    return {kWeightSteps, [&](double cosine) { return irradianceWeight(cosine, weight); }};
}

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
void weighRows(const DirectionColumns& directions, size_t directionCount, const float* normal,
               const CosineTable& f, const uint16_t* rows, size_t rowCount, float* cosines, float* weights) {
    const float *x = directions.x, *y = directions.y, *z = directions.z, *values = f.values();
    const float nx = normal[0], ny = normal[1], nz = normal[2], half = 0.5f * float(f.steps());
    for (size_t k = 0; k < directionCount; ++k) {
        const float cosine = nx * x[k] + ny * y[k] + nz * z[k];
        cosines[k] = cosine < -1 ? -1 : cosine > 1 ? 1 : cosine;
    }
    for (size_t j = 0; j < rowCount; ++j) {
        const float place = (cosines[rows[j]] + 1) * half;
        const int step = int(place);
        weights[j] = values[step] + (place - float(step)) * (values[step + 1] - values[step]);
    }
}

}  // namespace prt
