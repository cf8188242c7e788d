// What tests of the reference light, and with what.
#pragma once

#include <vector>

#include "precompute/io/environment_file.h"
#include "precompute/io/scene.h"
#include "precompute/io/surface_image.h"
#include "tests/rays/shapes.h"

namespace prt {

/// The same radiance from everywhere.
inline Environment uniformSky(float radiance = 1) {
    Environment environment;
    environment.image = {16, 8, 3, std::vector<float>(16 * 8 * 3, radiance)};
    return environment;
}

/// Points in one row of pixels.
inline SurfaceImage surfaceOf(const std::vector<Vec3f>& positions, const Vec3f& normal,
                              uint32_t triangle = 0) {
    SurfaceImage surface;
    surface.width = int(positions.size());
    surface.height = 1;
    surface.position = positions;
    surface.triangle.assign(positions.size(), triangle);
    surface.geometricNormal.assign(positions.size(), normal);
    surface.shadingNormal = surface.geometricNormal;
    surface.albedo.assign(positions.size(), Vec3f(1, 1, 1));
    return surface;
}

/// A floor with a box and a ball on it.
inline shapes::Mesh clutter() {
    shapes::Mesh mesh = shapes::floorSquare(3);
    mesh.add(shapes::box({-0.5f, 0, -0.5f}, {0.5f, 1.2f, 0.5f}));
    mesh.add(shapes::sphere(0.5, {1.2, 0.7, 0.1}, 3));
    return mesh;
}

/// One primitive of one grey material, no attributes.
inline Scene sceneOf(const shapes::Mesh& mesh) {
    Scene scene;
    scene.positions = mesh.positions;
    scene.indices = mesh.indices;
    scene.materials.emplace_back();
    scene.primitives = {{0, uint32_t(mesh.positions.size()), 0, uint32_t(mesh.indices.size()), 0}};
    return scene;
}

}  // namespace prt
