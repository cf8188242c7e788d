// Cube maps: faces and orientation of the OpenGL 4.5 core specification, table 8.19 and section 8.13.1
// (seamless filtering). Solid angles from the exact integral over a rectangle.
#include "precompute/math/sphere_map.h"

#include <algorithm>
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/math/sphere_map_parts.h"

namespace prt {
namespace {

/// Point on the surface of the cube [−1, 1]³ (further out for |s|, |t| > 1).
Vec3d onFace(int face, double s, double t) {
    switch (face) {
        case 0:
            return {1, -t, -s};
        case 1:
            return {-1, -t, s};
        case 2:
            return {s, 1, t};
        case 3:
            return {s, -1, -t};
        case 4:
            return {s, -t, 1};
        default:
            return {-s, -t, -1};
    }
}

/// Solid angle of the rectangle from the face's centre to (s, t), signed.
double cornerSolidAngle(double s, double t) { return std::atan2(s * t, std::sqrt(s * s + t * t + 1)); }

int cubeTexelIndex(int face, int x, int y, int size) { return (face * size + y) * size + x; }

SphereTaps seamlessTaps(const Vec3d& direction, int size) {
    const CubePoint point = cubePointFromDirection(direction, size);
    return bilinearTaps(point.x, point.y, [&](int x, int y) {
        const bool missing = (x < 0 || x >= size) && (y < 0 || y >= size);  // three faces meet there
        if (missing) return -1;
        const CubeTap tap = cubeTexelAcrossEdge(point.face, x, y, size);
        return cubeTexelIndex(tap.face, tap.x, tap.y, size);
    });
}

class CubeMap : public SphereMap {
  public:
    CubeMap(const std::string& name, int size, bool seamless)
        : SphereMap(name, 6, size, size), seamless_(seamless) {}

    SpherePoint pointFromDirection(const Vec3d& direction) const override {
        const CubePoint point = cubePointFromDirection(direction, faceWidth());
        return {point.face, point.x, point.y};
    }
    Vec3d directionFromPoint(const SpherePoint& point) const override {
        return cubeDirection({point.face, point.x, point.y}, faceWidth());
    }
    double texelSolidAngle(int texel) const override {
        const SpherePoint centre = texelCentre(texel);
        return cubeTexelSolidAngle(int(centre.x), int(centre.y), faceWidth());
    }
    SphereTaps taps(const Vec3d& direction) const override {
        const int size = faceWidth();
        if (seamless_) return seamlessTaps(direction, size);
        const CubePoint point = cubePointFromDirection(direction, size);
        return bilinearTaps(point.x, point.y, [&](int x, int y) {
            return cubeTexelIndex(point.face, std::clamp(x, 0, size - 1), std::clamp(y, 0, size - 1), size);
        });
    }

  private:
    bool seamless_;
};

}  // namespace

std::unique_ptr<SphereMap> makeCubeMap(const std::string& name, int size, bool seamless) {
    return std::make_unique<CubeMap>(name, size, seamless);
}

Vec3d cubeDirection(const CubePoint& point, int size) {
    PRT_CHECK_LE(1, size);
    PRT_CHECK(point.face >= 0 && point.face < 6);
    return onFace(point.face, fromTexels(point.x, size), fromTexels(point.y, size)).normalized();
}

Vec3f cubeTexelDirection(int face, int x, int y, int size) {
    return cubeDirection({face, x + 0.5, y + 0.5}, size).cast<float>();
}

CubePoint cubePointFromDirection(const Vec3d& direction, int size) {
    PRT_CHECK_LE(1, size);
    const double x = direction.x(), y = direction.y(), z = direction.z();
    const double ax = std::abs(x), ay = std::abs(y), az = std::abs(z);
    int face;
    double s, t, major;
    if (ax >= ay && ax >= az) {
        face = x >= 0 ? 0 : 1;
        s = x >= 0 ? -z : z;
        t = -y;
        major = ax;
    } else if (ay >= az) {
        face = y >= 0 ? 2 : 3;
        s = x;
        t = y >= 0 ? z : -z;
        major = ay;
    } else {
        face = z >= 0 ? 4 : 5;
        s = z >= 0 ? x : -x;
        t = -y;
        major = az;
    }
    PRT_CHECK_LT(0.0, major);
    return {face, toTexels(s / major, size), toTexels(t / major, size)};
}

double cubeTexelSolidAngle(int x, int y, int size) {
    PRT_CHECK(x >= 0 && x < size && y >= 0 && y < size);
    const double s0 = fromTexels(x, size), s1 = fromTexels(x + 1, size);
    const double t0 = fromTexels(y, size), t1 = fromTexels(y + 1, size);
    return cornerSolidAngle(s1, t1) - cornerSolidAngle(s0, t1) - cornerSolidAngle(s1, t0) +
           cornerSolidAngle(s0, t0);
}

CubeTap cubeTexelAcrossEdge(int face, int x, int y, int size) {
    PRT_CHECK(face >= 0 && face < 6 && size >= 1);
    const bool xOutside = x < 0 || x >= size, yOutside = y < 0 || y >= size;
    PRT_CHECK(!(xOutside && yOutside) && x >= -1 && x <= size && y >= -1 && y <= size);
    if (!xOutside && !yOutside) return {face, x, y, 0};
    // What sticks out over the edge is folded onto the neighbouring face.
    const double s = fromTexels(x + 0.5, size), t = fromTexels(y + 0.5, size);
    const double over = 1.0 / size;
    const Vec3d folded =
        onFace(face, std::clamp(s, -1.0, 1.0), std::clamp(t, -1.0, 1.0)) - over * onFace(face, 0, 0);
    const CubePoint point = cubePointFromDirection(folded, size);
    return {point.face, std::min(int(point.x), size - 1), std::min(int(point.y), size - 1), 0};
}

std::array<CubeTap, 4> cubeSeamlessTaps(const Vec3d& direction, int size) {
    const SphereTaps taps = seamlessTaps(direction, size);
    std::array<CubeTap, 4> result;
    for (size_t i = 0; i < 4; ++i) {
        const int row = taps[i].texel / size;
        result[i] = {row / size, taps[i].texel % size, row % size, taps[i].weight};
    }
    return result;
}

}  // namespace prt
