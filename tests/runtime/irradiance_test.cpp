// Whole frames against closed forms and against each other.
#include <cmath>
#include <numbers>

#include "precompute/base/error.h"
#include "precompute/math/sh.h"
#include "runtime/renderer.h"
#include "test_scenes.h"

namespace prt {
namespace {

using namespace test;
using std::numbers::pi;

Vec3f uniformLight(const Vec3d&) { return {1, 1, 1}; }
Vec3f colouredLight(const Vec3d& d) {
    return {float(1 + d.x()), float(0.5 + 0.5 * d.y() * d.y()), float(1 - d.z() + d.x() * d.y())};
}
Vec3f otherLight(const Vec3d& d) { return {float(d.z() * d.z()), 2.0f, float(1 + d.y())}; }

Camera facing() {
    Camera camera;
    camera.eye = {0, 0, 3};
    return camera;
}
constexpr RenderOptions kSmall{64, 48, true};

PointGrid gridFor(PointDomain domain, const Scene& scene) {
    return domain == PointDomain::Texel ? texelGrid(8, 8) : vertexGrid(scene.vertexCount());
}

// Relative RMS difference of two images, and that there is something in the first.
double difference(const FloatImage& a, const FloatImage& b) {
    double error = 0, size = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) {
        error += std::pow(double(a.pixels[i]) - double(b.pixels[i]), 2);
        size += std::pow(double(a.pixels[i]), 2);
    }
    EXPECT_GT(size, 0);
    return std::sqrt(error / size);
}

class Irradiance : public testing::TestWithParam<PointDomain> {};

// A half-space has only odd bands beyond the constant, the cosine only even ones beyond the first: their
// product ends with band 1, so that order 2 and up are exact for every tilt of the normal: E = (π/2)(1 + cos
// δ).
TEST_P(Irradiance, HalfSpaceUnderUniformLight) {
    GlContext context;
    for (const int shOrder : {2, 4, 6}) {
        for (const double tiltDeg : {0.0, 20.0, 35.0}) {
            const double tilt = tiltDeg * pi / 180;
            Scene scene = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
            for (Vec3f& normal : scene.normals)
                normal = Vec3f(float(std::sin(tilt)), 0, float(std::cos(tilt)));
            const PointGrid grid = gridFor(GetParam(), scene);
            const VisibilityMap visibility =
                uniformVisibility(grid, shOrder, hemisphereSh(shOrder, {0, 0, 1}));
            const PcaMap pca = completePca(visibility, 0.1f);
            Renderer renderer(context, scene, &visibility, &pca);
            const NormalTable table = lightCosineTable(uniformLight, shOrder, 32);
            renderer.setTable(table);
            renderer.setTable(tripleProductTable(table, pca));
            // Tables of 32 texels interpolate the normal over 1/32 of a face: second-order error about 5e-4.
            const double truth = pi / 2 * (1 + std::cos(tilt));
            for (const Technique technique : {Technique::Unc, Technique::Pca}) {
                const RenderedFrame frame = renderer.render(facing(), technique, kSmall);
                const float* middle = frame.irradiance.at(32, 24);
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(middle[c] / truth, 1, 1e-3) << shOrder << " " << tiltDeg;
                EXPECT_NEAR(frame.radiance.at(32, 24)[0], middle[0] / pi, 1e-6);
            }
        }
    }
}

// Suns add their irradiance × cosine × shadow to every technique, and go away again.
TEST_P(Irradiance, SunsAddTheirLight) {
    GlContext context;
    Scene scene = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const PointGrid grid = gridFor(GetParam(), scene);
    const VisibilityMap visibility = uniformVisibility(grid, 2, hemisphereSh(2, {0, 0, 1}));
    const PcaMap pca = completePca(visibility, 0.1f);
    Renderer renderer(context, scene, &visibility, &pca);
    const NormalTable table = lightCosineTable(uniformLight, 2, 16);
    renderer.setTable(table);
    renderer.setTable(tripleProductTable(table, pca));
    std::vector<SunLight> suns;
    Vec3f expected = Vec3f::Zero();
    for (int k = 0; k < kMostSuns; ++k) {
        SunLight sun;
        sun.direction = Vec3f(float(k) - 3.5f, 1, k == 6 ? -1.0f : 2.0f).normalized();
        sun.irradiance = Vec3f(1, 0.5f, 0.25f) * float(k + 1);
        sun.shadow.assign(grid.count, float(k) / 8);
        expected += sun.irradiance * std::max(0.0f, sun.direction.z()) * (float(k) / 8);
        suns.push_back(sun);
    }
    for (const Technique technique : {Technique::Unc, Technique::Pca}) {
        renderer.setSuns({}, grid);
        const RenderedFrame without = renderer.render(facing(), technique, kSmall);
        renderer.setSuns(suns, grid);
        const RenderedFrame with = renderer.render(facing(), technique, kSmall);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(with.irradiance.at(32, 24)[c] - without.irradiance.at(32, 24)[c], expected[c],
                        1e-5f * expected[c]);
        renderer.setSuns({}, grid);
        EXPECT_EQ(renderer.render(facing(), technique, kSmall).irradiance.pixels, without.irradiance.pixels);
    }
    suns.resize(size_t(kMostSuns) + 1, suns[0]);
    EXPECT_THROW(renderer.setSuns(suns, grid), InputError);
}

TEST_P(Irradiance, CompletePcaEqualsUncompressed) {
    GlContext context;
    Scene scene = sphere({0, 0, 0}, 1, 30);
    append(scene, quad({0, -1, 0}, {2, 0, 0}, {0, 0, -2}));
    const VisibilityMap visibility = noisyVisibility(gridFor(GetParam(), scene), 6, 3);
    const PcaMap pca = completePca(visibility, 0.3f);
    Renderer renderer(context, scene, &visibility, &pca);
    const NormalTable table = lightCosineTable(colouredLight, 6, 16);
    renderer.setTable(table);
    renderer.setTable(tripleProductTable(table, pca));
    const RenderedFrame unc = renderer.render(facing(), Technique::Unc, kSmall);
    const RenderedFrame all = renderer.render(facing(), Technique::Pca, kSmall);
    EXPECT_LT(difference(unc.irradiance, all.irradiance), 1e-5);
    EXPECT_LT(difference(unc.radiance, all.radiance), 1e-5);
}

TEST_P(Irradiance, IsLinearInTheTable) {
    GlContext context;
    const Scene scene = sphere({0, 0, 0}, 1, 30);
    const VisibilityMap visibility = noisyVisibility(gridFor(GetParam(), scene), 4, 4);
    Renderer renderer(context, scene, &visibility, nullptr);
    const NormalTable a = lightCosineTable(colouredLight, 4, 8), b = lightCosineTable(otherLight, 4, 8);
    NormalTable sum = a;
    for (size_t i = 0; i < sum.values.size(); ++i) sum.values[i] = 0.7f * a.values[i] + 0.3f * b.values[i];
    renderer.setTable(a);
    FloatImage combined = renderer.render(facing(), Technique::Unc, kSmall).irradiance;
    renderer.setTable(b);
    const FloatImage second = renderer.render(facing(), Technique::Unc, kSmall).irradiance;
    for (size_t i = 0; i < combined.pixels.size(); ++i)
        combined.pixels[i] = 0.7f * combined.pixels[i] + 0.3f * second.pixels[i];
    renderer.setTable(sum);
    EXPECT_LT(difference(combined, renderer.render(facing(), Technique::Unc, kSmall).irradiance), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Domains, Irradiance, testing::Values(PointDomain::Texel, PointDomain::Vertex),
                         [](const auto& domain) { return std::string(pointDomainName(domain.param)); });

TEST(Radiance, StaysLinearWhereTheSeriesIsNegative) {
    GlContext context;
    const Scene scene = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const VisibilityMap visibility = uniformVisibility(texelGrid(2, 2), 1, {1.0f});
    Renderer renderer(context, scene, &visibility, nullptr);
    NormalTable table = noisyTable(TableKind::LightCosine, 1, 1, 2, 1);
    std::fill(table.values.begin(), table.values.end(), -0.25f);
    renderer.setTable(table);
    const RenderedFrame frame = renderer.render(facing(), Technique::Unc, kSmall);
    EXPECT_EQ(frame.irradiance.at(32, 24)[0], -0.25f);
    const float albedo = scene.materials[0].baseColor.x();
    EXPECT_NEAR(frame.radiance.at(32, 24)[0], -0.25f * albedo / std::numbers::pi_v<float>, 1e-6f);
    EXPECT_EQ(frame.irradiance.at(0, 24)[0], 0.0f);  // beside the quad
}

TEST(Radiance, CarriesTheAlbedoOfFactorAndTexture) {
    GlContext context;
    Scene scene = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    scene.materials[0].baseColorTexture = addTexture(scene, 1, 1, [](int, int) {
        return std::array<uint8_t, 3>{188, 255, 0};
    });
    scene.materials[0].baseColor = Vec3f(0.5f, 0.25f, 1.0f);
    const VisibilityMap visibility = uniformVisibility(texelGrid(2, 2), 1, {1.0f});
    Renderer renderer(context, scene, &visibility, nullptr);
    NormalTable table = noisyTable(TableKind::LightCosine, 1, 1, 2, 1);
    std::fill(table.values.begin(), table.values.end(), 2.0f);
    renderer.setTable(table);
    const RenderedFrame frame = renderer.render(facing(), Technique::Unc, kSmall);
    // sRGB 188 is 0.503 linear.
    const double truth[3] = {0.5 * 0.5029, 0.25, 0.0};
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(frame.radiance.at(32, 24)[c], truth[c] * 2 / pi, 1e-3);
}

TEST(Frames, RepeatToTheBitAndSurviveOtherSizesAndRenderers) {
    GlContext context;
    const Scene scene = sphere({0, 0, 0}, 1, 30), other = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const VisibilityMap visibility = noisyVisibility(texelGrid(32, 16), 4, 4);
    const VisibilityMap otherVisibility = noisyVisibility(vertexGrid(4), 2, 4);
    Renderer renderer(context, scene, &visibility, nullptr);
    renderer.setTable(lightCosineTable(colouredLight, 4, 8));
    const RenderedFrame first = renderer.render(facing(), Technique::Unc, kSmall);
    {
        Renderer second(context, other, &otherVisibility, nullptr);
        second.setTable(lightCosineTable(otherLight, 2, 4));
        second.render(facing(), Technique::Unc, {33, 17, false});
    }
    renderer.render(facing(), Technique::Unc, {200, 10, true});
    const RenderedFrame again = renderer.render(facing(), Technique::Unc, kSmall);
    EXPECT_EQ(first.irradiance.pixels, again.irradiance.pixels);
    EXPECT_EQ(first.radiance.pixels, again.radiance.pixels);
    EXPECT_EQ(first.radiance.width, 64);
    EXPECT_EQ(first.radiance.height, 48);
}

TEST(Frames, TimesAreMeasured) {
    GlContext context;
    const Scene scene = sphere({0, 0, 0}, 1, 30);
    const VisibilityMap visibility = noisyVisibility(texelGrid(32, 16), 4, 4);
    Renderer renderer(context, scene, &visibility, nullptr);
    renderer.setTable(lightCosineTable(colouredLight, 4, 8));
    const double time = renderer.frameMilliseconds(facing(), Technique::Unc, kSmall, 4);
    EXPECT_TRUE(std::isfinite(time));
    EXPECT_GT(time, 0);
}

}  // namespace
}  // namespace prt
