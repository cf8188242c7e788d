#include "tests/mesh/mesh_kinds.h"

#include <cmath>
#include <numbers>
#include <random>

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

Scene makeTorus(int around, int across) {
    std::vector<Vec3f> p;
    std::vector<uint32_t> index;
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j) {
            const double a = 2 * kPi * i / around, b = 2 * kPi * j / across;
            const double r = 2 + 0.7 * std::cos(b);
            p.emplace_back(float(r * std::cos(a)), float(0.7 * std::sin(b)), float(r * std::sin(a)));
        }
    const auto at = [&](int i, int j) { return uint32_t((i % around) * across + j % across); };
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j)
            index.insert(index.end(), {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1),
                                       at(i + 1, j)});
    return sceneOf(p, index);
}

/// Five square fins that share one edge.
Scene makeFins() {
    std::vector<Vec3f> p{{0, 0, 0}, {0, 1, 0}};
    std::vector<uint32_t> index;
    for (int i = 0; i < 5; ++i) {
        const double a = 2 * kPi * i / 5;
        const auto n = uint32_t(p.size());
        p.emplace_back(float(std::cos(a)), 0.0f, float(std::sin(a)));
        p.emplace_back(float(std::cos(a)), 1.0f, float(std::sin(a)));
        index.insert(index.end(), {0, n, n + 1, 0, n + 1, 1});
    }
    return sceneOf(p, index);
}

Scene makeTerrain(int n) {
    Scene scene = makeGrid(n, 4);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> noise(-0.03f, 0.03f);
    for (Vec3f& p : scene.positions) p.y() = 0.3f * std::sin(3 * p.x()) * std::cos(2 * p.z()) + noise(random);
    return scene;
}

/// Every triangle with vertices of its own.
Scene shattered(const Scene& from) {
    std::vector<Vec3f> p;
    std::vector<uint32_t> index;
    for (uint32_t i : from.indices) {
        index.push_back(uint32_t(p.size()));
        p.push_back(from.positions[i]);
    }
    return sceneOf(p, index);
}

Scene withMixedWinding(Scene scene) {
    for (size_t t = 0; t < scene.triangleCount(); t += 3)
        std::swap(scene.indices[3 * t], scene.indices[3 * t + 1]);
    return scene;
}

Scene doubleSided(Scene scene) {
    const size_t count = scene.indices.size();
    for (size_t i = 0; i < count; i += 3)
        scene.indices.insert(scene.indices.end(),
                             {scene.indices[i], scene.indices[i + 2], scene.indices[i + 1]});
    scene.primitives[0].indexCount *= 2;
    return scene;
}

/// A fan of triangles up to 10,000 times as long as wide, beside a sound one.
Scene makeSlivers() {
    std::vector<Vec3f> p{{0, 0, 0}};
    std::vector<uint32_t> index;
    for (int i = 0; i <= 20; ++i) p.emplace_back(10.0f, 0.001f * float(i * i), -0.5f * float(i % 2));
    for (uint32_t i = 1; i <= 20; ++i) index.insert(index.end(), {0, i, i + 1});
    const auto n = uint32_t(p.size());
    p.insert(p.end(), {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
    index.insert(index.end(), {n, n + 1, n + 2});
    return sceneOf(p, index);
}

Scene makeTown() {
    Scene scene = makeGrid(8, 12);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 24; ++i) {
        const Vec3d low(10 * unit(random) - 5, 0.01, 10 * unit(random) - 5);
        scene = joined(
            scene, makeBox(low, low + Vec3d(0.2 + unit(random), 0.3 + 2 * unit(random), 0.1 + unit(random))));
    }
    return scene;
}

}  // namespace

Scene sceneOf(std::vector<Vec3f> positions, std::vector<uint32_t> indices) {
    Scene scene;
    scene.positions = std::move(positions);
    scene.indices = std::move(indices);
    scene.materials.emplace_back();
    scene.primitives.push_back({0, uint32_t(scene.positions.size()), 0, uint32_t(scene.indices.size()), 0});
    return scene;
}

