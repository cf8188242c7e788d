// Where a lightmap is gathered, and how values at those places become values anywhere on the surface.
#pragma once

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "precompute/io/scene.h"
#include "precompute/io/visibility_file.h"
#include "precompute/mesh/texel_raster.h"
#include "precompute/visibility/bake.h"

namespace prt {

/// A piece of the surface that an item stands for.
struct LightmapPart {
    SurfacePoint point;
    float share = 1;  ///< > 0, of the item
};

/// One item per texel that a chart touches (whole texels one part, others as the bake cuts them), or per
/// vertex (its corners; none where it is a copy of another).
class LightmapPoints {
  public:
    /// @param scene     with uv1 where the grid is an atlas; must outlive the object
    /// @param grid      of the bundle's visibility
    /// @param validity  [grid.count] of the bundle's visibility: which points are inside geometry
    LightmapPoints(const Scene& scene, const PointGrid& grid, std::span<const Validity> validity);

    size_t items() const { return first_.size() - 1; }
    std::span<const LightmapPart> parts(size_t item) const {
        return {parts_.data() + first_[item], first_[item + 1] - first_[item]};
    }
    /// Geometric, unit; of vertices the mean of their faces'.
    const Vec3f& normal(size_t item) const { return normals_[item]; }
    /// Whether its value is made from its neighbours'.
    bool inside(size_t item) const { return inside_[item] != 0; }

    /// Values of items on the grid: points inside geometry and gutters are filled as in the bake.
    /// @param values   [items×columns]   @param columns  1..100
    /// @return [grid.count×columns]
    std::vector<float> spread(std::span<const float> values, size_t columns) const;
    /// The value of the grid at a point of a triangle: bilinear between texels, linear between vertices.
    /// @param values  [grid.count×3]
    /// @param u, v    barycentric coordinates of corners 1 and 2
    Vec3f at(std::span<const float> values, uint32_t triangle, float u, float v) const;

  private:
    void addTexels();
    void addVertices();

    const Scene& scene_;
    PointGrid grid_;
    std::variant<VertexPoints, TexelSurface> source_;
    std::vector<LightmapPart> parts_;
    std::vector<size_t> first_;  // [items + 1]
    std::vector<Vec3f> normals_;
    std::vector<uint8_t> inside_;
};

}  // namespace prt
