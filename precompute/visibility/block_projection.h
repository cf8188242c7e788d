// From answers per direction to expansions and their estimated errors.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "precompute/math/irradiance_norm.h"
#include "precompute/math/irradiance_projection.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/accumulate.h"
#include "precompute/visibility/level_masks.h"

namespace prt {

/// What all blocks of a bake share.
class ProjectionTables {
  public:
    ProjectionTables(int shOrder, const Projection& projection);

    int shOrder;
    IrradianceNorm norm;
    struct Weighting {
        CosineTable weight;
        IrradianceProjection projection;
    };
    std::optional<Weighting> weighting;  ///< absent where projection is plain
};

/// The share of the difference between a set's expansion and that of its every second direction, and between
/// a set's and the coarser set's, that is taken for the error of the former. Measured (tools/docs/
/// performance.md).
inline constexpr double kHalfSetShare = 0.65, kCoarserSetShare = 0.45;

/// Sums one block's visible directions of a set.
class BlockProjection {
  public:
    /// @param stride  of the levels' tables
    BlockProjection(const ProjectionTables& tables, size_t stride);

    /// @param orientations  [items of the block], or empty: all the first
    /// @param normals       [items of the block] unit, world; zero: no points, everything comes out zero
    /// @param shared        items of several sub-points, or one of another normal
    /// @param openShares    [items of the block] BakeItems::openShare of the shared ones
    void project(const DirectionLevel& level, std::span<const uint8_t> orientations, const LevelMasks& masks,
                 std::span<const Vec3f> normals, const PointMask& shared, std::span<const float> openShares);

    /// @param out  [n²] the expansion of item i, world
    void expansion(size_t i, std::span<float> out) const;
    /// (1/π)∫V max(0, n·ω) about the item's normal by this set: what is seen as a share of what is above the
    /// horizons, times what an open item receives.
    float openness(size_t i) const { return openness_[i]; }
    /// [items] irradiance norm of the difference between each expansion and that of every second direction.
    std::span<const float> halfSetDifferences() const { return halfSetDifferences_; }
    /// Irradiance norm of the differences from other expansions.
    /// @param items         [items of the block] rows of
    /// @param coefficients  [row × n²] world
    /// @param out           [items of the block]
    void compare(std::span<const uint32_t> items, std::span<const float> coefficients,
                 std::span<float> out) const;

  private:
    // Of arrays by coefficient; not a power of two, so that rows do not share cache sets.
    static constexpr size_t kSoaStride = kMostBlockPoints + 16;

    size_t columns() const { return size_t(shCount(tables_.shOrder)); }
    void sumRows(const DirectionLevel& level, const LevelMasks& masks);
    void listVisible(const LevelMasks& masks, size_t start, size_t end);
    void addChunk(const DirectionLevel& level, size_t i, size_t start, size_t count);
    void findOpenness(const DirectionLevel& level, const LevelMasks& masks, const PointMask& shared,
                      std::span<const float> openShares);
    void findExpansions(size_t directions);
    void findHalfSetDifferences(size_t directions);
    void solve(std::span<const float> openness, std::vector<float>& values) const;
    void turnIntoWorld(std::span<const uint8_t> orientations);
    float* sums(size_t half, size_t i) { return &sums_[(i * 2 + half) * stride_]; }
    const float* sums(size_t half, size_t i) const { return &sums_[(i * 2 + half) * stride_]; }

    const ProjectionTables& tables_;
    size_t stride_, count_ = 0;  // floats per row of the levels' tables; items
    // Of items, turned back to the set as it is; with +Z for zero; in the world, with +Z for zero.
    std::vector<Vec3f> setNormals_, unitSetNormals_, unitNormals_;
    std::vector<uint16_t> lists_;  // [kMostBlockPoints × 2 × row] visible directions of a chunk, by half
    std::vector<float> sums_;      // [kMostBlockPoints × 2 × stride]
    std::vector<float> cosines_, weights_;
    std::vector<float> expansions_, differences_;  // [n² × kSoaStride]
    std::vector<float> halfSetDifferences_;
    std::array<std::array<uint16_t, kMostBlockPoints>, 2> counts_{};
    std::array<std::array<CosineSum, kMostBlockPoints>, 2> seen_{},
        open_{};  // sums of cosines about the normal
    std::array<float, kMostBlockPoints> openness_{};
};

}  // namespace prt
