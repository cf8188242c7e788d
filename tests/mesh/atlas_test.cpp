#include "precompute/mesh/atlas.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "precompute/base/error.h"
#include "precompute/mesh/atlas_parts.h"
#include "precompute/mesh/load_mesh.h"
#include "tests/mesh/mesh_kinds.h"
#include "tests/mesh/plane_geometry.h"

namespace prt {
namespace {

AtlasReport unwrap(Scene scene, int texels = 256) {
    scene = prepareScene(std::move(scene), "test", {});
    AtlasOptions options;
    options.texels = texels;
    return buildAtlas(scene, options);
}

TEST(BuildAtlas, APlaneIsOneChartThatFillsTheAtlas) {
    const AtlasReport report = unwrap(makeGrid(60), 512);
    EXPECT_EQ(report.charts, 1);
    EXPECT_GT(report.utilisation, 0.95);
    EXPECT_NEAR(report.texelsPerUnit, 510, 2);
    EXPECT_NEAR(report.smallestStretch, 1, 1e-6);
}

TEST(BuildAtlas, ABoxIsItsSixSides) {
    const AtlasReport report = unwrap(makeBox({0, 0, 0}, {1, 1, 1}));
    EXPECT_EQ(report.charts, 6);
    EXPECT_GT(report.utilisation, 0.6);
}

TEST(BuildAtlas, SpheresAndHousesAreUsedWell) {
    EXPECT_GT(unwrap(makeSphere(48, 72), 512).utilisation, 0.55);
    LoadMeshReport load;
    Scene house = loadMesh(std::string(PRT_SOURCE_DIR) + "/meshes/house/house.obj", {}, &load);
    Scene again = house;
    const AtlasReport report = buildAtlas(house, {});
    // 16,000 triangles of fence, frames and columns: most charts are hardly wider than the gutters.
    EXPECT_GT(report.utilisation, 0.42);
    AtlasOptions options;
    options.creaseAngleDeg = 180;
    EXPECT_GT(buildAtlas(again, options).utilisation, 0.5);
    EXPECT_TRUE(isValidAtlas(house, 512));
    EXPECT_GT(report.smallestStretch, std::cos(80.01 * M_PI / 180));
}

TEST(BuildAtlas, ChartsEndAtCreases) {
    // Two roof halves that meet at 50°, together as wide as long.
    const float h = float(std::tan(25 * M_PI / 180));
    Scene roof = prepareScene(sceneOf({{-1, 0, 0}, {-1, 0, 2}, {0, h, 0}, {0, h, 2}, {1, 0, 0}, {1, 0, 2}},
                                      {0, 1, 3, 0, 3, 2, 2, 3, 5, 2, 5, 4}),
                              "roof", {});
    for (double crease : {40.0, 49.0, 51.0, 180.0}) {
        Scene scene = roof;
        AtlasOptions options;
        options.creaseAngleDeg = crease;
        EXPECT_EQ(buildAtlas(scene, options).charts, crease < 50 ? 2 : 1);
    }
}

TEST(BuildAtlas, ARoughSurfaceDoesNotFallIntoCrumbs) {
    Scene scene = makeGrid(200, 10);
    uint32_t seed = 1;
    for (Vec3f& p : scene.positions)
        p.y() = 0.02f * float((seed = seed * 1664525u + 1013904223u) >> 8) / float(1 << 24);
    const AtlasReport report = unwrap(scene, 512);
    EXPECT_LT(report.charts, 40);
    EXPECT_GT(report.utilisation, 0.6);
}

TEST(BuildAtlas, SpiralsAreSplit) {
    const AtlasReport report = unwrap(makeSpiral(3.3, 60, 0.5));
    EXPECT_GE(report.splitCharts, 1);
    EXPECT_GE(report.charts, 4);
    EXPECT_LE(report.charts, 12);
    // So are spirals of triangles much smaller than a texel.
    const AtlasReport fine = unwrap(makeSpiral(3.3, 4000, 2));
    EXPECT_GE(fine.splitCharts, 1);
    EXPECT_LE(fine.charts, 12);
}

TEST(BuildAtlas, GuttersAreAsWideAsAsked) {
    for (int gutter : {2, 3, 8}) {
        Scene scene = prepareScene(makeBox({0, 0, 0}, {1, 1, 1}), "box", {});
        AtlasOptions options;
        options.texels = 128;
        options.gutter = gutter;
        buildAtlas(scene, options);
        // Sides of a box are axis-aligned rectangles: their distance is that of their bounds.
        std::vector<std::array<float, 4>> rects;
        for (uint32_t first = 0; first < scene.indices.size(); first += 6) {
            std::array<float, 4> r{1e9f, 1e9f, -1e9f, -1e9f};
            for (uint32_t i = first; i < first + 6; ++i) {
                const Vec2f p = scene.uv1[scene.indices[i]] * 128;
                r = {std::min(r[0], p.x()), std::min(r[1], p.y()), std::max(r[2], p.x()),
                     std::max(r[3], p.y())};
            }
            rects.push_back(r);
        }
        for (size_t a = 0; a < rects.size(); ++a) {
            EXPECT_GE(std::min(rects[a][0], rects[a][1]), float(gutter) / 2 - 1e-3f);
            EXPECT_LE(std::max(rects[a][2], rects[a][3]), 128 - float(gutter) / 2 + 1e-3f);
            for (size_t b = a + 1; b < rects.size(); ++b) {
                const float apart = std::max({rects[a][0] - rects[b][2], rects[b][0] - rects[a][2],
                                              rects[a][1] - rects[b][3], rects[b][1] - rects[a][3]});
                EXPECT_GE(apart, float(gutter) - 1e-3f);
            }
        }
    }
}

TEST(BuildAtlas, TooManyChartsSayWhatWouldDo) {
    // 400 loose triangles in all directions cannot have gutters in 32 texels.
    std::vector<Vec3f> p;
    std::vector<uint32_t> index;
    for (uint32_t i = 0; i < 400; ++i) {
        const Vec3f at(float(3 * i), 0, 0);
        p.insert(p.end(), {at, at + Vec3f(1, 0, 0), at + Vec3f(0, 1, float(i % 7))});
        index.insert(index.end(), {3 * i, 3 * i + 1, 3 * i + 2});
    }
    Scene scene = prepareScene(sceneOf(p, index), "crumbs", {});
    AtlasOptions options;
    options.texels = 32;
    try {
        buildAtlas(scene, options);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.where(), "--texels 32");
        EXPECT_THAT(error.problem(), testing::HasSubstr("400 charts"));
        int needed = 0;
        ASSERT_EQ(std::sscanf(error.remedy().c_str(), "use --texels %d", &needed), 1);
        options.texels = needed;
        EXPECT_NO_THROW(buildAtlas(scene, options));
    }
}

// So many that they are packed in rows: loose triangles, and a few large charts among them.
TEST(BuildAtlas, TensOfThousandsOfChartsAreUsedWell) {
    constexpr int kLoose = 22'000, kTexels = 1024;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    Scene scene = joined(makeSphere(24, 36, 40), makeGrid(10, 30));
    for (int i = 0; i < kLoose; ++i) {
        const auto first = uint32_t(scene.positions.size());
        const Vec3f at = 200 * Vec3f(unit(random), unit(random), 1 + unit(random));
        for (int k = 0; k < 3; ++k)
            scene.positions.push_back(at + Vec3f(unit(random), unit(random), unit(random)));
        scene.indices.insert(scene.indices.end(), {first, first + 1, first + 2});
    }
    scene = prepareScene(sceneOf(scene.positions, scene.indices), "crumbs", {});
    AtlasOptions options;
    options.texels = kTexels;
    const AtlasReport report = buildAtlas(scene, options);
    EXPECT_GT(report.charts, 20'000);
    EXPECT_TRUE(isValidAtlas(scene, kTexels));
    // Rectangles are half filled at best and have gutters; a skyline reaches 0.416, rows 0.407.
    EXPECT_GT(report.utilisation, 0.38);
}

TEST(BuildAtlas, CanBeInterrupted) {
    Scene scene = prepareScene(makeSphere(16, 24), "sphere", {});
    requestInterrupt();
    EXPECT_THROW(buildAtlas(scene, {}), Interrupted);
    EXPECT_THROW(prepareScene(scene, "sphere", {}), Interrupted);
    clearInterrupt();
    EXPECT_NO_THROW(buildAtlas(scene, {}));
}

TEST(BuildAtlas, OptionsOutOfRange) {
    Scene scene = prepareScene(makeGrid(1), "grid", {});
    for (int texels : {-5, 0, 15, 8193}) {
        AtlasOptions options;
        options.texels = texels;
        EXPECT_THROW(buildAtlas(scene, options), UsageError);
    }
    for (double cone : {0.0, 90.0, std::numeric_limits<double>::quiet_NaN()}) {
        AtlasOptions options;
        options.coneAngleDeg = cone;
        EXPECT_THROW(buildAtlas(scene, options), UsageError);
    }
}

TEST(ValidAtlas, OfTheInputIsKept) {
    Scene scene = prepareScene(makeSphere(12, 16), "sphere", {});
    EXPECT_FALSE(isValidAtlas(scene, 256));
    buildAtlas(scene, {});
    LoadMeshReport report;
    const Scene again = prepareScene(scene, "again", {}, &report);
    EXPECT_TRUE(report.hasAtlas);
    EXPECT_EQ(again.uv1, scene.uv1);
    EXPECT_EQ(again.indices, scene.indices);
    EXPECT_EQ(report.counts.count("invalid_atlas_dropped"), 0u);
}

TEST(ValidAtlas, OverlapsHolesAndNumbersOutsideAreRefused) {
    Scene good = prepareScene(makeSphere(12, 16), "sphere", {});
    buildAtlas(good, {});
    ASSERT_TRUE(isValidAtlas(good, 512));
    const auto refused = [](const Scene& scene) {
        LoadMeshReport report;
        const Scene result = prepareScene(scene, "test", {}, &report);
        EXPECT_FALSE(report.hasAtlas);
        EXPECT_TRUE(result.uv1.empty());
        EXPECT_EQ(report.counts.at("invalid_atlas_dropped"), 1u);
        return !isValidAtlas(scene, 512);
    };
    for (float bad : {-0.01f, 1.01f, std::numeric_limits<float>::quiet_NaN()}) {
        Scene scene = good;
        scene.uv1[7].y() = bad;
        EXPECT_TRUE(refused(scene));
    }
    Scene zero = good;
    zero.uv1.assign(zero.vertexCount(), Vec2f(0, 0));
    EXPECT_TRUE(refused(zero));
    Scene folded = good;
    for (Vec2f& uv : folded.uv1) uv.x() = std::abs(uv.x() - 0.5f);
    EXPECT_TRUE(refused(folded));
    // A grid whose two triangles per quad share an edge is no overlap, mirrored or not.
    for (float side : {1.0f, -1.0f}) {
        Scene grid = prepareScene(makeGrid(16), "grid", {});
        for (const Vec3f& p : grid.positions) grid.uv1.emplace_back(0.5f + side * (p.x() - 0.5f), p.z());
        EXPECT_TRUE(isValidAtlas(grid, 512));
    }
}

TEST(ColumnsInRow, HoldEveryCentreOfATriangleAndFewMore) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(-5, 205), small(-1, 1);
    for (int i = 0; i < 2000; ++i) {
        // Every other one is a splinter, every fourth has an edge exactly on a row of centres.
        Triangle2 t{{{place(random), place(random)}, {place(random), place(random)}, {0, 0}}};
        t[2] = {place(random), place(random)};
        if (i % 2) t[2] = {t[1][0] + small(random), t[1][1] + small(random)};
        if (i % 4 == 2) t[0][1] = t[1][1] = std::floor(t[0][1]) + 0.5;
        double widest = 0, slope = 0;
        for (int y = 0; y < 200; ++y) {
            const auto [from, to] =
                columnsInRow({t[0][0], t[1][0], t[2][0]}, {t[0][1], t[1][1], t[2][1]}, y, 0, 199);
            for (int x = 0; x < 200; ++x) {
                if (x >= from && x <= to) continue;
                ASSERT_FALSE(containsPoint(t, {x + 0.5, y + 0.5})) << i << ": " << x << ", " << y;
            }
            widest = std::max(widest, double(to - from));
        }
        for (size_t k = 0; k < 3; ++k) {
            const Point2 &a = t[k], &b = t[(k + 1) % 3];
            slope = std::max(slope, std::abs(b[0] - a[0]) / std::max(std::abs(b[1] - a[1]), 1e-9));
        }
        // In one row each long edge moves by its slope; they lie one unit and one unit's slope apart at most.
        if (i % 2) {
            EXPECT_LE(widest, 2 * slope + 1 + 3) << i;
        }
    }
}

}  // namespace
}  // namespace prt
