// Per-texel visibility: what a texel stands for.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "precompute/base/parallel.h"
#include "precompute/mesh/atlas.h"
#include "precompute/mesh/texel_raster.h"
#include "precompute/visibility/bake.h"
#include "precompute/visibility/orientations.h"
#include "precompute/visibility/trace_blocks.h"
#include "tests/visibility/shape_scene.h"

namespace prt {
namespace {

using shapes::Mesh;
constexpr int kAtlas = 64;

BakeResult bakeTexels(const Scene& scene, const TexelSurface& surface, int shOrder, int rays) {
    BakeOptions options;
    options.shOrder = shOrder;
    options.rays = rays;
    return bakeTexelVisibility(RayCaster(scene.positions, scene.indices), surface, options);
}

// A sphere over a floor, unwrapped.
const Scene& unwrapped() {
    static const Scene scene = [] {
        Mesh mesh = shapes::sphere(1, {0, 0, 0}, 3);
        mesh.add(shapes::floorSquare(3, -0.7f));
        Scene made = sceneOf(mesh);
        AtlasOptions options;
        options.texels = kAtlas;
        buildAtlas(made, options);
        return made;
    }();
    return scene;
}

// A floor over the texels [2, 2 + width] × [2, 62] of the atlas, one unit a texel, that ends `past` units
// beyond two long boxes with tops at y = 1: between them a groove of width 1 from x = 0 to 1.
// An open floor beside them keeps most points of the scene outside.
struct Groove {
    Scene scene;
    TexelSurface surface;

