// Which faces are surely outside of geometry, and that no point on them is inside.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <vector>

#include "precompute/visibility/find_inside.h"
#include "precompute/visibility/surely_outside.h"
#include "tests/rays/shapes.h"

namespace prt {
namespace {

std::vector<SurfacePoint> pointsOn(const shapes::Mesh& mesh, int perFace) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<SurfacePoint> points;
    for (uint32_t t = 0; t < mesh.triangles(); ++t)
        for (int k = 0; k < perFace; ++k) {
            double u = uniform(random), v = uniform(random);
            if (u + v > 1) {
                u = 1 - u;
                v = 1 - v;
            }
            points.push_back({mesh.point(t, u, v), mesh.normal(t), t});
        }
    return points;
}

struct Outsides {
    std::vector<uint8_t> faces;
    size_t wrong = 0;  // points inside on faces that are called outside

    explicit Outsides(const shapes::Mesh& mesh, size_t mostFaces = 1u << 30,
                      std::span<const uint8_t> doubleSided = {}) {
        const RayCaster caster(mesh.positions, mesh.indices);
        faces = findSurelyOutside(caster, doubleSided, mostFaces);
        const std::vector<SurfacePoint> points = pointsOn(mesh, 20);
        const std::vector<uint8_t> inside =
            findInsidePoints(caster, points, spreadDirections(64), doubleSided);
        for (size_t i = 0; i < points.size(); ++i) wrong += inside[i] && faces[points[i].triangle];
    }
    size_t count() const { return size_t(std::count(faces.begin(), faces.end(), 1)); }
};

TEST(SurelyOutside, FacesOfAClosedMeshThatMeetsNothing) {
    const Outsides sphere(shapes::sphere(1, {0, 0, 0}, 3));
    EXPECT_EQ(sphere.count(), 1280u);
    const Outsides box(shapes::box({-1, -1, -1}, {1, 1, 1}));
    EXPECT_EQ(box.count(), 12u);
    EXPECT_EQ(sphere.wrong + box.wrong, 0u);
}

TEST(SurelyOutside, NotWhereOneThingStandsOnAnother) {
    for (const float height : {-0.3f, 0.0f, 1e-6f}) {  // pierced, touched, touched but for rounding
        shapes::Mesh mesh = shapes::floorSquare(3);
        mesh.add(shapes::box({-1, height, -1}, {1, 1, 1}));
        const Outsides outsides(mesh);
        EXPECT_EQ(outsides.faces[0], 0) << height;
        EXPECT_EQ(outsides.faces[1], 0) << height;
        EXPECT_EQ(outsides.wrong, 0u) << height;
    }
    shapes::Mesh apart = shapes::floorSquare(3);
    apart.add(shapes::box({-1, 0.2f, -1}, {1, 1, 1}));
    EXPECT_EQ(Outsides(apart).count(), apart.triangles());
}

TEST(SurelyOutside, NotWhatIsWhollyWithin) {
    shapes::Mesh mesh = shapes::sphere(1, {0, 0, 0}, 3);
    mesh.add(shapes::sphere(0.3, {0.2, 0, 0}, 2));
    const Outsides outsides(mesh);
    EXPECT_EQ(outsides.count(), 1280u);
    for (size_t t = 1280; t < outsides.faces.size(); ++t) EXPECT_EQ(outsides.faces[t], 0);
    // But through walls that have no back.
    std::vector<uint8_t> doubleSided(mesh.triangles(), 1);
    EXPECT_EQ(Outsides(mesh, 1u << 30, doubleSided).count(), mesh.triangles());
}

TEST(SurelyOutside, NotFacesWoundTheOtherWay) {
    shapes::Mesh mesh = shapes::sphere(1, {0, 0, 0}, 3);
    for (const size_t t : {7u, 500u, 501u}) std::swap(mesh.indices[3 * t + 1], mesh.indices[3 * t + 2]);
    const Outsides outsides(mesh);
    EXPECT_EQ(outsides.count(), 1277u);
    EXPECT_EQ(outsides.faces[7] + outsides.faces[500] + outsides.faces[501], 0);
}

TEST(SurelyOutside, SplitVerticesAreWeldedAndSeamsDoNotMatter) {
    const shapes::Mesh welded = shapes::sphere(1, {0, 0, 0}, 3);
    shapes::Mesh split;
    for (const uint32_t index : welded.indices) {
        split.indices.push_back(uint32_t(split.positions.size()));
        split.positions.push_back(welded.positions[index]);
    }
    EXPECT_EQ(Outsides(split).count(), 1280u);
}

// An open sheet above a wall's foot, which nothing touches: samples disagree, faces are looked at one by one.
TEST(SurelyOutside, FaceByFaceWhereARegionIsBoth) {
    shapes::Mesh mesh = shapes::floorSquare(3);
    mesh.indices.clear();
    mesh.positions.clear();
    // A floor with a square hole.
    for (const auto& [a, b, c, d] :
         {std::tuple{Vec3f(-9, 0, 9), Vec3f(9, 0, 9), Vec3f(9, 0, 1.1f), Vec3f(-9, 0, 1.1f)},
          {Vec3f(-9, 0, -1.1f), Vec3f(9, 0, -1.1f), Vec3f(9, 0, -9), Vec3f(-9, 0, -9)},
          {Vec3f(-9, 0, 1.1f), Vec3f(-1.1f, 0, 1.1f), Vec3f(-1.1f, 0, -1.1f), Vec3f(-9, 0, -1.1f)},
          {Vec3f(1.1f, 0, 1.1f), Vec3f(9, 0, 1.1f), Vec3f(9, 0, -1.1f), Vec3f(1.1f, 0, -1.1f)}})
        mesh.add(shapes::quad(a, b, c, d));
    const size_t floorFaces = mesh.triangles();
    // A column through the hole.
    constexpr int kRings = 40, kSides = 4;
    shapes::Mesh column;
    for (int ring = 0; ring <= kRings; ++ring)
        for (const Vec3f& corner : {Vec3f(-1, 0, 1), Vec3f(1, 0, 1), Vec3f(1, 0, -1), Vec3f(-1, 0, -1)})
            column.positions.push_back(corner + Vec3f(0, -4 + 8 * float(ring) / kRings, 0));
    for (uint32_t ring = 0; ring < kRings; ++ring)
        for (uint32_t side = 0; side < kSides; ++side) {
            const uint32_t a = ring * 4 + side, b = ring * 4 + (side + 1) % 4;
            for (const uint32_t i : {a, b, b + 4, a, b + 4, a + 4}) column.indices.push_back(i);
        }
    mesh.add(column);
    const Outsides outsides(mesh), unlooked(mesh, 0);
    EXPECT_EQ(outsides.wrong, 0u);
    for (size_t t = floorFaces; t < mesh.triangles(); ++t) {
        const float y = mesh.point(t, 1.0 / 3, 1.0 / 3).y();
        if (y > 1) {
            EXPECT_EQ(outsides.faces[t], 1) << y;
        }
        if (y < -0.5f) {
            EXPECT_EQ(outsides.faces[t], 0) << y;
        }
        EXPECT_EQ(unlooked.faces[t], 0);
    }
}

TEST(SurelyOutside, NoPointOfClutterIsInsideUnnoticed) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> place(-1, 1), size(0.05f, 0.5f);
    shapes::Mesh mesh = shapes::heightField(12, [](double x, double z) { return 0.1 * std::sin(4 * x) * z; });
    for (int i = 0; i < 25; ++i) {
        const Vec3f low(place(random), 0.3f * place(random), place(random));
        mesh.add(shapes::box(low, low + Vec3f(size(random), size(random), size(random))));
    }
    const Outsides outsides(mesh);
    EXPECT_GT(outsides.count(), mesh.triangles() / 4);
    EXPECT_LE(outsides.wrong, 2u);  // of some ten thousand, beside the edge of the sheet
}

TEST(SurelyOutside, OddMeshes) {
    const shapes::Mesh none;
    EXPECT_TRUE(Outsides(none).faces.empty());
    shapes::Mesh lines;
    lines.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}};
    lines.indices = {0, 1, 2, 0, 0, 0};
    EXPECT_EQ(Outsides(lines).faces.size(), 2u);
    // Hundreds of faces at one edge.
    shapes::Mesh fan;
    fan.positions = {{0, 0, 0}, {0, 1, 0}};
    for (uint32_t i = 0; i < 300; ++i) {
        const float angle = 0.02f * float(i);
        fan.positions.push_back({std::cos(angle), 0.5f, std::sin(angle)});
        for (const uint32_t v : {0u, 1u, i + 2}) fan.indices.push_back(v);
    }
    EXPECT_EQ(Outsides(fan).faces.size(), 300u);
}

}  // namespace
}  // namespace prt
