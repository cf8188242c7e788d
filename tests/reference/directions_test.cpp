// Directions of the reference: areas, flux, refinement and rotation.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "precompute/base/error.h"
#include "runtime/reference/reference.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

Environment environmentOf(int width, int height, float value) {
    Environment environment;
    environment.name = "test";
    environment.image = {width, height, 3, std::vector<float>(size_t(width) * size_t(height) * 3, value)};
    return environment;
}

Environment noise(int width, int height, unsigned seed) {
    Environment environment = environmentOf(width, height, 0);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0, 2);
    for (float& value : environment.image.pixels) value = uniform(random);
    return environment;
}

double texelSr(int y, int width, int height) {
    return 2 * kPi / width * (std::cos(kPi * y / height) - std::cos(kPi * (y + 1) / height));
}

Vec3d texelDirection(double x, double y, int width, int height) {
    const double longitude = kPi - 2 * kPi * x / width, latitude = kPi / 2 - kPi * y / height;
    return {std::sin(longitude) * std::cos(latitude), std::sin(latitude),
            std::cos(longitude) * std::cos(latitude)};
}

Vec3d flux(const Environment& environment) {
    Vec3d sum = Vec3d::Zero();
    for (int y = 0; y < environment.image.height; ++y)
        for (int x = 0; x < environment.image.width; ++x)
            for (int c = 0; c < 3; ++c)
                sum[c] += double(environment.image.at(x, y)[c]) *
                          texelSr(y, environment.image.width, environment.image.height);
    return sum;
}

ReferenceDirections make(const std::vector<Environment>& environments, std::vector<double> rotations = {},
                         int baseCount = 4096) {
    rotations.resize(environments.size(), 0.0);
    return makeReferenceDirections(environments, rotations, baseCount);
}

TEST(ReferenceDirections, BaseCellsHaveEqualAreas) {
    for (const int baseCount : {16, 100, 1000, 4096, 50000}) {
        const ReferenceDirections set = make({}, {}, baseCount);
        const double count = double(set.direction.size());
        EXPECT_NEAR(count, baseCount, 5 + 0.2 * baseCount);
        EXPECT_TRUE(set.radiance.empty());
        Vec3d mean = Vec3d::Zero();
        for (size_t k = 0; k < set.direction.size(); ++k) {
            EXPECT_NEAR(set.direction[k].norm(), 1, 1e-6);
            EXPECT_NEAR(set.solidAngleSr[k], 4 * kPi / count, 1e-5 * 4 * kPi / count);
            mean += set.direction[k].cast<double>() / count;
        }
        EXPECT_LT(mean.norm(), 2 / count);
        EXPECT_NEAR(std::accumulate(set.solidAngleSr.begin(), set.solidAngleSr.end(), 0.0), 4 * kPi, 1e-5);
    }
}

// Second moments of a uniform set: ∫ ω ωᵀ = (4π/3)·I.
TEST(ReferenceDirections, AreEvenOverTheSphere) {
    const ReferenceDirections set = make({});
    Mat3d moment = Mat3d::Zero();
    for (size_t k = 0; k < set.direction.size(); ++k) {
        const Vec3d d = set.direction[k].cast<double>();
        moment += double(set.solidAngleSr[k]) * d * d.transpose();
    }
    EXPECT_LT((moment - 4 * kPi / 3 * Mat3d::Identity()).norm(), 0.01);
}

TEST(ReferenceDirections, FluxIsExact) {
    const std::vector<Environment> environments = {noise(64, 32, 1), noise(512, 256, 2), noise(7, 5, 3),
                                                   environmentOf(32, 16, 1)};
    const ReferenceDirections set = make(environments, {0, 1.234, -2, 7});
    ASSERT_EQ(set.radiance.size(), 4u);
    for (size_t e = 0; e < environments.size(); ++e) {
        ASSERT_EQ(set.radiance[e].size(), set.direction.size() * 3);
        Vec3d sum = Vec3d::Zero();
        for (size_t k = 0; k < set.direction.size(); ++k)
            for (size_t c = 0; c < 3; ++c)
                sum[int(c)] += double(set.radiance[e][3 * k + c]) * double(set.solidAngleSr[k]);
        EXPECT_LT((sum - flux(environments[e])).norm(), 1e-6 * sum.norm());
    }
    for (const float value : set.radiance[3]) EXPECT_NEAR(value, 1, 1e-6);
}

