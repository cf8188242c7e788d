// Random points of a mesh that measurements look at, and what they see.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/io/scene.h"
#include "precompute/mesh/texel_raster.h"
#include "precompute/rays/ray_caster.h"

namespace prt::tools {

/// Points uniform over the area of a mesh, the same for the same seed.
/// @throws InputError  the mesh has no area
std::vector<SurfacePoint> randomSurfacePoints(const Scene& scene, size_t count, uint64_t seed);

/// Those of `count` randomSurfacePoints that are not inside geometry, in their order; at least one.
/// @param caster  of the scene
/// @throws InputError  the mesh has no area, or all points are inside
std::vector<SurfacePoint> outsidePoints(const RayCaster& caster, const Scene& scene, size_t count,
                                        uint64_t seed);

/// Visibility of a point: 1 where a direction above the horizon of its normal is not blocked, else 0.
/// @param directions  [N] unit, world
/// @return [N]
std::vector<float> traceVisibility(const RayCaster& caster, const SurfacePoint& point,
                                   std::span<const Vec3f> directions);

}  // namespace prt::tools
