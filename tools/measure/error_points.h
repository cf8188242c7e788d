// What a measurement of errors knows of a bundle: its visibility as it ships, and points of its surface that
// are judged.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "precompute/io/scene.h"
#include "precompute/io/visibility_file.h"
#include "precompute/rays/ray_caster.h"
#include "precompute/visibility/bake.h"

namespace prt::tools {

/// A bundle in memory.
struct JudgedBundle {
    Scene scene;
    VisibilityMap visibility;
    std::optional<PcaMap> pca;   ///< none where the bundle is not compressed
    std::string bakeCommand;     ///< that made visibility.exr
    std::string compressedWith;  ///< kind of the weights: "irradiance" or "plain"
};

/// @throws InputError  no bundle, stale or damaged (names file and command)
JudgedBundle readJudgedBundle(const std::string& path);

/// Valid points of a bundle, in the order of their normals.
struct JudgedPoints {
    std::vector<uint32_t> place;  ///< [points] texel or vertex, index into VisibilityMap
    /// Each point as a vertex of its own: what of the surface it stands for, as the bake has it (a texel that
    /// is its point has one part). Parts inside geometry are left out where others are not.
    VertexPoints parts;
    std::vector<uint32_t> chart;  ///< [texels] TexelSurface::chartOfTexel; empty per vertex
};

/// At most `most` of the points with Validity::Valid, spread evenly over the file.
/// @param caster  of the bundle's mesh
/// @param most    0: all
/// @throws InputError  no valid point, or the mesh is not the one that was baked
JudgedPoints judgedPoints(const JudgedBundle& bundle, const RayCaster& caster, size_t most);

/// Visibility of the points by many directions, of the bundle's order.
/// @param rays  directions over the sphere, 1..kMaxBakeRays
/// @return [points×n²]
/// @throws Interrupted
std::vector<float> bakeJudgedPoints(const RayCaster& caster, const JudgedPoints& points, int shOrder,
                                    int rays, const Projection& projection);

/// Share of a point that each direction reaches from it, 0..1: the mean over its parts of what
/// traceVisibility finds.
/// @param directions  [K] unit, world
/// @return [K]
std::vector<float> traceJudgedPoint(const RayCaster& caster, const JudgedPoints& points, size_t point,
                                    std::span<const Vec3f> directions);

}  // namespace prt::tools
