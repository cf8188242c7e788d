// Two hemispheres, each projected to a disc and from there to a square: [IwanickiSloan2012, Appendix A], the
// concentric map of [ShirleyChiu1997]. A projection turns circles around the axis into circles around the
// disc's centre, and the concentric map turns those into squares, so the solid angle over (s, t) is a
// function of max(|s|, |t|) alone and integrates in closed form.
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/sphere_map_parts.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

/// A circle of the unit sphere around ±Z.
struct Circle {
    double radius, height;  ///< height ≥ 0, radius² + height² = 1
};

/// Disc radius tan(θ/2). On the square dω = π / (1 + m²)² ds dt, m = max(|s|, |t|).
struct Paraboloid {
    static double discRadius(const Circle& circle) { return circle.radius / (1 + circle.height); }
    static Circle circle(double r) {
        return {2 * r / (1 + r * r), std::max(0.0, (1 - r) * (1 + r) / (1 + r * r))};
    }
    static double square(double m) { return kPi * m * m / (1 + m * m); }
    static double strip(double m) { return kPi / 2 * (m / (1 + m * m) + std::atan(m)); }
};

/// Disc radius sin θ. On the square dω = π/4 / √(1 − m²) ds dt.
struct Orthographic {
    static double discRadius(const Circle& circle) { return circle.radius; }
    static Circle circle(double r) { return {r, std::sqrt(std::max(0.0, (1 - r) * (1 + r)))}; }
    static double square(double m) { return kPi / 2 * m * m / (1 + std::sqrt((1 - m) * (1 + m))); }
    static double strip(double m) { return kPi / 4 * std::asin(m); }
};

/// @param Projection  square(m): solid angle over [0, m]², sr; strip(m): over a strip along s, 0 ≤ s ≤ m, per
///                    unit of its width, where m = s all over
template <typename Projection>
class DualMap : public SphereMap {
  public:
    DualMap(const std::string& name, int size) : SphereMap(name, 2, size, size) {}

    SpherePoint pointFromDirection(const Vec3d& direction) const override {
        const double length = direction.norm();
        PRT_CHECK_LT(0.0, length);
        const int face = direction.z() >= 0 ? 0 : 1;
        const double x = (face == 0 ? direction.x() : -direction.x()) / length, y = -direction.y() / length;
        const Circle circle{std::hypot(x, y), std::abs(direction.z()) / length};
        const double r = std::min(1.0, Projection::discRadius(circle));
        double s = 0, t = 0;
        if (std::abs(x) >= std::abs(y)) {
            s = std::copysign(r, x);
            if (r > 0) t = s * (4 / kPi) * std::atan(y / x);
        } else {
            t = std::copysign(r, y);
            s = t * (4 / kPi) * std::atan(x / y);
        }
        return {face, toRing(s), toRing(t)};
    }

    Vec3d directionFromPoint(const SpherePoint& point) const override {
        PRT_CHECK(point.face == 0 || point.face == 1);
        const double s = fromRing(point.x), t = fromRing(point.y);
        const bool wide = std::abs(s) >= std::abs(t);
        const double r = std::max(std::abs(s), std::abs(t));
        const double angle = r > 0 ? kPi / 4 * (wide ? t / s : s / t) : 0;
        const Circle circle = Projection::circle(r);
        const double along = std::copysign(circle.radius, wide ? s : t) * std::cos(angle);
        const double across = std::copysign(circle.radius, wide ? s : t) * std::sin(angle);
        const double x = wide ? along : across, y = wide ? across : along;
        return point.face == 0 ? Vec3d(x, -y, circle.height) : Vec3d(-x, -y, -circle.height);
    }

    double texelSolidAngle(int texel) const override {
        const SpherePoint centre = texelCentre(texel);
        const double s0 = fromRing(centre.x - 0.5), s1 = fromRing(centre.x + 0.5);
        const double t0 = fromRing(centre.y - 0.5), t1 = fromRing(centre.y + 0.5);
        return cornerSolidAngle(s1, t1) - cornerSolidAngle(s0, t1) - cornerSolidAngle(s1, t0) +
               cornerSolidAngle(s0, t0);
    }

    SphereTaps taps(const Vec3d& direction) const override {
        const SpherePoint point = pointFromDirection(direction);
        const int size = faceWidth();
        // On the ring itself the texel beyond it weighs 0.
        return bilinearTaps(point.x, point.y, [&](int x, int y) {
            return (point.face * size + std::clamp(y, 0, size - 1)) * size + std::clamp(x, 0, size - 1);
        });
    }

  private:
    /// From [−1, 1] to texels, and back: ±1 are the outermost centres.
    double toRing(double s) const { return 0.5 + 0.5 * (s + 1) * (faceWidth() - 1); }
    double fromRing(double x) const { return std::clamp(2 * (x - 0.5) / (faceWidth() - 1) - 1, -1.0, 1.0); }

    /// Solid angle over the rectangle from the centre to (s, t), signed.
    static double cornerSolidAngle(double s, double t) {
        const double low = std::min(std::abs(s), std::abs(t)), high = std::max(std::abs(s), std::abs(t));
        const double omega =
            Projection::square(low) + low * (Projection::strip(high) - Projection::strip(low));
        return (s < 0) == (t < 0) ? omega : -omega;
    }
};

}  // namespace

std::unique_ptr<SphereMap> makeDualParaboloidMap(const std::string& name, int size) {
    return std::make_unique<DualMap<Paraboloid>>(name, size);
}

std::unique_ptr<SphereMap> makeDualOrthographicMap(const std::string& name, int size) {
    return std::make_unique<DualMap<Orthographic>>(name, size);
}

}  // namespace prt
