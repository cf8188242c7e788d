// What is baked: points, or sets of sub-points that share one result.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/mesh/texel_raster.h"

namespace prt {

/// Item i owns sub-points [firstPoint[i], firstPoint[i+1]) and deals the directions to them.
struct BakeItems {
    std::span<const SurfacePoint> points;
    std::span<const uint32_t> firstPoint;  ///< [items + 1], or empty: item i is point i
    /// [points] upper end of the sub-point's share of [0, 2^32), a multiple of 2^24 but for the last of an
    /// item; empty when firstPoint is
    std::span<const uint32_t> shareEnd;
    /// [items] unit, what projection weighted for irradiance turns about; empty: items are points, each its
    /// own
    std::span<const Vec3f> normals;
    /// [items] index into setOrientations(); empty: all the first
    std::span<const uint8_t> orientations;
    /// [items] 1 for items all of whose sub-points are known to be inside geometry; empty: not known
    std::span<const uint8_t> hidden;

    size_t count() const { return firstPoint.empty() ? points.size() : firstPoint.size() - 1; }
    uint32_t begin(uint32_t item) const { return firstPoint.empty() ? item : firstPoint[item]; }
    uint32_t end(uint32_t item) const { return firstPoint.empty() ? item + 1 : firstPoint[item + 1]; }
    int orientation(uint32_t item) const { return orientations.empty() ? 0 : int(orientations[item]); }
    /// What an open item receives of constant light about its normal n, as a share of π: directions dealt to
    /// sub-points of other normals m_p that are below their horizons are missing, Σ_p share_p (1 + n·m_p)
    /// / 2.
    float openShare(uint32_t item) const;
    /// Unit; zero where the item has no points.
    Vec3f normal(uint32_t item) const {
        if (begin(item) == end(item)) return Vec3f::Zero();
        return normals.empty() ? points[item].normal : normals[item];
    }
};

/// Shares of one item's sub-points as the upper ends of ranges of [0, 2^32).
class ShareEnds {
  public:
    /// @param sum  of the shares
    explicit ShareEnds(double sum);
    uint32_t next(double share);

  private:
    double scale_, passed_ = 0;
};

/// What deals directions: sub-points whose share of [0, 2^32) holds this number take the direction. The
/// fractional part of k·√2 plus a hash of the item. The spiral of directions turns by the golden ratio per k:
/// dealing by that too would give each sub-point one wedge of azimuths.
constexpr uint32_t dealStep(uint32_t direction) { return direction * 0x6a09e667u; }  // frac(√2)·2^32
uint32_t dealOfDirection(uint32_t item, uint32_t direction);

/// Index of the sub-point that takes direction k of an item (its points: first … last − 1, at least one).
uint32_t subPointOfDirection(const BakeItems& items, uint32_t item, uint32_t direction);

/// Order in which near items follow each other: along a Morton curve through the positions, ties by index.
/// @source [Morton1966]
std::vector<uint32_t> mortonOrder(std::span<const Vec3f> positions);
/// The same of items, by their first points.
std::vector<uint32_t> mortonOrderOfItems(const BakeItems& items);

}  // namespace prt
