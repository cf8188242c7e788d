// Incident radiance of one environment at the points of a bundle, with light that bounced: what an SH
// lightmap holds.
#pragma once

#include <span>
#include <vector>

#include "precompute/io/lightmap_file.h"
#include "precompute/io/scene.h"
#include "precompute/io/surface_albedo.h"
#include "precompute/io/visibility_file.h"
#include "precompute/rays/ray_caster.h"
#include "precompute/visibility/lightmap_light.h"

namespace prt {

inline constexpr int kMinLightmapRays = 16, kMaxLightmapRays = 65536;

struct LightmapOptions {
    int bounces = 2;  ///< 0..kMaxLightmapBounces
    /// kMinLightmapRays..kMaxLightmapRays: so many over a point's hemisphere and so many towards the light;
    /// a quarter of that for the light that is handed on from bounce to bounce
    int rays = 1024;
    Projection projection;  ///< of the expansions; the default serves irradiance
};

struct LightmapBake {
    std::vector<float> coefficients;  ///< [grid.count][3][9], see Lightmap
    std::vector<float> irradiance;    ///< [grid.count][3] about the geometric normal, not by way of SH
    /// Estimated RMS sampling error of that irradiance as a share of its RMS, over points that are not inside
    /// geometry; from two halves of the rays. Noise of what was handed on is averaged by the rays of the next
    /// bounce, and not in it.
    double relativeError = 0;
    uint64_t rays = 0;
};

/// Bounce by bounce: E_j, the irradiance with j diffuse reflections, is gathered at all points from the
/// environment and from ρ/π E_{j−1} at whatever a ray meets (bilinear between texels, linear between
/// vertices; ρ the albedo there); with E_{bounces−1} the last pass also sums the expansion. Surfaces reflect
/// about their geometric normal. Backs of triangles are black, unless their material is double-sided: then
/// the light of the other side is handed on, too.
///   L_i = ∫ L(ω) Y_i(ω) dω above the geometric horizon (plain), or the expansion that irradiance cannot tell
///   from L (math/irradiance_projection.h)
/// Rays over the hemisphere and rays towards the light are weighed against each other by the balance
/// heuristic. Parts of a point inside geometry do not count while any other does; points inside geometry and
/// gutters are filled as in the bake. The same for any number of threads.
/// @param scene     as LightmapPoints; the albedo's
/// @param grid      of the bundle's visibility
/// @param validity  [grid.count] of the bundle's visibility
/// @throws UsageError  an option out of range; Interrupted
/// @source order-3 SH lightmaps [IwanickiSloan2012, Sec. 5]; gathering radiosity on the surface's points
/// [GoralEtAl1984], [Heckbert1990]; balance heuristic [VeachGuibas1995]
LightmapBake bakeLightmap(const RayCaster& caster, const Scene& scene, const SurfaceAlbedo& albedo,
                          const PointGrid& grid, std::span<const Validity> validity,
                          const EnvironmentSampler& light, const LightmapOptions& options);

}  // namespace prt
