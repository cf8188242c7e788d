// The plain mesh: bounds, face normals and every promise that validateScene checks.
#include "precompute/io/scene.h"

#include <functional>
#include <limits>

#include "precompute/base/error.h"
#include "tests/io/small_scene.h"

namespace prt {
namespace {

using testing::HasSubstr;

TEST(SceneBounds, EnclosesAllPositions) {
    Scene scene;
    EXPECT_EQ(sceneBounds(scene).low, Vec3f(0, 0, 0));
    scene.positions = {{1, -2, 3}, {-1, 5, 3}, {0, 0, -7}};
    EXPECT_EQ(sceneBounds(scene).low, Vec3f(-1, -2, -7));
    EXPECT_EQ(sceneBounds(scene).high, Vec3f(1, 5, 3));
}

TEST(TriangleNormal, IsCounterClockwiseAtEveryScale) {
    for (float scale : {1e-18f, 1e-6f, 1.0f, 1e6f, 1e18f}) {
        Scene scene;
        scene.positions = {{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}};
        scene.indices = {0, 1, 2, 0, 2, 1, 0, 1, 1};
        EXPECT_EQ(triangleNormal(scene, 0), Vec3f(0, 0, 1)) << scale;
        EXPECT_EQ(triangleNormal(scene, 1), Vec3f(0, 0, -1)) << scale;
        EXPECT_EQ(triangleNormal(scene, 2), Vec3f(0, 0, 0)) << scale;
    }
}

TEST(TriangleNormal, SurvivesCancellation) {
    // Edges of 1e-3 at 1e4: a cross product in float would lose two digits.
    Scene scene;
    scene.positions = {{10000, 10000, 10000}, {10000.001f, 10000, 10000}, {10000, 10000.001f, 10000}};
    scene.indices = {0, 1, 2};
    EXPECT_EQ(triangleNormal(scene, 0), Vec3f(0, 0, 1));
}

TEST(ValidateScene, AcceptsASoundScene) { EXPECT_NO_THROW(validateScene(smallScene(), "small")); }

struct Damage {
    const char* name;
    const char* message;
    std::function<void(Scene&)> apply;
};

class DamagedScene : public testing::TestWithParam<Damage> {};

TEST_P(DamagedScene, IsRefusedWithItsReason) {
    Scene scene = smallScene();
    GetParam().apply(scene);
    try {
        validateScene(scene, "small");
        FAIL() << "accepted";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("small: "));
        EXPECT_THAT(error.what(), HasSubstr(GetParam().message));
    }
}

const float kNan = std::numeric_limits<float>::quiet_NaN();
const float kInfinity = std::numeric_limits<float>::infinity();

INSTANTIATE_TEST_SUITE_P(
    Each, DamagedScene,
    testing::Values(
        Damage{"Index", "uses vertex 99", [](Scene& s) { s.indices[1] = 99; }},
        Damage{"IndexOfAnotherPrimitive", "outside 0 to 4", [](Scene& s) { s.indices[0] = 5; }},
        Damage{"NanPosition", "vertex 2 has a position", [](Scene& s) { s.positions[2].y() = kNan; }},
        Damage{"InfiniteUv", "texture coordinate", [](Scene& s) { s.uv0[1].x() = kInfinity; }},
        Damage{"InfiniteAtlas", "atlas coordinate", [](Scene& s) { s.uv1[1].x() = -kInfinity; }},
        Damage{"NormalCount", "6 normal for 7 vertices", [](Scene& s) { s.normals.pop_back(); }},
        Damage{"LongNormal", "normal of vertex 3", [](Scene& s) { s.normals[3] *= 1.01f; }},
        Damage{"ZeroNormal", "normal of vertex 0", [](Scene& s) { s.normals[0].setZero(); }},
        Damage{"TangentSign", "tangent of vertex 4", [](Scene& s) { s.tangents[4].w() = 0.5f; }},
        Damage{"TangentLength", "tangent of vertex 4", [](Scene& s) { s.tangents[4].head<3>() *= 2; }},
        Damage{"Material", "uses material 2 of 2", [](Scene& s) { s.primitives[1].material = 2; }},
        Damage{"NoMaterial", "uses material -1", [](Scene& s) { s.primitives[1].material = -1; }},
        Damage{"Texture", "uses texture 2 of 2", [](Scene& s) { s.materials[0].baseColorTexture = 2; }},
        Damage{"NormalTexture", "uses texture -2", [](Scene& s) { s.materials[1].normalTexture = -2; }},
        Damage{"NanColour", "material 0", [](Scene& s) { s.materials[0].baseColor.x() = kNan; }},
        Damage{"Overlap", "primitive 1 does not start", [](Scene& s) { s.primitives[1].firstVertex = 3; }},
        Damage{"Beyond", "beyond the vertices", [](Scene& s) { s.primitives[1].vertexCount = 4; }},
        Damage{"Uncovered", "cover 4 of 7 vertices", [](Scene& s) { s.primitives.pop_back(); }},
        Damage{"NotTriangles", "not a multiple of 3", [](Scene& s) { s.primitives[1].indexCount = 2; }}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace prt
