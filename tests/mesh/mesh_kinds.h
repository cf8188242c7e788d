// The meshes that every property is checked on: closed, open, non-manifold, in pieces, damaged, far away,
// tiny.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "precompute/io/scene.h"

namespace prt {

/// Triangles as a Scene of one primitive, with nothing but positions.
Scene sceneOf(std::vector<Vec3f> positions, std::vector<uint32_t> indices);

Scene makeSphere(int rings, int segments, double radius = 1, const Vec3d& centre = {0, 0, 0});
/// n×n quads in the plane y = 0, facing +Y, `size` wide.
Scene makeGrid(int n, double size = 1);
Scene makeBox(const Vec3d& low, const Vec3d& high);
/// Both in one mesh, one primitive.
Scene joined(Scene a, const Scene& b);
/// A ramp of two metres' width that climbs slowly around the y axis, so that its turns lie above each other.
Scene makeSpiral(double turns, int stepsPerTurn, double rise);

struct MeshKind {
    std::string name;
    std::function<Scene()> make;
    friend void PrintTo(const MeshKind& kind, std::ostream* out) { *out << kind.name; }
};
std::vector<MeshKind> meshKinds();

/// Corner k of a triangle.
const Vec3f& cornerPosition(const Scene& scene, size_t triangle, size_t k);
double surfaceArea(const Scene& scene);

}  // namespace prt
