// The lookups of the shaders against the same lookups on the CPU, with noise for data: nothing smooth hides a
// wrong texel or weight.
#include <cmath>
#include <random>

#include "compress/tables/normal_tables.h"
#include "precompute/math/sh.h"
#include "runtime/renderer.h"
#include "test_scenes.h"

namespace prt {
namespace {

using namespace test;

std::vector<float> noise(size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(-1, 1);
    std::vector<float> values(count);
    for (float& v : values) v = value(random);
    return values;
}

// E = Σ_i k_i T_ci(n) with T looked up on the CPU.
std::array<double, 3> expected(const NormalTable& table, std::span<const float> k, const Vec3f& normal) {
    const std::vector<float> looked =
        lookUpTable(table.values, table.layers, TableLayout(table.layout, table.size), normal.cast<double>());
    std::array<double, 3> sum{};
    for (size_t c = 0; c < 3; ++c) {
        const size_t first = c * size_t(table.layers);
        for (size_t i = 0; i < k.size(); ++i) sum[c] += double(k[i]) * double(looked[first + i]);
        if (table.kind == TableKind::TripleProduct) sum[c] += double(looked[first + k.size()]);
    }
    return sum;
}

// Largest |E − expected| over a sphere seen from all eight diagonals, each with a corner of the cube of
// normals in the middle of the picture.
double worstOverSphere(Renderer& renderer, Technique technique, const NormalTable& table,
                       std::span<const float> k) {
    double worst = 0;
    size_t compared = 0;
    for (int corner = 0; corner < 8; ++corner) {
        Camera camera;
        camera.eye =
            Vec3f((corner & 1) ? 3.0f : -3.0f, (corner & 2) ? 3.0f : -3.0f, (corner & 4) ? 3.0f : -3.0f);
        camera.verticalFovDeg = 24;
        const RenderOptions options{96, 96, true};
        const SurfaceImage surface = renderer.surface(camera, options);
        const RenderedFrame frame = renderer.render(camera, technique, options);
        for (size_t i = 0; i < surface.pixels(); ++i) {
            if (surface.triangle[i] == kNoTriangle) continue;
            const auto truth = expected(table, k, surface.shadingNormal[i]);
            for (size_t c = 0; c < 3; ++c)
                worst = std::max(worst, std::abs(double(frame.irradiance.pixels[i * 3 + c]) - truth[c]));
            ++compared;
        }
    }
    EXPECT_GT(compared, 30000u);
    return worst;
}

// Order or components, size, and layout.
class TableLookup : public testing::TestWithParam<std::tuple<std::tuple<int, int>, std::string>> {};

// Points of a face are off by roundings of float, about 1e-7·size texels, noise differs by up to 2 between
// texels, and the errors of coefficients are independent. The arctangent of the paraboloids is good to 1e-6.
double tolerance(const std::string& layout, int size, size_t coefficients) {
    return std::sqrt(double(coefficients)) * (1e-6 + (layout == "dual-paraboloid" ? 2e-6 : 3e-7) * size);
}

TEST_P(TableLookup, LightCosineAsOnTheCpu) {
    const auto [shOrder, size] = std::get<0>(GetParam());
    const std::string& layout = std::get<1>(GetParam());
    if (size < TableLayout::minSize(layout)) return;
    GlContext context;
    const Scene scene = sphere({0, 0, 0}, 1, 40);
    const std::vector<float> k = noise(size_t(shCount(shOrder)), 7);
    const VisibilityMap visibility = uniformVisibility(texelGrid(2, 2), shOrder, k);
    Renderer renderer(context, scene, &visibility, nullptr);
    const NormalTable table = noisyTable(TableKind::LightCosine, shOrder, shCount(shOrder), size, 11, layout);
    renderer.setTable(table);
    EXPECT_LT(worstOverSphere(renderer, Technique::Unc, table, k), tolerance(layout, size, k.size()));
}

TEST_P(TableLookup, TripleProductAsOnTheCpu) {
    const auto [components, size] = std::get<0>(GetParam());
    const std::string& layout = std::get<1>(GetParam());
    if (size < TableLayout::minSize(layout)) return;
    GlContext context;
    const Scene scene = sphere({0, 0, 0}, 1, 40);
    const std::vector<float> k = noise(size_t(components), 17);
    PcaMap pca;
    pca.grid = texelGrid(2, 2);
    pca.shOrder = 6;
    pca.components = components;
    for (int i = 0; i < 4; ++i) pca.weights.insert(pca.weights.end(), k.begin(), k.end());
    Renderer renderer(context, scene, nullptr, &pca);
    const NormalTable table = noisyTable(TableKind::TripleProduct, 6, components + 1, size, 12, layout);
    renderer.setTable(table);
    EXPECT_LT(worstOverSphere(renderer, Technique::Pca, table, k), tolerance(layout, size, k.size() + 1));
}

INSTANTIATE_TEST_SUITE_P(
    Sizes, TableLookup,
    testing::Combine(testing::Values(std::tuple(1, 8), std::tuple(2, 1), std::tuple(3, 2), std::tuple(4, 16),
                                     std::tuple(5, 5), std::tuple(6, 32), std::tuple(10, 3)),
                     testing::ValuesIn(TableLayout::names())));

// A table that carries coefficient `index` to red alone, whatever the normal.
NormalTable pickingTable(int shOrder, int index) {
    NormalTable table = noisyTable(TableKind::LightCosine, shOrder, shCount(shOrder), 4, 1);
    std::fill(table.values.begin(), table.values.end(), 0.0f);
    std::fill_n(table.layer(0, index), table.texels(), 1.0f);
    return table;
}

Camera facing() {
    Camera camera;
    camera.eye = {0, 0, 3};
    return camera;
}

double bilinear(const VisibilityMap& map, int index, double u, double v) {
    const int width = map.grid.width, height = map.grid.height, n2 = shCount(map.shOrder);
    const double x = u * width - 0.5, y = v * height - 0.5;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    double sum = 0;
    for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx) {
            const double weight = (dx ? x - x0 : 1 - x + x0) * (dy ? y - y0 : 1 - y + y0);
            const int column = std::clamp(x0 + dx, 0, width - 1), row = std::clamp(y0 + dy, 0, height - 1);
            sum += weight * double(map.coefficients[size_t((row * width + column) * n2 + index)]);
        }
    return sum;
}

TEST(VisibilityLookup, TexelsAreFilteredBilinearly) {
    GlContext context;
    const Scene scene = quad({0, 0, 0}, {2, 0, 0}, {0, 1.5f, 0});  // larger than the view: clamps in corners
    const VisibilityMap visibility = noisyVisibility(texelGrid(16, 9), 3, 5);
    Renderer renderer(context, scene, &visibility, nullptr);
    const RenderOptions options{120, 100, true};
    for (const int index : {0, 3, 5, 8}) {
        renderer.setTable(pickingTable(3, index));
        const RenderedFrame frame = renderer.render(facing(), Technique::Unc, options);
        const SurfaceImage surface = renderer.surface(facing(), options);
        for (size_t i = 0; i < surface.pixels(); ++i) {
            ASSERT_NE(surface.triangle[i], kNoTriangle);
            const double u = (double(surface.position[i].x()) + 2) / 4,
                         v = (1.5 - double(surface.position[i].y())) / 3;
            ASSERT_NEAR(frame.irradiance.pixels[i * 3], bilinear(visibility, index, u, v), 2e-5) << i;
            ASSERT_EQ(frame.irradiance.pixels[i * 3 + 1], 0.0f);
        }
    }
}

TEST(VisibilityLookup, LargeAtlasKeepsItsPlace) {
    GlContext context;
    const Scene scene = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const VisibilityMap visibility = noisyVisibility(texelGrid(2048, 512), 1, 5);
    Renderer renderer(context, scene, &visibility, nullptr);
    renderer.setTable(pickingTable(1, 0));
    const RenderOptions options{200, 200, true};
    const RenderedFrame frame = renderer.render(facing(), Technique::Unc, options);
    const SurfaceImage surface = renderer.surface(facing(), options);
    size_t covered = 0;
    for (size_t i = 0; i < surface.pixels(); ++i) {
        if (surface.triangle[i] == kNoTriangle) continue;
        const double u = (double(surface.position[i].x()) + 1) / 2,
                     v = (1 - double(surface.position[i].y())) / 2;
        // Coordinates are good to a rounding of float, 2048 texels to a few thousandths of one.
        ASSERT_NEAR(frame.irradiance.pixels[i * 3], bilinear(visibility, 0, u, v), 3e-3) << i;
        ++covered;
    }
    EXPECT_GT(covered, 10000u);
}

TEST(VisibilityLookup, VerticesAreInterpolatedOverTheTriangle) {
    GlContext context;
    const Scene scene = sphere({0, 0, 0}, 1, 12);
    VisibilityMap visibility = noisyVisibility(vertexGrid(scene.vertexCount()), 4, 9);
    visibility.grid.width = 100;  // several rows
    visibility.grid.height = int(scene.vertexCount() + 99) / 100;
    Renderer renderer(context, scene, &visibility, nullptr);
    const int index = 6;
    renderer.setTable(pickingTable(4, index));
    const RenderOptions options{90, 80, true};
    const RenderedFrame frame = renderer.render(facing(), Technique::Unc, options);
    const SurfaceImage surface = renderer.surface(facing(), options);
    size_t covered = 0;
    for (size_t i = 0; i < surface.pixels(); ++i) {
        if (surface.triangle[i] == kNoTriangle) continue;
        const uint32_t* corner = &scene.indices[surface.triangle[i] * 3];
        const auto at = [&](int c) { return Vec3d(scene.positions[corner[c]].cast<double>()); };
        const Vec3d point = surface.position[i].cast<double>(), normal = (at(1) - at(0)).cross(at(2) - at(0));
        double value = 0;
        for (int c = 0; c < 3; ++c) {
            const double share =
                (at((c + 1) % 3) - point).cross(at((c + 2) % 3) - point).dot(normal) / normal.squaredNorm();
            value += share * double(visibility.coefficients[corner[c] * 16 + index]);
        }
        ASSERT_NEAR(frame.irradiance.pixels[i * 3], value, 2e-4) << i;
        ++covered;
    }
    EXPECT_GT(covered, 1000u);
}

}  // namespace
}  // namespace prt
