// Cube maps: faces and orientation of the OpenGL 4.5 core specification, table 8.19 and section 8.13.1
// (seamless filtering). Solid angles from the exact integral over a rectangle.
#include "precompute/math/sphere_map.h"

#include <algorithm>
#include <cmath>

#include "precompute/base/check.h"

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

double toTexels(double s, int size) { return std::clamp(0.5 * (s + 1) * size, 0.0, double(size)); }

/// Solid angle of the rectangle from the face's centre to (s, t), signed.
double cornerSolidAngle(double s, double t) { return std::atan2(s * t, std::sqrt(s * s + t * t + 1)); }

}  // namespace

Vec3d cubeDirection(const CubePoint& point, int size) {
    PRT_CHECK_LE(1, size);
    PRT_CHECK(point.face >= 0 && point.face < 6);
    return onFace(point.face, 2 * point.x / size - 1, 2 * point.y / size - 1).normalized();
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
    const double s0 = 2.0 * x / size - 1, s1 = 2.0 * (x + 1) / size - 1;
    const double t0 = 2.0 * y / size - 1, t1 = 2.0 * (y + 1) / size - 1;
    return cornerSolidAngle(s1, t1) - cornerSolidAngle(s0, t1) - cornerSolidAngle(s1, t0) +
           cornerSolidAngle(s0, t0);
}

CubeTap cubeTexelAcrossEdge(int face, int x, int y, int size) {
    PRT_CHECK(face >= 0 && face < 6 && size >= 1);
    const bool xOutside = x < 0 || x >= size, yOutside = y < 0 || y >= size;
    PRT_CHECK(!(xOutside && yOutside) && x >= -1 && x <= size && y >= -1 && y <= size);
    if (!xOutside && !yOutside) return {face, x, y, 0};
    // What sticks out over the edge is folded onto the neighbouring face.
    const double s = (2 * x + 1.0) / size - 1, t = (2 * y + 1.0) / size - 1;
    const double over = 1.0 / size;
    const Vec3d folded =
        onFace(face, std::clamp(s, -1.0, 1.0), std::clamp(t, -1.0, 1.0)) - over * onFace(face, 0, 0);
    const CubePoint point = cubePointFromDirection(folded, size);
    return {point.face, std::min(int(point.x), size - 1), std::min(int(point.y), size - 1), 0};
}

std::array<CubeTap, 4> cubeSeamlessTaps(const Vec3d& direction, int size) {
    const CubePoint point = cubePointFromDirection(direction, size);
    const int x0 = int(std::floor(point.x - 0.5)), y0 = int(std::floor(point.y - 0.5));
    const double fx = point.x - 0.5 - x0, fy = point.y - 0.5 - y0;
    std::array<CubeTap, 4> taps;
    double missing = 0;
    int missingTap = -1;
    double weights[4];
    for (int i = 0; i < 4; ++i) {
        const int x = x0 + i % 2, y = y0 + i / 2;
        weights[i] = (i % 2 ? fx : 1 - fx) * (i / 2 ? fy : 1 - fy);
        if ((x < 0 || x >= size) && (y < 0 || y >= size)) {
            missing = weights[i];
            missingTap = i;
            weights[i] = 0;
            taps[size_t(i)] = {point.face, std::clamp(x, 0, size - 1), std::clamp(y, 0, size - 1), 0};
        } else {
            taps[size_t(i)] = cubeTexelAcrossEdge(point.face, x, y, size);
        }
    }
    // The texel missing at a corner of the cube is the mean of the other three.
    for (int i = 0; i < 4; ++i)
        taps[size_t(i)].weight = i == missingTap ? 0.0f : float(weights[i] + missing / 3);
    return taps;
}

}  // namespace prt
