// The builder for live light against the straightforward functions, at every layout's normals.
#include "compress/tables/fast_tables.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "tests/compress/table_lights.h"
#include "tests/math/allocation_counter.h"

namespace prt {
namespace {

std::vector<Vec3f> texelNormals(const TableLayout& layout) {
    std::vector<Vec3f> normals;
    for (int texel = 0; texel < layout.texelCount(); ++texel)
        normals.push_back(layout.normal(texel).cast<float>());
    return normals;
}

/// Largest difference, relative to the reference's largest value.
double difference(std::span<const float> values, std::span<const float> reference) {
    EXPECT_EQ(values.size(), reference.size());
    double result = 0;
    for (size_t k = 0; k < values.size(); ++k)
        result = std::max(result, std::abs(double(values[k]) - double(reference[k])));
    return result / largest(reference);
}

/// Σ_i R_i basis_mi in double, the mean last.
std::vector<float> tripleReference(std::span<const float> lightCosine, size_t texels,
                                   std::span<const float> mean, std::span<const float> basis) {
    const size_t n2 = mean.size(), components = basis.size() / n2;
    std::vector<float> result;
    for (size_t colour = 0; colour < 3; ++colour)
        for (size_t m = 0; m <= components; ++m)
            for (size_t t = 0; t < texels; ++t) {
                double sum = 0;
                for (size_t i = 0; i < n2; ++i)
                    sum += double(m < components ? basis[m * n2 + i] : mean[i]) *
                           double(lightCosine[(colour * n2 + i) * texels + t]);
                result.push_back(float(sum));
            }
    return result;
}

std::vector<float> randomVectors(size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    std::vector<float> values(count);
    for (float& value : values) value = normal(random);
    return values;
}

class BuilderLayouts : public testing::TestWithParam<std::string> {};

// Sizes whose octants end within a vector, a block and beside the middle; 1e-5 is what the interface
// promises.
TEST_P(BuilderLayouts, EqualsTheStraightforwardTables) {
    double worst = 0;
    for (const int size : {1, 2, 3, 4, 7, 8, 16, 31, 32, 40}) {
        if (size < TableLayout::minSize(GetParam())) continue;
        const TableLayout layout(GetParam(), size);
        const std::vector<Vec3f> normals = texelNormals(layout);
        for (const int cosineBands : {1, 2, kPaperCosineBands, 5, kTableCosineBands}) {
            for (const int shOrder : {1, 3, 6}) {
                LightTableBuilder builder(layout, shOrder, cosineBands);
                const EnvironmentSh light =
                    randomLight(builder.environmentShOrder(), builder.environmentShOrder(), unsigned(size));
                const std::vector<float> expected = evalLightCosine(light, shOrder, normals, cosineBands);
                std::vector<float> table(expected.size(), -1e9f);
                builder.buildLightCosine(light, table);
                const double error = difference(table, expected);
                ASSERT_LT(error, 1e-5) << size << " texels, " << shOrder << " bands, cosine " << cosineBands;
                worst = std::max(worst, error);
            }
        }
    }
    std::printf("%s: largest difference %.1e of the table's maximum\n", GetParam().c_str(), worst);
}

TEST_P(BuilderLayouts, EveryOrderOfABundle) {
    const TableLayout layout(GetParam(), 6);
    const std::vector<Vec3f> normals = texelNormals(layout);
    for (int shOrder = 1; shOrder <= kMaxBundleShOrder; ++shOrder) {
        const int bands = std::min(13, kMaxShOrder + 1 - shOrder);
        LightTableBuilder builder(layout, shOrder, bands);
        const EnvironmentSh light = randomLight(kMaxShOrder, kMaxShOrder, 5);
        const std::vector<float> expected = evalLightCosine(light, shOrder, normals, bands);
        std::vector<float> table(expected.size());
        builder.buildLightCosine(light, table);
        EXPECT_LT(difference(table, expected), 1e-5) << shOrder;
    }
}

TEST_P(BuilderLayouts, TripleProductsOfNoneToAllVectors) {
    const int shOrder = 4;
    const size_t n2 = 16;
    const TableLayout layout(GetParam(), 9);
    const std::vector<Vec3f> normals = texelNormals(layout);
    for (const int cosineBands : {kPaperCosineBands, kTableCosineBands}) {
        LightTableBuilder builder(layout, shOrder, cosineBands);
        const EnvironmentSh light = randomLight(builder.environmentShOrder(), 20, 6);
        const std::vector<float> lightCosine = evalLightCosine(light, shOrder, normals, cosineBands);
        for (const size_t components : {size_t(0), size_t(1), size_t(12), n2}) {
            const std::vector<float> mean = randomVectors(n2, 7), basis = randomVectors(n2 * components, 8);
            std::vector<float> table(3 * (components + 1) * normals.size());
            builder.buildTripleProduct(light, mean, basis, table);
            EXPECT_LT(difference(table, tripleReference(lightCosine, normals.size(), mean, basis)), 1e-5)
                << components;
        }
    }
}
INSTANTIATE_TEST_SUITE_P(All, BuilderLayouts, testing::ValuesIn(TableLayout::names()), layoutTestName);

TEST(LightTableBuilder, LightAfterLight) {
    // Nothing is left of the light before.
    const TableLayout layout("cube", 16);
    const std::vector<Vec3f> normals = texelNormals(layout);
    LightTableBuilder builder(layout, 6);
    std::vector<float> table(3 * 36 * builder.texelCount());
    for (const double sun : {300.0, 0.0, 3000.0}) {
        const EnvironmentSh light = skyLight(builder.environmentShOrder(), sun);
        builder.buildLightCosine(light, table);
        EXPECT_LT(difference(table, evalLightCosine(light, 6, normals)), 1e-5) << sun;
    }
}

TEST(LightTableBuilder, LightBeyondItsBandsChangesNothing) {
    LightTableBuilder builder(TableLayout("cube", 4), 3);
    const EnvironmentSh wide = randomLight(kMaxShOrder, kMaxShOrder, 5);
    EnvironmentSh narrow = wide;
    narrow.shOrder = builder.environmentShOrder();
    for (std::vector<float>& colour : narrow.rgb) colour.resize(size_t(shCount(narrow.shOrder)));
    std::vector<float> fromWide(27 * 96), fromNarrow(27 * 96);
    builder.buildLightCosine(wide, fromWide);
    builder.buildLightCosine(narrow, fromNarrow);
    EXPECT_EQ(fromWide, fromNarrow);
}

TEST(LightTableBuilder, AllocatesNothing) {
    LightTableBuilder builder(TableLayout("cube", 8), 6);
    const EnvironmentSh light = randomLight(builder.environmentShOrder(), builder.environmentShOrder(), 9);
    const std::vector<float> mean = randomVectors(36, 10), basis = randomVectors(36 * 16, 11);
    std::vector<float> lightCosine(108 * 384), triple(51 * 384);
    EXPECT_EQ(test::allocationsOf([&] {
                  builder.buildLightCosine(light, lightCosine);
                  builder.buildTripleProduct(light, mean, basis, triple);
              }),
              0u);
}

TEST(LightTableBuilderDeath, WrongShapes) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const TableLayout layout("cube", 2);
    EXPECT_DEATH(LightTableBuilder(layout, 0), "shOrder");
    EXPECT_DEATH(LightTableBuilder(layout, 14), "shOrder");
    EXPECT_DEATH(LightTableBuilder(layout, 3, 0), "cosineBands");
    EXPECT_DEATH(LightTableBuilder(layout, 3, 23), "cosineBands");
    LightTableBuilder builder(layout, 2);
    std::vector<float> out(12 * 24), few(12 * 24 - 1);
    EXPECT_DEATH(builder.buildLightCosine(basisLight(0, 12), out), "environment");
    EXPECT_DEATH(builder.buildLightCosine(basisLight(0, 13), few), "out");
    const std::vector<float> vectors(4 * 5);
    const std::span<const float> mean(vectors.data(), 4), all(vectors);
    EXPECT_DEATH(builder.buildTripleProduct(basisLight(0, 13), mean, all, out), "components");
}

}  // namespace
}  // namespace prt
