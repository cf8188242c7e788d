#include "precompute/math/irradiance_norm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "precompute/math/clamped_cosine.h"
#include "precompute/math/directions.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

// The definition by brute force: every band of light integrated against e and the cosine, in the world.
double slowNorm(const Vec3f& normal, std::span<const float> e, int shOrder) {
    const std::vector<Vec3f> directions = sphericalFibonacci(40000);
    const size_t lights = size_t(shCount(kMaxShOrder)), count = size_t(shCount(shOrder));
    std::vector<double> error(lights, 0.0), open(lights, 0.0), y(lights);
    for (const Vec3f& direction : directions) {
        const double cosine = double(normal.dot(direction));
        if (!(cosine > 0)) continue;
        evalSh(kMaxShOrder, direction.cast<double>(), y);
        double value = 0;
        for (size_t i = 0; i < count; ++i) value += double(e[i]) * y[i];
        for (size_t j = 0; j < lights; ++j) {
            error[j] += value * y[j] * cosine;
            open[j] += y[j] * cosine;
        }
    }
    double squares = 0, openSquares = 0;
    for (int l = 0; l < kMaxShOrder; ++l)
        for (int k = shIndex(l, -l); k <= shIndex(l, l); ++k) {
            squares += naturalLightPower(l) * error[size_t(k)] * error[size_t(k)];
            openSquares += naturalLightPower(l) * open[size_t(k)] * open[size_t(k)];
        }
    return std::sqrt(squares / openSquares);
}

TEST(IrradianceNorm, IsItsDefinition) {
    std::mt19937 random(1);
    std::normal_distribution<float> normal;
    for (const int shOrder : {1, 3, 6, 10}) {
        const IrradianceNorm norm(shOrder);
        for (int trial = 0; trial < 3; ++trial) {
            const Vec3f n = Vec3f(normal(random), normal(random), normal(random)).normalized();
            std::vector<float> e(size_t(shCount(shOrder)));
            for (float& value : e) value = normal(random);
            const double slow = slowNorm(n, e, shOrder);
            EXPECT_NEAR(norm.evaluate(n, e), slow, 2e-3 * slow) << shOrder;
        }
    }
}

TEST(IrradianceNorm, AnOpenPointIsOneUpToItsTruncation) {
    // The hemisphere's plain expansion; bands above those of the bundle are what it lacks.
    double before = 1;
    for (const int shOrder : {2, 4, 6, 10}) {
        const IrradianceNorm norm(shOrder);
        std::vector<float> open(size_t(shCount(shOrder)), 0.0f), y(open.size());
        const std::vector<Vec3f> directions = sphericalFibonacci(20000);
        const Vec3f n = Vec3f(0.3f, -0.8f, 0.52f).normalized();
        for (const Vec3f& direction : directions) {
            if (!(n.dot(direction) > 0)) continue;
            evalSh(shOrder, direction, y);
            for (size_t i = 0; i < y.size(); ++i) open[i] += float(4 * std::numbers::pi / 20000) * y[i];
        }
        const double distance = std::abs(norm.evaluate(n, open) - 1);
        EXPECT_LT(distance, 0.05);
        EXPECT_LT(distance, before);
        before = distance + 0.005;
    }
}

TEST(IrradianceNorm, ScalesAndTurnsWithItsArgument) {
    const IrradianceNorm norm(4);
    std::vector<float> e(16);
    for (size_t i = 0; i < 16; ++i) e[i] = float(i) - 5;
    const Vec3f n(0, 0, 1);
    const double value = norm.evaluate(n, e);
    for (float& x : e) x *= -3;
    EXPECT_NEAR(norm.evaluate(n, e), 3 * value, 1e-5 * value);
    std::fill(e.begin(), e.end(), 0.0f);
    EXPECT_EQ(norm.evaluate(n, e), 0);
}

TEST(IrradianceNorm, ManyAreEachOfThem) {
    std::mt19937 random(4);
    std::normal_distribution<float> normal;
    for (const int order : {1, 3, 6, 10})
        for (const size_t count : {1u, 5u, 16u, 37u}) {
            const IrradianceNorm norm(order);
            const size_t columns = size_t(shCount(order)), stride = 48;
            std::vector<Vec3f> normals;
            std::vector<float> many(columns * stride, 7.0f), out(count);
            std::vector<std::vector<float>> single(count, std::vector<float>(columns));
            for (size_t k = 0; k < count; ++k) {
                normals.push_back(Vec3f(normal(random), normal(random), normal(random)).normalized());
                for (size_t c = 0; c < columns; ++c) many[c * stride + k] = single[k][c] = normal(random);
            }
            norm.evaluateSoa(normals, stride, many, out);
            for (size_t k = 0; k < count; ++k) {
                const double expected = norm.evaluate(normals[k], single[k]);
                EXPECT_NEAR(double(out[k]), expected, 3e-6 * expected);
            }
        }
}

TEST(NaturalLight, FallsWithTheBand) {
    EXPECT_EQ(naturalLightPower(0), 1);
    EXPECT_NEAR(naturalLightPower(1), 0.3, 1e-12);
    for (int l = 1; l < kMaxShOrder; ++l) EXPECT_LT(naturalLightPower(l + 1), naturalLightPower(l));
}

}  // namespace
}  // namespace prt
