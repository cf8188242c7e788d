// Meshes as they come out of bad exporters, scans and accidents, and what a bake of any of them has to hold.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "precompute/io/visibility_file.h"
#include "tests/mesh/mesh_kinds.h"

namespace prt::nasty {

/// Triangles under construction.
struct Soup {
    std::vector<Vec3f> positions;
    std::vector<uint32_t> indices;

    /// With vertices of its own.
    void add(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
        for (const Vec3d& p : {a, b, c}) {
            indices.push_back(uint32_t(positions.size()));
            positions.push_back(p.cast<float>());
        }
    }
    Scene scene() const { return sceneOf(positions, indices); }
};

/// A random triangle of an edge of about `size` around a centre.
inline std::array<Vec3d, 3> randomTriangle(std::mt19937& random, const Vec3d& centre, double size) {
    std::uniform_real_distribution<double> unit(-0.5, 0.5);
    std::array<Vec3d, 3> corners;
    for (Vec3d& p : corners) p = centre + size * Vec3d(unit(random), unit(random), unit(random));
    return corners;
}

/// `count` separate triangles of an edge of about `size` in a box of edges `extent`.
inline Scene confetti(int count, double size, const Vec3d& extent) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(-0.5, 0.5);
    Soup soup;
    for (int i = 0; i < count; ++i) {
        auto corners = randomTriangle(
            random, extent.cwiseProduct(Vec3d(unit(random), unit(random), unit(random))), size);
        for (Vec3d& p : corners)
            if (extent.y() == 0) p.y() = 0;  // all in one plane, over each other
        soup.add(corners[0], corners[1], corners[2]);
    }
    return soup.scene();
}

/// Two cones that touch in one vertex, and two triangles that do.
inline Scene bowTies() {
    std::vector<Vec3f> p{{0, 0, 0}};
    std::vector<uint32_t> index;
    for (const float side : {-1.0f, 1.0f}) {
        const uint32_t first = uint32_t(p.size());
        for (int i = 0; i < 6; ++i)
            p.emplace_back(std::cos(float(i) * 1.0472f), side, std::sin(float(i) * 1.0472f));
        for (uint32_t i = 0; i < 6; ++i) index.insert(index.end(), {0, first + i, first + (i + 1) % 6});
    }
    const uint32_t n = uint32_t(p.size());
    p.insert(p.end(), {{2, 0, 0}, {3, 1, 0}, {3, 0, 1}, {1.5f, 1, 0}, {1.5f, 0, 1}});
    index.insert(index.end(), {n, n + 1, n + 2, n, n + 3, n + 4});
    return sceneOf(p, index);
}

/// Pages around one edge, wound at random, and pairs of pages that are the same face.
inline Scene book() {
    std::vector<Vec3f> p{{0, 0, 0}, {0, 1, 0}};
    std::vector<uint32_t> index;
    for (int page = 0; page < 9; ++page) {
        p.emplace_back(std::cos(float(page / 2)), 0.5f, std::sin(float(page / 2)));
        const auto n = uint32_t(p.size() - 1);
        if (page % 3 == 0)
            index.insert(index.end(), {0, 1, n});
        else
            index.insert(index.end(), {1, 0, n});
    }
    return sceneOf(p, index);
}

/// A sphere in several copies: the same, turned inside out, and a hair's breadth away.
inline Scene coincident() {
    const Scene sphere = makeSphere(8, 12);
    Scene turned = sphere, moved = sphere;
    for (size_t t = 0; t < turned.triangleCount(); ++t)
        std::swap(turned.indices[3 * t], turned.indices[3 * t + 1]);
    for (Vec3f& p : moved.positions) p.x() = std::nextafter(p.x(), 2.0f);
    return joined(joined(sphere, sphere), joined(turned, moved));
}

/// Triangles a million times smaller than the scene: floating, on a wall, and at the end of a long edge,
/// where the neighbour's edge has no vertex (a T-junction).
inline Scene specks() {
    constexpr double kSpeck = 1e-4, kRoom = 100;
    Soup soup;
    soup.add({0, 0, 0}, {0, 0, kRoom}, {kRoom, 0, 0});
    std::mt19937 random(4);
    for (int i = 0; i < 60; ++i) {
        const auto floating = randomTriangle(random, {30, 20, 30.0 + i * 1e-3}, kSpeck);
        soup.add(floating[0], floating[1], floating[2]);
        const Vec3d on(10.0 + i, 0, 5);
        soup.add(on, on + Vec3d(0, 0, kSpeck), on + Vec3d(kSpeck, 0, 0));
        // The floor's edge along x goes on upwards in steps.
        const Vec3d at(i * kSpeck, 0, 0), next((i + 1) * kSpeck, 0, 0), up(0, kSpeck, 0);
        soup.add(at, next, at + up);
        soup.add(next, next + up, at + up);
    }
    soup.add({60 * kSpeck, 0, 0}, {kRoom, 0, 0}, {kRoom, 1, 0});
    return soup.scene();
}

