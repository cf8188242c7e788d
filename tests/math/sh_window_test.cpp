// Windows: their formulas, and that the conservative one leaves nothing negative and no slack.
#include "precompute/math/sh_window.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "precompute/math/clamped_cosine.h"
#include "precompute/math/directions.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr ShWindow kWindows[] = {ShWindow::Hanning, ShWindow::Lanczos, ShWindow::Gaussian};

/// Lights of positive intensity, as an expansion that rings.
std::vector<float> lights(int shOrder, int count, test::RandomInput& random) {
    std::vector<float> coefficients(size_t(shCount(shOrder)), 0.0f), y(coefficients.size());
    for (int k = 0; k < count; ++k) {
        evalSh(shOrder, random.direction().cast<float>(), std::span<float>(y));
        const float intensity = float(-std::log(1 - random.uniform(0, 0.999)));
        for (size_t i = 0; i < y.size(); ++i) coefficients[i] += intensity * y[i];
    }
    return coefficients;
}

double lowestValue(std::span<const float> coefficients, const std::vector<Vec3f>& directions) {
    const int shOrder = shOrderFromCount(coefficients.size());
    std::vector<float> basis(directions.size() * coefficients.size());
    evalShBatch(shOrder, directions, basis);
    double lowest = kInfinity;
    for (size_t k = 0; k < directions.size(); ++k) {
        double sum = 0;
        for (size_t i = 0; i < coefficients.size(); ++i)
            sum += double(coefficients[i]) * double(basis[k * coefficients.size() + i]);
        lowest = std::min(lowest, sum);
    }
    return lowest;
}

double length(std::span<const float> coefficients) {
    double sum = 0;
    for (const float c : coefficients) sum += double(c) * double(c);
    return std::sqrt(sum);
}

TEST(ShWindow, FactorsAreTheFormulas) {
    const double x = std::numbers::pi * 2 / 5;
    EXPECT_DOUBLE_EQ(shWindowFactor(ShWindow::Hanning, 5, 2), (1 + std::cos(x)) / 2);
    EXPECT_DOUBLE_EQ(shWindowFactor(ShWindow::Lanczos, 5, 2), std::sin(x) / x);
    EXPECT_DOUBLE_EQ(shWindowFactor(ShWindow::Gaussian, 5, 2), std::exp(-x * x / 2));
    EXPECT_EQ(shWindowFactor(ShWindow::Hanning, 5, 5), 0);
    EXPECT_EQ(shWindowFactor(ShWindow::Lanczos, 5, 7), 0);
    for (const ShWindow window : kWindows) {
        EXPECT_EQ(shWindowFactor(window, 0.5, 0), 1);
        EXPECT_EQ(shWindowFactor(window, kInfinity, 23), 1);
        for (double width = 0.5; width < 40; width *= 1.1)
            for (int l = 0; l < 23; ++l) {
                EXPECT_LE(shWindowFactor(window, width, l + 1), shWindowFactor(window, width, l));
                EXPECT_LE(shWindowFactor(window, width, l), shWindowFactor(window, width * 1.1, l));
            }
    }
}

TEST(ShWindow, ApplyingKeepsTheMean) {
    test::RandomInput random(3);
    EnvironmentSh environment{4, {lights(4, 3, random), lights(4, 3, random), lights(4, 3, random)}};
    const EnvironmentSh before = environment;
    applyShWindow(ShWindow::Hanning, 3.5, environment);
    for (size_t c = 0; c < 3; ++c)
        for (int l = 0; l < 4; ++l)
            for (int m = -l; m <= l; ++m) {
                const size_t i = size_t(shIndex(l, m));
                EXPECT_FLOAT_EQ(environment.rgb[c][i],
                                before.rgb[c][i] * float(shWindowFactor(ShWindow::Hanning, 3.5, l)));
            }
    EXPECT_EQ(environment.rgb[0][0], before.rgb[0][0]);
}

class ConservativeShWindow : public testing::TestWithParam<std::tuple<int, ShWindow>> {};

TEST_P(ConservativeShWindow, LeavesNothingNegativeAndNoSlackInItsBound) {
    const auto [shOrder, window] = GetParam();
    const std::vector<Vec3f> directions = sphericalFibonacci(20000);
    test::RandomInput random(100u + unsigned(shOrder));
    for (const int count : {1, 2, 5, 20}) {
        std::vector<float> coefficients = lights(shOrder, count, random);
        EXPECT_TRUE(count > 1 || lowestValue(coefficients, directions) < 0) << "one light rings";
        if (shLowerBound(coefficients) >= 0) {  // many lights may not
            EXPECT_EQ(findConservativeWindow(coefficients, window).width, kInfinity);
            EXPECT_GE(lowestValue(coefficients, directions), 0);
            continue;
        }
        const ConservativeWindow found = findConservativeWindow(coefficients, window);
        ASSERT_TRUE(found.nonNegative);
        ASSERT_LT(found.width, kInfinity);
        std::vector<float> weaker = coefficients, windowed = coefficients;
        applyShWindow(window, found.width, windowed);
        applyShWindow(window, found.width * 1.001, weaker);
        const double rounding = 1e-6 * length(coefficients) * shOrder;
        EXPECT_GE(lowestValue(windowed, directions), -rounding);
        EXPECT_GE(shLowerBound(windowed), -rounding);
        EXPECT_LT(shLowerBound(weaker), shLowerBound(windowed));
        EXPECT_LT(shLowerBound(weaker), 0);
        EXPECT_EQ(windowed[0], coefficients[0]);
    }
}

