// Light that changes while drawing: only what changed is sent to OpenGL, and tables blended there are those
// that are blended here.
#include <cmath>
#include <numbers>

#include "context_scene.h"
#include "precompute/base/error.h"
#include "runtime/gl_functions.h"
#include "runtime/table_blender.h"

namespace prt {
namespace {

using namespace test;

constexpr int kOrder = 3;
constexpr Technique kWithTable[] = {Technique::Unc, Technique::Pca, Technique::PreconvolvedAo};

std::vector<Environment> skies(int count) {
    std::vector<Environment> list;
    for (int i = 0; i < count; ++i) list.push_back(patchSky(i));
    return list;
}

/// A sphere over a floor with every technique that needs no lightmap.
struct Stage {
    GlContext context;
    Scene scene = sphere({0, 0, 0}, 1, 8);
    VisibilityMap visibility = noisyVisibility(texelGrid(8, 8), kOrder, 5);
    PcaMap pca = completePca(visibility, 0.2f);
    Renderer renderer{context, scene, &visibility, &pca};
    Stage() {
        renderer.add(Technique::Sh2, noisyVisibility(texelGrid(8, 8), 2, 6));
        renderer.add(Technique::PcaUniform, pca);
        renderer.add(Technique::PreconvolvedAo, visibility);
    }
    FloatImage irradiance(Technique technique) {
        Camera camera;
        camera.eye = {1, 2, 3};
        return renderer.render(camera, technique, {48, 40, true}).irradiance;
    }
};

TEST(LiveUploads, SameLightIsNotSentAgain) {
    Stage stage;
    Renderer& renderer = stage.renderer;
    const LiveLight light(skies(2), kOrder, {}), other(skies(2), kOrder, {});
    for (const Technique technique :
         {Technique::Unc, Technique::Pca, Technique::PreconvolvedAo, Technique::Sh2, Technique::PcaUniform}) {
        const uint64_t perChange = technique == Technique::Sh2 || technique == Technique::PcaUniform ? 0 : 1;
        const auto sent = [&](const LiveLight& from, const std::vector<double>& weights, double turn) {
            const uint64_t uploads = renderer.uploads(), revision = renderer.lightRevision(technique);
            renderer.setLight(technique, from, weights, turn);
            const uint64_t changes = renderer.lightRevision(technique) - revision;
            EXPECT_EQ(renderer.uploads() - uploads, changes * perChange);
            return changes;
        };
        EXPECT_EQ(sent(light, {1, 0.5}, 0), 1u);
        EXPECT_EQ(sent(light, {1, 0.5}, 0), 0u);
        EXPECT_EQ(sent(light, {1, 0.25}, 0), 1u);
        EXPECT_EQ(sent(light, {1, 0.25}, 0.5), 1u);
        EXPECT_EQ(sent(LiveLight(light), {1, 0.25}, 0.5), 0u);  // a copy
        EXPECT_EQ(sent(other, {1, 0.25}, 0.5), 1u);
    }
    // What was replaced since is sent again.
    renderer.setTable(Technique::Unc, other.lightCosineTable({1, 1}, 0));
    const uint64_t uploads = renderer.uploads();
    renderer.setLight(Technique::Unc, other, {1, 0.25}, 0.5);
    EXPECT_EQ(renderer.uploads(), uploads + 1);
    renderer.add(Technique::Unc, stage.visibility);
    renderer.setLight(Technique::Unc, other, {1, 0.25}, 0.5);
    EXPECT_EQ(renderer.uploads(), uploads + 2);
}

TEST(LiveUploads, AfterAnErrorItIsTriedAgain) {
    Stage stage;
    const LiveLight light(skies(1), kOrder, {});
    stage.renderer.setLight(Technique::Unc, light, {1}, 0);
    const uint64_t revision = stage.renderer.lightRevision(Technique::Unc);
    const PcaMap many = completePca(noisyVisibility(texelGrid(2, 2), 10, 1), 0);
    stage.renderer.add(Technique::PcaUniform, many);
    const LiveLight tenBands(skies(1), 10, {});
    EXPECT_THROW(stage.renderer.setLight(Technique::PcaUniform, tenBands, {1}, 0), InputError);
    EXPECT_THROW(stage.renderer.setLight(Technique::PcaUniform, tenBands, {1}, 0), InputError);
    stage.renderer.setLight(Technique::Unc, light, {1}, 0);
    EXPECT_EQ(stage.renderer.lightRevision(Technique::Unc), revision);
}

TEST(LiveUploads, SameBackgroundAndShadowsAreNotSentAgain) {
    Stage stage;
    Renderer& renderer = stage.renderer;
    const FloatImage first = patchSky(0).image, second = patchSky(1).image;
    const PointGrid grid = texelGrid(8, 8);
    SunLight sun{Vec3f::UnitY(), Vec3f::Ones(), std::vector<float>(grid.count, 0.5f)};
    const auto sent = [&](auto&& change) {
        const uint64_t before = renderer.uploads();
        change();
        return renderer.uploads() - before;
    };
    EXPECT_EQ(sent([&] { renderer.setBackground(first, 0); }), 1u);
    EXPECT_EQ(sent([&] { renderer.setBackground(first, 1); }), 0u);
    EXPECT_EQ(sent([&] { renderer.setBackground(second, 1); }), 1u);
    EXPECT_EQ(sent([&] { renderer.setSuns({&sun, 1}, grid); }), 1u);
    sun.irradiance *= 2;
    sun.direction = Vec3f::UnitX();
    EXPECT_EQ(sent([&] { renderer.setSuns({&sun, 1}, grid); }), 0u);
    EXPECT_EQ(sent([&] { renderer.setSuns({}, grid); }), 0u);
    EXPECT_EQ(sent([&] { renderer.setSuns({&sun, 1}, grid); }), 0u);
    sun.shadow[7] = 1;
    EXPECT_EQ(sent([&] { renderer.setSuns({&sun, 1}, grid); }), 1u);
}

// Weights of a turned background that was not sent again are drawn with its new rotation.
TEST(LiveUploads, BackgroundTurnsWithoutBeingSent) {
    Stage stage, fresh;
    const LiveLight light(skies(1), kOrder, {});
    const Camera camera{.eye = {1, 2, 3}};
    FloatImage images[2];
    for (Stage* each : {&stage, &fresh}) {
        each->renderer.setLight(Technique::Unc, light, {1}, 0);
        if (each == &stage) each->renderer.setBackground(patchSky(0).image, 0);
        each->renderer.setBackground(patchSky(0).image, 2);
        images[each == &fresh] = each->renderer.render(camera, Technique::Unc, {48, 40, true}).radiance;
    }
    EXPECT_EQ(images[0].pixels, images[1].pixels);
}

double largestOf(const FloatImage& image) {
    double largest = 0;
    for (const float v : image.pixels) largest = std::max(largest, std::abs(double(v)));
    return largest;
}

void expectSame(const FloatImage& a, const FloatImage& b, double relative) {
    const double size = largestOf(a);
    EXPECT_GT(size, 0.1);
    for (size_t i = 0; i < a.pixels.size(); ++i) ASSERT_NEAR(a.pixels[i], b.pixels[i], relative * size) << i;
}

class GpuBlend : public testing::TestWithParam<const char*> {
  protected:
    TableOptions options() const {
        TableOptions result;
        result.layout = GetParam();
        result.size = 8;
        return result;
    }
};

TEST_P(GpuBlend, IsTheCpuBlend) {
    Stage cpu, gpu;
    const LiveLight light(skies(4), kOrder, options());
    // Two of four; another two; all, turned; one alone; darker than nothing; black.
    const std::pair<std::vector<double>, double> steps[] = {
        {{0.7, 0, 0.3, 0}, 0}, {{0, 0.2, 0.3, 0}, 0},        {{0.1, 0.2, 0.3, 0.4}, 1.1},
        {{0, 1, 0, 0}, 1.1},   {{1.5, -0.25, 0, 0.5}, -0.4}, {{0, 0, 0, 0}, -0.4}};
    for (const auto& [weights, turn] : steps)
        for (const Technique technique : kWithTable) {
            cpu.renderer.setLight(technique, light, weights, turn, BlendOn::Cpu);
            gpu.renderer.setLight(technique, light, weights, turn, BlendOn::Gpu);
            const FloatImage expected = cpu.irradiance(technique), blended = gpu.irradiance(technique);
            if (largestOf(expected) == 0)
                EXPECT_EQ(largestOf(blended), 0);
            else
                expectSame(expected, blended, 1e-5);
        }
}
INSTANTIATE_TEST_SUITE_P(Layouts, GpuBlend, testing::Values("cube", "dual-paraboloid", "octahedral"),
                         [](const auto& layout) {
                             std::string name = layout.param;
                             std::erase(name, '-');
                             return name;
                         });

TEST(GpuBlending, SendsEachEnvironmentOnce) {
    Stage stage;
    Renderer& renderer = stage.renderer;
    const LiveLight light(skies(3), kOrder, {});
    const auto sent = [&](const std::vector<double>& weights, double turn) {
        const uint64_t before = renderer.uploads();
        renderer.setLight(Technique::Pca, light, weights, turn, BlendOn::Gpu);
        return renderer.uploads() - before;
    };
    EXPECT_EQ(sent({1, 0, 0}, 0), 1u);
    EXPECT_EQ(sent({0.5, 0.5, 0}, 0), 1u);
    EXPECT_EQ(sent({0.25, 0.75, 0}, 0), 0u);
    EXPECT_EQ(sent({0, 1, 0}, 0), 0u);
    EXPECT_EQ(sent({0, 0, 1}, 0), 1u);
    EXPECT_EQ(sent({1, 0, 0}, 0), 0u);
    EXPECT_EQ(sent({0.5, 0.5, 0}, 0.3), 2u);  // turned
    EXPECT_EQ(sent({0.5, 0.5, 0}, 0.3), 0u);
}

TEST(GpuBlending, TakesTurnsWithTheCpu) {
    Stage stage;
    const LiveLight light(skies(2), kOrder, {});
    stage.renderer.setLight(Technique::Unc, light, {0.5, 0.5}, 0, BlendOn::Gpu);
    const FloatImage gpu = stage.irradiance(Technique::Unc);
    stage.renderer.setLight(Technique::Unc, light, {1, 0}, 0, BlendOn::Cpu);
    const FloatImage cpu = stage.irradiance(Technique::Unc);
    stage.renderer.setLight(Technique::Unc, light, {0.5, 0.5}, 0, BlendOn::Gpu);
    EXPECT_EQ(stage.irradiance(Technique::Unc).pixels, gpu.pixels);
    stage.renderer.setLight(Technique::Unc, light, {1, 0}, 0, BlendOn::Cpu);
    EXPECT_EQ(stage.irradiance(Technique::Unc).pixels, cpu.pixels);
}

std::vector<float> texels(const GlContext& context, const TableImage& image) {
    std::vector<float> rgba(size_t(image.shape.width) * size_t(image.shape.height) *
                            size_t(image.shape.images) * 4);
    context.gl().GetTextureImage(image.texture.name(), 0, GL_RGBA, GL_FLOAT, GLsizei(rgba.size() * 4),
                                 rgba.data());
    return rgba;
}

// More sources than one pass takes, and every number of them below.
TEST(GpuBlending, OfAnyNumberOfTables) {
    const GlContext context;
    TableBlender blender(context);
    std::vector<TableImage> tables(35);
    std::vector<std::vector<float>> values;
    for (size_t i = 0; i < tables.size(); ++i) {
        uploadTable(context, noisyTable(TableKind::TripleProduct, 2, 6, 4, unsigned(i)), tables[i]);
        values.push_back(texels(context, tables[i]));
    }
    for (const size_t count : {1, 2, 3, 5, 8, 15, 16, 17, 35}) {
        std::vector<const TableImage*> sources;
        std::vector<float> weights;
        for (size_t i = 0; i < count; ++i) {
            sources.push_back(&tables[i]);
            weights.push_back(float(i % 7) - 2.5f);
        }
        TableImage result;
        blender.blend(sources, weights, result);
        const std::vector<float> blended = texels(context, result);
        ASSERT_EQ(blended.size(), values[0].size());
        for (size_t t = 0; t < blended.size(); ++t) {
            double sum = 0, size = 0;
            for (size_t i = 0; i < count; ++i) {
                sum += double(weights[i]) * double(values[i][t]);
                size += std::abs(double(weights[i]) * double(values[i][t]));
            }
            ASSERT_NEAR(blended[t], sum, 1e-6 * (size + 1e-30)) << count << " " << t;
        }
    }
}

}  // namespace
}  // namespace prt
