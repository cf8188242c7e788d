// Every technique against a slow evaluation of its formula on the CPU, with light made by LiveLight as a user
// has it.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "compress/irradiance_weights.h"
#include "compress/reduce_visibility.h"
#include "precompute/base/error.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_product.h"
#include "runtime/renderer.h"
#include "test_scenes.h"

namespace prt {
namespace {

using namespace test;

constexpr RenderOptions kSmall{48, 40, true};
constexpr int kOrder = 4;

Camera facing() {
    Camera camera;
    camera.eye = {1, 2, 3};
    return camera;
}

// A dark sky with a bright coloured patch.
Environment patchedSky() {
    Environment sky;
    sky.name = "patch";
    sky.image = {64, 32, 3, std::vector<float>(size_t(64 * 32 * 3), 0.2f)};
    for (int y = 6; y < 12; ++y)
        for (int x = 20; x < 30; ++x) {
            sky.image.at(x, y)[0] = 9;
            sky.image.at(x, y)[1] = 5;
            sky.image.at(x, y)[2] = 2;
        }
    return sky;
}

// ∫ (expansion·Y) L max(0, n·ω) dω: product of all bands, then so many bands of the cosine.
double convolved(std::span<const float> expansion, std::span<const float> light, int cosineBands,
                 const Vec3f& normal) {
    const std::vector<float> product = shProduct(expansion, light, cosineBands);
    std::vector<float> cosine(product.size());
    evalClampedCosineSh(cosineBands, normal, cosine);
    double sum = 0;
    for (size_t i = 0; i < product.size(); ++i) sum += double(product[i]) * double(cosine[i]);
    return sum;
}

class Techniques : public testing::TestWithParam<PointDomain> {
  protected:
    void SetUp() override {
        const PointGrid grid =
            GetParam() == PointDomain::Texel ? texelGrid(2, 2) : vertexGrid(scene_.vertexCount());
        // One value at all points: the lookup of points is tested elsewhere.
        std::vector<float> v = hemisphereSh(kOrder, Vec3f(0.6f, 0.64f, 0.48f));
        for (size_t i = 0; i < v.size(); ++i) v[i] += 0.02f * float(i % 5) - 0.04f;
        visibility_ = uniformVisibility(grid, kOrder, v);
        visibility_.ao.assign(grid.count, 0.37f);
        pca_ = reduceComponents(completePca(visibility_, 0.05f), visibility_.normals, 6);
    }
    // Largest |E − expected(normal, colour)| over the picture, as a share of the largest E.
    template <class Expected>
    double worst(Renderer& renderer, Technique technique, const Expected& expected) {
        const SurfaceImage surface = renderer.surface(facing(), kSmall);
        const RenderedFrame frame = renderer.render(facing(), technique, kSmall);
        double difference = 0, largest = 0;
        size_t compared = 0;
        for (size_t i = 0; i < surface.pixels(); i += 3) {
            if (surface.triangle[i] == kNoTriangle) continue;
            for (size_t c = 0; c < 3; ++c) {
                const double truth = expected(surface.shadingNormal[i], c);
                largest = std::max(largest, std::abs(truth));
                difference =
                    std::max(difference, std::abs(double(frame.irradiance.pixels[3 * i + c]) - truth));
            }
            ++compared;
        }
        EXPECT_GT(compared, 100u);
        return difference / largest;
    }
    std::vector<float> reconstruction() const {
        std::vector<float> v = pca_.mean;
        for (size_t m = 0; m < size_t(pca_.components); ++m)
            for (size_t i = 0; i < v.size(); ++i) v[i] += pca_.weights[m] * pca_.basis[m * v.size() + i];
        return v;
    }

