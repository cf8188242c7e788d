// The environment behind the scene against the definition in math/environment.h.
#include <cmath>
#include <numbers>
#include <random>

#include "precompute/math/environment.h"
#include "precompute/math/sh_rotation.h"
#include "runtime/renderer.h"
#include "test_scenes.h"

namespace prt {
namespace {

using namespace test;

constexpr int kWidth = 64, kHeight = 32;

FloatImage noisyEnvironment() {
    FloatImage image{kWidth, kHeight, 3, std::vector<float>(size_t(kWidth * kHeight * 3))};
    std::mt19937 random(3);
    std::uniform_real_distribution<float> value(0, 1);
    for (float& v : image.pixels) v = value(random);
    return image;
}

std::array<double, 3> bilinear(const FloatImage& image, const Vec3d& direction) {
    const auto [x, y] = latLongPoint(direction, image.width, image.height);
    const double u = x - 0.5, v = y - 0.5;
    const int x0 = int(std::floor(u)), y0 = int(std::floor(v));
    std::array<double, 3> sum{};
    for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx) {
            const double weight = (dx ? u - x0 : 1 - u + x0) * (dy ? v - y0 : 1 - v + y0);
            const float* pixel =
                image.at((x0 + dx + image.width) % image.width, std::clamp(y0 + dy, 0, image.height - 1));
            for (size_t c = 0; c < 3; ++c) sum[c] += weight * double(pixel[c]);
        }
    return sum;
}

struct Stage {
    GlContext context;
    Scene scene = quad({0, 0, 0}, {0.2f, 0, 0}, {0, 0.2f, 0});
    VisibilityMap visibility = uniformVisibility(texelGrid(2, 2), 1, {1.0f});
    Renderer renderer{context, scene, &visibility, nullptr};
    Stage() {
        NormalTable table = noisyTable(TableKind::LightCosine, 1, 1, 2, 1);
        std::fill(table.values.begin(), table.values.end(), 7.0f);
        renderer.setTable(table);
    }
};

TEST(Background, ShowsTheEnvironmentWhereItIs) {
    Stage stage;
    const FloatImage environment = noisyEnvironment();
    const RenderOptions options{60, 40, true};
    for (const double rotation : {0.0, 0.7, -2.5}) {
        stage.renderer.setBackground(environment, rotation);
        for (const Vec3f& forward : {Vec3f(0, 0, -1), Vec3f(0, 0, 1), Vec3f(1, 0.5f, 0), Vec3f(-1, 2, 0.3f),
                                     Vec3f(0.1f, -2, 0.3f)}) {
            Camera camera;
            camera.eye = {0, 0, 3};
            camera.target = camera.eye + forward;
            camera.verticalFovDeg = 70;
            const RenderedFrame frame = stage.renderer.render(camera, Technique::Unc, options);
            const SurfaceImage surface = stage.renderer.surface(camera, options);
            const Vec3d f = forward.cast<double>().normalized(), r = f.cross(Vec3d(0, 1, 0)).normalized();
            const double half = std::tan(35 * std::numbers::pi / 180);
            for (int y = 0; y < 40; ++y)
                for (int x = 0; x < 60; ++x) {
                    const auto i = size_t(y * 60 + x);
                    if (surface.triangle[i] != kNoTriangle) {
                        ASSERT_NEAR(frame.radiance.pixels[i * 3], 7 / std::numbers::pi, 1e-5);
                        continue;
                    }
                    const Vec3d ray = f + r * (half * 1.5 * (2 * (x + 0.5) / 60 - 1)) +
                                      r.cross(f) * (half * (1 - 2 * (y + 0.5) / 40));
                    const Vec3d source = rotationAboutUp(rotation).transpose() * ray.normalized();
                    const auto truth = bilinear(environment, source);
                    for (size_t c = 0; c < 3; ++c) {
                        ASSERT_NEAR(frame.radiance.pixels[i * 3 + c], truth[c], 2e-4) << x << " " << y;
                        ASSERT_EQ(frame.irradiance.pixels[i * 3 + c], 0.0f);
                    }
                }
        }
    }
}

TEST(Background, LooksUpAtTheTopRow) {
    Stage stage;
    FloatImage sky{kWidth, kHeight, 3, std::vector<float>(size_t(kWidth * kHeight * 3), 0.0f)};
    for (int y = 0; y < kHeight / 2; ++y)
        for (int x = 0; x < kWidth; ++x) sky.at(x, y)[2] = 1;
    stage.renderer.setBackground(sky, 0);
    Camera camera;
    camera.eye = {0, 0, 3};
    camera.target = {0, 0, 6};
    const FloatImage image = stage.renderer.render(camera, Technique::Unc, {40, 40, true}).radiance;
    EXPECT_EQ(image.at(20, 2)[2], 1.0f);
    EXPECT_EQ(image.at(20, 38)[2], 0.0f);
}

TEST(Background, IsBlackWhenNeverSet) {
    Stage stage;
    const FloatImage image = stage.renderer.render({}, Technique::Unc, {40, 40, true}).radiance;
    EXPECT_EQ(image.at(1, 1)[0], 0.0f);
    EXPECT_GT(image.at(20, 20)[0], 0.0f);
}

}  // namespace
}  // namespace prt
