#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "precompute/mesh/readers.h"

namespace prt {
namespace {

double areaOf(const std::vector<Vec3f>& p, const std::array<uint32_t, 3>& t, const Vec3d& up) {
    return 0.5 * triangleCross(p[t[0]], p[t[1]], p[t[2]]).dot(up);
}

/// All triangles wind like the polygon, and their areas add up to its own.
void expectPartition(const std::vector<Vec3f>& polygon, double area, const Vec3d& up) {
    const auto triangles = triangulatePolygon(polygon);
    ASSERT_EQ(triangles.size(), polygon.size() - 2);
    double total = 0;
    for (const auto& t : triangles) {
        EXPECT_GE(areaOf(polygon, t, up), -1e-6);
        total += areaOf(polygon, t, up);
    }
    EXPECT_NEAR(total, area, 1e-5 * area);
}

TEST(Triangulate, ConcaveQuadIsCutAtItsReflexCorner) {
    // An arrow head: the diagonal 0–2 would leave it.
    const std::vector<Vec3f> arrow{{0, 0, 0}, {2, -1, 0}, {0.5f, 0, 0}, {2, 1, 0}};
    for (size_t start = 0; start < 4; ++start) {
        std::vector<Vec3f> turned(arrow);
        std::rotate(turned.begin(), turned.begin() + std::ptrdiff_t(start), turned.end());
        expectPartition(turned, 0.5, {0, 0, 1});
    }
}

TEST(Triangulate, ConvexQuadIsCutAtItsShorterDiagonal) {
    const std::vector<Vec3f> kite{{0, 0, 0}, {5, -1, 0}, {10, 0, 0}, {5, 1, 0}};
    for (const auto& t : triangulatePolygon(kite)) {
        const std::set<uint32_t> corners(t.begin(), t.end());
        EXPECT_TRUE(corners.count(1) && corners.count(3));
    }
}

TEST(Triangulate, ConcavePolygonsInAnyPlane) {
    // A comb with three teeth, seen along each axis and from both sides.
    const std::vector<Vec3f> comb{{0, 0, 0}, {5, 0, 0}, {5, 3, 0}, {4, 3, 0}, {4, 1, 0}, {3, 1, 0},
                                  {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
    for (int turn = 0; turn < 3; ++turn)
        for (bool reversed : {false, true}) {
            std::vector<Vec3f> points;
            for (const Vec3f& p : comb) {
                Vec3f q(0, 0, 0);
                q[turn] = p.x();
                q[(turn + 1) % 3] = p.y();
                points.push_back(q + Vec3f(7, -3, 2));
            }
            if (reversed) std::reverse(points.begin(), points.end());
            Vec3d up(0, 0, 0);
            up[(turn + 2) % 3] = reversed ? -1 : 1;
            expectPartition(points, 11, up);
        }
}

TEST(Triangulate, CollinearCornersAndRepeatedCornersDoNotHang) {
    EXPECT_EQ(triangulatePolygon(std::vector<Vec3f>(6, Vec3f(1, 2, 3))).size(), 4u);
    const std::vector<Vec3f> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
    EXPECT_EQ(triangulatePolygon(line).size(), 3u);
    const std::vector<Vec3f> bowTie{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}, {-1, 1, 0}};
    EXPECT_EQ(triangulatePolygon(bowTie).size(), 3u);
}

TEST(Triangulate, ManyCornersOnACircle) {
    std::vector<Vec3f> circle;
    const int n = 500;
    for (int i = 0; i < n; ++i)
        circle.emplace_back(float(std::cos(2 * M_PI * i / n)), 0.0f, float(-std::sin(2 * M_PI * i / n)));
    expectPartition(circle, 0.5 * n * std::sin(2 * M_PI / n), {0, 1, 0});
}

}  // namespace
}  // namespace prt
