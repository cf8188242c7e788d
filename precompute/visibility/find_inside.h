// Points inside geometry: most of what they see is the back of faces.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/rays/ray_caster.h"
#include "precompute/visibility/bake_items.h"

namespace prt {

/// The spiral of directions in an order in which every few of them are spread over the sphere.
/// @param count  a power of two
std::vector<Vec3f> spreadDirections(int count);

/// What rays from one place met.
struct InsideCount {
    int rays = 0, hits = 0, backs = 0;

    void add(const RayCaster& caster, const SurfacePoint& point, const Vec3f& direction,
             std::span<const uint8_t> doubleSided);
    /// At least a quarter of the rays hit something, and most of those meet its back.
    bool isInside() const { return backs * 2 > hits && hits * 4 >= rays; }
    /// Enough rays, spread over the hemisphere, to be sure: from inside most meet a back, from outside few
    /// do.
    bool isDecided() const { return (rays >= 8 && backs == 0) || (rays >= 24 && backs * 4 >= rays * 3); }
};

/// 1 for items inside geometry. More open ones than an inside one can be are not examined.
/// @param ao           [items]
/// @param doubleSided  [triangles] or empty: faces whose back does not count
std::vector<uint8_t> findInside(const RayCaster& caster, const BakeItems& items, std::span<const float> ao,
                                std::span<const uint8_t> doubleSided);

}  // namespace prt
