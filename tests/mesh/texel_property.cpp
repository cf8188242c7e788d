// What every texel's point must be, whatever the mesh: against a search over all triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "precompute/base/parallel.h"
#include "precompute/mesh/atlas.h"
#include "precompute/mesh/load_mesh.h"
#include "precompute/mesh/texel_raster.h"
#include "tests/mesh/mesh_kinds.h"
#include "tests/mesh/plane_geometry.h"

namespace prt {
namespace {

constexpr int kTexels = 96;
/// Points nearest to a texel from outside the chart are moved inwards by up to this, in texels.
constexpr double kInset = 1.0 / 32;

struct Rastered {
    Scene scene;
    TexelSurface surface;
    std::vector<Triangle2> triangles;
};

const Rastered& rastered(const MeshKind& kind) {
    static std::map<std::string, Rastered> made;
    const auto [entry, isNew] = made.try_emplace(kind.name);
    Rastered& r = entry->second;
    if (isNew) {
        r.scene = prepareScene(kind.make(), kind.name, {});
        AtlasOptions options;
        options.texels = kTexels;
        buildAtlas(r.scene, options);
        r.surface = rasterizeTexels(r.scene, kTexels, kTexels);
        for (size_t t = 0; t < r.scene.triangleCount(); ++t)
            r.triangles.push_back(texelTriangle(r.scene, t, kTexels));
    }
    return r;
}

/// Barycentric coordinates of a point of space in the plane of a triangle.
Vec3d barycentric(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& p) {
    const Vec3d n = (b - a).cross(c - a);
    const double whole = n.squaredNorm();
    return {(b - p).cross(c - p).dot(n) / whole, (c - p).cross(a - p).dot(n) / whole,
            (a - p).cross(b - p).dot(n) / whole};
}

class Texels : public testing::TestWithParam<MeshKind> {};

TEST_P(Texels, AreTheFootprintOfTheTriangles) {
    const Rastered& r = rastered(GetParam());
    ASSERT_EQ(r.surface.width, kTexels);
    size_t points = 0;
    for (int y = 0; y < kTexels; ++y)
        for (int x = 0; x < kTexels; ++x) {
            const Point2 centre{x + 0.5, y + 0.5};
            double touching = 0, grown = 0;
            for (const Triangle2& t : r.triangles) {
                touching = std::max(touching, areaWithinSquare(t, centre, 1));
                grown = std::max(grown, areaWithinSquare(t, centre, 1.0001));
            }
            const uint32_t point = r.surface.pointOfTexel[size_t(y * kTexels + x)];
            if (touching > 1e-9) {
                ASSERT_NE(point, kNoPoint) << x << ", " << y;
            } else if (grown == 0) {
                ASSERT_EQ(point, kNoPoint) << x << ", " << y;
            }
            ASSERT_EQ(point == kNoPoint, r.surface.chartOfTexel[size_t(y * kTexels + x)] == kNoPoint);
            if (point != kNoPoint) {
                ASSERT_EQ(point, points++);
            }
        }
    EXPECT_EQ(points, r.surface.points.size());
}

TEST_P(Texels, HoldTheNearestPointOfTheSurface) {
    const Rastered& r = rastered(GetParam());
    const Bounds bounds = sceneBounds(r.scene);
    const double rounding = bounds.low.cwiseAbs().cwiseMax(bounds.high.cwiseAbs()).maxCoeff() * 1.2e-7;
    for (int y = 0; y < kTexels; ++y)
        for (int x = 0; x < kTexels; ++x) {
            const uint32_t id = r.surface.pointOfTexel[size_t(y * kTexels + x)];
            if (id == kNoPoint) continue;
            const SurfacePoint& point = r.surface.points[id];
            const Point2 centre{x + 0.5, y + 0.5};
            double nearest = 1e300;
            for (const Triangle2& t : r.triangles)
                if (areaWithinSquare(t, centre, 1) > 0) nearest = std::min(nearest, pointDistance(t, centre));
            const Triangle2& flat = r.triangles[point.triangle];
            const double own = pointDistance(flat, centre);
            ASSERT_LE(own, nearest + 1e-6);
            ASSERT_GT(areaWithinSquare(flat, centre, 1.0001), 0);

            const Vec3d a = cornerPosition(r.scene, point.triangle, 0).cast<double>(),
                        b = cornerPosition(r.scene, point.triangle, 1).cast<double>(),
                        c = cornerPosition(r.scene, point.triangle, 2).cast<double>();
            const Vec3d normal = (b - a).cross(c - a).normalized();
            ASSERT_LT((point.normal.cast<double>() - normal).norm(), 1e-6);
            const Vec3d p = point.position.cast<double>();
            ASSERT_LT(std::abs(normal.dot(p - a)), 2 * rounding);
            const double shortest =
                (b - a).cross(c - a).norm() / std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
            const Vec3d w = barycentric(a, b, c, p);
            ASSERT_GT(w.minCoeff(), -4 * rounding / shortest);

            // Back in the texture plane the point lies at the centre, or as near as the triangle lets it.
            const Point2 back{w[0] * flat[0][0] + w[1] * flat[1][0] + w[2] * flat[2][0],
                              w[0] * flat[0][1] + w[1] * flat[1][1] + w[2] * flat[2][1]};
            const double off = std::hypot(back[0] - centre[0], back[1] - centre[1]);
            const double longestPx = std::max({std::hypot(flat[1][0] - flat[0][0], flat[1][1] - flat[0][1]),
                                               std::hypot(flat[2][0] - flat[0][0], flat[2][1] - flat[0][1])});
            ASSERT_LE(off, own + kInset + 1e-3 + 8 * rounding / shortest * longestPx) << x << ", " << y;
        }
}

TEST_P(Texels, CompleteEveryBilinearLookup) {
    const Rastered& r = rastered(GetParam());
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0, 1);
    std::map<uint32_t, uint32_t> chartOfVertex;
    for (int i = 0; i < 20000; ++i) {
        const size_t t = size_t(unit(random) * double(r.triangles.size()));
        double u = unit(random), v = unit(random);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const Triangle2& p = r.triangles[t];
        const double x = p[0][0] + u * (p[1][0] - p[0][0]) + v * (p[2][0] - p[0][0]) - 0.5;
        const double y = p[0][1] + u * (p[1][1] - p[0][1]) + v * (p[2][1] - p[0][1]) - 0.5;
        uint32_t chart = kNoPoint;
        for (int k = 0; k < 4; ++k) {
            const int tx = int(std::floor(x)) + (k & 1), ty = int(std::floor(y)) + (k >> 1);
            // Texels of no weight need not be there.
            if (std::abs(x - tx) > 1 - 1e-6 || std::abs(y - ty) > 1 - 1e-6) continue;
            ASSERT_TRUE(tx >= 0 && ty >= 0 && tx < kTexels && ty < kTexels);
            const uint32_t here = r.surface.chartOfTexel[size_t(ty * kTexels + tx)];
            ASSERT_NE(here, kNoPoint);
            if (chart == kNoPoint) chart = here;
            ASSERT_EQ(here, chart) << "a lookup mixes two charts";
        }
    }
}

TEST_P(Texels, DoNotDependOnThreads) {
    const Rastered& r = rastered(GetParam());
    setThreadCount(1);
    const TexelSurface again = rasterizeTexels(r.scene, kTexels, kTexels);
    setThreadCount(0);
    EXPECT_EQ(again.pointOfTexel, r.surface.pointOfTexel);
    EXPECT_EQ(again.chartOfTexel, r.surface.chartOfTexel);
    ASSERT_EQ(again.points.size(), r.surface.points.size());
    for (size_t i = 0; i < again.points.size(); ++i) {
        EXPECT_EQ(again.points[i].position, r.surface.points[i].position);
        EXPECT_EQ(again.points[i].triangle, r.surface.points[i].triangle);
    }
}

std::string kindName(const testing::TestParamInfo<MeshKind>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Kinds, Texels, testing::ValuesIn(meshKinds()), kindName);

}  // namespace
}  // namespace prt
