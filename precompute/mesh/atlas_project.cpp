// Charts in their planes. Smallest enclosing rectangle along an edge of the convex hull: H. Freeman and R.
// Shapira, "Determining the Minimum-Area Encasing Rectangle for an Arbitrary Closed Curve", CACM 18(7), 1975;
// hull by A. Andrew's monotone chain, 1979.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "precompute/base/parallel.h"
#include "precompute/mesh/atlas_parts.h"

namespace prt {
namespace {

using Point = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;

/// Directions tried for the rectangle: hulls of scans have thousands of edges, nearly all alike.
constexpr size_t kMostDirections = 256;

double turn(const Point& a, const Point& b, const Point& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

std::vector<Point> convexHull(std::vector<Point> points) {
    std::sort(points.begin(), points.end(),
              [](const Point& a, const Point& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    std::vector<Point> hull;
    const auto addChain = [&](auto begin, auto end) {
        const size_t base = hull.size();
        for (auto it = begin; it != end; ++it) {
            while (hull.size() >= base + 2 && turn(hull[hull.size() - 2], hull.back(), *it) <= 0)
                hull.pop_back();
            hull.push_back(*it);
        }
        hull.pop_back();
    };
    addChain(points.begin(), points.end());
    addChain(points.rbegin(), points.rend());
    return hull;
}

/// Extents of points along a direction and across it.
struct Extents {
    double low[2], high[2];
    double area() const { return (high[0] - low[0]) * (high[1] - low[1]); }
};

Extents extentsAlong(const std::vector<Point>& points, const Point& along) {
    Extents e{{1e300, 1e300}, {-1e300, -1e300}};
    for (const Point& p : points) {
        const double a[2] = {along.dot(p), along.x() * p.y() - along.y() * p.x()};
        for (int i = 0; i < 2; ++i) {
            e.low[i] = std::min(e.low[i], a[i]);
            e.high[i] = std::max(e.high[i], a[i]);
        }
    }
    return e;
}

/// Unit vector along the wide side of the smallest rectangle.
Point widestDirection(const std::vector<Point>& hull) {
    Point best(1, 0);
    double bestArea = extentsAlong(hull, best).area();
    const size_t step = std::max<size_t>(1, hull.size() / kMostDirections);
    for (size_t i = 0; i < hull.size(); i += step) {
        const Point edge = hull[(i + 1) % hull.size()] - hull[i];
        const double length = edge.norm();
        if (!(length > 0)) continue;
        const Point along = edge / length;
        const double area = extentsAlong(hull, along).area();
        // Only a real gain turns a chart: boxes that lie straight stay straight.
        if (area < bestArea * (1 - 1e-6)) bestArea = area, best = along;
    }
    const Extents e = extentsAlong(hull, best);
    return e.high[0] - e.low[0] >= e.high[1] - e.low[1] ? best : Point(-best.y(), best.x());
}

ChartShape projectChart(const AtlasMesh& mesh, const Vec3d& mean, std::span<const uint32_t> faces) {
    ChartShape shape;
    const double length = mean.norm();
    const Vec3d normal = length > 0 ? Vec3d(mean / length) : Vec3d(0, 0, 1);
    // World up is up in the image where there is one: easier to look at, and straight walls stay straight.
    const Vec3d reference = std::abs(normal.y()) < 0.99 ? Vec3d(0, 1, 0) : Vec3d(0, 0, -1);
    const Vec3d right = reference.cross(normal).normalized();
    const Vec3d up = normal.cross(right);
    const Vec3d origin = mesh.corner(3 * faces[0]).cast<double>();
    std::vector<Point> points;
    points.reserve(faces.size() * 3);
    for (uint32_t f : faces)
        for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
            const Vec3d d = mesh.corner(h).cast<double>() - origin;
            points.emplace_back(right.dot(d), up.dot(d));
        }
    const std::vector<Point> hull = convexHull(std::move(points));
    const Point along = widestDirection(hull);
    shape.right = right * along.x() + up * along.y();
    shape.up = up * along.x() - right * along.y();
    const Extents e = extentsAlong(hull, along);
    shape.low[0] = e.low[0] + shape.right.dot(origin);
    shape.low[1] = -e.high[1] - shape.up.dot(origin);
    shape.size[0] = e.high[0] - e.low[0];
    shape.size[1] = e.high[1] - e.low[1];
    for (uint32_t f : faces)
        shape.area += std::max(0.0, mesh.normal[f].cast<double>().dot(normal)) * double(mesh.area[f]);
    return shape;
}

/// A straight cut through a chart's rectangle.
struct Cut {
    int axis = -1;
    double at = 0;
    double area = 0;  ///< of the rectangles of both sides
};

Cut bestCut(const AtlasMesh& mesh, const ChartShape& shape, std::span<const uint32_t> faces,
            bool longAxisOnly) {
    constexpr int kPositions = 16;
    Cut best;
    best.area = 1e300;
    for (int axis = 0; axis < (longAxisOnly ? 1 : 2); ++axis)
        for (int k = 1; k < kPositions; ++k) {
            if (longAxisOnly && k != kPositions / 2) continue;
            const double at = shape.size[axis] * k / kPositions;
            double low[2][2] = {{1e300, 1e300}, {1e300, 1e300}},
                   high[2][2] = {{-1e300, -1e300}, {-1e300, -1e300}};
            for (uint32_t f : faces) {
                const int side = shape.project(mesh.centroid[f])[axis] < at ? 0 : 1;
                for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
                    const Point p = shape.project(mesh.corner(h));
                    for (int i = 0; i < 2; ++i) {
                        low[side][i] = std::min(low[side][i], p[i]);
                        high[side][i] = std::max(high[side][i], p[i]);
                    }
                }
            }
            if (low[0][0] > high[0][0] || low[1][0] > high[1][0]) continue;
            double area = 0;
            for (int side = 0; side < 2; ++side)
                area += (high[side][0] - low[side][0]) * (high[side][1] - low[side][1]);
            if (area < best.area) best = {axis, at, area};
        }
    return best;
}

}  // namespace

std::vector<ChartShape> projectCharts(const AtlasMesh& mesh, const Charts& charts, const ChartFaces& faces) {
    const std::vector<Vec3d> mean = meanNormals(mesh, charts);
    std::vector<ChartShape> shapes(charts.count);
    parallelFor(charts.count, 16, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) shapes[c] = projectChart(mesh, mean[c], faces.of(uint32_t(c)));
    });
    return shapes;
}

