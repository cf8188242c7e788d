// Values of an atlas at the vertices of its mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/io/scene.h"

namespace prt {

/// Values at vertices which, interpolated linearly over the triangles, come nearest to what a bilinear lookup
/// in the texels shows:
///   min_x ∫ (Σ_v b_v x_v − f)² dA + Σ_triangles λ A Σ_edges (x_i − x_j)²
/// by evenly spaced samples, at least four to a triangle and about two to a texel. λ is 1e-5, for steady
/// equations, and rises to 1e-2 where samples of a triangle do not count: so vertices that no counting texel
/// reaches go on from their neighbours, and what hangs on nothing is 0. Vertices of the same position and
/// normal (seams of the atlas) have the same values, hard edges may differ. The same for any number of
/// threads.
/// @param scene          with uv1 and normals
/// @param width, height  of the atlas, texels
/// @param counts         [width×height] non-zero where the texel's value is to be trusted
/// @param values         [width×height×perPoint] finite
/// @param perPoint       values of a texel, > 0
/// @return               [scene.vertexCount()×perPoint]
/// @throws Interrupted
/// @source [Kavan2011, Sec. 3], with differences along edges in place of their smoothness
std::vector<float> fitVertexValues(const Scene& scene, int width, int height, std::span<const uint8_t> counts,
                                   std::span<const float> values, size_t perPoint);

}  // namespace prt
