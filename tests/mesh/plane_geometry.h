// Slow and obvious geometry of triangles in the texture plane, to test fast code against.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "precompute/io/scene.h"

namespace prt {

using Point2 = std::array<double, 2>;
using Triangle2 = std::array<Point2, 3>;

inline Triangle2 texelTriangle(const Scene& scene, size_t t, double texels) {
    Triangle2 result;
    for (size_t k = 0; k < 3; ++k) {
        const Vec2f& uv = scene.uv1[scene.indices[3 * t + k]];
        result[k] = {double(uv.x()) * texels, double(uv.y()) * texels};
    }
    return result;
}

inline double signedArea(const Triangle2& t) {
    return 0.5 * ((t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[2][0] - t[0][0]) * (t[1][1] - t[0][1]));
}

inline double pointSegment(const Point2& p, const Point2& a, const Point2& b) {
    const double dx = b[0] - a[0], dy = b[1] - a[1], length2 = dx * dx + dy * dy;
    double s = length2 > 0 ? ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length2 : 0;
    s = std::clamp(s, 0.0, 1.0);
    return std::hypot(p[0] - a[0] - s * dx, p[1] - a[1] - s * dy);
}

inline double borderDistance(const Triangle2& t, const Point2& p) {
    return std::min({pointSegment(p, t[0], t[1]), pointSegment(p, t[1], t[2]), pointSegment(p, t[2], t[0])});
}

inline bool containsPoint(const Triangle2& t, const Point2& p) {
    const double whole = std::abs(signedArea(t));
    const double parts = std::abs(signedArea({p, t[1], t[2]})) + std::abs(signedArea({t[0], p, t[2]})) +
                         std::abs(signedArea({t[0], t[1], p}));
    return whole > 0 && parts <= whole * (1 + 1e-9);
}

inline double pointDistance(const Triangle2& t, const Point2& p) {
    return containsPoint(t, p) ? 0 : borderDistance(t, p);
}

/// Distance of two triangles that do not cross.
inline double triangleDistance(const Triangle2& a, const Triangle2& b) {
    double least = 1e300;
    for (size_t k = 0; k < 3; ++k) least = std::min({least, pointDistance(a, b[k]), pointDistance(b, a[k])});
    return least;
}

/// Area of a triangle within the square |x − cx| ≤ half, |y − cy| ≤ half (Sutherland–Hodgman).
inline double areaWithinSquare(const Triangle2& t, const Point2& centre, double half) {
    for (size_t axis = 0; axis < 2; ++axis) {
        const auto [low, high] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
        if (low > centre[axis] + half || high < centre[axis] - half) return 0;
    }
    std::vector<Point2> polygon(t.begin(), t.end());
    for (int axis = 0; axis < 2; ++axis)
        for (double side : {-1.0, 1.0}) {
            std::vector<Point2> kept;
            const auto room = [&](const Point2& p) {
                return half - side * (p[size_t(axis)] - centre[size_t(axis)]);
            };
            for (size_t i = 0; i < polygon.size(); ++i) {
                const Point2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
                if (room(a) >= 0) kept.push_back(a);
                if ((room(a) < 0) != (room(b) < 0)) {
                    const double s = room(a) / (room(a) - room(b));
                    kept.push_back({a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])});
                }
            }
            polygon = std::move(kept);
        }
    double area = 0;
    for (size_t i = 2; i < polygon.size(); ++i) area += signedArea({polygon[0], polygon[i - 1], polygon[i]});
    return std::abs(area);
}

}  // namespace prt
