// The truth: the same pixels lit by tracing rays against the whole environment. Shares neither the bake's
// directions nor any spherical harmonics with the rest of the pipeline.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "precompute/io/environment_file.h"
#include "precompute/io/scene.h"
#include "precompute/io/surface_image.h"
#include "precompute/rays/ray_caster.h"

namespace prt {

/// Directions of the reference: cells of an equal-area grid over the sphere, split further where an
/// environment concentrates its light, each traced at its centre.
struct ReferenceDirections {
    std::vector<Vec3f> direction;     ///< [K] unit
    std::vector<float> solidAngleSr;  ///< [K] sums to 4π
    /// [environments][K][3] mean radiance of the environment over each cell
    std::vector<std::vector<float>> radiance;
};

/// Cells are boxes in height y = sin β and longitude. One is split in four while it carries more than
/// 4/baseCount of the flux of some environment, down to half a texel of that environment. Radiance over a
/// cell is integrated exactly over the image (constant over each texel), so Σ radiance·solidAngle is the flux
/// whatever the cells.
/// @param environments  any number; all share the directions
/// @param rotationsRad  [environments] turn about the up axis: +Z turns towards +X
/// @param baseCount     cells before splitting, about; 16..1048576
/// @throws UsageError   baseCount out of range
ReferenceDirections makeReferenceDirections(std::span<const Environment> environments,
                                            std::span<const double> rotationsRad, int baseCount = 4096);

/// Called once per covered pixel (from any thread): visible[k] = 1 where direction k is above the geometric
/// horizon and nothing blocks it.
using ReferenceVisitor = std::function<void(size_t pixel, std::span<const uint8_t> visible)>;

/// Positions are first moved to the plane of their triangle (they come from a rasteriser's interpolation).
/// Irradiance of every covered pixel under every environment: E = Σ_k V_k max(0, n_s·ω_k) L_k ΔΩ_k, n_s the
/// shading normal, V from the geometric horizon up. One ray pass for all environments; deterministic.
/// @param surface  of the same mesh as the caster's
/// @param visitor  may be empty
/// @throws Interrupted
/// @return [environments][pixels×3]; zeros where nothing is seen
std::vector<std::vector<float>> traceReference(const RayCaster& caster, const SurfaceImage& surface,
                                               const ReferenceDirections& directions,
                                               const ReferenceVisitor& visitor = {});

/// Primary rays of a camera, as an independent check of the runtime's rasteriser: triangle, position and
/// geometric normal; shading normal = interpolated vertex normal (no maps), albedo 1.
SurfaceImage castPrimaryRays(const RayCaster& caster, const Scene& scene, const Camera& camera, int width,
                             int height);

}  // namespace prt
