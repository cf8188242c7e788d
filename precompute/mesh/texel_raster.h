// Which point of the surface a texel stands for.
#pragma once

#include <cstdint>
#include <vector>

#include "precompute/io/scene.h"

namespace prt {

/// A point on the surface to bake at.
struct SurfacePoint {
    Vec3f position;
    Vec3f normal;       ///< geometric, unit
    uint32_t triangle;  ///< index in Scene order
};

inline constexpr uint32_t kNoPoint = 0xffffffffu;

/// A sub-point of a texel, and its part of the texel's directions.
struct TexelPart {
    uint32_t subPoint;  ///< index into TexelSurface::subPoints
    float share;        ///< > 0, sums to 1 over a texel
};
inline constexpr int kMaxTexelParts = 16;

struct TexelSurface {
    int width = 0, height = 0;
    std::vector<SurfacePoint> points;     ///< one per texel touched by a chart, in row order
    std::vector<uint32_t> pointOfTexel;   ///< [width×height] index into points, or kNoPoint
    std::vector<uint32_t> chartOfTexel;   ///< [width×height] id of the connected piece in uv1, or kNoPoint
    std::vector<SurfacePoint> subPoints;  ///< neighbouring texels share them
    std::vector<TexelPart> parts;         ///< of all points, at most kMaxTexelParts each
    std::vector<uint32_t> firstPart;      ///< [points + 1]
    std::vector<uint8_t> whole;           ///< [points] 1: all that bilinear lookups show is on the chart
};

/// Every texel that the bilinear filter can fetch for a point of a chart (conservatively: the texel square,
/// grown by half a texel, touches a triangle) gets the point of those triangles nearest to its centre in
/// texture space: the centre itself where it lies on the chart, else a point of the chart's border moved
/// inwards by 1/32 texel (at most half way to the triangle's middle). Ties go to the lowest triangle.
///
/// Its parts are what of the chart the bilinear filter shows of a texel: the square grown by half a texel is
/// cut into 4×4 cells, and the centroid of what the chart covers of each is a sub-point (that of the largest
/// piece of a triangle where the centroid of all lies on another or on none). Its share is that of the
/// chart's area in the cell times the square of the filter's weight there (the weight that a sample has for
/// one texel in the normal equations of a least-squares fit). Where triangles cover no area (degenerate uv1)
/// the texel's point is the only part.
TexelSurface rasterizeTexels(const Scene& scene, int width, int height);

/// For texels that have no value: the nearest texel (Euclidean, in texels) that has one, itself for those
/// that do.
/// @param has         [width×height] non-zero where there is a value
/// @param group       [width×height] or empty: only texels of the same group may be the source
/// @param reachTexels farthest source considered
/// @return [width×height] index of the source, kNoPoint where none is in reach
std::vector<uint32_t> nearestFilledTexel(const std::vector<uint8_t>& has, const std::vector<uint32_t>& group,
                                         int width, int height, int reachTexels);

}  // namespace prt