Scene makeSphere(int rings, int segments, double radius, const Vec3d& centre) {
    std::vector<Vec3f> p;
    std::vector<uint32_t> index;
    const auto add = [&](double theta, double phi) {
        const Vec3d d(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
        p.push_back((centre + radius * d).cast<float>());
    };
    add(0, 0);
    for (int r = 1; r < rings; ++r)
        for (int s = 0; s < segments; ++s) add(kPi * r / rings, 2 * kPi * s / segments);
    add(kPi, 0);
    const auto south = uint32_t(p.size() - 1);
    const auto at = [&](int r, int s) { return uint32_t(1 + (r - 1) * segments + s % segments); };
    for (int s = 0; s < segments; ++s) {
        index.insert(index.end(), {0, at(1, s), at(1, s + 1)});
        for (int r = 1; r + 1 < rings; ++r)
            index.insert(index.end(), {at(r, s), at(r + 1, s), at(r + 1, s + 1), at(r, s), at(r + 1, s + 1),
                                       at(r, s + 1)});
        index.insert(index.end(), {at(rings - 1, s), south, at(rings - 1, s + 1)});
    }
    return sceneOf(p, index);
}

Scene makeGrid(int n, double size) {
    std::vector<Vec3f> p;
    std::vector<uint32_t> index;
    for (int z = 0; z <= n; ++z)
        for (int x = 0; x <= n; ++x) p.emplace_back(float(size * x / n), 0.0f, float(size * z / n));
    for (int z = 0; z < n; ++z)
        for (int x = 0; x < n; ++x) {
            const auto a = uint32_t(z * (n + 1) + x), b = a + 1, c = a + uint32_t(n) + 1, d = c + 1;
            index.insert(index.end(), {a, c, d, a, d, b});
        }
    return sceneOf(p, index);
}

Scene makeBox(const Vec3d& low, const Vec3d& high) {
    std::vector<Vec3f> p;
    for (int i = 0; i < 8; ++i)
        p.push_back(Vec3d(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z())
                        .cast<float>());
    return sceneOf(p, {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                       2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6});
}

Scene joined(Scene a, const Scene& b) {
    const auto base = uint32_t(a.positions.size());
    a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
    for (uint32_t i : b.indices) a.indices.push_back(base + i);
    return sceneOf(std::move(a.positions), std::move(a.indices));
}

Scene makeSpiral(double turns, int stepsPerTurn, double rise) {
    std::vector<Vec3f> p;
    std::vector<uint32_t> index;
    const int steps = int(turns * stepsPerTurn);
    for (int i = 0; i <= steps; ++i) {
        const double a = 2 * kPi * i / stepsPerTurn;
        for (double r : {1.0, 3.0})
            p.emplace_back(float(r * std::cos(a)), float(rise * i / stepsPerTurn), float(-r * std::sin(a)));
    }
    for (uint32_t i = 0; i < uint32_t(steps); ++i)
        index.insert(index.end(), {2 * i, 2 * i + 1, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 2});
    return sceneOf(p, index);
}

std::vector<MeshKind> meshKinds() {
    return {
        {"closed_sphere", [] { return makeSphere(16, 24); }},
        {"closed_torus", [] { return makeTorus(30, 14); }},
        {"box",
         [] {
             return makeBox({0, 0, 0}, {1, 2, 3});
         }},
        {"open_grid", [] { return makeGrid(12); }},
        {"open_terrain", [] { return makeTerrain(20); }},
        {"non_manifold_fins", [] { return makeFins(); }},
        {"components", [] { return makeTown(); }},
        {"soup", [] { return shattered(makeSphere(10, 16)); }},
        {"mixed_winding", [] { return withMixedWinding(makeSphere(10, 12)); }},
        {"double_sided", [] { return doubleSided(makeGrid(6)); }},
        {"spiral", [] { return makeSpiral(3.3, 40, 0.5); }},
        {"slivers", [] { return makeSlivers(); }},
        {"one_triangle",
         [] {
             return sceneOf({{0, 0, 0}, {1, 0, 0}, {0.3f, 1, 0.2f}}, {0, 1, 2});
         }},
        {"far_away",
         [] {
             return makeSphere(8, 12, 100, {1e6, -1e6, 1e6});
         }},
        {"tiny", [] { return makeSphere(8, 12, 1e-3); }},
        {"huge",
         [] {
             return makeBox({-1e6, 0, -1e6}, {1e6, 1e6, 1e6});
         }},
    };
}

const Vec3f& cornerPosition(const Scene& scene, size_t triangle, size_t k) {
    return scene.positions[scene.indices[3 * triangle + k]];
}

double surfaceArea(const Scene& scene) {
    double area = 0;
    for (size_t t = 0; t < scene.triangleCount(); ++t) {
        const Vec3d a = cornerPosition(scene, t, 0).cast<double>();
        area += 0.5 * (cornerPosition(scene, t, 1).cast<double>() - a)
                          .cross(cornerPosition(scene, t, 2).cast<double>() - a)
                          .norm();
    }
    return area;
}

}  // namespace prt
