// Ear clipping: D. Eberly, "Triangulation by Ear Clipping", Geometric Tools, 2002; plane by Newell's method
// (M. Newell, in I. Sutherland, R. Sproull, R. Schumacker, "A Characterization of Ten Hidden-Surface
// Algorithms", 1974).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "precompute/base/error.h"
#include "precompute/mesh/readers.h"

namespace prt {
namespace {

using Point = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;

double turn(const Point& a, const Point& b, const Point& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

std::vector<Point> projectPolygon(std::span<const Vec3f> points) {
    Vec3d normal(0, 0, 0);
    const Vec3d origin = points[0].cast<double>();
    for (size_t i = 0; i < points.size(); ++i) {
        const Vec3d a = points[i].cast<double>() - origin;
        const Vec3d b = points[(i + 1) % points.size()].cast<double>() - origin;
        normal += a.cross(b);
    }
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    // Dropping the largest axis keeps the order of the corners, mirrored where the normal points down it.
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double sign = normal[axis] < 0 ? -1 : 1;
    std::vector<Point> flat;
    flat.reserve(points.size());
    for (const Vec3f& p : points) {
        const Vec3d d = p.cast<double>() - origin;
        flat.emplace_back(sign * d[u], d[v]);
    }
    return flat;
}

class EarClipper {
  public:
    explicit EarClipper(std::vector<Point> points) : points_(std::move(points)), ring_(points_.size()) {
        std::iota(ring_.begin(), ring_.end(), 0u);
    }

    std::vector<std::array<uint32_t, 3>> run() {
        std::vector<std::array<uint32_t, 3>> triangles;
        size_t at = 0;
        while (ring_.size() > 3) {
            at = pickEar(at % ring_.size());
            const size_t n = ring_.size();
            triangles.push_back({ring_[(at + n - 1) % n], ring_[at], ring_[(at + 1) % n]});
            ring_.erase(ring_.begin() + std::ptrdiff_t(at));
        }
        triangles.push_back({ring_[0], ring_[1], ring_[2]});
        return triangles;
    }

  private:
    const Point& point(size_t i) const { return points_[ring_[i % ring_.size()]]; }

    bool isEar(size_t i) const {
        const size_t n = ring_.size();
        const Point &a = point(i + n - 1), &b = point(i), &c = point(i + 1);
        if (turn(a, b, c) <= 0) return false;
        for (size_t k = 2; k < n - 1; ++k) {
            const Point& p = point(i + k);
            if (p == a || p == b || p == c) continue;
            if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
        }
        return true;
    }

    /// The first ear from `start` on; where there is none (self-intersection, no area) any corner must do.
    size_t pickEar(size_t start) const {
        for (size_t k = 0; k < ring_.size(); ++k)
            if (isEar((start + k) % ring_.size())) return (start + k) % ring_.size();
        return start;
    }

    std::vector<Point> points_;
    std::vector<uint32_t> ring_;
};

}  // namespace

std::vector<std::array<uint32_t, 3>> triangulatePolygon(std::span<const Vec3f> points) {
    if (points.size() < 3) return {};
    if (points.size() == 3) return {{0, 1, 2}};
    std::vector<Point> flat = projectPolygon(points);
    if (points.size() == 4) {
        const bool cut02 = turn(flat[0], flat[1], flat[2]) > 0 && turn(flat[0], flat[2], flat[3]) > 0;
        const bool cut13 = turn(flat[0], flat[1], flat[3]) > 0 && turn(flat[1], flat[2], flat[3]) > 0;
        const double d02 = (points[2] - points[0]).cast<double>().squaredNorm();
        const double d13 = (points[3] - points[1]).cast<double>().squaredNorm();
        if (cut13 && (!cut02 || d13 < d02)) return {{0, 1, 3}, {1, 2, 3}};
        return {{0, 1, 2}, {0, 2, 3}};
    }
    return EarClipper(std::move(flat)).run();
}

void PolygonAppender::append(std::span<const uint32_t> corners, std::span<const uint32_t> normal,
                             std::span<const uint32_t> texcoord, int material, const std::string& where) {
    if (corners.size() < 3) {
        countRepair(report_, "degenerate_faces_dropped", 1);
        return;
    }
    if (corners.size() > kMaxPolygonCorners)
        throw InputError(
            where, fmt::format("a face has {} corners, more than {}", corners.size(), kMaxPolygonCorners),
            "triangulate the mesh before exporting it");
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
        for (uint32_t k : {a, b, c}) {
            mesh_.position.push_back(corners[k]);
            if (!normal.empty()) mesh_.normal.push_back(normal[k]);
            if (!texcoord.empty()) mesh_.texcoord.push_back(texcoord[k]);
        }
        mesh_.material.push_back(material);
    };
    if (corners.size() == 3) {
        add(0, 1, 2);
        return;
    }
    points_.clear();
    for (uint32_t c : corners) points_.push_back(mesh_.positions[c]);
    for (const auto& t : triangulatePolygon(points_)) add(t[0], t[1], t[2]);
    countRepair(report_, "polygons_triangulated", 1);
}

}  // namespace prt
