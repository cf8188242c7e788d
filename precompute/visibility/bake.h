// Visibility of surface points in spherical harmonics.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "precompute/math/irradiance_weight.h"
#include "precompute/mesh/texel_raster.h"
#include "precompute/rays/ray_caster.h"

namespace prt {

/// Largest number of directions (their basis functions are kept in a table).
inline constexpr int kMaxBakeRays = 262144;
/// Sizes of the sets of directions that an adaptive bake goes through.
inline constexpr std::array kAdaptiveSets{256, 1024, 4096, 16384};

struct BakeOptions {
    int shOrder = 6;  ///< 1..kMaxBundleShOrder
    int rays = 1024;  ///< 1..kMaxBakeRays over the whole sphere; those above a point's horizon are traced
    /// 0: every point takes all `rays`. Above: adaptive, `rays` does not count. A point goes through finer
    /// and finer sets of directions (kAdaptiveSets) and stops at the first one whose estimated error
    /// (BakeResult::error) is at most this; of each finer set only directions next to a silhouette are traced
    double error = 0;
    int finestSet = 16384;  ///< adaptive: the last of kAdaptiveSets to be used
    int blockPoints = 256;  ///< 64, 128, 192 or 256 points that take one direction at a time; for speed alone
    Projection projection;  ///< weighted for irradiance, or plain
    bool findInside = true;  ///< classify points inside geometry (most hits are back faces)
    /// [triangles] or empty: non-zero where both sides are a proper outside (a curtain, a leaf), so that
    /// meeting the back does not mean to be inside
    std::span<const uint8_t> doubleSided;
};

/// Seconds of a bake by what was done, summed over threads.
struct BakeStages {
    double setUp = 0;    ///< tables, order of the points
    double trace = 0;    ///< choosing, making and tracing rays
    double project = 0;  ///< sums over visible directions, least squares, estimated errors
    double inside = 0;   ///< points inside geometry
};

struct BakeResult {
    /// [points×n²] world space, V = 0 below the geometric horizon. Plain: of V. Weighted for irradiance: the
    /// expansion that irradiance cannot tell from V; far below the horizon it is not V
    std::vector<float> coefficients;
    std::vector<float> ao;  ///< [points] (1/π)∫V max(0,n·ω), normalised so that an open point has exactly 1
    std::vector<uint8_t> inside;  ///< [points] 1: most rays that hit anything hit the back of a face
    /// More than half of the points looked inside: the winding is inverted or inconsistent, and `inside` was
    /// cleared. A warning has been logged.
    bool windingSuspect = false;
    /// [points] estimated RMS sampling error of irradiance under natural light, as a share of what an open
    /// point receives (math/irradiance_norm.h). Nine of ten true errors are below twice the estimate.
    std::vector<float> error;
    uint64_t rays = 0;        ///< occlusion rays traced
    double traceSeconds = 0;  ///< wall clock of tracing and projection
    BakeStages stages;        ///< where it went
};

/// Visibility at points, by world-fixed sets of directions (spherical Fibonacci) shared by all points;
/// blocks of neighbouring points take one direction at a time. Same bits for any number of threads, and for a
/// point whatever the other points are.
///   plain: v_i = (4π/N) Σ_k V(ω_k) Y_i(ω_k)
///   weighted: b_i = (4π/N) Σ_k w(ω_k·n) V(ω_k) Y_i(ω_k), and v from b and the ambient occlusion by
///   IrradianceProjection about the geometric normal n
/// @throws UsageError   an option out of range
/// @throws Interrupted
/// @source [IwanickiSloan2012, Sec. 3]
BakeResult bakeVisibility(const RayCaster& caster, std::span<const SurfacePoint> points,
                          const BakeOptions& options);

/// As bakeVisibility, one result per point of the surface. A texel whose lookups stay on its chart, with
/// nothing on or in that surface, is its point, to the bit. Others stand for their parts (on a chart's border
/// the point would be one that a neighbouring surface touches), less those inside geometry while any is not;
/// the directions are dealt to the parts by share, so the cost is that of one point. Each part keeps its own
/// horizon; weighted projection is about the texel's normal. Texels take the directions in four orientations,
/// dealt so that every 2×2 have them all: errors of neighbours differ, and leave no bands on smooth surfaces.
/// @throws UsageError, Interrupted
BakeResult bakeTexelVisibility(const RayCaster& caster, const TexelSurface& surface,
                               const BakeOptions& options);

/// Per-vertex points: each vertex stands for the corners of its faces. Sub-points lie inside the incident
/// faces (inset from the vertex, so that rays do not start in the plane of an adjoining wall); the directions
/// are dealt to the sub-points by angle, so the cost is that of one point.
/// Vertices with the same position and shading normal (split only for UVs or materials) are baked once, over
/// all their faces, so that no seam shows between them; hard edges stay apart.
struct VertexPoints {
    std::vector<SurfacePoint> points;  ///< sub-points, all vertices; at most kMaxSubPoints per vertex
    std::vector<uint32_t> firstPoint;  ///< [vertices + 1]; no points where sameAs is another vertex
    std::vector<uint32_t> sameAs;      ///< [vertices] first vertex with the same position and normal
    std::vector<float> share;          ///< [points] of each vertex's directions; sums to 1 per vertex
    std::vector<Vec3f> normals;        ///< [vertices] angle-weighted geometric normal
};
inline constexpr int kMaxSubPoints = 32;

/// @param scene  normals may be absent (then positions alone are compared); a vertex without a face of any
/// area
///               has no points, and bakes to zeros
VertexPoints makeVertexPoints(const Scene& scene);
/// As bakeVisibility, one result per vertex; weighted projection is about the vertex's normal. Vertices take
/// the directions in four orientations, by their index.
BakeResult bakeVertexVisibility(const RayCaster& caster, const VertexPoints& vertices,
                                const BakeOptions& options);

}  // namespace prt
