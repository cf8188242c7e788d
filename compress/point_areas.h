// How much of the surface the points of a bundle stand for.
#pragma once

#include <vector>

#include "precompute/io/scene.h"
#include "precompute/io/visibility_file.h"

namespace prt {

/// World area of each point of a grid: of a texel, what of the mesh lies in its square of the atlas, exact;
/// of a vertex, a third of the triangles at it. Together they are the area of the mesh, but for triangles
/// without area in the atlas. Memory: 28 bytes per triangle, or 4 per vertex; none per texel.
class PointAreas {
  public:
    /// @param scene  of mesh.glb; uv1 where the grid is of texels, in [0, 1]
    /// @throws InputError  the grid is of another mesh: no atlas, or another number of vertices
    PointAreas(const Scene& scene, const PointGrid& grid);

    /// Areas of rows firstRow … firstRow + rows − 1 of the grid, in squares of scene units.
    /// @param areas  [rows×width] out; zeros behind the last vertex
    void evaluate(int firstRow, int rows, std::vector<float>& areas) const;

  private:
    struct Triangle {
        float x[3], y[3];  // in texels
        float density;     // world area per square texel
    };
    void addTriangle(const Triangle& triangle, int firstRow, int endRow, std::vector<double>& cover,
                     std::vector<float>& areas) const;

    PointGrid grid_;
    std::vector<Triangle> triangles_;  // of texels
    std::vector<float> vertexAreas_;
};

}  // namespace prt
