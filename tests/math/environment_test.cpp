// Latitude-longitude images, their projection, rotation and blending.
#include "precompute/math/environment.h"

#include <cmath>
#include <numbers>

#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

struct Image {
    int width, height;
    std::vector<float> rgb;
    LatLongView view() const { return {width, height, rgb}; }
    float& at(int x, int y, int c) { return rgb[size_t((y * width + x) * 3 + c)]; }
};

Image randomImage(int width, int height, uint64_t seed) {
    test::RandomInput random(seed);
    Image image{width, height, std::vector<float>(size_t(width * height * 3))};
    for (float& v : image.rgb) v = float(std::pow(random.uniform(0, 2), 4));
    return image;
}

/// Every column's light moves by `columns` to the left (towards smaller x).
Image rolledLeft(const Image& image, int columns) {
    Image result = image;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const int to = ((x - columns) % image.width + image.width) % image.width;
            for (int c = 0; c < 3; ++c)
                result.at(to, y, c) = image.rgb[size_t((y * image.width + x) * 3 + c)];
        }
    return result;
}

/// Σ L ΔΩ Y, texel by texel.
std::array<std::vector<double>, 3> slowProjection(const Image& image, int shOrder) {
    std::vector<double> y(size_t(shCount(shOrder)));
    std::array<std::vector<double>, 3> sum;
    sum.fill(std::vector<double>(y.size(), 0.0));
    for (int row = 0; row < image.height; ++row)
        for (int x = 0; x < image.width; ++x) {
            evalSh(shOrder, latLongDirection(x + 0.5, row + 0.5, image.width, image.height),
                   std::span<double>(y));
            const double bottom = kPi / 2 - kPi * (row + 1) / image.height,
                         top = kPi / 2 - kPi * row / image.height;
            const double omega = 2 * kPi / image.width * (std::sin(top) - std::sin(bottom));
            for (size_t c = 0; c < 3; ++c)
                for (size_t i = 0; i < y.size(); ++i)
                    sum[c][i] += omega * double(image.rgb[size_t(row * image.width + x) * 3 + c]) * y[i];
        }
    return sum;
}

double norm(const std::vector<float>& v) {
    double sum = 0;
    for (const float x : v) sum += double(x) * double(x);
    return std::sqrt(sum);
}

double relativeDifference(const EnvironmentSh& a, const EnvironmentSh& b) {
    double worst = 0;
    for (size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(a.rgb[c].size(), b.rgb[c].size());
        double sum = 0;
        for (size_t i = 0; i < a.rgb[c].size(); ++i) {
            const double d = double(a.rgb[c][i]) - double(b.rgb[c][i]);
            sum += d * d;
        }
        worst = std::max(worst, std::sqrt(sum) / norm(a.rgb[c]));
    }
    return worst;
}

TEST(LatLong, OrientationIsThatOfOpenExr) {
    EXPECT_LT((latLongDirection(50, 25, 100, 50) - Vec3d(0, 0, 1)).norm(), 1e-15);   // centre
    EXPECT_LT((latLongDirection(10, 0, 100, 50) - Vec3d(0, 1, 0)).norm(), 1e-15);    // top row
    EXPECT_LT((latLongDirection(10, 50, 100, 50) - Vec3d(0, -1, 0)).norm(), 1e-15);  // bottom
    EXPECT_LT((latLongDirection(25, 25, 100, 50) - Vec3d(1, 0, 0)).norm(), 1e-15);   // left of the centre
    EXPECT_LT((latLongDirection(75, 25, 100, 50) - Vec3d(-1, 0, 0)).norm(), 1e-15);
    EXPECT_LT((latLongDirection(0, 25, 100, 50) - Vec3d(0, 0, -1)).norm(), 1e-15);  // left edge: longitude π
    // the same as ImfEnvmap's latLong(): longitude = atan2(x, z), latitude = asin(y)
    const Vec3d d = latLongDirection(12.5, 7.5, 64, 32);
    EXPECT_NEAR(std::atan2(d.x(), d.z()), kPi - 2 * kPi * 12.5 / 64, 1e-14);
    EXPECT_NEAR(std::asin(d.y()), kPi / 2 - kPi * 7.5 / 32, 1e-14);
}

