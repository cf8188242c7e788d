// The steps of the atlas: segment, merge, project, split, pack. Internal to the mesh stage.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "precompute/io/scene.h"
#include "precompute/mesh/atlas.h"
#include "precompute/mesh/half_edge_mesh.h"
#include "precompute/mesh/topology.h"

namespace prt {

/// Largest angle between a face and its chart's plane normal, whatever is merged: beyond it the projection
/// shrinks texels more than fivefold.
inline constexpr double kLargestLeanDeg = 80;

/// What every step reads: faces, their geometry, and which they touch.
struct AtlasMesh {
    const Scene& scene;
    std::vector<Vec3f> normal;    ///< [faces] zero where there is no area
    std::vector<float> area;      ///< [faces]
    std::vector<Vec3f> centroid;  ///< [faces]
    HalfEdgeMesh edges;           ///< with borders along creases
    std::vector<uint32_t> twin;   ///< [3×faces] opposites() of it
    double totalArea = 0;
    size_t faces() const { return normal.size(); }
    const Vec3f& corner(uint32_t halfEdge) const { return scene.positions[scene.indices[halfEdge]]; }
};
/// @param creaseDeg  edges sharper than this are borders: across them visibility jumps with the horizon, and
///                   a texel that straddles one would mix both sides
AtlasMesh makeAtlasMesh(const Scene& scene, double creaseDeg);

/// A chart for every face; charts are connected over twins.
struct Charts {
    std::vector<uint32_t> ofFace;  ///< [faces]
    uint32_t count = 0;
};

/// Faces by chart: those of chart c are faces[first[c]] … faces[first[c + 1] − 1], rising.
struct ChartFaces {
    std::vector<uint32_t> first, faces;
    std::span<const uint32_t> of(uint32_t chart) const {
        return std::span(faces).subspan(first[chart], first[chart + 1] - first[chart]);
    }
};
ChartFaces facesByChart(const Charts& charts);

/// Whether a face leans no more than the angle of that cosine from a mean normal; faces without area do not.
inline bool withinCone(const Vec3f& normal, const Vec3d& mean, double cosine) {
    const double length = mean.norm();
    return normal.isZero(0.0f) || (length > 0 && normal.cast<double>().dot(mean) >= cosine * length);
}

/// Area-weighted mean normals, not normalised.
std::vector<Vec3d> meanNormals(const AtlasMesh& mesh, const Charts& charts);

/// Renumbers so that every connected piece of every label is a chart, by lowest face.
void splitIntoConnected(const AtlasMesh& mesh, Charts& charts);

/// Faces outside `angleDeg` of their chart's mean normal become charts of their own, until there are none.
void ejectLeaningFaces(const AtlasMesh& mesh, Charts& charts, double angleDeg);

/// Segments by growing within a cone, flattest regions first, and relaxes the result.
Charts growCharts(const AtlasMesh& mesh, double coneAngleDeg);

/// Merges charts smaller than an area into the neighbour with the longest common border.
/// @param smallArea   in scene units²
/// @param leanDeg     largest angle of any face to the mean normal of the merged chart
void mergeSmallCharts(const AtlasMesh& mesh, Charts& charts, double smallArea, double leanDeg);

/// A chart in its plane: x along `right`, y down the image along −`up`; right × up is the normal.
struct ChartShape {
    Vec3d right, up;
    double low[2] = {0, 0};   ///< smallest p·right, p·(−up), scene units
    double size[2] = {0, 0};  ///< extents, scene units
    double area = 0;          ///< of the projected triangles
    Eigen::Matrix<double, 2, 1, Eigen::DontAlign> project(const Vec3f& p) const {
        const Vec3d d = p.cast<double>();
        return {right.dot(d) - low[0], -up.dot(d) - low[1]};
    }
};

/// Projects onto the plane of the mean normal, turned to the smallest enclosing rectangle, wide rather than
/// high.
std::vector<ChartShape> projectCharts(const AtlasMesh& mesh, const Charts& charts, const ChartFaces& faces);

/// Cuts charts that are longer than the atlas at this density or fill little of their rectangle.
/// @return whether anything changed
bool splitWastefulCharts(const AtlasMesh& mesh, Charts& charts, double texelsPerUnit, int texels);

/// Splits charts whose projections cover a texel centre twice at this density.
/// @return number of charts that were split
int splitOverlaps(const AtlasMesh& mesh, Charts& charts, const ChartFaces& faces,
                  const std::vector<ChartShape>& shapes, double texelsPerUnit);

/// Where charts lie.
struct Packing {
    double texelsPerUnit = 0;  ///< 0: no room
    bool upright = false;      ///< shapes were turned by 90°
    std::vector<int> x, y;     ///< [charts] texel of the shape's low corner
};
/// The fullest packing that fits.
Packing packCharts(const AtlasMesh& mesh, const ChartFaces& faces, const std::vector<ChartShape>& shapes,
                   int texels, int gutter);
/// Turns by 90° in the plane.
ChartShape turned(const ChartShape& shape);

/// Columns from low to high that a triangle reaches between y = row and row + 1, generously: to test all of
/// them would cost the square of a splinter's length. Empty: the second below the first.
std::pair<int, int> columnsInRow(const std::array<double, 3>& x, const std::array<double, 3>& y, int row,
                                 int low, int high);

/// Texel centres that the triangles of uv1 cover.
struct Coverage {
    size_t covered = 0;  ///< at least once
    size_t twice = 0;    ///< by two triangles, each with a margin to its border
};
Coverage measureCoverage(const Scene& scene, int texels);

}  // namespace prt
