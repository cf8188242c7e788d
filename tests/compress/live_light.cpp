// Blended and turned light: tables are linear in the weights, and turning is rolling the image.
#include "runtime/live_light.h"

#include <cmath>
#include <numbers>
#include <random>

#include "compress/tables/normal_tables.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_window.h"
#include "precompute/math/sphere_map.h"

namespace prt {
namespace {

// Smooth gradients with a few bright texels; different for every seed.
Environment testEnvironment(unsigned seed, int width = 64) {
    Environment environment;
    environment.name = "test" + std::to_string(seed);
    environment.contentHash = "hash" + std::to_string(seed);
    environment.image = {width, width / 2, 3, {}};
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int y = 0; y < width / 2; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                environment.image.pixels.push_back(
                    uniform(random) +
                    (x > width / 4 * c && x < width / 4 * (c + 1) && y < width / 6 ? 4 : 0));
    return environment;
}

// Column x of the result shows what column x + columns of the image showed.
Environment rolled(const Environment& environment, int columns) {
    Environment result = environment;
    const int width = environment.image.width;
    for (int y = 0; y < environment.image.height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                result.image.at(x, y)[c] = environment.image.at((x + columns + width) % width, y)[c];
    return result;
}

double largest(const std::vector<float>& values) {
    double result = 0;
    for (const float value : values) result = std::max(result, double(std::abs(value)));
    return result;
}

double largestDifference(const NormalTable& a, const NormalTable& b) {
    EXPECT_EQ(a.values.size(), b.values.size());
    double result = 0;
    for (size_t k = 0; k < a.values.size(); ++k)
        result = std::max(result, std::abs(double(a.values[k]) - double(b.values[k])));
    return result / std::max(largest(a.values), largest(b.values));
}

PcaMap randomPca(int shOrder, int components) {
    PcaMap pca;
    pca.shOrder = shOrder;
    pca.components = components;
    std::mt19937 random(1);
    std::normal_distribution<float> normal;
    pca.mean.resize(size_t(shCount(shOrder)));
    pca.basis.resize(size_t(shCount(shOrder) * components));
    for (float& value : pca.mean) value = normal(random);
    for (float& value : pca.basis) value = normal(random);
    return pca;
}

TableOptions tablesOf(int size) {
    TableOptions options;
    options.size = size;
    return options;
}

class LiveLightOrders : public testing::TestWithParam<int> {};

TEST_P(LiveLightOrders, TablesHaveTheirShape) {
    const int shOrder = GetParam();
    const LiveLight light({testEnvironment(1), testEnvironment(2)}, shOrder, tablesOf(3));
    const NormalTable cosine = light.lightCosineTable({1, 2}, 0.5);
    EXPECT_EQ(cosine.kind, TableKind::LightCosine);
    EXPECT_EQ(cosine.shOrder, shOrder);
    EXPECT_EQ(cosine.size, 3);
    EXPECT_EQ(cosine.layers, shCount(shOrder));
    EXPECT_EQ(cosine.values.size(), size_t(3 * shCount(shOrder) * 54));
    const int components = std::min(4, shCount(shOrder));
    const NormalTable triple = light.tripleProductTable({1, 2}, 0.5, randomPca(shOrder, components));
    EXPECT_EQ(triple.kind, TableKind::TripleProduct);
    EXPECT_EQ(triple.layers, components + 1);
    EXPECT_EQ(triple.values.size(), size_t(3 * (components + 1) * 54));
}

TEST_P(LiveLightOrders, OneEnvironmentIsItsOwnTable) {
    const int shOrder = GetParam();
    const Environment a = testEnvironment(1);
    const NormalTable table =
        LiveLight({a, testEnvironment(2)}, shOrder, tablesOf(4)).lightCosineTable({1, 0}, 0);
    EXPECT_EQ(table.values, buildLightCosineTable(
                                projectEnvironment(a.view(), tableEnvironmentShOrder(shOrder)), shOrder, 4));
}

TEST_P(LiveLightOrders, BlendingIsLinear) {
    const int shOrder = GetParam();
    const LiveLight light({testEnvironment(1), testEnvironment(2), testEnvironment(3)}, shOrder, tablesOf(5));
    const NormalTable a = light.lightCosineTable({1, 0, 0}, 0.4), b = light.lightCosineTable({0, 1, 0}, 0.4),
                      c = light.lightCosineTable({0, 0, 1}, 0.4),
                      blend = light.lightCosineTable({0.7, 0.3, -1.5}, 0.4);
    NormalTable expected = a;
    for (size_t k = 0; k < expected.values.size(); ++k)
        expected.values[k] = float(0.7 * a.values[k] + 0.3 * b.values[k] - 1.5 * c.values[k]);
    EXPECT_LT(largestDifference(blend, expected), 1e-5);
    EXPECT_EQ(largest(light.lightCosineTable({0, 0, 0}, 0.4).values), 0.0);
}

TEST_P(LiveLightOrders, TurningRollsTheImage) {
    const int shOrder = GetParam(), width = 64;
    const Environment environment = testEnvironment(4, width);
    const LiveLight light({environment}, shOrder, tablesOf(5));
    const NormalTable still = light.lightCosineTable({1}, 0);
    for (const int columns : {1, 7, 16, -13, 32, 63}) {
        const NormalTable turned = light.lightCosineTable({1}, 2 * std::numbers::pi * columns / width);
        const NormalTable image =
            LiveLight({rolled(environment, columns)}, shOrder, tablesOf(5)).lightCosineTable({1}, 0);
        EXPECT_LT(largestDifference(turned, image), 1e-4) << columns << " columns";
        EXPECT_GT(largestDifference(turned, still), 1e-2) << columns << " columns";
    }
    EXPECT_LT(largestDifference(light.lightCosineTable({1}, 2 * std::numbers::pi), still), 1e-5);
}

TEST_P(LiveLightOrders, TripleProductIsTheSumOverTheBasis) {
    const int shOrder = GetParam(), n2 = shCount(shOrder), components = std::min(5, n2);
    const PcaMap pca = randomPca(shOrder, components);
    const LiveLight light({testEnvironment(1), testEnvironment(2)}, shOrder, tablesOf(4));
    const NormalTable cosine = light.lightCosineTable({0.2, 0.9}, -1);
    const NormalTable triple = light.tripleProductTable({0.2, 0.9}, -1, pca);
    for (int colour = 0; colour < 3; ++colour)
        for (int m = 0; m <= components; ++m)
            for (size_t t = 0; t < triple.texels(); ++t) {
                double expected = 0, magnitude = 0;
                for (int i = 0; i < n2; ++i) {
                    const float v = m < components ? pca.basis[size_t(m * n2 + i)] : pca.mean[size_t(i)];
                    expected += double(v) * double(cosine.layer(colour, i)[t]);
                    magnitude += std::abs(double(v) * double(cosine.layer(colour, i)[t]));
                }
                ASSERT_NEAR(triple.layer(colour, m)[t], expected, 3e-6 * magnitude);
            }
}

INSTANTIATE_TEST_SUITE_P(ShOrder, LiveLightOrders, testing::Range(1, 11));

TEST(LiveLight, AttributesSayWhatTheLightIs) {
    const LiveLight light({testEnvironment(1), testEnvironment(2), testEnvironment(3)}, 2, tablesOf(2));
    const NormalTable table = light.lightCosineTable({0.7, 0, 0.3}, std::numbers::pi / 2);
    EXPECT_EQ(table.attributes.at("environmentName"), "test1:0.7 + test3:0.3");
    EXPECT_EQ(table.attributes.at("environmentHash"), "hash1 hash3");
    EXPECT_EQ(table.attributes.at("rotationDeg"), "90");
}

TEST(LiveLightDeath, WeightsAndBasisMustFit) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const LiveLight light({testEnvironment(1)}, 2, tablesOf(2));
    EXPECT_DEATH(light.lightCosineTable({1, 1}, 0), "weights");
    EXPECT_DEATH(light.tripleProductTable({1}, 0, randomPca(3, 2)), "shOrder");
    EXPECT_DEATH(LiveLight({}, 2, tablesOf(2)), "environments");
}

TEST(LiveLight, OptionsReachTheTables) {
    const Environment environment = testEnvironment(1);
    TableOptions options;
    for (const std::string& layout : TableLayout::names()) {
        options.layout = layout;
        options.size = 6;
        const NormalTable exact = LiveLight({environment}, 3, options).lightCosineTable({1}, 0);
        EXPECT_EQ(exact.layout, layout);
        std::vector<Vec3f> normals;
        const TableLayout texels(layout, 6);
        for (int t = 0; t < texels.texelCount(); ++t) normals.push_back(texels.normal(t).cast<float>());
        EnvironmentSh light = projectEnvironment(environment.view(), tableEnvironmentShOrder(3));
        NormalTable expected = exact;
        expected.values = evalLightCosine(light, 3, normals);
        EXPECT_LT(largestDifference(exact, expected), 1e-5);

        options.variant = "paper";
        const NormalTable paper = LiveLight({environment}, 3, options).lightCosineTable({1}, 0);
        expected.values = evalLightCosine(light, 3, normals, 3);
        EXPECT_LT(largestDifference(paper, expected), 1e-5);
        EXPECT_GT(largestDifference(paper, exact), 1e-4);
        EXPECT_EQ(paper.attributes.at("cosineBands"), "3");
        options.variant = "exact";

        options.window = "hanning:5";
        const NormalTable windowed = LiveLight({environment}, 3, options).lightCosineTable({1}, 0);
        applyShWindow(ShWindow::Hanning, 5, light);
        expected.values = evalLightCosine(light, 3, normals);
        EXPECT_LT(largestDifference(windowed, expected), 1e-5);
        options.window = "none";
    }
}

}  // namespace
}  // namespace prt
