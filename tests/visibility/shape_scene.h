// A scene of one of the shapes that rays are tested with.
#pragma once

#include "precompute/io/scene.h"
#include "tests/rays/shapes.h"

namespace prt {

/// One primitive of one material; normals up, no texture coordinates.
inline Scene sceneOf(const shapes::Mesh& mesh) {
    Scene scene;
    scene.positions = mesh.positions;
    scene.indices = mesh.indices;
    scene.normals.assign(mesh.positions.size(), Vec3f(0, 1, 0));
    scene.materials.emplace_back();
    scene.primitives = {{0, uint32_t(mesh.positions.size()), 0, uint32_t(mesh.indices.size()), 0}};
    return scene;
}

}  // namespace prt
