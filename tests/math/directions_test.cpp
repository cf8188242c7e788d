// Direction sets and frames.
#include "precompute/math/directions.h"

#include <cmath>
#include <numbers>

#include "precompute/math/sh.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

/// Root mean square over bands 1..order−1 of the mean of Y_lm, in units of what N random directions give.
double quadratureError(int shOrder, const std::vector<Vec3f>& directions) {
    const std::vector<float> ones(directions.size(), 1.0f);
    const std::vector<float> c = projectShSamples(shOrder, directions, ones);
    double sum = 0;
    for (size_t i = 1; i < c.size(); ++i) sum += double(c[i]) * double(c[i]);
    const double random = std::sqrt(4 * kPi / double(directions.size()));
    return std::sqrt(sum / double(c.size() - 1)) / random;
}

TEST(SphericalFibonacci, UnitAndSpreadFromOneUpwards) {
    for (const int count : {1, 2, 3, 5, 16, 100, 1024, 10000}) {
        const std::vector<Vec3f> directions = sphericalFibonacci(count);
        ASSERT_EQ(directions.size(), size_t(count));
        Vec3d mean = Vec3d::Zero();
        for (const Vec3f& d : directions) {
            EXPECT_NEAR(d.norm(), 1, 2e-7f);
            mean += d.cast<double>();
        }
        // heights are symmetric, the rest is the spiral's closing error
        EXPECT_NEAR(mean.y(), 0, 1e-6 * count) << count;
        EXPECT_LT(mean.norm() / count, count == 1 ? 1.01 : 1.0 / count) << count;
    }
    const Vec3f only = sphericalFibonacci(1)[0];
    EXPECT_NEAR((only - Vec3f(0, 0, 1)).norm(), 0, 1e-6f);
}

TEST(SphericalFibonacci, PolarAxisIsUpAndEveryBandOfHeightHoldsOne) {
    const int count = 257;
    const std::vector<Vec3f> directions = sphericalFibonacci(count);
    for (int k = 0; k < count; ++k)
        EXPECT_NEAR(double(directions[size_t(k)].y()), 1 - (2.0 * k + 1) / count, 1e-6);
}

TEST(SphericalFibonacci, KeepsItsDistance) {
    for (const int count : {50, 500, 2000}) {
        const std::vector<Vec3f> directions = sphericalFibonacci(count);
        double nearest = 2;
        for (size_t i = 0; i < directions.size(); ++i)
            for (size_t j = 0; j < i; ++j)
                nearest = std::min(nearest, double((directions[i] - directions[j]).norm()));
        // a hexagonal lattice would have sqrt(8π/√3) = 3.81; this spiral keeps 3.09 along its length
        EXPECT_GT(nearest * std::sqrt(double(count)), 2.9) << count;
    }
}

TEST(SphericalFibonacci, IntegratesHarmonicsFarBetterThanRandomDirections) {
    for (const int count : {64, 256, 1024, 4096}) {
        EXPECT_LT(quadratureError(6, sphericalFibonacci(count)), 1.0 / std::sqrt(double(count))) << count;
        const double random = quadratureError(6, randomDirections(count, 5));
        EXPECT_GT(random, 0.6);
        EXPECT_LT(random, 1.4);
    }
}

TEST(RandomDirections, DependOnTheSeedAlone) {
    const std::vector<Vec3f> a = randomDirections(100, 1), b = randomDirections(100, 1),
                             c = randomDirections(100, 2);
    for (size_t k = 0; k < 100; ++k) {
        EXPECT_EQ(a[k], b[k]);
        EXPECT_NE(a[k], c[k]);
        EXPECT_NEAR(a[k].norm(), 1, 2e-7f);
    }
    EXPECT_TRUE(randomDirections(0, 1).empty());
}

TEST(FrameAround, IsOrthonormalAndRightHandedEverywhere) {
    test::RandomInput random(31);
    std::vector<Vec3f> normals = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    for (int k = 0; k < 2000; ++k) normals.push_back(random.direction().cast<float>());
    for (int exponent = -45; exponent < 0; ++exponent) {
        const double e = std::pow(10.0, exponent);
        normals.push_back(Vec3d(e, -0.7 * e, -1).normalized().cast<float>());
        normals.push_back(Vec3d(0, e, -1).normalized().cast<float>());
    }
    for (const Vec3f& n : normals) {
        const Frame f = frameAround(n);
        EXPECT_EQ(f.normal, n);
        EXPECT_NEAR(f.tangent.norm(), 1, 3e-7f);
        EXPECT_NEAR(f.bitangent.norm(), 1, 3e-7f);
        EXPECT_NEAR(f.tangent.dot(f.bitangent), 0, 3e-7f);
        EXPECT_NEAR(f.tangent.dot(n), 0, 3e-7f);
        EXPECT_NEAR(f.bitangent.dot(n), 0, 3e-7f);
        EXPECT_NEAR((f.tangent.cross(f.bitangent) - n).norm(), 0, 6e-7f);
    }
}

TEST(FrameAround, IsContinuousAwayFromMinusZ) {
    test::RandomInput random(32);
    for (int k = 0; k < 5000; ++k) {
        const Vec3d a = random.direction();
        if (a.z() < -0.98) continue;
        const Vec3d b = (a + 1e-4 * random.direction()).normalized();
        const Frame fa = frameAround(a.cast<float>()), fb = frameAround(b.cast<float>());
        // the frame turns at most 1 / (1 + z) · sinθ times as fast as the normal, 10 at z = −0.98
        EXPECT_LT((fa.tangent - fb.tangent).norm(), 2e-3f) << a.transpose();
        EXPECT_LT((fa.bitangent - fb.bitangent).norm(), 2e-3f) << a.transpose();
    }
    // across the equator, where the branch-free variant of the same construction jumps
    const Frame above = frameAround(Vec3f(0.6f, 0.8f, 1e-6f)), below = frameAround(Vec3f(0.6f, 0.8f, -1e-6f));
    EXPECT_LT((above.tangent - below.tangent).norm(), 1e-5f);
}

}  // namespace
}  // namespace prt