// The radiance of cells against a slow mean over many points: every cell is found again from its centre and
// area by the nearest centre.
TEST(ReferenceDirections, RadianceIsTheMeanOverTheCell) {
    const Environment environment = noise(16, 8, 4);
    const double rotation = 0.7;
    const ReferenceDirections set = make({environment}, {rotation}, 64);
    // First moments agree: Σ L ω ΔΩ over cells and over the turned image (cells are coarse: a few per cent).
    Vec3d cells = Vec3d::Zero(), texels = Vec3d::Zero();
    double scale = 0;
    for (size_t k = 0; k < set.direction.size(); ++k)
        cells +=
            double(set.radiance[0][3 * k]) * double(set.solidAngleSr[k]) * set.direction[k].cast<double>();
    const int fine = 8;
    for (int y = 0; y < 8 * fine; ++y)
        for (int x = 0; x < 16 * fine; ++x) {
            const Vec3d d = texelDirection(x + 0.5, y + 0.5, 16 * fine, 8 * fine);
            // +Z turns towards +X: longitude grows.
            const Vec3d turned(d.x() * std::cos(rotation) + d.z() * std::sin(rotation), d.y(),
                               -d.x() * std::sin(rotation) + d.z() * std::cos(rotation));
            const double sr = texelSr(y, 16 * fine, 8 * fine);
            texels += double(environment.image.at(x / fine, y / fine)[0]) * sr * turned;
            scale += double(environment.image.at(x / fine, y / fine)[0]) * sr;
        }
    EXPECT_LT((cells - texels).norm(), 0.01 * scale);
}

TEST(ReferenceDirections, RotationByColumnsRollsTheImage) {
    const Environment environment = noise(64, 32, 5);
    for (const int columns : {1, 5, 40}) {
        Environment rolled = environment;
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 64; ++x)
                std::copy_n(environment.image.at((x - columns + 64) % 64, y), 3, rolled.image.at(x, y));
        // Column x of longitude π − 2πx/w: rolling by +k columns turns by −2πk/w in longitude.
        const ReferenceDirections a = make({environment}, {-2 * kPi * columns / 64}, 1000);
        const ReferenceDirections b = make({rolled}, {0}, 1000);
        ASSERT_EQ(a.direction.size(), b.direction.size());
        for (size_t i = 0; i < a.radiance[0].size(); ++i)
            EXPECT_NEAR(a.radiance[0][i], b.radiance[0][i], 1e-5);
    }
}

TEST(ReferenceDirections, SplitsWhereTheSunIs) {
    Environment environment = environmentOf(256, 128, 0.2f);
    const int sunX = 70, sunY = 33;
    for (int c = 0; c < 3; ++c) environment.image.at(sunX, sunY)[c] = 2e4f;
    const int baseCount = 1000;
    const size_t plain = make({}, {}, baseCount).direction.size();
    for (const double rotation : {0.0, 1.0}) {
        const ReferenceDirections set = make({environment}, {rotation}, baseCount);
        EXPECT_GT(set.direction.size(), plain);
        EXPECT_LT(set.direction.size(), plain + 400);
        Vec3d centre = texelDirection(sunX + 0.5, sunY + 0.5, 256, 128);
        centre = Eigen::AngleAxisd(rotation, Eigen::Vector3d::UnitY()) * Eigen::Vector3d(centre);
        const double total = flux(environment)[0], sunSr = texelSr(sunY, 256, 128);
        Vec3d mean = Vec3d::Zero();
        double sun = 0;
        for (size_t k = 0; k < set.direction.size(); ++k) {
            const double share = double(set.radiance[0][3 * k]) * double(set.solidAngleSr[k]) / total;
            if (share > 4.0 / baseCount) {
                EXPECT_LE(set.solidAngleSr[k], sunSr / 4 * 1.001);
            }
            if (set.radiance[0][3 * k] < 1) continue;
            mean += share * set.direction[k].cast<double>();
            sun += share;
            EXPECT_LT(std::acos(std::min(1.0, centre.dot(set.direction[k].cast<double>()))), 0.06);
        }
        EXPECT_GT(sun, 0.5);
        EXPECT_LT((mean.normalized() - centre).norm(), 0.003);
    }
}

TEST(ReferenceDirections, ShareTheirCellsBetweenEnvironments) {
    Environment east = environmentOf(64, 32, 0.1f), west = east;
    for (int c = 0; c < 3; ++c) east.image.at(48, 12)[c] = 900, west.image.at(16, 12)[c] = 900;
    const ReferenceDirections both = make({east, west}, {}, 500);
    const ReferenceDirections one = make({east}, {}, 500);
    EXPECT_GT(both.direction.size(), one.direction.size());
    EXPECT_EQ(both.radiance[0].size(), both.radiance[1].size());
}

TEST(ReferenceDirections, BlackEnvironmentsAndBadCounts) {
    const ReferenceDirections set = make({environmentOf(8, 4, 0)});
    for (const float value : set.radiance[0]) EXPECT_EQ(value, 0.0f);
    for (const int count : {-1, 0, 15, 1048577}) EXPECT_THROW(make({}, {}, count), UsageError);
}

}  // namespace
}  // namespace prt
