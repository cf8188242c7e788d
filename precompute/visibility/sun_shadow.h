// How much of a small disc of the sky every point of a mesh sees: the shadow term of a sun that was taken out
// of an environment (math/extract_sun.h).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "precompute/io/scene.h"
#include "precompute/io/visibility_file.h"
#include "precompute/rays/ray_caster.h"

namespace prt {

/// A disc of the sky.
struct SkyDisc {
    Vec3d direction = Vec3d::UnitY();  ///< towards its middle, unit
    double angularRadiusRad = 0;       ///< 0..π/4
};

/// Rays towards a disc that a texel or vertex has, dealt to its sub-points by their shares.
inline constexpr int kSunRays = 64;

/// The share of the disc that is above the geometric horizon of a point and that nothing hides, 0..1: for
/// every texel the mean over its sub-points, for every vertex that over its corners. Sub-points whose ray
/// leaves geometry (the first thing it meets shows its back) do not count while any other does. Points inside
/// geometry and gutters are filled as in the bake, empty texels are 0. The same for any number of threads.
/// @param scene  with uv1 where the grid is an atlas, as rasterizeTexels takes it
/// @param grid   of the bundle's visibility
/// @param validity  [grid.count] of the bundle's visibility: which points are inside
/// @return [grid.count]
/// @throws Interrupted
std::vector<float> sunShadow(const RayCaster& caster, const Scene& scene, const PointGrid& grid,
                             std::span<const Validity> validity, const SkyDisc& disc, int rays = kSunRays);

}  // namespace prt
