// The sets of directions of a bake, from coarse to fine, shared by all points.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "precompute/math/vec.h"
#include "precompute/visibility/orientations.h"

namespace prt {

/// One spherical Fibonacci set.
struct DirectionLevel {
    /// [N] by each of setOrientations(): what is traced.
    std::array<std::vector<Vec3f>, kOrientations> turned;
    std::vector<float> x, y, z;  ///< [N] the set as it is
    std::vector<float> basis;    ///< [N×stride] basis functions of the set as it is, rows padded with zeros
    size_t stride = 0;           ///< paddedColumns(n²)
    /// [N] the nearest directions of the coarser set; empty for the first set
    std::vector<std::array<uint16_t, 4>> coarser;
    /// [N] the nearest other directions of the same set; empty for the first set
    std::vector<std::array<uint16_t, 6>> near;
    /// [N] an order in which near directions follow each other; empty for the first set
    std::vector<uint16_t> order;
    /// Every so many directions one is traced whatever its neighbours say; 0: none.
    uint32_t auditStep = 0;

    size_t size() const { return x.size(); }
};

/// Indices of the K directions of the Fibonacci set of `set.size()` that are nearest to `direction`, nearest
/// first, ties by index.
/// @param skip  an index that does not count, or UINT32_MAX
template <size_t K>
std::array<uint16_t, K> nearestDirections(const std::vector<Vec3f>& set, const Vec3f& direction,
                                          uint32_t skip);

class DirectionLevels {
  public:
    /// @param sizes    directions of each set; all but the first at most 65,536
    /// @param shOrder  of the basis functions
    DirectionLevels(std::vector<int> sizes, int shOrder);
    size_t count() const { return sizes_.size(); }
    /// Made when first asked for; any thread.
    const DirectionLevel& operator[](size_t level) const;

  private:
    struct Slot {
        std::once_flag once;
        DirectionLevel level;
    };
    std::vector<int> sizes_;
    int shOrder_;
    std::unique_ptr<Slot[]> slots_;
};

}  // namespace prt
