// Tracing and projection shared by texels and vertices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/visibility/bake.h"

namespace prt {

/// What is baked: item i owns sub-points [firstPoint[i], firstPoint[i+1]) and deals the directions to them.
struct BakeItems {
    std::span<const SurfacePoint> points;
    std::span<const uint32_t> firstPoint;  ///< [items + 1], or empty: item i is point i
    /// [points] upper end of the sub-point's share of [0, 2^32); empty when firstPoint is
    std::span<const uint32_t> shareEnd;
    /// [items] unit, what projection weighted for irradiance turns about; empty: items are points, each its
    /// own
    std::span<const Vec3f> normals;
    size_t count() const { return firstPoint.empty() ? points.size() : firstPoint.size() - 1; }
};

/// Index of the sub-point that takes direction k of an item (its points: first … last − 1, at least one).
/// Directions are dealt by the fractional part of k·√2 plus a hash of the item. The spiral of directions
/// turns by the golden ratio per k: dealing by that too would give each sub-point one wedge of azimuths.
uint32_t subPointOfDirection(const BakeItems& items, uint32_t item, uint32_t direction);

/// Bakes all items; results [items].
BakeResult bakeItems(const RayCaster& caster, const BakeItems& items, const BakeOptions& options,
                     const char* unit);

/// Order in which near items follow each other: along a Morton curve through the positions, ties by index.
std::vector<uint32_t> mortonOrder(std::span<const Vec3f> positions);

}  // namespace prt
