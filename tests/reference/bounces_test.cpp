// Light that bounces against closed forms: a sphere with a hole, a wall on a floor, a white furnace.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "runtime/reference/reference.h"
#include "tests/rays/shapes.h"
#include "tests/reference/reference_scenes.h"

namespace prt {
namespace {

using shapes::Mesh;
constexpr double kPi = std::numbers::pi;

Scene greyScene(const Mesh& mesh, float albedo) {
    Scene scene = sceneOf(mesh);
    scene.materials[0].baseColor = Vec3f(albedo, albedo, albedo);
    return scene;
}

BounceResult bounced(const Scene& scene, const SurfaceImage& surface, const BounceOptions& options,
                     const Environment& environment = uniformSky(), int baseCount = 1024) {
    const RayCaster caster(scene.positions, scene.indices);
    const ReferenceDirections directions =
        makeReferenceDirections(std::span(&environment, 1), std::vector<double>{0.0}, baseCount);
    const SurfaceAlbedo albedo(scene);
    return traceReferenceBounces(caster, surface, directions, albedo, options);
}

double meanOf(const std::vector<float>& values) {
    double sum = 0;
    for (const float value : values) sum += double(value);
    return sum / double(values.size());
}

// The inside of a sphere without the part above a height: every point of it sees every other through the same
// form factor per area, so that with the hole's share f of the sphere
//   E_k = π L f Σ_{j ≤ k} (ρ (1 − f))^j everywhere inside.
struct HollowSphere {
    Mesh mesh;
    SurfaceImage surface;
    double hole = 1;  // share of the sphere

