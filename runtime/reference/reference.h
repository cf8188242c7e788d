// The truth: the same pixels lit by tracing rays against the whole environment. Shares neither the bake's
// directions nor any spherical harmonics with the rest of the pipeline.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "precompute/io/environment_file.h"
#include "precompute/io/scene.h"
#include "precompute/io/surface_albedo.h"
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

inline constexpr int kMaxBounces = 64;

struct BounceOptions {
    int bounces = 0;    ///< 0..kMaxBounces; 0: direct light alone, no path is traced
    int paths = 256;    ///< 2..1048576 per pixel, an even number
    uint64_t seed = 1;  ///< of the paths; errors of different seeds are independent
};
struct BounceResult {
    std::vector<std::vector<float>> irradiance;  ///< [environments][pixels×3] direct and bounced
    /// [environments] estimated sampling error of the bounced part: its RMS over covered pixels and colours,
    /// as a share of the RMS of the irradiance. From two halves of the paths; 0 without bounces. What the
    /// cells of the direct light are wrong by is not in it.
    std::vector<double> relativeError;
    uint64_t rays = 0;  ///< of the bounced part
};

/// Irradiance as traceReference has it, and what of it arrives after 1 … k diffuse reflections:
///   E = E_direct + (1/P) Σ_paths ρ_1 (e_1 + ρ_2 (e_2 + … ρ_k e_k)),
/// ρ_j the albedo of the j-th surface a path meets, e_j its direct irradiance estimated with one cell of the
/// light that is chosen in proportion to its flux (mean share over the environments). Paths leave every
/// surface with a density of cosine over π, the first about the shading normal, all others about the
/// geometric one, and end where they meet nothing or the back of a triangle whose material is not
/// double-sided (it is black). The same for any number of threads; a pixel does not depend on the others.
/// @param surface  of the same mesh as the caster's and the albedo's
/// @param visitor  as in traceReference
/// @throws UsageError  an option out of range; Interrupted
/// @source rendering equation by paths with next-event estimation [Kajiya1986]; first directions by a
/// Kronecker sequence [Roberts2018], shifted per pixel [CranleyPatterson1976]
BounceResult traceReferenceBounces(const RayCaster& caster, const SurfaceImage& surface,
                                   const ReferenceDirections& directions, const SurfaceAlbedo& albedo,
                                   const BounceOptions& options, const ReferenceVisitor& visitor = {});

/// Primary rays of a camera, as an independent check of the runtime's rasteriser: triangle, position and
/// geometric normal; shading normal = interpolated vertex normal (no maps), albedo 1.
SurfaceImage castPrimaryRays(const RayCaster& caster, const Scene& scene, const Camera& camera, int width,
                             int height);

}  // namespace prt