TEST(LatLong, DirectionAndPointRoundTrip) {
    test::RandomInput random(71);
    for (int k = 0; k < 2000; ++k) {
        const double x = random.uniform(0.001, 63.999), y = random.uniform(0.001, 31.999);
        const Vec3d d = latLongDirection(x, y, 64, 32);
        EXPECT_NEAR(d.norm(), 1, 1e-15);
        const std::array<double, 2> point = latLongPoint(2 * d, 64, 32);
        EXPECT_NEAR(point[0], x, 1e-10);
        EXPECT_NEAR(point[1], y, 1e-12);
    }
    for (const Vec3d& pole : {Vec3d(0, 1, 0), Vec3d(0, -1, 0)}) {
        const std::array<double, 2> point = latLongPoint(pole, 64, 32);
        EXPECT_NEAR(point[1], pole.y() > 0 ? 0 : 32, 1e-12);
        EXPECT_TRUE(point[0] >= 0 && point[0] <= 64);
    }
}

TEST(LatLong, SolidAnglesSumToTheSphere) {
    for (const auto& [width, height] : {std::array{1, 1}, {2, 1}, {7, 5}, {512, 256}, {4096, 2048}}) {
        double sum = 0;
        for (int y = 0; y < height; ++y) {
            const double top = kPi / 2 - kPi * y / height, bottom = kPi / 2 - kPi * (y + 1) / height;
            const double omega = latLongTexelSolidAngle(y, width, height);
            EXPECT_NEAR(omega, 2 * kPi / width * (std::sin(top) - std::sin(bottom)), 1e-15);
            sum += omega * width;
        }
        EXPECT_NEAR(sum, 4 * kPi, 1e-11);
    }
}

TEST(ProjectEnvironment, EqualsTheSlowSum) {
    for (const auto& [width, height] : {std::array{1, 1}, {2, 1}, {7, 5}, {64, 32}, {50, 33}})
        for (const int n : {1, 2, 6, 20, 24}) {
            const Image image = randomImage(width, height, uint64_t(width + n));
            const EnvironmentSh fast = projectEnvironment(image.view(), n);
            const auto slow = slowProjection(image, n);
            EXPECT_EQ(fast.shOrder, n);
            for (size_t c = 0; c < 3; ++c) {
                ASSERT_EQ(fast.rgb[c].size(), slow[c].size());
                const double scale = norm(fast.rgb[c]);
                for (size_t i = 0; i < slow[c].size(); ++i)
                    EXPECT_NEAR(double(fast.rgb[c][i]), slow[c][i], 1e-7 * scale)
                        << width << ' ' << n << ' ' << i;
            }
        }
}

TEST(ProjectEnvironment, OfConstantLightIsTheFirstFunction) {
    const Image image{256, 128, std::vector<float>(256 * 128 * 3, 1.0f)};
    const EnvironmentSh sh = projectEnvironment(image.view(), 10);
    for (const std::vector<float>& c : sh.rgb) {
        EXPECT_NEAR(double(c[0]), std::sqrt(4 * kPi), 1e-6);
        // Y at texel centres: the midpoint rule's error, (l h)² / 24 at most with h = π/128
        for (int l = 1; l < 10; ++l)
            for (int m = -l; m <= l; ++m)
                EXPECT_NEAR(double(c[size_t(shIndex(l, m))]), 0,
                            std::sqrt(4 * kPi) * std::pow((l + 1) * kPi / 128, 2) / 4);
    }
}

