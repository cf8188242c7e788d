// The inner loops of projection: sums of rows of a table. Additions and multiplications only, never fused and
// in a fixed order, so the same bits on every machine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "precompute/math/irradiance_weight.h"

namespace prt {

/// Row length of a table for so many columns: the next multiple of 16.
constexpr size_t paddedColumns(size_t columns) { return (columns + 15) / 16 * 16; }

/// sum[c] += Σ_j table[rows[j]·stride + c], added in the order of j.
/// @param stride  floats per row, a multiple of 16
/// @param sum     [stride]
void addTableRows(const float* table, size_t stride, const uint16_t* rows, size_t rowCount, float* sum);

/// sum[c] += Σ_j weights[j] · table[rows[j]·stride + c], added in the order of j.
/// @param weights  [rowCount]
void addWeightedTableRows(const float* table, size_t stride, const uint16_t* rows, const float* weights,
                          size_t rowCount, float* sum);

/// A function of cosines, tabulated.
class CosineTable {
  public:
    /// @param steps  intervals of [−1, 1], values between are interpolated linearly
    template <class Function>
    CosineTable(int steps, const Function& function) : steps_(steps) {
        for (int k = 0; k <= steps; ++k) values_.push_back(float(function(2.0 * k / steps - 1)));
        values_.push_back(values_.back());
    }
    /// @param cosine  −1..1
    float operator()(float cosine) const {
        const float place = (cosine + 1) * 0.5f * float(steps_);
        const int step = int(place);
        const float* value = &values_[size_t(step)];
        return value[0] + (place - float(step)) * (value[1] - value[0]);
    }
    int steps() const { return steps_; }
    const float* values() const { return values_.data(); }

  private:
    int steps_;
    std::vector<float> values_;  // one more than the steps have ends, so that 1 needs no case of its own
};

/// w of the cosine to the geometric normal, good to 1e-6.
CosineTable irradianceWeightTable(const IrradianceWeight& weight);

/// Unit directions as a structure of arrays.
struct DirectionColumns {
    const float *x, *y, *z;
};

/// Σ max(0, cosine) and how many are positive: two sums over the same cosines may differ by their order, but
/// not in their counts.
struct CosineSum {
    double sum = 0;
    uint32_t positive = 0;

    CosineSum& operator+=(const CosineSum& other) {
        sum += other.sum;
        positive += other.positive;
        return *this;
    }
    friend CosineSum operator+(CosineSum a, const CosineSum& b) { return a += b; }
};
/// What is seen of all that is open: exactly 1 where nothing is missing; 0 where nothing is open.
float seenShare(const CosineSum& seen, const CosineSum& open);

/// cosines[k] = n·ω_k, clamped to [−1, 1].
/// @param count    at most 1024
/// @param normal   [3]
/// @param cosines  [count, rounded up to a multiple of 16] out
/// @return sums over even and over odd k
std::array<CosineSum, 2> cosinesAbout(const DirectionColumns& directions, size_t count, const float* normal,
                                      float* cosines);

/// The sum over the cosines of some rows, at most 1024.
CosineSum sumOfCosines(const float* cosines, const uint16_t* rows, size_t rowCount);

/// weights[j] = f(cosines[rows[j]])
/// @param weights  [rowCount] out
void weighRows(const CosineTable& f, const float* cosines, const uint16_t* rows, size_t rowCount,
               float* weights);

}  // namespace prt