TEST_P(ConservativeShWindow, IsTheSameForTurnedLight) {
    const auto [shOrder, window] = GetParam();
    test::RandomInput random(50u + unsigned(shOrder));
    const std::vector<float> coefficients = lights(shOrder, 4, random);
    std::vector<float> turned(coefficients.size());
    const Mat3d rotation = random.rotation();
    rotateSh(rotation, shOrder, std::span<const float>(coefficients), std::span<float>(turned));
    EXPECT_NEAR(findConservativeWindow(turned, window).width,
                findConservativeWindow(coefficients, window).width, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Orders, ConservativeShWindow,
                         testing::Combine(testing::Values(2, 3, 4, 6, 10, 24), testing::ValuesIn(kWindows)));

TEST(ShLowerBound, IsBelowEveryValueAndExactForZonalFunctions) {
    const std::vector<Vec3f> directions = sphericalFibonacci(20000);
    test::RandomInput random(17);
    for (const int shOrder : {1, 2, 3, 6, 10}) {
        std::vector<float> coefficients(size_t(shCount(shOrder)));
        for (float& c : coefficients) c = float(random.uniform(-1, 1));
        EXPECT_LE(shLowerBound(coefficients), lowestValue(coefficients, directions) + 1e-5) << shOrder;
        std::vector<float> zonal(coefficients.size());
        evalClampedCosineSh(shOrder, Vec3f(0.48f, -0.6f, 0.64f), zonal);
        EXPECT_NEAR(shLowerBound(zonal), lowestValue(zonal, directions), 2e-4) << shOrder;
    }
}

TEST(NonNegativeShWindow, IsTheWidestThatLeavesNothingNegative) {
    const std::vector<Vec3f> directions = sphericalFibonacci(16 * shCount(8));
    test::RandomInput random(23);
    for (const ShWindow window : kWindows)
        for (const int count : {1, 2, 5}) {
            EnvironmentSh light{8,
                                {lights(8, count, random), lights(8, count, random), lights(8, 40, random)}};
            const double width = findNonNegativeWindow(light, window);
            EXPECT_GE(width, 0.999 * findConservativeWindow(light, window).width);
            ASSERT_LT(width, kInfinity);
            const auto lowest = [&](double w) {
                EnvironmentSh windowed = light;
                applyShWindow(window, w, windowed);
                double least = kInfinity;
                for (const std::vector<float>& colour : windowed.rgb)
                    least = std::min(least, lowestValue(colour, directions));
                return least;
            };
            const double rounding = 1e-5 * length(light.rgb[0]);
            EXPECT_GE(lowest(width), -rounding);
            EXPECT_LT(lowest(1.02 * width), -rounding);
        }
    EXPECT_EQ(findNonNegativeWindow({1, {std::vector<float>{1}, {1}, {0}}}), kInfinity);
}

TEST(ConservativeShWindow, SpecialCases) {
    const std::vector<float> constant = {1, 0, 0, 0, 0, 0, 0, 0, 0}, black(9, 0.0f);
    EXPECT_EQ(findConservativeWindow(constant).width, kInfinity);
    EXPECT_TRUE(findConservativeWindow(constant).nonNegative);
    EXPECT_EQ(findConservativeWindow(black).width, kInfinity);
    const std::vector<float> negative = {-1, 0, 1, 0};
    EXPECT_FALSE(findConservativeWindow(negative).nonNegative);
    const std::vector<float> noMean = {0, 0, 1, 0};  // all bands have to go
    EXPECT_TRUE(findConservativeWindow(noMean).nonNegative);
    EXPECT_NEAR(findConservativeWindow(noMean).width, 1, 1e-6);
    // linear band of three times the mean: Hanning has to bring it to 1/√3 of what it may be
    const std::vector<float> linear = {1, 0, 3, 0};
    const double width = findConservativeWindow(linear, ShWindow::Hanning).width;
    EXPECT_NEAR(shWindowFactor(ShWindow::Hanning, width, 1), 1 / (3 * std::sqrt(3.0)), 1e-6);
    // colours share the strongest
    const EnvironmentSh environment{2, {std::vector<float>{1, 0, 0, 0}, linear, {1, 0, 1, 0}}};
    EXPECT_EQ(findConservativeWindow(environment, ShWindow::Hanning).width, width);
}

TEST(ShWindowDeathTest, WrongSizes) {
    std::vector<float> five(5);
    EXPECT_DEATH(applyShWindow(ShWindow::Hanning, 3, five), "");
    EXPECT_DEATH(shWindowFactor(ShWindow::Hanning, 0, 1), "");
    EXPECT_DEATH(shLowerBound(five), "");
}

}  // namespace
}  // namespace prt
