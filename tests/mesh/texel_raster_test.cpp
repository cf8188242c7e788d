#include "precompute/mesh/texel_raster.h"

#include <gtest/gtest.h>

#include "tests/mesh/mesh_kinds.h"

namespace prt {
namespace {

/// A square of the xy plane over the texels 2…6 of 8.
Scene square() {
    Scene scene = sceneOf({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {0, 1, 2, 0, 2, 3});
    for (const Vec3f& p : scene.positions) scene.uv1.emplace_back((2 + p.x()) / 8, (6 - p.y()) / 8);
    return scene;
}

TEST(TexelRaster, CentresOnTheChartAreExactAndOthersClamped) {
    const TexelSurface surface = rasterizeTexels(square(), 8, 8);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
            const uint32_t id = surface.pointOfTexel[size_t(8 * y + x)];
            // One ring of texels around the 4×4 that it covers.
            const bool expected = x >= 1 && x <= 6 && y >= 1 && y <= 6;
            ASSERT_EQ(id != kNoPoint, expected) << x << ", " << y;
            if (!expected) continue;
            const SurfacePoint& point = surface.points[id];
            EXPECT_EQ(point.normal, Vec3f(0, 0, 1));
            const float px = float(x) + 0.5f - 2, py = 6 - (float(y) + 0.5f);
            const Vec3f nearest(std::clamp(px, 0.0f, 4.0f), std::clamp(py, 0.0f, 4.0f), 0);
            const bool inside = nearest == Vec3f(px, py, 0);
            EXPECT_LT((point.position - nearest).norm(), inside ? 1e-6f : 1 / 31.9f) << x << ", " << y;
            if (!inside) {
                EXPECT_TRUE(point.position.x() > 0 && point.position.x() < 4 && point.position.y() > 0 &&
                            point.position.y() < 4)
                    << "strictly inside, off the borders";
            }
        }
}

TEST(TexelRaster, TiesGoToTheLowestTriangle) {
    // Centres 2.5…5.5 lie on the diagonal that both triangles share.
    const TexelSurface surface = rasterizeTexels(square(), 8, 8);
    for (int i = 2; i < 6; ++i) {
        const uint32_t id = surface.pointOfTexel[size_t(8 * (7 - i) + i)];
        EXPECT_EQ(surface.points[id].triangle, 0u);
    }
}

TEST(TexelRaster, ChartsAreThePiecesOfTheTexture) {
    Scene scene = square();
    // The same square again, somewhere else on the atlas, its corners in the same places of space.
    const Scene other = square();
    scene = joined(scene, other);
    scene.uv1 = other.uv1;
    for (const Vec2f& uv : other.uv1) scene.uv1.push_back(uv * 0.25f);
    const TexelSurface surface = rasterizeTexels(scene, 64, 64);
    EXPECT_EQ(surface.chartOfTexel[size_t(30 * 64 + 30)], 0u);
    EXPECT_EQ(surface.chartOfTexel[size_t(8 * 64 + 8)], 1u);
    EXPECT_EQ(surface.chartOfTexel[size_t(63 * 64 + 2)], kNoPoint);
}

TEST(TexelRaster, TrianglesBelowATexelStillHavePoints) {
    Scene scene =
        sceneOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 0, 0.001f}}, {0, 1, 2, 3, 4, 5});
    scene.uv1 = {{0.31f, 0.31f}, {0.3101f, 0.31f}, {0.31f, 0.3101f},
                 {0.7f, 0.7f},   {0.7f, 0.7f},     {0.7f, 0.7f}};
    const TexelSurface surface = rasterizeTexels(scene, 16, 16);
    EXPECT_NE(surface.pointOfTexel[4 * 16 + 4], kNoPoint);
    EXPECT_NE(surface.pointOfTexel[11 * 16 + 11], kNoPoint) << "squeezed to a point";
    for (const SurfacePoint& point : surface.points) EXPECT_TRUE(point.position.allFinite());
}

TEST(TexelRaster, NotSquare) {
    const TexelSurface surface = rasterizeTexels(square(), 16, 4);
    ASSERT_EQ(surface.pointOfTexel.size(), 64u);
    const SurfacePoint& point = surface.points[surface.pointOfTexel[2 * 16 + 8]];
    // Texel (8, 2) has its centre at u = 8.5/16, v = 2.5/4.
    EXPECT_LT((point.position - Vec3f(8.5f / 2 - 2, 6 - 5, 0)).norm(), 1e-6f);
}

}  // namespace
}  // namespace prt
