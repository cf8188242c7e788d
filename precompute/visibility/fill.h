// Values for texels and vertices that have none of their own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/io/visibility_file.h"
#include "precompute/mesh/texel_raster.h"
#include "precompute/visibility/bake.h"

namespace prt {

/// How far a texel inside geometry may be from the valid texel of its chart that it copies.
inline constexpr int kInsideReachTexels = 32;
/// How far gutters are filled (bilinear lookups need 1, the rest serves smaller mip levels).
inline constexpr int kGutterReachTexels = 8;

/// Spreads baked points over the atlas: points inside geometry take the nearest valid texel of their chart
/// (their normal stays their own), gutters the nearest texel that then has a good value.
/// @param baked  [surface.points]
VisibilityMap fillTexels(const TexelSurface& surface, const BakeResult& baked, int shOrder);

/// Vertices inside geometry take the mean of their good neighbours along edges, weighted by the inverse of
/// the edge's length, from the outside in.
/// @param baked  [vertices]
VisibilityMap fillVertices(const Scene& scene, const VertexPoints& vertices, const BakeResult& baked,
                           int shOrder);

}  // namespace prt