    explicit HollowSphere(double height) {
        Mesh sphere = shapes::sphere(1, {0, 0, 0}, 5);
        sphere.flip();
        mesh.positions = sphere.positions;
        double whole = 0, kept = 0;
        std::vector<Vec3f> middles, normals;
        for (size_t t = 0; t < sphere.triangles(); ++t) {
            const Vec3d a = sphere.corner(t, 0);
            const double area = (sphere.corner(t, 1) - a).cross(sphere.corner(t, 2) - a).norm() / 2;
            const Vec3f middle = sphere.point(t, 1.0 / 3, 1.0 / 3);
            whole += area;
            if (double(middle.y()) > height) continue;
            kept += area;
            for (size_t k = 0; k < 3; ++k) mesh.indices.push_back(sphere.indices[3 * t + k]);
            if (middle.y() > float(height) - 0.1f || t % 257 != 0) continue;
            middles.push_back(middle);
            normals.push_back(sphere.normal(t));
            surface.triangle.push_back(uint32_t(mesh.triangles() - 1));
        }
        hole = 1 - kept / whole;
        surface = [&] {
            SurfaceImage points = surfaceOf(middles, {0, 1, 0});
            points.triangle = surface.triangle;
            points.geometricNormal = points.shadingNormal = normals;
            return points;
        }();
    }
};

TEST(Bounces, InsideOfASphereWithAHole) {
    const HollowSphere sphere(0.4);
    ASSERT_GT(sphere.surface.pixels(), 30u);
    const double rho = 0.8;
    const Scene scene = greyScene(sphere.mesh, float(rho));
    double factor = 0;
    for (const int bounces : {0, 1, 2, 5}) {
        const BounceOptions options{bounces, 4096, 1};
        const BounceResult result = bounced(scene, sphere.surface, options);
        factor = 0;
        for (int j = 0; j <= bounces; ++j) factor += std::pow(rho * (1 - sphere.hole), j);
        const double expected = kPi * sphere.hole * factor;
        // Facets for a sphere, and noise.
        EXPECT_NEAR(meanOf(result.irradiance[0]), expected, 0.006 * expected) << bounces;
        for (const float e : result.irradiance[0]) EXPECT_NEAR(e, expected, 0.06 * expected) << bounces;
        EXPECT_LT(result.relativeError[0], 0.025);
    }
    EXPECT_GT(factor, 2);
}

// A wall without end on a floor without end: it is lit by half of a uniform sky all the way up, and the floor
// sees it with the form factor ½(1 − d/√(d² + h²)).
TEST(Bounces, WallOnAFloor) {
    Mesh mesh = shapes::quad({0, 0, 4000}, {8000, 0, 4000}, {8000, 0, -4000}, {0, 0, -4000});
    mesh.add(shapes::quad({0, 0, 4000}, {0, 0, -4000}, {0, 2, -4000}, {0, 2, 4000}));
    std::vector<Vec3f> positions;
    for (const float d : {0.3f, 1.0f, 2.0f, 5.0f}) positions.push_back({d, 0, 0});
    const BounceResult result =
        bounced(greyScene(mesh, 0.5f), surfaceOf(positions, {0, 1, 0}), {1, 8192, 3}, uniformSky(), 4096);
    for (size_t i = 0; i < positions.size(); ++i) {
        const double d = double(positions[i].x()), toWall = 0.5 * (1 - d / std::hypot(d, 2));
        EXPECT_NEAR(result.irradiance[0][3 * i], kPi * (1 - toWall) + 0.5 * kPi / 2 * toWall, 0.006 * kPi)
            << d;
    }
}

// Under a uniform sky white surfaces are as bright as the sky, once all light has got out again.
TEST(Bounces, WhiteFurnace) {
    const Mesh mesh = clutter();
    Camera camera;
    camera.eye = {3, 3, 4};
    const SurfaceImage surface =
        castPrimaryRays(RayCaster(mesh.positions, mesh.indices), sceneOf(mesh), camera, 31, 19);
    const Scene white = greyScene(mesh, 1), black = greyScene(mesh, 0);
    const BounceResult direct = bounced(white, surface, {0, 64, 1});
    std::vector<float> last = direct.irradiance[0];
    for (const int bounces : {1, 2, 8, 32}) {
        const BounceResult result = bounced(white, surface, {bounces, 64, 1});
        for (size_t i = 0; i < last.size(); ++i) EXPECT_GE(result.irradiance[0][i], last[i]);
        last = result.irradiance[0];
    }
    double sum = 0;
    size_t covered = 0;
    for (size_t i = 0; i < surface.pixels(); ++i) {
        if (surface.triangle[i] == kNoTriangle) {
            EXPECT_EQ(last[3 * i], 0.0f);
            continue;
        }
        sum += double(last[3 * i]);
        ++covered;
    }
    ASSERT_GT(covered, 100u);
    // The floor ends, below it the same sky shines: nothing is lost. Noise of 64 paths for each of the
    // pixels.
    EXPECT_NEAR(sum / double(covered), kPi, 0.01 * kPi);
    EXPECT_EQ(bounced(black, surface, {4, 64, 1}).irradiance, direct.irradiance);
}

TEST(Bounces, NoBounceIsTheDirectReference) {
    const Mesh mesh = clutter();
    const RayCaster caster(mesh.positions, mesh.indices);
    const Scene scene = greyScene(mesh, 0.6f);
    Camera camera;
    camera.eye = {3, 3, 4};
    const SurfaceImage surface = castPrimaryRays(caster, scene, camera, 33, 21);
    const Environment sky = uniformSky();
    const ReferenceDirections directions =
        makeReferenceDirections(std::span(&sky, 1), std::vector<double>{0.4}, 512);
    const BounceResult result =
        traceReferenceBounces(caster, surface, directions, SurfaceAlbedo(scene), BounceOptions{});
    EXPECT_EQ(result.irradiance, traceReference(caster, surface, directions));
    EXPECT_EQ(result.relativeError, std::vector<double>{0.0});
    EXPECT_EQ(result.rays, 0u);
}

// Two environments at once, the second of them a small sun; any number of threads.
TEST(Bounces, EnvironmentsTogetherAndThreads) {
    const Mesh mesh = clutter();
    const RayCaster caster(mesh.positions, mesh.indices);
    const Scene scene = greyScene(mesh, 0.7f);
    Camera camera;
    camera.eye = {3, 3, 4};
    const SurfaceImage surface = castPrimaryRays(caster, scene, camera, 25, 15);
    std::vector<Environment> both = {uniformSky(), uniformSky(0)};
    both[1].image.at(3, 2)[1] = 100;
    const std::vector<double> rotations = {0, 0};
    const ReferenceDirections directions = makeReferenceDirections(both, rotations, 600);
    const SurfaceAlbedo albedo(scene);
    setThreadCount(1);
    const BounceResult one = traceReferenceBounces(caster, surface, directions, albedo, {2, 128, 5});
    setThreadCount(2);
    const BounceResult two = traceReferenceBounces(caster, surface, directions, albedo, {2, 128, 5});
    setThreadCount(0);
    EXPECT_EQ(one.irradiance, two.irradiance);
    EXPECT_EQ(one.relativeError, two.relativeError);
    EXPECT_EQ(one.rays, two.rays);

    const ReferenceDirections alone =
        makeReferenceDirections(std::span(&both[1], 1), std::vector<double>{0.0}, 600);
    const BounceResult sun = traceReferenceBounces(caster, surface, alone, albedo, {2, 128, 5});
    const double expected = meanOf(sun.irradiance[0]);
    EXPECT_GT(expected, 0.01);
    EXPECT_NEAR(meanOf(one.irradiance[1]), expected, 0.02 * expected);
    for (size_t i = 0; i < surface.pixels(); ++i) EXPECT_EQ(one.irradiance[1][3 * i], 0.0f);  // no red
}

// What the halves say of the noise is what it is, and it falls with the number of paths.
TEST(Bounces, EstimatedErrorIsNearTheTrueOne) {
    const HollowSphere sphere(0.0);
    const Scene scene = greyScene(sphere.mesh, 0.7f);
    const std::vector<float> truth = bounced(scene, sphere.surface, {2, 16384, 11}).irradiance[0];
    double last = 1;
    for (const int paths : {32, 512}) {
        const BounceResult result = bounced(scene, sphere.surface, {2, paths, 12});
        double error = 0, square = 0;
        for (size_t i = 0; i < truth.size(); ++i) {
            error += std::pow(double(result.irradiance[0][i]) - double(truth[i]), 2);
            square += std::pow(double(truth[i]), 2);
        }
        const double relative = std::sqrt(error / square);
        EXPECT_LT(relative, 1.5 * result.relativeError[0]) << paths;
        EXPECT_GT(relative, result.relativeError[0] / 3) << paths;
        EXPECT_LT(relative, last / 3.5) << paths;
        last = relative;
    }
}

// A roof that looks up: what is below sees its back.
TEST(Bounces, BacksAreBlackUnlessDoubleSided) {
    Mesh mesh = shapes::floorSquare(3);
    mesh.add(shapes::floorSquare(1, 1));
    Scene scene = greyScene(mesh, 0.8f);
    const SurfaceImage surface = surfaceOf({{0, 0, 0}, {0.5f, 0, 0.5f}}, {0, 1, 0});
    const BounceResult direct = bounced(scene, surface, {0, 256, 1});
    EXPECT_EQ(bounced(scene, surface, {3, 256, 1}).irradiance, direct.irradiance);
    scene.materials[0].doubleSided = true;
    // The roof's back is lit by the floor, and by the sky below the floor's edges.
    EXPECT_GT(bounced(scene, surface, {3, 256, 1}).irradiance[0][0], 1.05f * direct.irradiance[0][0]);
}

TEST(Bounces, OptionsOutOfRangeAndInterruption) {
    const Scene scene = greyScene(shapes::floorSquare(5), 0.5f);
    const SurfaceImage surface = surfaceOf({{0, 0, 0}}, {0, 1, 0});
    for (const BounceOptions& options : {BounceOptions{-1, 2, 1}, BounceOptions{kMaxBounces + 1, 2, 1},
                                         BounceOptions{1, 0, 1}, BounceOptions{1, 3, 1}})
        EXPECT_THROW(bounced(scene, surface, options), UsageError);
    requestInterrupt();
    EXPECT_THROW(bounced(scene, surface, {1, 2, 1}), Interrupted);
    clearInterrupt();
}

}  // namespace
}  // namespace prt
