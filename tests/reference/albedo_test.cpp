// Reflectance of points of a scene: textures, their wrapping and their transfer curve.
#include "precompute/io/surface_albedo.h"

#include "precompute/base/error.h"
#include "tests/reference/reference_scenes.h"

namespace prt {
namespace {

// A square of two triangles, (u, v) = (x, z), whose texture is two texels: sRGB 0 and 188 (0.503 linear).
Scene texturedSquare() {
    Scene scene = sceneOf(shapes::quad({0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}));
    scene.uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    scene.textures.push_back({"two", "image/png", encodePng({2, 1, 4, {0, 0, 0, 255, 188, 188, 188, 255}})});
    scene.materials[0].baseColorTexture = 0;
    scene.materials[0].baseColor = Vec3f(1, 0.5f, 0);
    return scene;
}

// Triangle 0 has the corners (0, 0), (1, 0), (1, 1).
Vec3f at(const SurfaceAlbedo& albedo, double x, double z) { return albedo.at(0, float(x - z), float(z)); }

TEST(SurfaceAlbedo, BilinearInLinearLight) {
    const Scene scene = texturedSquare();
    const SurfaceAlbedo albedo(scene);
    const float bright = 0.50289f;  // ((188/255 + 0.055)/1.055)^2.4
    EXPECT_NEAR(at(albedo, 0.25, 0.1).x(), 0, 1e-6);
    EXPECT_NEAR(at(albedo, 0.75, 0.1).x(), bright, 1e-4);
    EXPECT_NEAR(at(albedo, 0.75, 0.1).y(), bright / 2, 1e-4);
    EXPECT_EQ(at(albedo, 0.75, 0.1).z(), 0.0f);
    EXPECT_NEAR(at(albedo, 0.5, 0.1).x(), bright / 2, 1e-4);
    // Repeated: half way between the last texel and the first one.
    EXPECT_NEAR(at(albedo, 1.0, 0.1).x(), bright / 2, 1e-4);
    EXPECT_NEAR(at(albedo, 0.0, 0.0).x(), bright / 2, 1e-4);
}

TEST(SurfaceAlbedo, CoordinatesBeyondTheImageRepeat) {
    Scene scene = texturedSquare();
    for (Vec2f& uv : scene.uv0) uv += Vec2f(-3, 7);
    const Scene plain = texturedSquare();
    const SurfaceAlbedo moved(scene), albedo(plain);
    for (const double x : {0.1, 0.3, 0.5, 0.8, 0.95})
        EXPECT_LT((at(moved, x, 0.05) - at(albedo, x, 0.05)).norm(), 1e-5f) << x;
}

TEST(SurfaceAlbedo, MaterialsOfPrimitives) {
    Scene scene = texturedSquare();
    scene.primitives = {{0, 3, 0, 3, 0}, {3, 1, 3, 3, 1}};
    scene.materials.emplace_back();
    scene.materials[1].baseColor = Vec3f(3, 0.25f, 0.5f);
    scene.materials[1].doubleSided = true;
    const SurfaceAlbedo albedo(scene);
    EXPECT_EQ(albedo.at(1, 0.3f, 0.3f), Vec3f(1, 0.25f, 0.5f));  // no more than all of the light
    EXPECT_FALSE(albedo.doubleSided(0));
    EXPECT_TRUE(albedo.doubleSided(1));
}

TEST(SurfaceAlbedo, DamagedTextureIsNamed) {
    Scene scene = texturedSquare();
    scene.textures[0].encoded.resize(30);
    try {
        const SurfaceAlbedo albedo(scene);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("two"), std::string::npos) << error.what();
    }
    scene.materials[0].baseColorTexture = -1;  // what nothing uses is not read
    EXPECT_EQ(SurfaceAlbedo(scene).at(0, 0, 0), Vec3f(1, 0.5f, 0));
}

}  // namespace
}  // namespace prt
