// Rays from a block of near items, one direction at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "precompute/rays/ray_caster.h"
#include "precompute/visibility/bake_items.h"
#include "precompute/visibility/direction_levels.h"
#include "precompute/visibility/point_mask.h"

namespace prt {

/// How Embree is given the rays of one direction. By packets a ray that grazes an edge may depend on those
/// beside it: they never reach from one word of a mask to the next.
enum class RayCasting { Stream, Packets };

class RayBlock {
  public:
    RayBlock(const RayCaster& caster, const BakeItems& items) : caster_(caster), items_(items) {}

    /// @param block  the items, at most kMostBlockPoints, near each other, all of one orientation; kept by
    ///               reference
    void begin(std::span<const uint32_t> block);
    /// The items with more than one sub-point, or one of another normal than theirs.
    const PointMask& shared() const { return shared_; }

    /// Items with direction k above the horizon of the sub-point that takes it.
    PointMask above(const DirectionLevel& level, uint32_t k);
    /// The cosine of any direction at the sub-point that takes it.
    float cosineOf(const DirectionLevel& level, size_t i, uint32_t k) const;

    /// Those of `rays`, all above their horizon, that see past the scene in a direction.
    PointMask visible(const DirectionLevel& level, uint32_t k, const PointMask& rays, RayCasting casting);
    /// The same of several directions, gathered so that streams of rays are full: their answers are added to
    /// `visible` (zero there) by the next flush() at the latest. Directions that follow each other should be
    /// near each other.
    void enqueue(const DirectionLevel& level, uint32_t k, const PointMask& rays,
                 std::vector<PointMask>& visible);
    void flush(std::vector<PointMask>& visible);
    uint64_t rays() const { return rays_; }  ///< traced since the beginning

  private:
    uint32_t subPoint(size_t i, uint32_t k) const;
    void setCone(Vec3f axis);

    const RayCaster& caster_;
    const BakeItems& items_;
    std::span<const uint32_t> block_;
    size_t orientation_ = 0;
    PointMask shared_;
    std::vector<uint32_t> sharedList_;
    std::vector<uint8_t> slots_;  // [kMostBlockPoints × 256] sub-point by the upper bits of the deal
    std::vector<Vec3f> offset_;   // ray origins of all sub-points of the block
    std::vector<Vec3f> normal_;   // their normals
    std::array<uint32_t, kMostBlockPoints> offsetStart_{}, hash_{};
    std::array<float, kMostBlockPoints> normalX_{}, normalY_{}, normalZ_{}, cosines_{};
    std::array<Vec3f, kMostBlockPoints> origins_;
    std::array<uint8_t, kMostBlockPoints> blocked_{};
    // Cone around the normals: no item has a direction above its horizon that is farther from the axis.
    Vec3f coneAxis_ = Vec3f::Zero();
    float coneSine_ = 1;
    uint64_t rays_ = 0;
    // Rays waiting for a full stream.
    std::vector<Vec3f> queueOrigins_, queueDirections_;
    std::vector<std::pair<uint32_t, uint32_t>> queuePlaces_;  // direction, item
    std::vector<uint8_t> queueBlocked_;
};

}  // namespace prt
