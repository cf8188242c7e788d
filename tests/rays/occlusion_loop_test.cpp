// The bare loops against single first hits, and against each other.
#include "precompute/rays/occlusion_loop.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "tests/rays/shapes.h"

namespace prt {
namespace {

using shapes::Mesh;

// Points on a mesh, every third triangle, with their horizons.
struct Points {
    std::vector<Vec3f> origins, normals;
    Points(const RayCaster& caster, const Mesh& mesh) {
        for (size_t t = 0; t < mesh.triangles(); t += 3) {
            normals.push_back(mesh.normal(t));
            origins.push_back(caster.offsetOrigin(mesh.point(t, 0.3, 0.4), normals.back()));
        }
    }
};

Mesh waves() {
    return shapes::heightField(
        40, [](double x, double z) { return 0.2 * std::sin(11 * x) * std::cos(9 * z) + 0.1 * x; });
}

// Over all points: by how many rays two counts differ at least.
uint64_t difference(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
    uint64_t sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += uint64_t(std::abs(int64_t(a[i]) - int64_t(b[i])));
    return sum;
}

class Arrangement : public testing::TestWithParam<RayArrangement> {};

TEST_P(Arrangement, CountsWhatSingleFirstHitsCount) {
    Mesh mesh = waves();
    mesh.add(shapes::sphere(0.2, {0, 0.6, 0}, 2));
    const RayCaster caster(mesh.positions, mesh.indices);
    Points points(caster, mesh);
    points.normals[5].setZero();  // casts nothing
    const std::vector<Vec3f> directions = sphericalFibonacci(301);
    std::vector<uint32_t> expected(points.origins.size(), 0);
    uint64_t rays = 0, blocked = 0;
    for (size_t i = 0; i < points.origins.size(); ++i)
        for (const Vec3f& direction : directions) {
            const Vec3f& n = points.normals[i];
            if (!(n.x() * direction.x() + n.y() * direction.y() + n.z() * direction.z() > 0)) continue;
            ++rays;
            const bool hit = caster.firstHit(points.origins[i], direction).triangle != RayHit{}.triangle;
            expected[i] += hit;
            blocked += hit;
        }
    ASSERT_GT(blocked, rays / 20);
    ASSERT_LT(blocked, rays * 19 / 20);
    for (const bool robust : {true, false}) {
        const OcclusionLoop loop(caster, points.origins, points.normals, directions, robust);
        const OcclusionCount count = loop.run(GetParam());
        EXPECT_EQ(count.rays, rays);
        EXPECT_GT(count.seconds, 0);
        ASSERT_EQ(count.blocked.size(), expected.size());
        EXPECT_EQ(count.blocked[5], 0u);
        // Nothing here is aligned with anything: grazing rays within rounding of an edge are one in a
        // million.
        EXPECT_LE(difference(count.blocked, expected), 3u) << "robust " << robust;
        EXPECT_NEAR(double(count.allBlocked()), double(blocked), 3);
    }
}

// Numbers of points and of directions that fill no block and no packet, none included.
TEST_P(Arrangement, AnyNumberOfPointsAndDirections) {
    const Mesh mesh = waves();
    const RayCaster caster(mesh.positions, mesh.indices);
    const Points all(caster, mesh);
    for (const size_t points : {size_t(0), size_t(1), size_t(15), size_t(257)})
        for (const int directions : {1, 2, 17}) {
            const OcclusionLoop loop(caster, std::span(all.origins).first(points),
                                     std::span(all.normals).first(points), sphericalFibonacci(directions));
            const OcclusionCount single = loop.run(RayArrangement::SingleDirectionMajor);
            const OcclusionCount count = loop.run(GetParam());
            EXPECT_EQ(count.rays, single.rays);
            EXPECT_LE(difference(count.blocked, single.blocked), 1u) << points << " " << directions;
        }
}

TEST_P(Arrangement, ThreadsDoNotMatter) {
    const Mesh mesh = waves();
    const RayCaster caster(mesh.positions, mesh.indices);
    const Points points(caster, mesh);
    const OcclusionLoop loop(caster, points.origins, points.normals, sphericalFibonacci(64));
    std::vector<OcclusionCount> counts;
    for (const int threads : {1, 2, 5}) {
        const ScopedThreadCount scope(threads);
        counts.push_back(loop.run(GetParam()));
    }
    for (const OcclusionCount& count : counts) {
        EXPECT_EQ(count.rays, counts[0].rays);
        EXPECT_EQ(count.blocked, counts[0].blocked);
    }
}

INSTANTIATE_TEST_SUITE_P(All, Arrangement, testing::ValuesIn(kRayArrangements), [](const auto& instance) {
    std::string name = rayArrangementName(instance.param);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

TEST(OcclusionLoop, StopsWhenInterrupted) {
    const Mesh mesh = waves();
    const RayCaster caster(mesh.positions, mesh.indices);
    const Points points(caster, mesh);
    const OcclusionLoop loop(caster, points.origins, points.normals, sphericalFibonacci(8));
    requestInterrupt();
    EXPECT_THROW(loop.run(RayArrangement::StreamDirectionMajor), Interrupted);
    clearInterrupt();
}

}  // namespace
}  // namespace prt
