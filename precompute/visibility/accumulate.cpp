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
std::array<double, 2> cosinesAbout(const DirectionColumns& directions, size_t count, const float* normal,
                                   float* cosines) {
    const float *x = directions.x, *y = directions.y, *z = directions.z;
    const float nx = normal[0], ny = normal[1], nz = normal[2];
    for (size_t k = 0; k < count; ++k) {
        const float cosine = nx * x[k] + ny * y[k] + nz * z[k];
        cosines[k] = cosine < -1 ? -1 : cosine > 1 ? 1 : cosine;
    }
    const size_t padded = (count + kLanes - 1) / kLanes * kLanes;
    for (size_t k = count; k < padded; ++k) cosines[k] = 0;
    double partial[kLanes] = {};
    for (size_t k = 0; k < padded; k += kLanes)
        for (size_t lane = 0; lane < kLanes; ++lane)
            partial[lane] += double(cosines[k + lane] > 0 ? cosines[k + lane] : 0.0f);
    std::array<double, 2> sums{};
    for (size_t lane = 0; lane < kLanes; ++lane) sums[lane % 2] += partial[lane];
    return sums;
}

double sumOfCosines(const float* cosines, const uint16_t* rows, size_t rowCount) {
    // Several sums side by side: one would wait for its own additions.
    std::array<double, 4> partial{};
    size_t j = 0;
    for (; j + 4 <= rowCount; j += 4)
        for (size_t lane = 0; lane < 4; ++lane) {
            const float cosine = cosines[rows[j + lane]];
            partial[lane] += double(cosine > 0 ? cosine : 0.0f);
        }
    for (; j < rowCount; ++j) partial[0] += double(cosines[rows[j]] > 0 ? cosines[rows[j]] : 0.0f);
    return (partial[0] + partial[1]) + (partial[2] + partial[3]);
}

PRT_TARGET_CLONES
void weighRows(const CosineTable& f, const float* cosines, const uint16_t* rows, size_t rowCount,
               float* weights) {
    const float* values = f.values();
    const float half = 0.5f * float(f.steps());
    for (size_t j = 0; j < rowCount; ++j) {
        const float place = (cosines[rows[j]] + 1) * half;
        const int step = int(place);
        weights[j] = values[step] + (place - float(step)) * (values[step + 1] - values[step]);
    }
}

}  // namespace prt
