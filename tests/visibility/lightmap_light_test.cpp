// Sampling of environments: densities, flux and rotation.
#include "precompute/visibility/lightmap_light.h"

#include <cmath>
#include <numbers>

#include "precompute/math/direction_sets.h"
#include "precompute/math/sh.h"
#include "tests/reference/reference_scenes.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

Environment spotted() {
    Environment environment;
    environment.image = {24, 12, 3, std::vector<float>(24 * 12 * 3, 0.0f)};
    for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 24; ++x) {
            if (y == 5 || x % 5 == 2) continue;  // whole rows and columns are dark
            for (int c = 0; c < 3; ++c) environment.image.at(x, y)[c] = float((x * 7 + y * 3 + c) % 11);
        }
    environment.image.at(20, 3)[0] = 500;
    return environment;
}

TEST(EnvironmentSampler, DensityIntegratesToOneAndSamplesFollowIt) {
    const Environment environment = spotted();
    const EnvironmentSampler light(environment.view(), 0.9);
    Vec3d flux = Vec3d::Zero();
    double density = 0;
    for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 24; ++x) {
            const Vec3d direction = latLongDirection(x + 0.5, y + 0.5, 24, 12);
            const double sr = latLongTexelSolidAngle(y, 24, 12);
            density +=
                sr * double(EnvironmentSampler(environment.view(), 0).evaluate(direction.cast<float>()).pdf);
            for (int c = 0; c < 3; ++c) flux[c] += sr * double(environment.image.at(x, y)[c]);
        }
    EXPECT_NEAR(density, 1, 1e-5);

    Vec3d sum = Vec3d::Zero();
    double upwards = 0;
    const std::vector points = sobolOwenPoints(1 << 14, 3);
    for (const auto& [u1, u2] : points) {
        const LightSample sample = light.sample(u1, u2);
        ASSERT_GT(sample.pdf, 0.0f);
        EXPECT_NEAR(sample.direction.norm(), 1, 1e-6);
        sum += sample.radiance.cast<double>() / double(sample.pdf);
        upwards += sample.direction.y() > 0;
    }
    // The sum of the colours over the density is the same for every sample.
    EXPECT_NEAR(sum.sum() / double(points.size()), flux.sum(), 1e-4 * flux.sum());
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / double(points.size()), flux[c], 0.01 * flux[c]);
    EXPECT_GT(upwards / double(points.size()), 0.5);
}

// A direction that a texel was sampled with shows this texel, but for rounding at its edge.
TEST(EnvironmentSampler, EvaluateSeesWhatWasSampled) {
    const Environment environment = spotted();
    for (const double rotation : {0.0, 0.9, -7.0, 2 * kPi}) {
        const EnvironmentSampler light(environment.view(), rotation);
        size_t different = 0;
        const std::vector points = sobolOwenPoints(4096, 5);
        for (const auto& [u1, u2] : points) {
            const LightSample sample = light.sample(u1, u2);
            const LightSample seen = light.evaluate(sample.direction);
            different += seen.radiance != sample.radiance || seen.pdf != sample.pdf;
        }
        EXPECT_LE(different, 4u) << rotation;
    }
}

TEST(EnvironmentSampler, TurnsAsTheExpansionDoes) {
    const Environment environment = spotted();
    const double rotation = 0.8;
    const EnvironmentSampler light(environment.view(), rotation);
    const EnvironmentSh turned =
        rotateEnvironmentAboutUp(projectEnvironment(environment.view(), 2), rotation);
    std::vector<double> sums(4, 0.0);
    const std::vector points = sobolOwenPoints(1 << 16, 9);
    std::vector<double> basis(4);
    for (const auto& [u1, u2] : points) {
        const LightSample sample = light.sample(u1, u2);
        evalSh(2, sample.direction.cast<double>(), basis);
        for (size_t i = 0; i < 4; ++i)
            sums[i] += basis[i] * double(sample.radiance.x()) / double(sample.pdf) / double(points.size());
    }
    // 24 texels around: the expansion has each of them at its middle.
    for (size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(sums[i], double(turned.rgb[0][i]), 0.02 * double(turned.rgb[0][0])) << i;
}

TEST(EnvironmentSampler, DarkAndEndsOfTheRange) {
    const Environment black = uniformSky(0);
    EXPECT_TRUE(EnvironmentSampler(black.view(), 0).dark());
    EXPECT_EQ(EnvironmentSampler(black.view(), 0).evaluate({0, 1, 0}).pdf, 0.0f);
    const Environment environment = spotted();
    const EnvironmentSampler light(environment.view(), 0);
    for (const double u1 : {0.0, 0.5, 1 - 1e-16})
        for (const double u2 : {0.0, 0.5, 1 - 1e-16}) EXPECT_GT(light.sample(u1, u2).pdf, 0.0f);
    for (const Vec3f& pole : {Vec3f(0, 1, 0), Vec3f(0, -1, 0), Vec3f(0, 0, -1)})
        EXPECT_TRUE(light.evaluate(pole).radiance.allFinite());
}

}  // namespace
}  // namespace prt
