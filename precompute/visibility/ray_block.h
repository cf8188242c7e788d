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
    RayBlock(const RayCaster& caster, const BakeItems& items)
        : caster_(caster), items_(items), stream_(caster), queue_(caster) {}

    /// @param block  the items, at most kMostBlockPoints, near each other; kept by reference
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
    static constexpr uint32_t kNoDirection = ~uint32_t(0);

    // Of all sub-points of the block.
    size_t subPoint(size_t i, uint32_t k) const;
    void addSubPoints(size_t i);
    void setCone(Vec3f axis);
    PointMask streamed(const DirectionLevel& level, uint32_t k, const PointMask& rays);
    PointMask inPackets(const DirectionLevel& level, uint32_t k, const PointMask& rays);
    // Lets shared items start their rays in a direction, and look along the normal that they have for it.
    void placeShared(uint32_t k);

    const RayCaster& caster_;
    const BakeItems& items_;
    std::span<const uint32_t> block_;
    PointMask shared_;
    std::vector<uint32_t> sharedList_;
    std::vector<uint8_t> slots_;  // [kMostBlockPoints × 256] sub-point by the upper bits of the deal
    std::vector<Vec3f> offset_;   // ray origins of all sub-points of the block
    std::vector<Vec3f> normal_;   // their normals, turned back to the sets as they are
    std::array<uint32_t, kMostBlockPoints> offsetStart_{}, hash_{};
    std::array<uint8_t, kMostBlockPoints> orientation_{};
    // Of the sub-point that takes the direction in turn: normals as above, starts of rays.
    uint32_t placed_ = kNoDirection;
    std::array<float, kMostBlockPoints> normalX_{}, normalY_{}, normalZ_{};
    std::array<Vec3f, kMostBlockPoints> start_;
    // Cone around the normals: no item has a direction above its horizon that is farther from the axis.
    Vec3f coneAxis_ = Vec3f::Zero();
    float coneSine_ = 1;
    uint64_t rays_ = 0;
    RayStream stream_, queue_;
    std::array<std::pair<uint32_t, uint32_t>, RayStream::kCapacity> queuePlaces_;  // direction, item
};

}  // namespace prt
