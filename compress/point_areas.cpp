// Area of triangles within the squares of texels, by Green's theorem: every edge adds what lies to its right,
// with the sign of its direction, so that the sum over edges is the triangle and no polygon is clipped.
#include "compress/point_areas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/base/error.h"

namespace prt {
namespace {

double worldArea(const Scene& scene, size_t triangle) {
    Vec3d p[3];
    for (size_t k = 0; k < 3; ++k) p[k] = scene.positions[scene.indices[3 * triangle + k]].cast<double>();
    return (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2;
}

// Adds the piece of edge a–b within row [y, y + 1): after a running sum over columns, cover[c] is the signed
// area of what lies to the right of the edge within column c.
void addEdge(double ax, double ay, double bx, double by, int y, int firstColumn, std::vector<double>& cover) {
    if (ay == by) return;
    const double slope = (bx - ax) / (by - ay), lowX = std::min(ax, bx), highX = std::max(ax, bx);
    const double from = std::clamp(ay, double(y), double(y + 1)),
                 to = std::clamp(by, double(y), double(y + 1));
    if (from == to) return;
    const auto xAt = [&](double at) { return std::clamp(ax + (at - ay) * slope, lowX, highX); };
    const double x0 = xAt(from), x1 = xAt(to), left = std::min(x0, x1), right = std::max(x0, x1);
    const int last = int(std::floor(right));
    for (int column = int(std::floor(left)); column <= last; ++column) {
        const double begin = std::max(left, double(column)), end = std::min(right, double(column + 1));
        const double height = right > left ? (to - from) * (end - begin) / (right - left) : to - from;
        const double within = (begin + end) / 2 - column;
        const size_t index = size_t(column - firstColumn);
        cover[index] += height * (1 - within);
        cover[index + 1] += height * within;
    }
}

}  // namespace

PointAreas::PointAreas(const Scene& scene, const PointGrid& grid) : grid_(grid) {
    if (grid.domain == PointDomain::Vertex) {
        if (scene.vertexCount() != grid.count)
            throw InputError("mesh.glb", fmt::format("has {} vertices, visibility.exr is of {}",
                                                     scene.vertexCount(), grid.count));
        std::vector<double> areas(grid.count);
        for (size_t t = 0; t < scene.triangleCount(); ++t)
            for (size_t k = 0; k < 3; ++k) areas[scene.indices[3 * t + k]] += worldArea(scene, t) / 3;
        vertexAreas_.assign(areas.begin(), areas.end());
        return;
    }
    if (scene.uv1.size() != scene.vertexCount() || scene.vertexCount() == 0)
        throw InputError("mesh.glb", "has no TEXCOORD_1, the atlas that texels are of");
    for (size_t t = 0; t < scene.triangleCount(); ++t) {
        Triangle triangle{};
        for (size_t k = 0; k < 3; ++k) {
            const Vec2f& uv = scene.uv1[scene.indices[3 * t + k]];
            triangle.x[k] = std::clamp(uv.x(), 0.0f, 1.0f) * float(grid.width);
            triangle.y[k] = std::clamp(uv.y(), 0.0f, 1.0f) * float(grid.height);
        }
        const double area =
            std::abs((double(triangle.x[1]) - triangle.x[0]) * (double(triangle.y[2]) - triangle.y[0]) -
                     (double(triangle.x[2]) - triangle.x[0]) * (double(triangle.y[1]) - triangle.y[0])) /
            2;
        triangle.density = float(worldArea(scene, t) / area);
        if (area > 0 && std::isfinite(triangle.density)) triangles_.push_back(triangle);
    }
}

void PointAreas::evaluate(int firstRow, int rows, std::vector<float>& areas) const {
    PRT_CHECK(firstRow >= 0 && rows >= 0 && firstRow + rows <= grid_.height);
    const size_t width = size_t(grid_.width), first = size_t(firstRow) * width;
    areas.assign(size_t(rows) * width, 0.0f);
    if (grid_.domain == PointDomain::Vertex) {
        for (size_t i = 0; i < areas.size() && first + i < vertexAreas_.size(); ++i)
            areas[i] = vertexAreas_[first + i];
        return;
    }
    std::vector<double> cover;
    for (const Triangle& triangle : triangles_)
        addTriangle(triangle, firstRow, firstRow + rows, cover, areas);
}

void PointAreas::addTriangle(const Triangle& triangle, int firstRow, int endRow, std::vector<double>& cover,
                             std::vector<float>& areas) const {
    const auto [lowY, highY] = std::minmax_element(triangle.y, triangle.y + 3);
    if (*highY <= float(firstRow) || *lowY >= float(endRow)) return;
    const auto [lowX, highX] = std::minmax_element(triangle.x, triangle.x + 3);
    const int firstColumn = int(std::floor(*lowX)), columns = int(std::floor(*highX)) - firstColumn + 1;
    const int begin = std::max(firstRow, int(std::floor(*lowY)));
    const int end = std::min(endRow, int(std::ceil(*highY)));
    for (int y = begin; y < end; ++y) {
        cover.assign(size_t(columns) + 1, 0.0);
        for (int k = 0; k < 3; ++k) {
            const int l = (k + 1) % 3;
            addEdge(double(triangle.x[k]), double(triangle.y[k]), double(triangle.x[l]),
                    double(triangle.y[l]), y, firstColumn, cover);
        }
        double sum = 0;
        for (int c = 0; c < columns && firstColumn + c < grid_.width; ++c) {
            sum += cover[size_t(c)];
            areas[size_t(y - firstRow) * size_t(grid_.width) + size_t(firstColumn + c)] +=
                float(std::min(1.0, std::abs(sum)) * double(triangle.density));
        }
    }
}

}  // namespace prt
