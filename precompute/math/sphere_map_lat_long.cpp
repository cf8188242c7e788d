// Latitude-longitude maps, oriented as environments are.
#include "precompute/base/check.h"
#include "precompute/math/environment.h"
#include "precompute/math/sphere_map_parts.h"

namespace prt {
namespace {

class LatLongMap : public SphereMap {
  public:
    LatLongMap(const std::string& name, int size) : SphereMap(name, 1, 2 * size, size) {}

    SpherePoint pointFromDirection(const Vec3d& direction) const override {
        PRT_CHECK_LT(0.0, direction.norm());
        const auto [x, y] = latLongPoint(direction, faceWidth(), faceHeight());
        return {0, x, y};
    }
    Vec3d directionFromPoint(const SpherePoint& point) const override {
        PRT_CHECK_EQ(point.face, 0);
        return latLongDirection(point.x, point.y, faceWidth(), faceHeight());
    }
    double texelSolidAngle(int texel) const override {
        return latLongTexelSolidAngle(int(texelCentre(texel).y), faceWidth(), faceHeight());
    }
    SphereTaps taps(const Vec3d& direction) const override {
        const SpherePoint point = pointFromDirection(direction);
        const int width = faceWidth(), height = faceHeight();
        return bilinearTaps(point.x, point.y, [=](int x, int y) {
            return std::clamp(y, 0, height - 1) * width + (x + width) % width;
        });
    }
};

}  // namespace

std::unique_ptr<SphereMap> makeLatLongMap(const std::string& name, int size) {
    return std::make_unique<LatLongMap>(name, size);
}

}  // namespace prt
