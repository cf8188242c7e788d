// Meshes that tests of rays, bakes and the reference build in memory. Counter-clockwise faces look outwards.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "precompute/math/vec.h"

namespace prt::shapes {

struct Mesh {
    std::vector<Vec3f> positions;
    std::vector<uint32_t> indices;

    size_t triangles() const { return indices.size() / 3; }
    Vec3d corner(size_t triangle, size_t k) const {
        return positions[indices[3 * triangle + k]].cast<double>();
    }
    Vec3f normal(size_t triangle) const {
        const Vec3d a = corner(triangle, 0);
        const Vec3d cross = (corner(triangle, 1) - a).cross(corner(triangle, 2) - a);
        return cross.norm() > 0 ? Vec3f(cross.normalized().cast<float>()) : Vec3f(Vec3f::Zero());
    }
    /// Point with barycentric coordinates (1 − u − v, u, v), rounded once.
    Vec3f point(size_t triangle, double u, double v) const {
        return ((1 - u - v) * corner(triangle, 0) + u * corner(triangle, 1) + v * corner(triangle, 2))
            .cast<float>();
    }
    void add(const Mesh& other) {
        const uint32_t first = uint32_t(positions.size());
        positions.insert(positions.end(), other.positions.begin(), other.positions.end());
        for (const uint32_t index : other.indices) indices.push_back(first + index);
    }
    void flip() {
        for (size_t t = 0; t < triangles(); ++t) std::swap(indices[3 * t + 1], indices[3 * t + 2]);
    }
};

/// Corners counter-clockwise seen from the front.
inline Mesh quad(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
    return {{a, b, c, d}, {0, 1, 2, 0, 2, 3}};
}

/// Square in the plane y = height, looking up.
inline Mesh floorSquare(float half, float height = 0) {
    return quad({-half, height, half}, {half, height, half}, {half, height, -half}, {-half, height, -half});
}

inline Mesh box(const Vec3f& low, const Vec3f& high) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back(
            {i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z()});
    mesh.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 4, 6, 0, 6, 2,
                    1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3};
    return mesh;
}

/// Icosahedron subdivided `levels` times: 20·4^levels faces, vertices on the sphere (rounded to float).
inline Mesh sphere(double radius, const Vec3d& centre, int levels) {
    const double g = std::numbers::phi;
    std::vector<Vec3d> unit = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                               {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    std::vector<uint32_t> faces = {0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
                                   4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
                                   6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1};
    for (Vec3d& p : unit) p.normalize();
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
        const auto middle = [&](uint32_t a, uint32_t b) {
            const auto [it, added] = middles.try_emplace(std::minmax(a, b), uint32_t(unit.size()));
            if (added) unit.push_back((unit[a] + unit[b]).normalized());
            return it->second;
        };
        std::vector<uint32_t> finer;
        for (size_t f = 0; f < faces.size(); f += 3) {
            const uint32_t a = faces[f], b = faces[f + 1], c = faces[f + 2];
            const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            for (const uint32_t i : {a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca}) finer.push_back(i);
        }
        faces = std::move(finer);
    }
    Mesh mesh;
    for (const Vec3d& p : unit) mesh.positions.push_back((centre + radius * p).cast<float>());
    mesh.indices = std::move(faces);
    return mesh;
}

/// A wavy square of 2·cells² faces with overhangs none: y = height(x, z) over [−1, 1]².
template <class Height>
Mesh heightField(int cells, const Height& height) {
    Mesh mesh;
    for (int j = 0; j <= cells; ++j)
        for (int i = 0; i <= cells; ++i) {
            const double x = 2.0 * i / cells - 1, z = 2.0 * j / cells - 1;
            mesh.positions.push_back(Vec3d(x, height(x, z), z).cast<float>());
        }
    const auto at = [&](int i, int j) { return uint32_t(j * (cells + 1) + i); };
    for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i)
            for (const uint32_t v :
                 {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i + 1, j)})
                mesh.indices.push_back(v);
    return mesh;
}

}  // namespace prt::shapes