bool splitWastefulCharts(const AtlasMesh& mesh, Charts& charts, double texelsPerUnit, int texels) {
    constexpr double kPoorFill = 0.65, kWasteShare = 0.001, kWorthwhile = 0.8;
    const ChartFaces faces = facesByChart(charts);
    const std::vector<ChartShape> shapes = projectCharts(mesh, charts, faces);
    const double scale = texelsPerUnit * texelsPerUnit / (double(texels) * texels);
    const uint32_t before = charts.count;
    std::vector<Cut> cuts(before);
    parallelFor(before, 16, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
            const ChartShape& shape = shapes[c];
            const auto chartFaces = faces.of(uint32_t(c));
            if (chartFaces.size() < 2) continue;
            const double rectangle = shape.size[0] * shape.size[1];
            const bool tooLong = shape.size[0] * texelsPerUnit > 0.95 * texels;
            const bool wasteful =
                shape.area < kPoorFill * rectangle && (rectangle - shape.area) * scale > kWasteShare;
            if (!tooLong && !wasteful) continue;
            const Cut cut = bestCut(mesh, shape, chartFaces, tooLong);
            if (cut.axis >= 0 && (tooLong || cut.area < kWorthwhile * rectangle)) cuts[c] = cut;
        }
    });
    bool changed = false;
    for (uint32_t f = 0; f < mesh.faces(); ++f) {
        const uint32_t c = charts.ofFace[f];
        if (cuts[c].axis < 0 || shapes[c].project(mesh.centroid[f])[cuts[c].axis] < cuts[c].at) continue;
        charts.ofFace[f] = before + c;
        changed = true;
    }
    if (!changed) return false;
    charts.count = 2 * before;
    splitIntoConnected(mesh, charts);
    return true;
}

ChartShape turned(const ChartShape& shape) {
    ChartShape result = shape;
    // The image turns clockwise: what pointed right points down.
    result.right = shape.up;
    result.up = -shape.right;
    result.low[0] = -(shape.low[1] + shape.size[1]);
    result.low[1] = shape.low[0];
    result.size[0] = shape.size[1];
    result.size[1] = shape.size[0];
    return result;
}

}  // namespace prt
