// What a camera sees, before any light: exchanged between the runtime (which draws it) and the reference
// (which lights exactly these points with traced rays).
#pragma once

#include <cstdint>
#include <vector>

#include "precompute/math/vec.h"

namespace prt {

/// A pinhole camera.
struct Camera {
    Vec3f eye{0, 0, 5};
    Vec3f target{0, 0, 0};
    Vec3f up{0, 1, 0};
    float verticalFovDeg = 45;
};

inline constexpr uint32_t kNoTriangle = 0xffffffffu;

/// Surface points at pixel centres, rows from the top.
struct SurfaceImage {
    int width = 0, height = 0;
    std::vector<uint32_t>
        triangle;                 ///< index of the triangle in Scene order; kNoTriangle where nothing is seen
    std::vector<Vec3f> position;  ///< world
    std::vector<Vec3f> geometricNormal;  ///< world, unit, of the triangle (not turned to the viewer)
    std::vector<Vec3f> shadingNormal;    ///< world, unit, with normal map
    std::vector<Vec3f> albedo;           ///< linear
    size_t pixels() const { return triangle.size(); }
};

}  // namespace prt
