// Sixteen numbers at once, by the compilers' vector extension: AVX-512 holds them in one register, AVX2 in
// two, SSE in four. Internal to prt_math.
#pragma once

#include <algorithm>
#include <cstddef>

namespace prt::detail {

inline constexpr size_t kLanes = 16;
typedef float Lanes __attribute__((vector_size(sizeof(float) * kLanes)));
/// The same anywhere in an array of floats.
typedef float LanesInArray __attribute__((vector_size(sizeof(float) * kLanes), aligned(4), may_alias));

/// Columns k … k + 15 of a matrix whose row i begins at data + i·stride.
struct ConstLaneColumns {
    const float* data;
    size_t stride;
    [[gnu::always_inline]] const LanesInArray& operator[](size_t i) const {
        return *reinterpret_cast<const LanesInArray*>(data + i * stride);
    }
};
struct LaneColumns {
    float* data;
    size_t stride;
    [[gnu::always_inline]] LanesInArray& operator[](size_t i) const {
        return *reinterpret_cast<LanesInArray*>(data + i * stride);
    }
};

}  // namespace prt::detail
