// Rays that leave a surface neither meet it again nor start behind a neighbouring one.
#include <algorithm>
#include <random>
#include <tuple>

#include "precompute/rays/ray_caster.h"
#include "tests/rays/shapes.h"

namespace prt {
namespace {

using shapes::Mesh;

struct SphereCase {
    double radius;
    double distanceRadii;  ///< of the centre from the origin of coordinates
};

class OffsetOnSphere : public testing::TestWithParam<std::tuple<SphereCase, int>> {};

std::vector<Vec3f> hemisphere(const Vec3f& normal, int count) {
    static const std::vector<Vec3f> kSphere = [] {
        std::mt19937 random(11);
        std::normal_distribution<float> gauss;
        std::vector<Vec3f> result;
        for (int i = 0; i < 2000; ++i)
            result.push_back(Vec3f(gauss(random), gauss(random), gauss(random)).normalized());
        return result;
    }();
    std::vector<Vec3f> result;
    for (const Vec3f& direction : kSphere)
        if (direction.dot(normal) > 0 && result.size() < size_t(count)) result.push_back(direction);
    return result;
}

// Share of cosine-weighted rays that get away, mean over the area.
double meanOpenness(const Mesh& mesh, const RayCaster& caster, double* smallest) {
    double sum = 0;
    double area = 0;
    *smallest = 1;
    for (size_t t = 0; t < mesh.triangles(); t += 1 + mesh.triangles() / 300) {
        const Vec3f normal = mesh.normal(t);
        if (normal.isZero()) continue;
        const std::vector<Vec3f> aims = hemisphere(normal, 200);
        std::vector<uint8_t> blocked(aims.size());
        const double u = 0.05 + 0.4 * double(t % 7) / 7, v = 0.05 + 0.4 * double(t % 5) / 5;
        caster.occluded(caster.offsetOrigin(mesh.point(t, u, v), normal), aims, blocked);
        double open = 0, all = 0;
        for (size_t k = 0; k < aims.size(); ++k) {
            all += double(aims[k].dot(normal));
            open += blocked[k] ? 0.0 : double(aims[k].dot(normal));
        }
        const Vec3d a = mesh.corner(t, 0);
        const double faceArea = (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).norm() / 2;
        sum += open == all ? faceArea : faceArea * open / all;
        area += faceArea;
        *smallest = std::min(*smallest, open == all ? 1.0 : open / all);
    }
    return sum == area ? 1.0 : sum / area;
}

constexpr SphereCase kSpheres[] = {{1e-3, 0},  {1, 0},      {1e6, 0}, {1e-3, 1e3}, {1, 1e3},
                                   {1e6, 1e3}, {1e-3, 1e6}, {1, 1e6}, {1e6, 1e6}};

std::vector<Vec3d> ways() {
    std::mt19937 random(5);
    std::normal_distribution<double> gauss;
    std::vector<Vec3d> result = {{1, 0, 0}, {0, -1, 0}, {0.6, 0, -0.8}};
    while (result.size() < 8)
        result.push_back(Vec3d(gauss(random), gauss(random), gauss(random)).normalized());
    return result;
}

// Every face is open. At 1e6 radii a radius has 8 to 16 units in the last place: vertices are rounded off
// the sphere, faces stand at wrong angles, and a neighbour may rise a little above a horizon.
TEST_P(OffsetOnSphere, IsOpen) {
    const auto [where, levels] = GetParam();
    for (const Vec3d& way : ways()) {
        const Mesh mesh = shapes::sphere(where.radius, where.radius * where.distanceRadii * way, levels);
        const RayCaster caster(mesh.positions, mesh.indices);
        double smallest = 0;
        const double mean = meanOpenness(mesh, caster, &smallest);
        EXPECT_GE(mean, where.distanceRadii > 1e5 ? 0.9995 : 1.0);
        EXPECT_GE(smallest, where.distanceRadii > 1e5 ? 0.98 : 1.0);
        // The offset is small against the sphere unless precision forbids.
        const double unit = where.distanceRadii * where.radius * std::ldexp(1.0, -22);
        EXPECT_LT(caster.offsetDistance(mesh.positions[0]), 4e-6 * where.radius + 1.01 * unit);
    }
}

INSTANTIATE_TEST_SUITE_P(Scales, OffsetOnSphere,
                         testing::Combine(testing::ValuesIn(kSpheres), testing::Values(1, 2, 3)));

// Edges below the resolution of float: some faces are turned inwards by rounding and see nothing; the rest is
// open.
TEST(OffsetOnSphere, FinerThanFloatIsNearlyOpen) {
    for (const Vec3d& way : ways()) {
        const Mesh mesh = shapes::sphere(1, 1e6 * way, 5);
        const RayCaster caster(mesh.positions, mesh.indices);
        double smallest = 0;
        EXPECT_GT(meanOpenness(mesh, caster, &smallest), 0.95);  // measured: 0.970 and more
    }
}

// A room with walls of a hundred-thousandth of its size: nothing gets through from any side.
TEST(Offset, StaysInsideThinWalls) {
    for (const double scale : {1e-3, 1.0, 1e6}) {
        const double thickness = 1e-5 * scale;
        Mesh mesh = shapes::box(Vec3d(-scale, -scale, -scale).cast<float>(),
                                Vec3d(scale, scale, scale).cast<float>());
        mesh.flip();
        const double outer = scale + thickness;
        const size_t inner = mesh.triangles();
        mesh.add(shapes::box(Vec3d(-outer, -outer, -outer).cast<float>(),
                             Vec3d(outer, outer, outer).cast<float>()));
        const RayCaster caster(mesh.positions, mesh.indices);
        EXPECT_LT(double(caster.offsetDistance(mesh.positions[0])), 0.5 * thickness);
        for (size_t t = 0; t < mesh.triangles(); ++t) {
            const std::vector<Vec3f> aims = hemisphere(mesh.normal(t), 500);
            std::vector<uint8_t> blocked(aims.size());
            for (const double u : {0.001, 0.3, 0.7})
                for (const double v : {0.001, 0.1, 0.298}) {
                    caster.occluded(caster.offsetOrigin(mesh.point(t, u, v), mesh.normal(t)), aims, blocked);
                    EXPECT_EQ(std::count(blocked.begin(), blocked.end(), 1), t < inner ? 500 : 0) << t;
                }
        }
    }
}

// Floor under a slanting wall: the offset can lead through the wall only nearer to the edge than
// offset/tan(angle).
TEST(Offset, PassesAWallOnlyWithinItsOwnLength) {
    for (const double angleDeg : {10.0, 30.0, 60.0, 90.0}) {
        const double angle = angleDeg * std::numbers::pi / 180;
        const Vec3f foot(0, 0, 1), top = Vec3d(2 * std::cos(angle), 2 * std::sin(angle), 1).cast<float>();
        const Vec3f depth(0, 0, -2);
        Mesh mesh = shapes::quad({0, 0, 1}, {2, 0, 1}, {2, 0, -1}, {0, 0, -1});
        mesh.add(shapes::quad(foot, foot + depth, top + depth, top));
        const RayCaster caster(mesh.positions, mesh.indices);
        // Directions that meet the wall from any point near the edge: steeper than the wall, along the
        // middle.
        std::vector<Vec3f> aims;
        for (double a = angle + 0.1; a < std::numbers::pi - 0.02; a += 0.05)
            aims.push_back(Vec3d(std::cos(a), std::sin(a), 0.1).normalized().cast<float>());
        std::vector<uint8_t> blocked(aims.size());
        const double offset = double(caster.offsetDistance({0, 0, 0}));
        for (const double reach : {3.0, 10.0, 100.0, 1e4}) {
            const Vec3f point(float(reach * offset / std::tan(std::min(angle, 0.5))), 0, 0);
            caster.occluded(caster.offsetOrigin(point, {0, 1, 0}), aims, blocked);
            EXPECT_EQ(size_t(std::count(blocked.begin(), blocked.end(), 1)), aims.size())
                << angleDeg << " " << reach;
        }
    }
}

// Points of large faces far from where the coordinates are small: no ray leaves and meets its own face.
TEST(Offset, LargeFacesDoNotShadowThemselves) {
    std::mt19937 random(17);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int trial = 0; trial < 300; ++trial) {
        Mesh mesh;
        for (int k = 0; k < 3; ++k)
            mesh.positions.push_back(
                (Vec3d(uniform(random), uniform(random), uniform(random)) * (trial % 2 ? 1000 : 1) +
                 Vec3d(trial % 3 ? 0 : 5000, 0, 0))
                    .cast<float>());
        mesh.indices = {0, 1, 2};
        const RayCaster caster(mesh.positions, mesh.indices);
        const Vec3f normal = mesh.normal(0);
        std::vector<Vec3f> aims = hemisphere(normal, 100);
        for (const Vec3f& aim : hemisphere(normal, 100))  // grazing ones
            aims.push_back((aim - 0.999f * normal * aim.dot(normal)).normalized());
        std::vector<uint8_t> blocked(aims.size());
        double u = 0.5 * (uniform(random) + 1), v = 0.5 * (uniform(random) + 1);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        caster.occluded(caster.offsetOrigin(mesh.point(0, u, v), normal), aims, blocked);
        EXPECT_EQ(std::count(blocked.begin(), blocked.end(), 1), 0) << trial;
    }
}

// Where a large face passes near the origin of coordinates, the position is precise and the ray's
// intersection with the face is not: what the part of the offset that is relative to the extent is for.
TEST(Offset, CoversTheErrorOfLargeFacesNearTheOrigin) {
    std::mt19937 random(23);
    std::normal_distribution<double> gauss;
    size_t blockedWithout = 0;
    for (int trial = 0; trial < 300; ++trial) {
        Vec3d normal(gauss(random), gauss(random), gauss(random));
        normal.normalize();
        const Vec3d u = normal.unitOrthogonal(), v = normal.cross(u);
        Mesh mesh;
        for (const double a : {0.3, 2.4, 4.5})
            mesh.positions.push_back((1000 * (std::cos(a) * u + std::sin(a) * v)).cast<float>());
        mesh.indices = {0, 1, 2};
        // The exact plane of the rounded corners, near the origin.
        const Vec3d n =
            (mesh.corner(0, 1) - mesh.corner(0, 0)).cross(mesh.corner(0, 2) - mesh.corner(0, 0)).normalized();
        const Vec3f point = (n * n.dot(mesh.corner(0, 0))).cast<float>();
        const RayCaster caster(mesh.positions, mesh.indices);
        const std::vector<Vec3f> aims = hemisphere(mesh.normal(0), 200);
        std::vector<uint8_t> blocked(aims.size());
        caster.occluded(caster.offsetOrigin(point, mesh.normal(0)), aims, blocked);
        EXPECT_EQ(std::count(blocked.begin(), blocked.end(), 1), 0) << trial;
        caster.occluded(point, aims, blocked);
        blockedWithout += size_t(std::count(blocked.begin(), blocked.end(), 1));
    }
    EXPECT_GT(blockedWithout, 100u);  // the test would notice
}

}  // namespace
}  // namespace prt
