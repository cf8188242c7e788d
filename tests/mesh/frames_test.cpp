// Normals, box-projected texture coordinates and tangents.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "precompute/mesh/load_mesh.h"
#include "tests/mesh/mesh_kinds.h"

namespace prt {
namespace {

Scene prepared(const Scene& scene, double crease = 60, LoadMeshReport* report = nullptr) {
    LoadMeshOptions options;
    options.creaseAngleDeg = crease;
    return prepareScene(scene, "test", options, report);
}

Vec3f faceNormal(const Scene& scene, size_t t) {
    return (cornerPosition(scene, t, 1) - cornerPosition(scene, t, 0))
        .cross(cornerPosition(scene, t, 2) - cornerPosition(scene, t, 0))
        .normalized();
}

TEST(Normals, FollowTheSphere) {
    const Scene scene = prepared(makeSphere(64, 96, 2, {5, 6, 7}));
    for (size_t v = 0; v < scene.vertexCount(); ++v) {
        const Vec3f radial = (scene.positions[v] - Vec3f(5, 6, 7)).normalized();
        // Angle weighting is of second order in the edge length (0.05) on a sphere.
        EXPECT_LT((scene.normals[v] - radial).norm(), 2e-3f);
    }
}

TEST(Normals, CreasesStaySharpBelowTheAngle) {
    const Scene box = makeBox({0, 0, 0}, {1, 1, 1});
    const Scene sharp = prepared(box, 60);
    EXPECT_EQ(sharp.vertexCount(), 24u);
    for (size_t t = 0; t < 12; ++t)
        for (size_t k = 0; k < 3; ++k)
            EXPECT_LT((sharp.normals[sharp.indices[3 * t + k]] - faceNormal(sharp, t)).norm(), 1e-6f);
    // At 91° all faces of a corner meet in one normal: the diagonal, thanks to the angle weights.
    const Scene round = prepared(box, 91);
    for (size_t v = 0; v < round.vertexCount(); ++v) {
        const Vec3f out = (round.positions[v] - Vec3f(0.5f, 0.5f, 0.5f)).normalized();
        EXPECT_LT((round.normals[v] - out).norm(), 1e-6f);
    }
}

TEST(Normals, DoNotDependOnTheCutOfFaces) {
    // The corner at the origin touches one, or two, triangles of the same side.
    Scene a = makeBox({0, 0, 0}, {1, 1, 1}), b = a;
    b.indices[0] = 4, b.indices[1] = 6, b.indices[2] = 2, b.indices[3] = 4, b.indices[4] = 2,
    b.indices[5] = 0;
    const Scene na = prepared(a, 91), nb = prepared(b, 91);
    for (size_t v = 0; v < na.vertexCount(); ++v)
        for (size_t w = 0; w < nb.vertexCount(); ++w)
            if (na.positions[v] == nb.positions[w]) {
                EXPECT_LT((na.normals[v] - nb.normals[w]).norm(), 1e-6f);
            }
}

TEST(Normals, GivenOnesAreKeptAndUnusableOnesMade) {
    Scene scene = makeGrid(2);
    scene.normals.assign(9, Vec3f(0, 0.8f, 0.6f));
    scene.normals[0] = Vec3f(0, 0, 0);
    scene.normals[1] = Vec3f(0, std::numeric_limits<float>::quiet_NaN(), 1);
    scene.normals[2] = Vec3f(0, 8, 6);
    LoadMeshReport report;
    const Scene result = prepared(scene, 60, &report);
    ASSERT_EQ(result.vertexCount(), 9u);
    for (size_t v = 0; v < 9; ++v) {
        const bool made =
            result.positions[v] == scene.positions[0] || result.positions[v] == scene.positions[1];
        EXPECT_LT((result.normals[v] - (made ? Vec3f(0, 1, 0) : Vec3f(0, 0.8f, 0.6f))).norm(), 1e-6f);
    }
    EXPECT_EQ(report.counts.at("normals_made"), 2u);
    EXPECT_EQ(report.counts.at("normals_normalised"), 1u);
}

TEST(BoxProjection, IsUprightAndUnmirroredOnEverySide) {
    LoadMeshOptions options;
    options.uvScale = 2;
    const Scene scene = prepareScene(makeBox({10, 20, 30}, {11, 22, 33}), "box", options);
    for (size_t t = 0; t < scene.triangleCount(); ++t) {
        const Vec3f n = faceNormal(scene, t);
        // As seen from outside; on top the image's up is −Z, below +Z.
        const Vec3f up = std::abs(n.y()) > 0.5f ? Vec3f(0, 0, -n.y()) : Vec3f(0, 1, 0);
        const Vec3f right = up.cross(n);
        for (size_t k = 0; k < 3; ++k) {
            const size_t l = (k + 1) % 3;
            const Vec3f d = cornerPosition(scene, t, l) - cornerPosition(scene, t, k);
            const Vec2f duv = scene.uv0[scene.indices[3 * t + l]] - scene.uv0[scene.indices[3 * t + k]];
            EXPECT_NEAR(duv.x(), right.dot(d) / 2, 1e-5);
            EXPECT_NEAR(duv.y(), -up.dot(d) / 2, 1e-5);
        }
        for (size_t k = 0; k < 3; ++k) {
            const Vec4f& tangent = scene.tangents[scene.indices[3 * t + k]];
            EXPECT_LT((tangent.head<3>() - right).norm(), 1e-6f);
            EXPECT_EQ(tangent.w(), 1);
        }
    }
}

TEST(BoxProjection, TilesContinueAcrossMeshesAndStayExactFarAway) {
    LoadMeshOptions options;
    const Scene near = prepareScene(makeGrid(4, 4), "near", options);
    Scene moved = makeGrid(4, 4);
    for (Vec3f& p : moved.positions) p += Vec3f(8'000'000, 0, -8'000'000);
    const Scene far = prepareScene(moved, "far", options);
    EXPECT_EQ(near.uv0, far.uv0);
}

TEST(BoxProjection, FillsOnlyWhatIsAbsent) {
    Scene scene = joined(makeGrid(1), makeBox({5, 5, 5}, {6, 6, 6}));
    scene.materials.emplace_back();
    // Two primitives; the second came without texture coordinates, and was filled with zeros.
    scene.primitives = {{0, 4, 0, 6, 0}, {4, 8, 6, 36, 1}};
    scene.uv0.assign(12, Vec2f(0, 0));
    for (uint32_t v = 0; v < 4; ++v) scene.uv0[v] = Vec2f(0.1f * float(v), 0.5f * float(v % 2));
    LoadMeshReport report;
    const Scene result = prepared(scene, 60, &report);
    EXPECT_EQ(report.counts.at("texcoords_made"), 24u);
    for (uint32_t v = 0; v < result.primitives[0].vertexCount; ++v)
        EXPECT_THAT(std::vector<Vec2f>(scene.uv0.begin(), scene.uv0.begin() + 4),
                    testing::Contains(result.uv0[v]));
}

/// A unit square facing +Z with texture coordinates by a 2×2 matrix from (x, y).
Scene texturedSquare(const Eigen::Matrix2f& uvFromPosition) {
    Scene scene = sceneOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3});
    for (const Vec3f& p : scene.positions) {
        const Eigen::Vector2f uv = uvFromPosition * Eigen::Vector2f(p.x(), p.y());
        scene.uv0.emplace_back(uv.x(), uv.y());
    }
    return scene;
}

