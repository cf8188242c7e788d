// What every atlas must be, whatever the mesh.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "precompute/base/parallel.h"
#include "precompute/mesh/atlas.h"
#include "precompute/mesh/load_mesh.h"
#include "tests/mesh/mesh_kinds.h"
#include "tests/mesh/plane_geometry.h"

namespace prt {
namespace {

constexpr int kTexels = 192;

struct Unwrapped {
    Scene before, after;
    AtlasReport report;
    std::vector<Triangle2> triangles;
    std::vector<int> piece;  ///< [triangles] connected in uv1
    int pieces = 0;
};

/// Pieces by shared places of the texture, by flooding.
void findPieces(Unwrapped& u) {
    using Place = std::pair<float, float>;
    const auto place = [&](size_t corner) {
        const Vec2f& uv = u.after.uv1[u.after.indices[corner]];
        return Place(uv.x(), uv.y());
    };
    std::map<Place, std::vector<size_t>> at;
    for (size_t i = 0; i < u.after.indices.size(); ++i) at[place(i)].push_back(i / 3);
    u.piece.assign(u.after.triangleCount(), -1);
    for (size_t seed = 0; seed < u.piece.size(); ++seed) {
        if (u.piece[seed] >= 0) continue;
        std::vector<size_t> open{seed};
        u.piece[seed] = u.pieces;
        while (!open.empty()) {
            const size_t t = open.back();
            open.pop_back();
            for (size_t k = 0; k < 3; ++k)
                for (size_t other : at[place(3 * t + k)])
                    if (u.piece[other] < 0) {
                        u.piece[other] = u.pieces;
                        open.push_back(other);
                    }
        }
        ++u.pieces;
    }
}

const Unwrapped& unwrapped(const MeshKind& kind) {
    static std::map<std::string, Unwrapped> made;
    const auto [entry, isNew] = made.try_emplace(kind.name);
    Unwrapped& u = entry->second;
    if (isNew) {
        u.before = prepareScene(kind.make(), kind.name, {});
        u.after = u.before;
        AtlasOptions options;
        options.texels = kTexels;
        u.report = buildAtlas(u.after, options);
        for (size_t t = 0; t < u.after.triangleCount(); ++t)
            u.triangles.push_back(texelTriangle(u.after, t, kTexels));
        findPieces(u);
    }
    return u;
}

class Atlas : public testing::TestWithParam<MeshKind> {};

TEST_P(Atlas, KeepsTheMesh) {
    const Unwrapped& u = unwrapped(GetParam());
    ASSERT_NO_THROW(validateScene(u.after, GetParam().name));
    ASSERT_EQ(u.after.indices.size(), u.before.indices.size());
    for (size_t i = 0; i < u.before.indices.size(); ++i) {
        const uint32_t a = u.before.indices[i], b = u.after.indices[i];
        ASSERT_EQ(u.before.positions[a], u.after.positions[b]);
        ASSERT_EQ(u.before.normals[a], u.after.normals[b]);
        ASSERT_EQ(u.before.tangents[a], u.after.tangents[b]);
        ASSERT_EQ(u.before.uv0[a], u.after.uv0[b]);
    }
    EXPECT_EQ(u.before.primitives.size(), u.after.primitives.size());
}

TEST_P(Atlas, StaysHalfAGutterInsideTheSquare) {
    for (const Triangle2& t : unwrapped(GetParam()).triangles)
        for (const Point2& p : t)
            for (double x : p) {
                EXPECT_GE(x, 1 - 1e-3);
                EXPECT_LE(x, kTexels - 1 + 1e-3);
            }
}

TEST_P(Atlas, MirrorsNoTriangle) {
    // v runs down the image, so counter-clockwise triangles have negative areas there.
    for (const Triangle2& t : unwrapped(GetParam()).triangles) EXPECT_LT(signedArea(t), 1e-4);
}

TEST_P(Atlas, CoversNoTexelCentreTwice) {
    const Unwrapped& u = unwrapped(GetParam());
    size_t covered = 0;
    for (int y = 0; y < kTexels; ++y)
        for (int x = 0; x < kTexels; ++x) {
            const Point2 centre{x + 0.5, y + 0.5};
            int times = 0, touched = 0;
            for (const Triangle2& t : u.triangles) {
                if (std::max({t[0][1], t[1][1], t[2][1]}) < centre[1] ||
                    std::min({t[0][1], t[1][1], t[2][1]}) > centre[1])
                    continue;
                if (!containsPoint(t, centre)) continue;
                ++touched;
                times += borderDistance(t, centre) > 0.01;
            }
            ASSERT_LE(times, 1) << x << ", " << y;
            covered += touched > 0;
        }
    EXPECT_NEAR(u.report.utilisation, double(covered) / (kTexels * kTexels), 2.0 / kTexels);
    EXPECT_TRUE(isValidAtlas(u.after, kTexels));
}

TEST_P(Atlas, KeepsTheGutterBetweenCharts) {
    const Unwrapped& u = unwrapped(GetParam());
    EXPECT_EQ(u.pieces, u.report.charts);
    for (size_t a = 0; a < u.triangles.size(); ++a)
        for (size_t b = a + 1; b < u.triangles.size(); ++b) {
            if (u.piece[a] == u.piece[b]) continue;
            const auto apart = [&](size_t axis) {
                const auto [aLow, aHigh] =
                    std::minmax({u.triangles[a][0][axis], u.triangles[a][1][axis], u.triangles[a][2][axis]});
                const auto [bLow, bHigh] =
                    std::minmax({u.triangles[b][0][axis], u.triangles[b][1][axis], u.triangles[b][2][axis]});
                return aLow - bHigh > 2.1 || bLow - aHigh > 2.1;
            };
            if (apart(0) || apart(1)) continue;
            ASSERT_GE(triangleDistance(u.triangles[a], u.triangles[b]), 2 - 2e-3) << a << ", " << b;
        }
}

TEST_P(Atlas, HasOneDensity) {
    const Unwrapped& u = unwrapped(GetParam());
    double total = 0;
    for (size_t t = 0; t < u.triangles.size(); ++t) {
        const Vec3d a = cornerPosition(u.after, t, 0).cast<double>(),
                    b = cornerPosition(u.after, t, 1).cast<double>(),
                    c = cornerPosition(u.after, t, 2).cast<double>();
        const double area = 0.5 * (b - a).cross(c - a).norm() * std::pow(u.report.texelsPerUnit, 2);
        const double mapped = std::abs(signedArea(u.triangles[t]));
        total += mapped;
        // Float coordinates move corners by up to 2e-5 texels.
        const double slack = 1e-4 * (1 + std::sqrt(area) + (b - a).norm() * u.report.texelsPerUnit);
        EXPECT_LE(mapped, area + slack);
        EXPECT_GE(mapped, area * u.report.smallestStretch - slack);
        for (size_t k = 0; k < 3; ++k) {
            const Vec3d edge =
                (cornerPosition(u.after, t, (k + 1) % 3) - cornerPosition(u.after, t, k)).cast<double>();
            const Point2 &p = u.triangles[t][k], &q = u.triangles[t][(k + 1) % 3];
            EXPECT_LE(std::hypot(q[0] - p[0], q[1] - p[1]),
                      edge.norm() * u.report.texelsPerUnit * (1 + 1e-4) + 1e-3);
        }
    }
    EXPECT_GT(u.report.smallestStretch, std::cos(80.01 * M_PI / 180));
    EXPECT_EQ(u.report.largestStretch, 1);
    EXPECT_GT(total, 0.1 * surfaceArea(u.after) * std::pow(u.report.texelsPerUnit, 2));
}

TEST_P(Atlas, DoesNotDependOnThreads) {
    const Unwrapped& u = unwrapped(GetParam());
    setThreadCount(1);
    Scene again = u.before;
    AtlasOptions options;
    options.texels = kTexels;
    buildAtlas(again, options);
    setThreadCount(0);
    EXPECT_EQ(again.indices, u.after.indices);
    EXPECT_EQ(again.uv1, u.after.uv1);
}

std::string kindName(const testing::TestParamInfo<MeshKind>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Kinds, Atlas, testing::ValuesIn(meshKinds()), kindName);

}  // namespace
}  // namespace prt
