// Octahedra unfolded into a square: the central projection of [PraunHoppe2003], and the map of equal areas of
// [Clarberg2008]. Lookups over the border as engines store it, e.g. [Majercik2019]. Solid angles of
// triangles: [VanOosteromStrackee1983].
#include <array>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/sphere_map_parts.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

struct Plane {
    double u, v;
};

/// Solid angle of the triangle a, b, c of the plane x + y + z = 1, seen from the origin; signed.
/// @source [VanOosteromStrackee1983, Eq. 8]; there the determinant is twice the triangle's area in (u, v)
double triangleSolidAngle(const Plane& a, const Plane& b, const Plane& c) {
    const double determinant = (b.u - a.u) * (c.v - a.v) - (c.u - a.u) * (b.v - a.v);
    const auto point = [](const Plane& p) { return Vec3d(p.u, p.v, 1 - p.u - p.v); };
    const Vec3d pa = point(a), pb = point(b), pc = point(c);
    const double na = pa.norm(), nb = pb.norm(), nc = pc.norm();
    return 2 * std::atan2(determinant, na * nb * nc + pa.dot(pb) * nc + pb.dot(pc) * na + pc.dot(pa) * nb);
}

/// Solid angle of the part u + v ≤ 1 of the rectangle [u0, u1]×[v0, v1] within [0, 1]².
double rectangleSolidAngle(double u0, double u1, double v0, double v1) {
    const std::array<Plane, 4> corners = {{{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}}};
    std::array<Plane, 5> kept;
    size_t count = 0;
    for (size_t i = 0; i < 4; ++i) {
        const Plane &p = corners[i], &q = corners[(i + 1) % 4];
        const double in = 1 - p.u - p.v, inNext = 1 - q.u - q.v;
        if (in >= 0) kept[count++] = p;
        if ((in > 0 && inNext < 0) || (in < 0 && inNext > 0)) {
            const double f = in / (in - inNext);
            kept[count++] = {p.u + f * (q.u - p.u), p.v + f * (q.v - p.v)};
        }
    }
    double sum = 0;
    for (size_t i = 2; i < count; ++i) sum += triangleSolidAngle(kept[0], kept[i - 1], kept[i]);
    return sum;
}

/// One octant (x, y, z ≥ 0) and the triangle u, v ≥ 0, u + v ≤ 1.
struct Central {
    static Plane fromOctant(const Vec3d& unit) {
        const double sum = unit.x() + unit.y() + unit.z();
        return {unit.x() / sum, unit.y() / sum};
    }
    static Vec3d toOctant(const Plane& p) {
        return Vec3d(p.u, p.v, std::max(0.0, 1 - p.u - p.v)).normalized();
    }

    /// Of the square [s0, s1]×[t0, t1] of the map.
    static double solidAngle(double s0, double s1, double t0, double t1) {
        double sum = 0;
        // what lies in each quadrant, mirrored into the first
        for (const double signS : {-1.0, 1.0})
            for (const double signT : {-1.0, 1.0}) {
                const double u0 = std::max(0.0, std::min(signS * s0, signS * s1));
                const double u1 = std::max(0.0, std::max(signS * s0, signS * s1));
                const double v0 = std::max(0.0, std::min(signT * t0, signT * t1));
                const double v1 = std::max(0.0, std::max(signT * t0, signT * t1));
                if (u0 >= u1 || v0 >= v1) continue;
                sum += rectangleSolidAngle(u0, u1, v0, v1);
                sum += rectangleSolidAngle(1 - v1, 1 - v0, 1 - u1, 1 - u0);  // folded down
            }
        return sum;
    }
};

/// [Clarberg2008]: rings around the pole become lines u + v = r, with r² = 1 − z.
struct EqualArea {
    static Plane fromOctant(const Vec3d& unit) {
        // 1 − z without cancellation
        const double r = std::sqrt((unit.x() * unit.x() + unit.y() * unit.y()) / (1 + unit.z()));
        const double v = r * (2 / kPi) * std::atan2(unit.y(), unit.x());
        return {r - v, v};
    }
    static Vec3d toOctant(const Plane& p) {
        const double r = std::min(1.0, p.u + p.v);
        const double azimuth = r > 0 ? kPi / 2 * std::min(1.0, p.v / r) : 0;
        const double radius = r * std::sqrt(2 - r * r);
        return {radius * std::cos(azimuth), radius * std::sin(azimuth), (1 - r) * (1 + r)};
    }
    static double solidAngle(double s0, double s1, double t0, double t1) {
        return kPi * (s1 - s0) * (t1 - t0);
    }
};

template <typename Projection>
class OctahedralMap : public SphereMap {
  public:
    OctahedralMap(const std::string& name, int size) : SphereMap(name, 1, size, size) {}

    SpherePoint pointFromDirection(const Vec3d& direction) const override {
        const double length = direction.norm();
        PRT_CHECK_LT(0.0, length);
        const Vec3d unit = direction / length;
        Plane p = Projection::fromOctant(unit.cwiseAbs());
        if (unit.z() < 0) p = {1 - p.v, 1 - p.u};
        return {0, toTexels(std::copysign(p.u, unit.x()), faceWidth()),
                toTexels(std::copysign(p.v, -unit.y()), faceWidth())};
    }

    Vec3d directionFromPoint(const SpherePoint& point) const override {
        PRT_CHECK_EQ(point.face, 0);
        const double s = fromTexels(point.x, faceWidth()), t = fromTexels(point.y, faceWidth());
        Plane p{std::abs(s), std::abs(t)};
        const bool lower = p.u + p.v > 1;
        if (lower) p = {1 - p.v, 1 - p.u};
        const Vec3d octant = Projection::toOctant(p);
        return {std::copysign(octant.x(), s), std::copysign(octant.y(), -t),
                lower ? -octant.z() : octant.z()};
    }

    double texelSolidAngle(int texel) const override {
        const SpherePoint centre = texelCentre(texel);
        const int size = faceWidth();
        return Projection::solidAngle(fromTexels(centre.x - 0.5, size), fromTexels(centre.x + 0.5, size),
                                      fromTexels(centre.y - 0.5, size), fromTexels(centre.y + 0.5, size));
    }

    SphereTaps taps(const Vec3d& direction) const override {
        const SpherePoint point = pointFromDirection(direction);
        const int size = faceWidth();
        return bilinearTaps(point.x, point.y, [size](int x, int y) {
            // out over an edge and back in, mirrored in its middle
            const bool mirrorY = x < 0 || x >= size, mirrorX = y < 0 || y >= size;
            x = std::clamp(x, 0, size - 1);
            y = std::clamp(y, 0, size - 1);
            return (mirrorY ? size - 1 - y : y) * size + (mirrorX ? size - 1 - x : x);
        });
    }
};

}  // namespace

std::unique_ptr<SphereMap> makeOctahedralMap(const std::string& name, int size) {
    return std::make_unique<OctahedralMap<Central>>(name, size);
}

std::unique_ptr<SphereMap> makeEqualAreaOctahedralMap(const std::string& name, int size) {
    return std::make_unique<OctahedralMap<EqualArea>>(name, size);
}

}  // namespace prt
