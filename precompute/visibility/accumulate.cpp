// Projection as a sparse matrix product: a visible direction adds its row of basis functions.
#include "precompute/visibility/accumulate.h"

#include <algorithm>

#include "precompute/base/parallel.h"

namespace prt {
namespace {

constexpr int kWeightSteps = 1024;

constexpr size_t kLanes = 16;
typedef float Lanes __attribute__((vector_size(kLanes * sizeof(float)), aligned(alignof(float))));
typedef int32_t Counts __attribute__((vector_size(kLanes * sizeof(int32_t)), aligned(alignof(int32_t))));

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
std::array<CosineSum, 2> cosinesAbout(const DirectionColumns& directions, size_t count, const float* normal,
                                      float* cosines) {
    const float *x = directions.x, *y = directions.y, *z = directions.z;
    const float nx = normal[0], ny = normal[1], nz = normal[2];
    for (size_t k = 0; k < count; ++k) {
        const float cosine = nx * x[k] + ny * y[k] + nz * z[k];
        cosines[k] = cosine < -1 ? -1 : cosine > 1 ? 1 : cosine;
    }
    const size_t padded = (count + kLanes - 1) / kLanes * kLanes;
    for (size_t k = count; k < padded; ++k) cosines[k] = 0;
    Lanes sums = {};
    Counts counts = {};
    for (size_t k = 0; k < padded; k += kLanes) {
        Lanes values;
        load(cosines + k, values);
        const Counts positive = values > 0;
        sums += positive ? values : Lanes{};
        counts -= positive;  // of lanes: all bits set where true
    }
    std::array<CosineSum, 2> result{};
    for (size_t lane = 0; lane < kLanes; ++lane)
        result[lane % 2] += {double(sums[lane]), uint32_t(counts[lane])};
    return result;
}

CosineSum sumOfCosines(const float* cosines, const uint16_t* rows, size_t rowCount) {
    // Several sums side by side: one would wait for its own additions.
    std::array<float, 4> sums{};
    std::array<uint32_t, 4> counts{};
    const auto add = [&](size_t lane, float cosine) {
        sums[lane] += cosine > 0 ? cosine : 0.0f;
        counts[lane] += cosine > 0;
    };
    size_t j = 0;
    for (; j + 4 <= rowCount; j += 4)
        for (size_t lane = 0; lane < 4; ++lane) add(lane, cosines[rows[j + lane]]);
    for (; j < rowCount; ++j) add(0, cosines[rows[j]]);
    CosineSum result;
    for (size_t lane = 0; lane < 4; ++lane) result += {double(sums[lane]), counts[lane]};
    return result;
}

float seenShare(const CosineSum& seen, const CosineSum& open) {
    if (!(open.sum > 0)) return 0;
    return seen.positive == open.positive ? 1.0f : float(std::min(1.0, seen.sum / open.sum));
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
