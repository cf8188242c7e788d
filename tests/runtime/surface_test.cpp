// What is seen, against rays intersected with every triangle.
#include <cmath>
#include <numbers>

#include "precompute/base/error.h"
#include "runtime/renderer.h"
#include "test_scenes.h"

namespace prt {
namespace {

using namespace test;

struct Hit {
    uint32_t triangle = kNoTriangle;
    Vec3d position = Vec3d::Zero();
};

// Nearest front face along the ray through a pixel's centre.
Hit castRay(const Scene& scene, const Camera& camera, int x, int y, int width, int height) {
    const Vec3d eye = camera.eye.cast<double>();
    const Vec3d forward = (camera.target.cast<double>() - eye).normalized();
    const Vec3d right = forward.cross(camera.up.cast<double>()).normalized(), up = right.cross(forward);
    const double half = std::tan(camera.verticalFovDeg * std::numbers::pi / 360);
    const Vec3d ray = forward + right * (half * width / height * (2 * (x + 0.5) / width - 1)) +
                      up * (half * (1 - 2 * (y + 0.5) / height));
    Hit hit;
    double nearest = INFINITY;
    for (size_t t = 0; t < scene.triangleCount(); ++t) {
        const auto at = [&](size_t c) {
            return Vec3d(scene.positions[scene.indices[t * 3 + c]].cast<double>());
        };
        const Vec3d a = at(0), e1 = at(1) - a, e2 = at(2) - a, p = ray.cross(e2), s = eye - a,
                    q = s.cross(e1);
        const double determinant = e1.dot(p);
        if (determinant <= 0) continue;  // from behind
        const double u = s.dot(p) / determinant, v = ray.dot(q) / determinant,
                     distance = e2.dot(q) / determinant;
        if (u < 0 || v < 0 || u + v > 1 || distance <= 0 || distance >= nearest) continue;
        nearest = distance;
        hit = {uint32_t(t), eye + distance * ray};
    }
    return hit;
}

Scene mixedScene(const Vec3f& offset) {
    Scene scene = quad(offset + Vec3f(0, -1, 0), {3, 0, 0}, {0, 0, -3});
    append(scene, sphere(offset + Vec3f(0.4f, 0, 0), 1, 16));
    append(scene, quad(offset + Vec3f(-1.2f, 0, 0.6f), {0.5f, 0, 0.3f}, {0, 0.9f, 0.1f}));
    append(scene, quad(offset + Vec3f(0, 0.5f, -2), {3, 0, 0}, {0, 1.5f, 0}));
    return scene;
}

// Compares with rays; `size` is of float rounding at the scene's place.
void compareWithRays(GlContext& context, const Scene& scene, const Camera& camera, double rounding) {
    const RenderOptions options{96, 64, true};
    Renderer renderer(context, scene, nullptr, nullptr);
    const SurfaceImage surface = renderer.surface(camera, options);
    ASSERT_EQ(surface.pixels(), 96u * 64u);
    int covered = 0, otherTriangle = 0, otherCoverage = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 96; ++x) {
            const auto i = size_t(y * 96 + x);
            const Hit hit = castRay(scene, camera, x, y, 96, 64);
            const bool seen = surface.triangle[i] != kNoTriangle;
            if (seen != (hit.triangle != kNoTriangle)) {
                ++otherCoverage;
                continue;
            }
            if (!seen) continue;
            ++covered;
            if (surface.triangle[i] != hit.triangle) {
                ++otherTriangle;
                continue;
            }
            // Seen at a grazing angle, a rounding across the ray is a larger one along it.
            EXPECT_LT((surface.position[i].cast<double>() - hit.position).norm(), rounding) << x << " " << y;
            EXPECT_EQ(surface.geometricNormal[i], triangleNormal(scene, hit.triangle));
            EXPECT_NEAR(surface.shadingNormal[i].norm(), 1, 1e-6);
        }
    EXPECT_GT(covered, 2000);
    EXPECT_LT(otherTriangle, covered / 100);  // centres that fall on an edge
    EXPECT_LT(otherCoverage, covered / 200);
}

TEST(Surface, IsWhatRaysHit) {
    GlContext context;
    const Scene scene = mixedScene({0, 0, 0});
    Camera camera;
    camera.eye = {1.5f, 1.2f, 4};
    compareWithRays(context, scene, camera, 1e-4);
    camera.eye = {-2.5f, 0.3f, 1};
    camera.target = {0.2f, -0.2f, 0};
    camera.up = Vec3f(0.2f, 1, 0);
    compareWithRays(context, scene, camera, 1e-4);
}

TEST(Surface, KeepsItsDigitsFarFromTheOrigin) {
    GlContext context;
    const Vec3f offset(40000, -20000, 30000);  // floats are 0.004 apart there
    const Scene scene = mixedScene(offset);
    Camera camera;
    camera.eye = offset + Vec3f(1.5f, 1.25f, 4);
    camera.target = offset;
    compareWithRays(context, scene, camera, 1e-2);
}

TEST(Surface, InterpolatesNormals) {
    GlContext context;
    const Scene scene = sphere({0, 0, 0}, 1, 64);
    Renderer renderer(context, scene, nullptr, nullptr);
    const SurfaceImage surface = renderer.surface({}, {80, 80, true});
    int covered = 0;
    for (size_t i = 0; i < surface.pixels(); ++i) {
        if (surface.triangle[i] == kNoTriangle) continue;
        ++covered;
        EXPECT_LT((surface.shadingNormal[i] - surface.position[i].normalized()).norm(), 2e-3f);
        EXPECT_GT(surface.geometricNormal[i].dot(surface.shadingNormal[i]), 0.99f);
    }
    EXPECT_GT(covered, 500);
}

TEST(Surface, TopOfThePictureIsUp) {
    GlContext context;
    Scene scene = quad({0, 1, 0}, {0.3f, 0, 0}, {0, 0.3f, 0});
    append(scene, quad({-1, -1, 0}, {0.3f, 0, 0}, {0, 0.3f, 0}));
    Renderer renderer(context, scene, nullptr, nullptr);
    const SurfaceImage surface = renderer.surface({}, {100, 100, true});
    for (size_t i = 0; i < surface.pixels(); ++i) {
        if (surface.triangle[i] == kNoTriangle) continue;
        const bool upper = i / 100 < 50, left = i % 100 < 50;
        if (surface.triangle[i] < 2)
            EXPECT_TRUE(upper);
        else
            EXPECT_TRUE(!upper && left);
    }
    EXPECT_LT(surface.triangle[26 * 100 + 50], 2u);
}

TEST(Surface, BacksAreSeenOnlyIfDoubleSided) {
    GlContext context;
    Scene scene = quad({0, 0, 0}, {-1, 0, 0}, {0, 1, 0});  // faces −z, away from the camera
    const size_t middle = 16 * 32 + 16;
    {
        Renderer renderer(context, scene, nullptr, nullptr);
        EXPECT_EQ(renderer.surface({}, {32, 32, true}).triangle[middle], kNoTriangle);
    }
    scene.materials[0].doubleSided = true;
    Renderer renderer(context, scene, nullptr, nullptr);
    const SurfaceImage surface = renderer.surface({}, {32, 32, true});
    EXPECT_NE(surface.triangle[middle], kNoTriangle);
    EXPECT_EQ(surface.geometricNormal[middle], Vec3f(0, 0, -1));
    EXPECT_EQ(surface.shadingNormal[middle], Vec3f(0, 0, -1));
}

TEST(Surface, LooksStraightDown) {
    GlContext context;
    const Scene scene = quad({0, 0, 0}, {1, 0, 0}, {0, 0, -1});
    Renderer renderer(context, scene, nullptr, nullptr);
    Camera camera;
    camera.eye = {0, 3, 0};  // along "up"
    const SurfaceImage surface = renderer.surface(camera, {32, 32, true});
    EXPECT_LT(surface.position[16 * 32 + 16].norm(), 0.2f);
    EXPECT_NE(surface.triangle[16 * 32 + 16], kNoTriangle);
}

TEST(Surface, EyeInsideTheSceneSeesAllAround) {
    GlContext context;
    Scene scene = sphere({0, 0, 0}, 10, 24);
    scene.materials[0].doubleSided = true;
    Renderer renderer(context, scene, nullptr, nullptr);
    Camera camera;
    camera.eye = {9.99f, 0, 0};  // a thousandth of the radius before the wall
    for (const Vec3f& direction : {Vec3f(1, 0, 0), Vec3f(-1, 0.1f, 0), Vec3f(0, 0, 1), Vec3f(0.3f, -1, 0)}) {
        camera.target = camera.eye + direction;
        const SurfaceImage surface = renderer.surface(camera, {40, 40, true});
        for (const uint32_t triangle : surface.triangle) ASSERT_NE(triangle, kNoTriangle);
    }
}

TEST(Surface, NearHidesFar) {
    GlContext context;
    // A thousandth apart, drawn in both orders.
    for (const bool nearFirst : {false, true}) {
        const Scene far = quad({0, 0, 0}, {100, 0, 0}, {0, 100, 0}),
                    near = quad({0, 0, 1e-3f}, {1, 0, 0}, {0, 1, 0});
        Scene scene = nearFirst ? near : far;
        append(scene, nearFirst ? far : near);
        Renderer renderer(context, scene, nullptr, nullptr);
        Camera camera;
        camera.eye = {0, 0, 4};
        camera.verticalFovDeg = 20;
        for (const Vec3f& position : renderer.surface(camera, {32, 32, true}).position)
            ASSERT_FLOAT_EQ(position.z(), 1e-3f);
    }
}

TEST(Surface, ImpossibleCamerasAreRefused) {
    GlContext context;
    const Scene scene = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    Renderer renderer(context, scene, nullptr, nullptr);
    Camera camera;
    camera.target = camera.eye;
    EXPECT_THROW(renderer.surface(camera, {}), InputError);
    for (const float fov : {0.0f, -20.0f, 180.0f, NAN}) {
        Camera wide;
        wide.verticalFovDeg = fov;
        EXPECT_THROW(renderer.surface(wide, {}), InputError) << fov;
    }
}

}  // namespace
}  // namespace prt
