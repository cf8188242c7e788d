// The rasteriser against the reference's ray caster: two implementations that share only the camera's
// definition.
#include "precompute/rays/ray_caster.h"
#include "runtime/reference/reference.h"
#include "runtime/renderer.h"
#include "test_scenes.h"

namespace prt {
namespace {

using namespace test;

TEST(PrimaryRays, SeeWhatIsDrawn) {
    Scene scene = quad({0, -1, 0}, {4, 0, 0}, {0, 0, -4});
    append(scene, sphere({0, 0, 0}, 1, 60));
    append(scene, sphere({1.5f, -0.5f, 1}, 0.5f, 40));
    append(scene, quad({-2, 0, -1}, {0.3f, 0, 1}, {0, 1, 0.2f}));
    for (SceneMaterial& material : scene.materials) material.doubleSided = true;
    GlContext context;
    Renderer renderer(context, scene, nullptr, nullptr);
    const RayCaster caster(scene.positions, scene.indices);
    const int width = 320, height = 200;
    for (const Vec3f& eye : {Vec3f(0, 1, 5), Vec3f(4, 0.3f, -2), Vec3f(0.2f, 6, 0.1f), Vec3f(-3, -3, 3)}) {
        Camera camera;
        camera.eye = eye;
        const SurfaceImage drawn = renderer.surface(camera, {width, height, true});
        const SurfaceImage cast = castPrimaryRays(caster, scene, camera, width, height);
        size_t covered = 0, differ = 0;
        for (size_t i = 0; i < cast.pixels(); ++i) {
            covered += cast.triangle[i] != kNoTriangle;
            if (drawn.triangle[i] != cast.triangle[i]) {
                ++differ;
                continue;
            }
            if (drawn.triangle[i] == kNoTriangle) continue;
            // A thousandth of a pixel across the ray is more along it at grazing angles.
            const Vec3f ray = (cast.position[i] - eye).normalized();
            const float grazing = std::max(0.02f, std::abs(ray.dot(cast.geometricNormal[i])));
            EXPECT_LT((drawn.position[i] - cast.position[i]).norm(), 2e-5f / grazing) << i;
            EXPECT_LT((drawn.shadingNormal[i] - cast.shadingNormal[i]).norm(), 1e-4f / grazing) << i;
            EXPECT_EQ(drawn.geometricNormal[i], cast.geometricNormal[i]);
            EXPECT_EQ(drawn.albedo[i], Vec3f(1, 1, 1));
        }
        EXPECT_GT(covered, 5000u);
        EXPECT_LT(double(differ), 0.01 * double(covered));  // centres on an edge between triangles
    }
}

}  // namespace
}  // namespace prt
