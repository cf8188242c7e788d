// Per-vertex visibility.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "precompute/base/parallel.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/bake.h"
#include "tests/rays/shapes.h"

namespace prt {
namespace {

using shapes::Mesh;
constexpr double kPi = std::numbers::pi;

Scene sceneOf(const Mesh& mesh) {
    Scene scene;
    scene.positions = mesh.positions;
    scene.indices = mesh.indices;
    scene.materials.emplace_back();
    scene.primitives = {{0, uint32_t(mesh.positions.size()), 0, uint32_t(mesh.indices.size()), 0}};
    return scene;
}

// Every face with vertices and normals of its own.
Scene facetedSceneOf(const Mesh& mesh) {
    Mesh split;
    for (const uint32_t index : mesh.indices) {
        split.indices.push_back(uint32_t(split.positions.size()));
        split.positions.push_back(mesh.positions[index]);
    }
    Scene scene = sceneOf(split);
    for (size_t v = 0; v < split.positions.size(); ++v) scene.normals.push_back(split.normal(v / 3));
    return scene;
}

BakeResult bakeScene(const Scene& scene, int shOrder, int rays) {
    const RayCaster caster(scene.positions, scene.indices);
    BakeOptions options;
    options.shOrder = shOrder;
    options.rays = rays;
    return bakeVertexVisibility(caster, makeVertexPoints(scene), options);
}

TEST(VertexPoints, LieInsideTheIncidentFaces) {
    const Mesh mesh = shapes::sphere(2, {1, 0, 3}, 2);
    const Scene scene = sceneOf(mesh);
    const VertexPoints vertices = makeVertexPoints(scene);
    ASSERT_EQ(vertices.firstPoint.size(), scene.vertexCount() + 1);
    ASSERT_EQ(vertices.firstPoint.back(), vertices.points.size());
    ASSERT_EQ(vertices.share.size(), vertices.points.size());
    for (uint32_t v = 0; v < scene.vertexCount(); ++v) {
        EXPECT_EQ(vertices.sameAs[v], v);
        const uint32_t first = vertices.firstPoint[v], last = vertices.firstPoint[v + 1];
        EXPECT_THAT(last - first, testing::AnyOf(5u, 6u));
        EXPECT_NEAR(std::accumulate(vertices.share.begin() + first, vertices.share.begin() + last, 0.0), 1,
                    1e-6);
        const Vec3f outwards = (scene.positions[v] - Vec3f(1, 0, 3)).normalized();
        EXPECT_GT(vertices.normals[v].dot(outwards), 0.999f);
        EXPECT_NEAR(vertices.normals[v].norm(), 1, 1e-6);
        for (uint32_t p = first; p < last; ++p) {
            const SurfacePoint& point = vertices.points[p];
            const uint32_t* corner = &scene.indices[3 * point.triangle];
            const size_t k = size_t(std::find(corner, corner + 3, v) - corner);
            ASSERT_LT(k, 3u);
            const double u = k == 1 ? 0.8 : 0.1, w = k == 2 ? 0.8 : 0.1;  // 0.3 of the way to the centroid
            EXPECT_LT((point.position - mesh.point(point.triangle, u, w)).norm(), 1e-6f);
            EXPECT_LT((point.normal - mesh.normal(point.triangle)).norm(), 1e-6f);
        }
    }
}

TEST(VertexPoints, ManyFacesAreThinned) {
    Mesh fan;
    fan.positions.push_back({0, 1, 0});
    const int faces = 1000;
    for (int i = 0; i < faces; ++i) {
        // Half of the turn has nine tenths of the faces.
        const double turn = i < 900 ? i / 1800.0 : 0.5 + (i - 900) / 200.0;
        fan.positions.push_back(Vec3d(std::cos(2 * kPi * turn), 0, -std::sin(2 * kPi * turn)).cast<float>());
        for (const int v : {0, i + 1, (i + 1) % faces + 1}) fan.indices.push_back(uint32_t(v));
    }
    const VertexPoints vertices = makeVertexPoints(sceneOf(fan));
    const uint32_t count = vertices.firstPoint[1];
    EXPECT_LE(count, uint32_t(kMaxSubPoints));
    EXPECT_GE(count, 30u);
    double sum = 0;
    Vec3d mean = Vec3d::Zero();
    for (uint32_t p = 0; p < count; ++p) {
        sum += double(vertices.share[p]);
        mean += double(vertices.share[p]) * vertices.points[p].normal.cast<double>();
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_GT(mean.normalized().y(), 0.995);  // evenly around, by angle and not by number
    EXPECT_GT(vertices.normals[0].y(), 0.999f);
}

TEST(VertexPoints, SeamsAreJoinedAndHardEdgesAreNot) {
    // Two squares that share an edge, coplanar (a seam of UVs) or at a right angle (a hard edge).
    for (const bool hard : {false, true}) {
        Mesh mesh = shapes::quad({-1, 0, 1}, {0, 0, 1}, {0, 0, -1}, {-1, 0, -1});
        mesh.add(hard ? shapes::quad({0, 0, 1}, {0, -1, 1}, {0, -1, -1}, {0, 0, -1})
                      : shapes::quad({0, 0, 1}, {1, 0, 1}, {1, 0, -1}, {0, 0, -1}));
        Scene scene = sceneOf(mesh);
        for (size_t v = 0; v < 8; ++v)
            scene.normals.push_back(v < 4 || !hard ? Vec3f(0, 1, 0) : Vec3f(1, 0, 0));
        const VertexPoints vertices = makeVertexPoints(scene);
        EXPECT_EQ(vertices.sameAs[4], hard ? 4u : 1u);
        EXPECT_EQ(vertices.sameAs[7], hard ? 7u : 2u);
        EXPECT_EQ(vertices.sameAs[5], 5u);
        const BakeResult result = bakeScene(scene, 3, 512);
        const bool same =
            std::equal(&result.coefficients[9], &result.coefficients[18], &result.coefficients[36]);
        EXPECT_EQ(same, !hard);
        EXPECT_EQ(result.ao[1], 1.0f);
        EXPECT_EQ(result.ao[4], 1.0f);
    }
}

TEST(VertexPoints, VertexWithoutFacesBakesToZeros) {
    Scene scene = sceneOf(shapes::floorSquare(1));
    scene.positions.push_back({0, 5, 0});
    scene.positions.push_back({1, 5, 0});
    scene.primitives[0].vertexCount = 6;
    const VertexPoints vertices = makeVertexPoints(scene);
    EXPECT_EQ(vertices.firstPoint[4], vertices.firstPoint[6]);
    const BakeResult result = bakeScene(scene, 2, 128);
    ASSERT_EQ(result.ao.size(), 6u);
    EXPECT_EQ(result.ao[0], 1.0f);
    EXPECT_EQ(result.ao[5], 0.0f);
    for (size_t c = 16; c < 24; ++c) EXPECT_EQ(result.coefficients[c], 0.0f);
}

TEST(VertexBake, OpenSphereIsOpen) {
    const Scene scene = sceneOf(shapes::sphere(1, {0, 0, 0}, 4));
    const VertexPoints vertices = makeVertexPoints(scene);
    const BakeResult result = bakeScene(scene, 6, 1024);
    std::vector<float> cosine(36);
    double sum = 0;
    for (size_t v = 0; v < scene.vertexCount(); ++v) {
        EXPECT_EQ(result.ao[v], 1.0f);
        evalClampedCosineSh(6, vertices.normals[v], cosine);
        double irradiance = 0;
        for (size_t c = 0; c < 36; ++c)
            irradiance += double(result.coefficients[v * 36 + c]) * double(cosine[c]);
        EXPECT_NEAR(irradiance, kPi, 0.01 * kPi);  // sub-points deal the horizon's noise
        sum += irradiance;
    }
    EXPECT_NEAR(sum / double(scene.vertexCount()), kPi, 0.003 * kPi);
    // One set of directions per vertex, as for a texel.
    EXPECT_NEAR(double(result.rays) / double(scene.vertexCount()), 512, 8);
}

TEST(VertexBake, ClosedRoomDoesNotLeak) {
    for (const bool faceted : {false, true}) {
        Mesh mesh = shapes::box({-1, -1, -1}, {1, 1, 1});
        mesh.flip();
        const Scene scene = faceted ? facetedSceneOf(mesh) : sceneOf(mesh);
        const BakeResult result = bakeScene(scene, 4, 2048);
        for (const float c : result.coefficients) EXPECT_EQ(c, 0.0f);
        for (const float ao : result.ao) EXPECT_EQ(ao, 0.0f);
    }
}

// A corner of a room without a ceiling, from a floor vertex in the corner: the open quarter of the sky dome,
// cut by walls that end. Far from exact by design (sub-points), but between the extremes and alike on both
// walls.
TEST(VertexBake, FloorVertexUnderAWallSeesHalf) {
    Mesh mesh = shapes::quad({0, 0, 4000}, {8000, 0, 4000}, {8000, 0, -4000}, {0, 0, -4000});
    mesh.add(shapes::quad({0, 0, 4000}, {0, 0, -4000}, {0, 800000, -4000}, {0, 800000, 4000}));
    // A fine strip of floor at the foot of the wall, so that a vertex has its own small faces.
    const BakeResult result = [&] {
        Mesh strip;
        for (int i = -2; i <= 2; ++i)
            for (const float x : {0.0f, 1.0f}) strip.positions.push_back({x, 0.001f, float(i)});
        for (uint32_t i = 0; i < 4; ++i)
            for (const uint32_t v : {0u, 3u, 1u, 0u, 2u, 3u}) strip.indices.push_back(2 * i + v);
        mesh.add(strip);
        const Scene scene = facetedSceneOf(mesh);
        return bakeScene(scene, 3, 4096);
    }();
    const Scene scene = facetedSceneOf(mesh);
    size_t checked = 0;
    for (size_t v = 12; v < scene.vertexCount(); ++v) {
        EXPECT_EQ(scene.normals[v], Vec3f(0, 1, 0));
        EXPECT_NEAR(result.ao[v], 0.5, 0.01);
        ++checked;
    }
    EXPECT_EQ(checked, 24u);
}

TEST(VertexBake, BitsDoNotDependOnThreads) {
    Mesh mesh = shapes::sphere(1, {0, 0, 0}, 3);
    mesh.add(shapes::floorSquare(2, -0.6f));
    const Scene scene = sceneOf(mesh);
    setThreadCount(1);
    const BakeResult one = bakeScene(scene, 4, 300);
    setThreadCount(3);
    const BakeResult three = bakeScene(scene, 4, 300);
    setThreadCount(0);
    EXPECT_EQ(one.coefficients, three.coefficients);
    EXPECT_EQ(one.ao, three.ao);
    EXPECT_EQ(one.inside, three.inside);
}

TEST(VertexBake, FindsVerticesInsideGeometry) {
    Mesh mesh;
    const int cells = 24;
    mesh = shapes::heightField(cells, [](double, double) { return 0.0; });
    const size_t floorVertices = mesh.positions.size();
    mesh.add(shapes::box({-0.52f, -0.5f, -0.52f}, {0.52f, 1, 0.52f}));
    const Scene scene = sceneOf(mesh);
    const BakeResult result = bakeScene(scene, 2, 256);
    for (size_t v = 0; v < floorVertices; ++v) {
        const double x = double(scene.positions[v].x()), z = double(scene.positions[v].z());
        const double reach = std::max(std::abs(x), std::abs(z));
        if (reach < 0.45) {
            EXPECT_EQ(result.inside[v], 1) << x << " " << z;
        }
        if (reach > 0.55) {
            EXPECT_EQ(result.inside[v], 0) << x << " " << z;
        }
    }
}

}  // namespace
}  // namespace prt