    explicit Groove(float past) {
        const float low = -past, high = 1 + past;
        Mesh mesh = shapes::quad({low, 0, 60}, {high, 0, 60}, {high, 0, 0}, {low, 0, 0});
        mesh.add(shapes::quad({6, -1, 60}, {30, -1, 60}, {30, -1, 0}, {6, -1, 0}));
        mesh.add(shapes::box({-4, -1, -200}, {0, 1, 260}));
        mesh.add(shapes::box({1, -1, -200}, {5, 1, 260}));
        scene = sceneOf(mesh);
        scene.uv1.assign(scene.positions.size(), Vec2f::Zero());  // the boxes take no area of the atlas
        for (size_t v = 0; v < 4; ++v)
            scene.uv1[v] =
                Vec2f(2 - low + scene.positions[v].x(), 2 + scene.positions[v].z()) / float(kAtlas);
        for (size_t v = 4; v < 8; ++v)
            scene.uv1[v] = Vec2f(14 + scene.positions[v].x(), 2 + scene.positions[v].z()) / float(kAtlas);
        surface = rasterizeTexels(scene, kAtlas, kAtlas);
    }
};

TEST(TexelParts, AreOnTheChartAndSumToOne) {
    const Scene& scene = unwrapped();
    const TexelSurface surface = rasterizeTexels(scene, kAtlas, kAtlas);
    ASSERT_EQ(surface.firstPart.size(), surface.points.size() + 1);
    ASSERT_EQ(surface.firstPart.back(), surface.parts.size());
    ASSERT_EQ(surface.whole.size(), surface.points.size());
    size_t several = 0, whole = 0;
    for (size_t texel = 0; texel < surface.pointOfTexel.size(); ++texel) {
        const uint32_t i = surface.pointOfTexel[texel];
        if (i == kNoPoint) continue;
        const uint32_t first = surface.firstPart[i], last = surface.firstPart[i + 1];
        ASSERT_GT(last, first);
        ASSERT_LE(last - first, uint32_t(kMaxTexelParts));
        several += last - first > 1;
        whole += surface.whole[i];
        if (surface.whole[i]) {
            EXPECT_GE(last - first, 4u);
        }
        double sum = 0;
        for (uint32_t k = first; k < last; ++k) {
            const TexelPart& part = surface.parts[k];
            ASSERT_GT(part.share, 0);
            sum += double(part.share);
            const SurfacePoint& point = surface.subPoints[part.subPoint];
            std::array<Vec3d, 3> p;
            std::array<Vec2f, 3> uv;
            for (size_t c = 0; c < 3; ++c) {
                p[c] = scene.positions[scene.indices[3 * point.triangle + c]].cast<double>();
                uv[c] = scene.uv1[scene.indices[3 * point.triangle + c]] * float(kAtlas);
            }
            const Vec3d cross = (p[1] - p[0]).cross(p[2] - p[0]);
            EXPECT_LT((cross.normalized() - point.normal.cast<double>()).norm(), 1e-6);
            const Vec3d at = point.position.cast<double>();
            EXPECT_LT(std::abs(cross.normalized().dot(at - p[0])), 1e-6);
            // Inside its triangle, and there within the texel's footprint.
            double backX = 0, backY = 0;
            for (size_t c = 0; c < 3; ++c) {
                const double weight =
                    (p[(c + 1) % 3] - at).cross(p[(c + 2) % 3] - at).dot(cross) / cross.squaredNorm();
                EXPECT_GT(weight, -1e-5);
                backX += weight * double(uv[c].x());
                backY += weight * double(uv[c].y());
            }
            EXPECT_LT(std::abs(backX - double(texel % kAtlas) - 0.5), 1 + 1e-4);
            EXPECT_LT(std::abs(backY - double(texel / kAtlas) - 0.5), 1 + 1e-4);
        }
        EXPECT_NEAR(sum, 1, 1e-6);
    }
    EXPECT_GT(several, 100u);
    EXPECT_GT(whole, 100u);
}

TEST(TexelParts, SharesAreAreaTimesTheSquareOfTheFilter) {
    const Groove groove(0);
    // The strip covers the column of texels 2; that one sees two columns of cells, its neighbours one each.
    const auto partsOf = [&](size_t x) {
        const uint32_t i = groove.surface.pointOfTexel[30 * size_t(kAtlas) + x];
        return std::span(&groove.surface.parts[groove.surface.firstPart[i]],
                         groove.surface.firstPart[i + 1] - groove.surface.firstPart[i]);
    };
    for (const auto& [x, columns] : {std::pair<size_t, size_t>{1, 1}, {2, 2}, {3, 1}}) {
        const auto parts = partsOf(x);
        ASSERT_EQ(parts.size(), 4 * columns);
        for (const TexelPart& part : parts) {
            const Vec3f position = groove.surface.subPoints[part.subPoint].position;
            const double off = std::abs(double(position.z()) + 2 - 30.5);  // 1/4 or 3/4
            const double expected = off < 0.5 ? 0.45 : 0.05;               // 9 : 1, two of each
            EXPECT_NEAR(double(part.share), expected / double(columns), 1e-6);
            EXPECT_NEAR(double(std::min(position.x(), 1 - position.x())), 0.25, 1e-5);
        }
        EXPECT_EQ(groove.surface.whole[groove.surface.pointOfTexel[30 * size_t(kAtlas) + x]], 0);
    }
}

// At distance x from one wall of a long groove of depth 1 the cosine-weighted share of the sky on that side
// is half of x/√(x² + 1); its mean over the width is (√2 − 1)/2. Two sub-points across make the midpoint
// rule: off by at most max|f''|/24·(1/2)² = 0.86/96. Dealing adds the noise of 32768 directions, at most
// 0.5/√32768.
void expectMeanOfGroove(const Groove& groove, size_t firstColumn) {
    const BakeResult baked = bakeTexels(groove.scene, groove.surface, 1, 65536);
    const double tolerance = 0.86 / 96 + 3 * 0.5 / std::sqrt(32768.0);
    ASSERT_LT(tolerance, 0.02);  // the border itself has 0.354, the middle 0.447
    for (size_t y = 4; y < 60; y += 9)
        for (size_t x = firstColumn; x < firstColumn + 3; ++x) {
            const uint32_t i = groove.surface.pointOfTexel[y * size_t(kAtlas) + x];
            ASSERT_NE(i, kNoPoint);
            EXPECT_EQ(baked.inside[i], 0) << x << ", " << y;
            EXPECT_NEAR(baked.ao[i], std::sqrt(2.0) - 1, tolerance) << x << ", " << y;
        }
}

TEST(TexelBake, StripBetweenTouchingSolidsIsItsMean) { expectMeanOfGroove(Groove(0), 1); }

TEST(TexelBake, WhatIsInsideSolidsDoesNotCount) {
    // The floor runs two texels into both boxes.
    const Groove groove(2);
    expectMeanOfGroove(groove, 3);
    const BakeResult baked = bakeTexels(groove.scene, groove.surface, 1, 256);
    for (const size_t x : {2u, 6u})
        EXPECT_EQ(baked.inside[groove.surface.pointOfTexel[30 * size_t(kAtlas) + x]], 1) << x;
}

TEST(TexelBake, WholeTexelsAreTheirPointToTheBit) {
    const Scene& scene = unwrapped();
    const TexelSurface surface = rasterizeTexels(scene, kAtlas, kAtlas);
    const RayCaster caster(scene.positions, scene.indices);
    BakeOptions options;
    options.shOrder = 3;
    options.rays = 256;
    // As points, but with the orientations of their texels.
    std::vector<uint8_t> orientations(surface.points.size());
    for (uint32_t y = 0; y < uint32_t(kAtlas); ++y)
        for (uint32_t x = 0; x < uint32_t(kAtlas); ++x)
            if (const uint32_t point = surface.pointOfTexel[y * uint32_t(kAtlas) + x]; point != kNoPoint)
                orientations[point] = texelOrientation(x, y);
    BakeItems items;
    items.points = surface.points;
    items.orientations = orientations;
    const BakeResult points = bakeItems(caster, items, options, "points");
    const BakeResult parts = bakeTexelVisibility(caster, surface, options);
    ASSERT_EQ(parts.coefficients.size(), points.coefficients.size());
    size_t same = 0, clear = 0, other = 0;
    for (size_t i = 0; i < surface.points.size(); ++i) {
        const bool equal = std::equal(&points.coefficients[9 * i], &points.coefficients[9 * i] + 9,
                                      &parts.coefficients[9 * i]) &&
                           points.ao[i] == parts.ao[i];
        // Off the circle where the sphere meets the floor (radius √0.51 at y = −0.7).
        const Vec3d p = surface.points[i].position.cast<double>();
        const bool nearCircle = std::abs(std::hypot(p.x(), p.z()) - std::sqrt(0.51)) < 0.5 && p.y() < -0.2;
        if (surface.whole[i] && !nearCircle && !points.inside[i]) {
            EXPECT_TRUE(equal) << i;
            ++clear;
        }
        if (!surface.whole[i]) {
            same += equal;
            ++other;
        }
    }
    EXPECT_GT(clear, 100u);
    EXPECT_GT(other, 100u);
    EXPECT_LT(same, other);
}

TEST(TexelBake, BitsDoNotDependOnThreads) {
    const Scene& scene = unwrapped();
    const auto bakeWith = [&](int threads) {
        setThreadCount(threads);
        const TexelSurface surface = rasterizeTexels(scene, kAtlas, kAtlas);
        return std::pair(surface, bakeTexels(scene, surface, 4, 300));
    };
    const auto [surface1, baked1] = bakeWith(1);
    const auto [surface3, baked3] = bakeWith(3);
    setThreadCount(0);
    EXPECT_EQ(surface1.firstPart, surface3.firstPart);
    EXPECT_EQ(surface1.whole, surface3.whole);
    ASSERT_EQ(surface1.parts.size(), surface3.parts.size());
    for (size_t k = 0; k < surface1.parts.size(); ++k) {
        EXPECT_EQ(surface1.parts[k].subPoint, surface3.parts[k].subPoint);
        EXPECT_EQ(surface1.parts[k].share, surface3.parts[k].share);
    }
    EXPECT_EQ(baked1.coefficients, baked3.coefficients);
    EXPECT_EQ(baked1.ao, baked3.ao);
    EXPECT_EQ(baked1.inside, baked3.inside);
}

}  // namespace
}  // namespace prt
