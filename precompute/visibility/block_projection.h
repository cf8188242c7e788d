// From answers per direction to expansions and their estimated errors.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "precompute/math/irradiance_norm.h"
#include "precompute/math/irradiance_projection.h"
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

    /// @param orientation  of the block
    /// @param normals      [items of the block] unit, world; zero: no points, everything comes out zero
    void project(const DirectionLevel& level, int orientation, const LevelMasks& masks,
                 std::span<const Vec3f> normals);

    /// @param out  [n²] the expansion of item i, world
    void expansion(size_t i, std::span<float> out) const;
    /// (1/π)∫V max(0, n·ω) about the item's normal by this set, as a share of what nothing blocks.
    float openness(size_t i) const { return seenShare(seen_[0][i] + seen_[1][i], open_[0][i] + open_[1][i]); }
    /// Irradiance norm of the difference between the expansion and that of every second direction.
    double halfSetDifference(size_t i) const;

  private:
    void listVisible(const LevelMasks& masks, size_t start, size_t end);
    void addChunk(const DirectionLevel& level, size_t i, size_t start, size_t count);
    float* sums(size_t half, size_t i) { return &sums_[(i * 2 + half) * stride_]; }
    const float* sums(size_t half, size_t i) const { return &sums_[(i * 2 + half) * stride_]; }

    const ProjectionTables& tables_;
    size_t stride_, directions_ = 0;
    const TurnedSet* set_ = nullptr;
    Mat3d worldFromSet_ = Mat3d::Identity();
    bool turned_ = false;
    std::vector<Vec3f> normals_, setNormals_;  // in the world, and turned back to the set as it is
    std::vector<uint16_t> lists_;  // [kMostBlockPoints × 2 × row] visible directions of a chunk, by half
    std::vector<float> sums_;      // [kMostBlockPoints × 2 × stride]
    std::vector<float> cosines_, weights_;
    std::array<std::array<uint16_t, kMostBlockPoints>, 2> counts_{};
    std::array<std::array<CosineSum, kMostBlockPoints>, 2> seen_{},
        open_{};  // sums of cosines about the normal
};

}  // namespace prt