    GlContext context_;
    Scene scene_ = sphere({0, 0, 0}, 1, 24);
    VisibilityMap visibility_;
    PcaMap pca_;
    std::vector<Environment> environments_ = {patchedSky()};
};

// Tables of 512 texels interpolate to 1e-4 (measured: 128, 256 and 512 texels give 9.5e-4, 3.3e-4 and less
// than 1e-4); what is computed at every pixel is exact to float.
TEST_P(Techniques, EqualTheirFormulas) {
    TableOptions options;
    options.size = 512;
    options.layout = "octahedral";
    const LiveLight live(environments_, kOrder, options);
    const std::vector<double> weights = {1.0};
    const double turn = 0.7;
    const EnvironmentSh light = live.blend(weights, turn);
    Renderer renderer(context_, scene_, &visibility_, &pca_);
    const Technique unc3{TechniqueKind::Unc, 3};
    const VisibilityMap three = reduceOrder(visibility_, 3), two = reduceOrder(visibility_, 2);
    renderer.add(unc3, three);
    renderer.add(Technique::Sh2, two);
    renderer.add(Technique::PreconvolvedAo, visibility_);
    renderer.add(Technique::PcaUniform, pca_);
    for (const Technique technique : {Technique::Unc, unc3, Technique::Pca, Technique::PcaUniform,
                                      Technique::Sh2, Technique::PreconvolvedAo})
        renderer.setLight(technique, live, weights, turn);

    const std::vector<float> v(visibility_.coefficients.begin(), visibility_.coefficients.begin() + 16);
    const auto table = [&](const std::vector<float>& expansion) {
        return [&, expansion](const Vec3f& n, size_t c) {
            return convolved(expansion, light.rgb[c], kTableCosineBands, n);
        };
    };
    EXPECT_LT(worst(renderer, Technique::Unc, table(v)), 1e-4);
    EXPECT_LT(worst(renderer, unc3, table({v.begin(), v.begin() + 9})), 1e-4);
    EXPECT_LT(worst(renderer, Technique::Pca, table(reconstruction())), 1e-4);
    EXPECT_LT(worst(renderer, Technique::PcaUniform, table(reconstruction())), 1e-5);
    EXPECT_LT(worst(renderer, Technique::Sh2,
                    [&](const Vec3f& n, size_t c) {
                        return convolved(std::span(v).first(4), std::span(light.rgb[c]).first(4), 3, n);
                    }),
              1e-5);
    EXPECT_LT(worst(renderer, Technique::PreconvolvedAo,
                    [&](const Vec3f& n, size_t c) {
                        const float open[] = {std::sqrt(4 * std::numbers::pi_v<float>)};
                        return 0.37 * convolved(open, light.rgb[c], light.shOrder, n);
                    }),
              1e-4);
}

// The table's bilinear error falls with the square of its size; between 16 and 64 texels at least by 6.
TEST_P(Techniques, UniformProductsEqualTables) {
    std::vector<double> differences;
    for (const int size : {16, 32, 64}) {
        TableOptions options;
        options.size = size;
        const LiveLight live(environments_, kOrder, options);
        Renderer renderer(context_, scene_, nullptr, &pca_);
        renderer.add(Technique::PcaUniform, pca_);
        for (const Technique technique : {Technique::Pca, Technique::PcaUniform})
            renderer.setLight(technique, live, {1.0}, 0);
        const FloatImage a = renderer.render(facing(), Technique::PcaUniform, kSmall).irradiance,
                         b = renderer.render(facing(), Technique::Pca, kSmall).irradiance;
        double error = 0, square = 0;
        for (size_t i = 0; i < a.pixels.size(); ++i) {
            error += std::pow(double(a.pixels[i]) - double(b.pixels[i]), 2);
            square += std::pow(double(a.pixels[i]), 2);
        }
        differences.push_back(std::sqrt(error / square));
    }
    EXPECT_GT(differences[0], differences[1]);
    EXPECT_LT(differences[1], 1.3e-3);
    EXPECT_LT(differences[2], differences[0] / 6);
}

TEST_P(Techniques, PaperVariantHasThreeBandsOfTheCosine) {
    TableOptions options;
    options.variant = "paper";
    const LiveLight live(environments_, kOrder, options);
    Renderer renderer(context_, scene_, nullptr, &pca_);
    renderer.add(Technique::PcaUniform, pca_);
    renderer.setLight(Technique::PcaUniform, live, {1.0}, 0);
    const EnvironmentSh light = live.blend({1.0}, 0);
    EXPECT_LT(
        worst(renderer, Technique::PcaUniform,
              [&](const Vec3f& n, size_t c) { return convolved(reconstruction(), light.rgb[c], 3, n); }),
        1e-5);
}

// Whatever the domain of the other data: weights per vertex are drawn per vertex.
TEST_P(Techniques, VertexPcaDrawsWeightsOfVertices) {
    const LiveLight live(environments_, kOrder, {});
    PcaMap vertices = pca_;
    vertices.grid = vertexGrid(scene_.vertexCount());
    vertices.weights.clear();
    for (size_t v = 0; v < vertices.grid.count; ++v)
        vertices.weights.insert(vertices.weights.end(), pca_.weights.begin(), pca_.weights.begin() + 6);
    Renderer renderer(context_, scene_, nullptr, &pca_);
    renderer.add(Technique::VertexPca, vertices);
    for (const Technique technique : {Technique::Pca, Technique::VertexPca})
        renderer.setLight(technique, live, {1.0}, 0);
    const FloatImage a = renderer.render(facing(), Technique::Pca, kSmall).irradiance,
                     b = renderer.render(facing(), Technique::VertexPca, kSmall).irradiance;
    for (size_t i = 0; i < a.pixels.size(); ++i) ASSERT_NEAR(a.pixels[i], b.pixels[i], 1e-4);
    // Shadows stay where the bundle's data are.
    SunLight sun{Vec3f(1, 1, 1).normalized(), {5, 5, 5}, {}};
    for (size_t i = 0; i < visibility_.grid.count; ++i) sun.shadow.push_back(i % 2 ? 1.0f : 0.0f);
    renderer.setSuns(std::span(&sun, 1), visibility_.grid);
    const FloatImage c = renderer.render(facing(), Technique::Pca, kSmall).irradiance,
                     d = renderer.render(facing(), Technique::VertexPca, kSmall).irradiance;
    EXPECT_NE(a.pixels, c.pixels);
    for (size_t i = 0; i < c.pixels.size(); ++i) ASSERT_NEAR(c.pixels[i], d.pixels[i], 1e-4);
    EXPECT_GT(*std::ranges::max_element(a.pixels), 0.1f);
}

TEST_P(Techniques, LightmapIsWhatItsCoefficientsSay) {
    Lightmap map;
    map.grid = visibility_.grid;
    const auto fill = [&](float seed) {
        map.coefficients.clear();
        for (size_t i = 0; i < map.grid.count * 27; ++i)
            map.coefficients.push_back(std::sin(seed * float(i % 27)));
    };
    const auto irradiance = [&](const Vec3f& n, size_t c) {
        std::vector<float> cosine(9);
        evalClampedCosineSh(3, n, cosine);
        double sum = 0;
        for (size_t i = 0; i < 9; ++i) sum += double(map.coefficients[9 * c + i]) * double(cosine[i]);
        return sum;
    };
    Renderer renderer(context_, scene_, nullptr, nullptr);
    EXPECT_THROW(renderer.render(facing(), Technique::ShLightmap, kSmall), InputError);
    fill(1.3f);
    renderer.add(Technique::ShLightmap, map);
    EXPECT_EQ(renderer.lightRevision(Technique::ShLightmap), 1u);
    EXPECT_LT(worst(renderer, Technique::ShLightmap, irradiance), 1e-6);
    // Another light; a sun, which is in the lightmap already, does not come twice.
    fill(2.1f);
    renderer.add(Technique::ShLightmap, map);
    EXPECT_EQ(renderer.lightRevision(Technique::ShLightmap), 2u);
    const SunLight sun{Vec3f::UnitY(), {5, 5, 5}, std::vector<float>(map.grid.count, 1.0f)};
    renderer.setSuns(std::span(&sun, 1), map.grid);
    EXPECT_LT(worst(renderer, Technique::ShLightmap, irradiance), 1e-6);
    EXPECT_THROW(renderer.setLight(Technique::ShLightmap, LiveLight(environments_, kOrder, {}), {1.0}, 0),
                 InputError);
}

INSTANTIATE_TEST_SUITE_P(Domains, Techniques, testing::Values(PointDomain::Texel, PointDomain::Vertex),
                         [](const auto& domain) { return std::string(pointDomainName(domain.param)); });

TEST(TechniqueErrors, WhatWasNotAddedOrDoesNotFit) {
    GlContext context;
    const Scene scene = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const VisibilityMap visibility = noisyVisibility(texelGrid(4, 4), 4, 1);
    Renderer renderer(context, scene, &visibility, nullptr);
    const LiveLight live({patchedSky()}, 4, {});
    EXPECT_THROW(renderer.setLight(Technique::Sh2, live, {1.0}, 0), InputError);
    EXPECT_THROW(renderer.add(Technique{TechniqueKind::Unc, 3}, visibility), InputError);
    EXPECT_THROW(renderer.add(Technique::Sh2, visibility), InputError);
    renderer.add(Technique::PreconvolvedAo, visibility);
    EXPECT_THROW(renderer.render({}, Technique::PreconvolvedAo, kSmall), InputError);
    EXPECT_THROW(renderer.setTable(Technique::PreconvolvedAo,
                                   lightCosineTable([](const Vec3d&) { return Vec3f(1, 1, 1); }, 4, 8)),
                 InputError);
    // 100 vectors and 69 functions are more uniforms than anything takes.
    const PcaMap complete = completePca(noisyVisibility(texelGrid(2, 2), 10, 1), 0);
    renderer.add(Technique::PcaUniform, complete);
    const LiveLight tenBands({patchedSky()}, 10, {});
    EXPECT_THROW(renderer.setLight(Technique::PcaUniform, tenBands, {1.0}, 0), InputError);
}

// A fit is a projection: by way of ten vectors, or from the rows themselves, six get the same weights.
// Rounding of float in systems of condition 1e4 leaves 1e-3.
TEST(Reduction, WeightsAreThoseOfAFitOfTheRows) {
    VisibilityMap visibility = noisyVisibility(texelGrid(8, 8), kOrder, 3);
    for (size_t i = 0; i < visibility.normals.size(); ++i)
        visibility.normals[i] = Vec3f(float(i % 8) - 3.5f, 2, float(i / 8) - 3.5f).normalized();
    PcaMap all = completePca(visibility, 0.1f);
    all.attributes["weightsFit"] = "irradiance";
    PcaResult six;
    six.components = 6;
    six.mean = all.mean;
    six.basis.assign(all.basis.begin(), all.basis.begin() + 6 * 16);
    const std::vector<float> expected =
        projectPcaForIrradiance(six, visibility.coefficients, visibility.normals, kOrder);
    const PcaMap ten = reduceComponents(all, visibility.normals, 10),
                 byTen = reduceComponents(ten, visibility.normals, 6);
    ASSERT_EQ(byTen.weights.size(), expected.size());
    double worst = 0, leading = 0;
    for (size_t i = 0; i < expected.size(); ++i) {
        worst = std::max(worst, std::abs(double(byTen.weights[i]) - double(expected[i])));
        leading = std::max(leading, std::abs(double(all.weights[i / 6 * 16 + i % 6]) - double(expected[i])));
    }
    EXPECT_LT(worst, 1e-3);
    EXPECT_GT(leading, 0.1);
    all.attributes["weightsFit"] = "guessed";
    EXPECT_THROW(reduceComponents(all, visibility.normals, 6), InputError);
    all.attributes["weightsFit"] = "plain";
    EXPECT_EQ(reduceComponents(all, visibility.normals, 6).weights[7], all.weights[16 + 1]);
}

TEST(TechniqueNames, AreReadBack) {
    for (const Technique technique : listedTechniques()) {
        EXPECT_EQ(techniqueFromName(techniqueName(technique)), technique);
        EXPECT_FALSE(techniqueSummary(technique).empty());
    }
    EXPECT_EQ(techniqueFromName("pca100"), (Technique{TechniqueKind::Pca, 100}));
    EXPECT_EQ(techniqueFromName("vertex-pca7"), (Technique{TechniqueKind::VertexPca, 7}));
    for (const char* name :
         {"", "unc0", "unc03", "unc11", "pca101", "pca-uniform4", "sh3", "Unc", "unc6 ", "pca-4"})
        EXPECT_FALSE(techniqueFromName(name)) << name;
}

TEST(TechniqueNames, NeedsAndCosts) {
    const TechniqueSource all{6, 6, 16}, bare{4, 0, 0};
    EXPECT_TRUE(canDraw({TechniqueKind::Unc, 6}, all));
    EXPECT_FALSE(canDraw({TechniqueKind::Unc, 6}, bare));
    EXPECT_FALSE(canDraw({TechniqueKind::Pca, 20}, all));
    EXPECT_FALSE(canDraw(Technique::PcaUniform, bare));
    EXPECT_TRUE(canDraw(Technique::Sh2, bare));
    EXPECT_FALSE(canDraw(Technique::Sh2, {1, 0, 0}));
    EXPECT_FALSE(canDraw(Technique::ShLightmap, all));
    EXPECT_TRUE(canDraw(Technique::ShLightmap, {6, 6, 16, true}));
    // The paper's 9 + 27 fetches.
    EXPECT_EQ(techniqueCost({TechniqueKind::Unc, 6}, all, PointDomain::Texel, 12).fetches, 36);
    EXPECT_EQ(techniqueCost(Technique::Pca, all, PointDomain::Texel, 12).fetches, 17);
    EXPECT_EQ(techniqueCost(Technique::Pca, all, PointDomain::Vertex, 12).fetches, 25);
    EXPECT_EQ(techniqueCost({TechniqueKind::VertexPca, 8}, all, PointDomain::Texel, 12).fetches, 13);
    EXPECT_FALSE(canDraw({TechniqueKind::VertexPca, 20}, all));
    EXPECT_EQ(techniqueCost(Technique::PcaUniform, all, PointDomain::Texel, 12).uniforms, 69 * 17);
    EXPECT_EQ(techniqueCost(Technique::ShLightmap, all, PointDomain::Texel, 12).fetches, 7);
    EXPECT_EQ(techniqueCost(Technique::Sh2, all, PointDomain::Texel, 12).fetches, 1);
    EXPECT_EQ(techniqueCost(Technique::PreconvolvedAo, all, PointDomain::Texel, 12).fetches, 2);
    EXPECT_EQ(cosineFunctionCount(3), 9);
}

}  // namespace
}  // namespace prt