/// Needles and caps up to ten million times as long as they are wide.
inline Scene needles() {
    Soup soup;
    for (int i = 0; i < 8; ++i) {
        const double width = std::pow(10.0, -i), at = 2.0 * i;
        soup.add({at, 0, 0}, {at + width, 0, 0}, {at, 10, 0.1 * i});
        soup.add({at, 0, 1}, {at, 10, 1}, {at, 5, 1 + width});
    }
    return soup.scene();
}

/// A sphere among faces without area: repeated corners, corners in a row, all corners in one place.
inline Scene withoutArea() {
    Scene scene = makeSphere(6, 8);
    const auto n = uint32_t(scene.positions.size());
    std::vector<Vec3f> p = scene.positions;
    std::vector<uint32_t> index = scene.indices;
    p.insert(p.end(), {{2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {2, 0, 0}, {2, 0, 0}});
    index.insert(index.end(), {n, n, n + 1, n, n + 1, n + 2, n, n + 3, n + 4, 0, 0, 0, 1, 2, 1});
    return sceneOf(p, index);
}

inline Scene nestedSpheres() {
    Scene scene = makeSphere(6, 8);
    for (int i = 2; i <= 12; ++i) scene = joined(scene, makeSphere(6, 8, i));
    return scene;
}

inline Scene randomlyWound() {
    Scene scene = makeSphere(10, 14);
    std::mt19937 random(8);
    for (size_t t = 0; t < scene.triangleCount(); ++t)
        if (random() % 2) std::swap(scene.indices[3 * t], scene.indices[3 * t + 1]);
    return scene;
}

inline Scene insideOut() {
    Scene scene = makeSphere(8, 10);
    for (size_t t = 0; t < scene.triangleCount(); ++t)
        std::swap(scene.indices[3 * t], scene.indices[3 * t + 1]);
    return scene;
}

struct Kind {
    MeshKind mesh;
    int texels = 32;  ///< of the atlas, enough for all charts
};

/// Every kind of tests/mesh, and worse ones.
inline std::vector<Kind> kinds() {
    std::vector<Kind> all;
    for (const MeshKind& kind : meshKinds()) all.push_back({kind, 32});
    const auto add = [&](const char* name, int texels, std::function<Scene()> make) {
        all.push_back({{name, std::move(make)}, texels});
    };
    add("bow_ties", 32, bowTies);
    add("book", 32, book);
    add("coincident", 48, coincident);
    add("specks", 80, specks);
    add("needles", 48, needles);
    add("without_area", 32, withoutArea);
    add("nested", 64, nestedSpheres);
    add("randomly_wound", 80, randomlyWound);
    add("inside_out", 32, insideOut);
    add("thousands_of_components", 192, [] { return confetti(3000, 0.1, {4, 4, 4}); });
    add("overlapping_in_a_plane", 64, [] { return confetti(200, 0.5, {2, 0, 2}); });
    // At a million units floats are 1/16 apart: the sphere loses most of its shape, a box does not.
    add("far_sphere", 32, [] { return makeSphere(8, 10, 1, {1e6, 1e6, -1e6}); });
    add("far_box", 32, [] { return makeBox({1e6, -1e6, 1e6}, {1e6 + 1, -1e6 + 2, 1e6 + 1}); });
    add("one_speck", 16, [] { return confetti(1, 1e-12, {0, 0, 1e-9}); });
    add("as_large_as_the_world", 32, [] { return makeSphere(6, 8, 1e12); });
    return all;
}

/// What holds for the bake of any mesh whatever.
inline void expectSane(const VisibilityMap& map, const std::string& what) {
    SCOPED_TRACE(what);
    const size_t count = map.grid.count, columns = size_t(map.shOrder) * size_t(map.shOrder);
    ASSERT_EQ(map.coefficients.size(), count * columns);
    ASSERT_EQ(map.ao.size(), count);
    ASSERT_EQ(map.error.size(), count);
    ASSERT_EQ(map.normals.size(), count);
    ASSERT_EQ(map.validity.size(), count);
    size_t baked = 0;
    for (size_t i = 0; i < count; ++i) {
        const bool empty = map.validity[i] == Validity::Empty;
        ASSERT_LE(uint32_t(map.validity[i]), uint32_t(Validity::Inside)) << i;
        baked += map.validity[i] == Validity::Valid || map.validity[i] == Validity::Inside;
        ASSERT_TRUE(map.ao[i] >= 0 && map.ao[i] <= 1) << i << ": " << map.ao[i];
        ASSERT_TRUE(map.error[i] >= 0 && std::isfinite(map.error[i])) << i << ": " << map.error[i];
        const float length = map.normals[i].norm();
        if (empty)
            ASSERT_EQ(length, 0) << i;
        else
            ASSERT_NEAR(length, 1, 1e-5) << i;
        for (size_t c = 0; c < columns; ++c) {
            const float value = map.coefficients[i * columns + c];
            // V <= 1 has no coefficient above √(4π); the least squares of irradiance adds what its floor
            // lets.
            ASSERT_TRUE(std::isfinite(value) && std::abs(value) < 50) << i << ", " << c << ": " << value;
            if (empty) {
                ASSERT_EQ(value, 0) << i;
            }
        }
    }
    EXPECT_GT(baked, 0u);
}

}  // namespace prt::nasty