TEST(ProjectEnvironment, OfOneFunctionPerColourFindsIt) {
    for (const auto& [a, b, d] : {std::array{0, 5, 17}, {1, 2, 3}, {24, 30, 35}}) {
        const std::array<size_t, 3> functions = {size_t(a), size_t(b), size_t(d)};
        Image image{256, 128, std::vector<float>(256 * 128 * 3)};
        std::vector<double> basis(36);
        for (int y = 0; y < 128; ++y)
            for (int x = 0; x < 256; ++x) {
                evalSh(6, latLongDirection(x + 0.5, y + 0.5, 256, 128), std::span<double>(basis));
                for (int c = 0; c < 3; ++c) image.at(x, y, c) = float(basis[functions[size_t(c)]]);
            }
        const EnvironmentSh sh = projectEnvironment(image.view(), 6);
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < 36; ++i)
                EXPECT_NEAR(double(sh.rgb[c][i]), i == functions[c] ? 1 : 0, 2e-3);
    }
}

TEST(ProjectEnvironment, IsTheSameBitsForAnyThreadCount) {
    const Image image = randomImage(128, 67, 72);
    setThreadCount(1);
    const EnvironmentSh one = projectEnvironment(image.view(), 12);
    for (const int threads : {2, 3, 8}) {
        setThreadCount(threads);
        const EnvironmentSh many = projectEnvironment(image.view(), 12);
        for (size_t c = 0; c < 3; ++c) EXPECT_EQ(one.rgb[c], many.rgb[c]) << threads;
    }
    setThreadCount(0);
}

TEST(RotateEnvironment, ByWholeColumnsIsRollingTheImageToTheLeft) {
    for (const int width : {64, 45}) {
        const Image image = randomImage(width, 32, 73);
        const EnvironmentSh sh = projectEnvironment(image.view(), 20);
        for (const int k : {1, 5, width / 2, width - 1, -3}) {
            const EnvironmentSh turned = rotateEnvironmentAboutUp(sh, 2 * kPi * k / width);
            EXPECT_LT(relativeDifference(turned, projectEnvironment(rolledLeft(image, k).view(), 20)), 1e-6)
                << k;
            // the other way round is another light, unless the turn is a half
            if (2 * k != width) {
                EXPECT_GT(relativeDifference(turned, projectEnvironment(rolledLeft(image, -k).view(), 20)),
                          0.05)
                    << k;
            }
        }
    }
}

TEST(RotateEnvironment, MovesOneTexelsLightFromColumnXToXMinusK) {
    Image image{32, 16, std::vector<float>(32 * 16 * 3, 0.0f)};
    const int x = 20, y = 5, k = 7;
    for (int c = 0; c < 3; ++c) image.at(x, y, c) = float(10 + c);
    const EnvironmentSh turned =
        rotateEnvironmentAboutUp(projectEnvironment(image.view(), 10), 2 * kPi * k / 32);
    std::vector<double> expected(100);
    evalSh(10, latLongDirection(x - k + 0.5, y + 0.5, 32, 16), std::span<double>(expected));
    const double omega = latLongTexelSolidAngle(y, 32, 16);
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < 100; ++i)
            EXPECT_NEAR(double(turned.rgb[c][i]), double(10 + c) * omega * expected[i], 1e-6);
}

TEST(BlendEnvironments, IsLinear) {
    const Image a = randomImage(16, 8, 74), b = randomImage(16, 8, 75);
    Image mixed = a;
    for (size_t i = 0; i < mixed.rgb.size(); ++i) mixed.rgb[i] = 0.7f * a.rgb[i] - 0.2f * b.rgb[i];
    const std::vector<EnvironmentSh> both = {projectEnvironment(a.view(), 6),
                                             projectEnvironment(b.view(), 6)};
    const std::vector<double> weights = {0.7, -0.2};
    EXPECT_LT(relativeDifference(blendEnvironments(both, weights), projectEnvironment(mixed.view(), 6)),
              1e-6);
    const std::vector<double> first = {1, 0};
    EXPECT_EQ(blendEnvironments(both, first).rgb, both[0].rgb);
}

}  // namespace
}  // namespace prt
