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

/// Points that cost as many rays as a face of findSurelyOutside that is looked at by itself.
inline constexpr size_t kFacePrice = 8;

/// What rays from one place met.
struct InsideCount {
    int rays = 0, hits = 0, backs = 0;

    /// At least a quarter of the rays hit something, and most of those meet its back.
    bool isInside() const { return backs * 2 > hits && hits * 4 >= rays; }
    /// Enough rays, spread over the hemisphere, to be sure: from inside most meet a back, from outside few
    /// do. Of six from below an open sheet (half of the hemisphere sees its back) one meets it but once in
    /// thousands of normals.
    bool isDecided() const { return (rays >= 6 && backs == 0) || (rays >= 10 && backs * 5 >= rays * 4); }
};

/// 1 for points inside geometry.
/// @param directions   taken in turn, those above the horizon, until a point is decided
/// @param doubleSided  [triangles] or empty: faces whose back does not count
std::vector<uint8_t> findInsidePoints(const RayCaster& caster, std::span<const SurfacePoint> points,
                                      std::span<const Vec3f> directions,
                                      std::span<const uint8_t> doubleSided);

/// 1 for items inside geometry. More open ones than an inside one can be are not examined.
/// @param ao           [items]
/// @param doubleSided  [triangles] or empty: faces whose back does not count
std::vector<uint8_t> findInside(const RayCaster& caster, const BakeItems& items, std::span<const float> ao,
                                std::span<const uint8_t> doubleSided);

}  // namespace prt