TEST(Tangents, PointAlongUAndBitangentsUpTheImage) {
    // v grows down the image: an upright image has v = −y.
    for (double degrees : {0.0, 30.0, 90.0, 200.0})
        for (bool mirrored : {false, true}) {
            const double a = degrees * M_PI / 180;
            // The image's right and up on the square.
            const Eigen::Vector2f right(float(std::cos(a)), float(std::sin(a)));
            const Eigen::Vector2f up = (mirrored ? -1.0f : 1.0f) * Eigen::Vector2f(-right.y(), right.x());
            Eigen::Matrix2f uv;
            uv.row(0) = 3 * right.transpose();
            uv.row(1) = -2 * up.transpose();
            const Scene scene = prepared(texturedSquare(uv));
            for (size_t v = 0; v < scene.vertexCount(); ++v) {
                const Vec4f& tangent = scene.tangents[v];
                EXPECT_LT((tangent.head<3>() - Vec3f(right.x(), right.y(), 0)).norm(), 1e-5f);
                EXPECT_EQ(tangent.w(), mirrored ? -1 : 1);
                const Vec3f bitangent = tangent.w() * scene.normals[v].cross(Vec3f(tangent.head<3>()));
                EXPECT_LT((bitangent - Vec3f(up.x(), up.y(), 0)).norm(), 1e-5f);
            }
        }
}

TEST(Tangents, VerticesSplitWhereHandednessChanges) {
    // Two squares side by side, the image mirrored at x = 1.
    Scene scene = sceneOf({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}},
                          {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4});
    for (const Vec3f& p : scene.positions) scene.uv0.emplace_back(std::abs(p.x() - 1), -p.y());
    const Scene result = prepared(scene);
    EXPECT_EQ(result.vertexCount(), 8u);
    for (size_t t = 0; t < 4; ++t)
        for (size_t k = 0; k < 3; ++k) {
            const Vec4f& tangent = result.tangents[result.indices[3 * t + k]];
            EXPECT_LT((tangent - Vec4f(t < 2 ? -1.0f : 1.0f, 0, 0, t < 2 ? -1.0f : 1.0f)).norm(), 1e-6f);
        }
}

TEST(Tangents, AreUnitAndOrthogonalWhateverTheTexture) {
    for (const MeshKind& kind : meshKinds()) {
        Scene scene = prepared(kind.make());
        for (int round = 0; round < 2; ++round) {
            for (size_t v = 0; v < scene.vertexCount(); ++v) {
                const Vec3f t = scene.tangents[v].head<3>();
                EXPECT_NEAR(t.norm(), 1, 1e-5) << kind.name;
                EXPECT_NEAR(t.dot(scene.normals[v]), 0, 1e-5) << kind.name;
                EXPECT_EQ(std::abs(scene.tangents[v].w()), 1) << kind.name;
            }
            // Once more with a texture squeezed to a point.
            scene.uv0.assign(scene.vertexCount(), Vec2f(0.5f, 0.5f));
            makeTangents(scene);
        }
    }
}

TEST(Tangents, GivenOnesAreKept) {
    Scene scene = texturedSquare(Eigen::Matrix2f::Identity());
    scene.normals.assign(4, Vec3f(0, 0, 1));
    scene.tangents.assign(4, Vec4f(0, 1, 0, -1));
    scene.tangents[3] = Vec4f(0, 0, 0, 0);
    LoadMeshReport report;
    const Scene result = prepared(scene, 60, &report);
    for (size_t v = 0; v < 4; ++v)
        if (result.positions[v] != scene.positions[3]) {
            EXPECT_EQ(result.tangents[v], Vec4f(0, 1, 0, -1));
        }
    EXPECT_EQ(report.counts.at("tangents_made"), 1u);
}

}  // namespace
}  // namespace prt
