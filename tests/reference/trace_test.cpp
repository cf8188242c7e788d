// Irradiance of the reference against closed forms.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
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

std::vector<float> irradiance(const Mesh& mesh, const SurfaceImage& surface, int baseCount = 4096,
                              const Environment& environment = uniformSky()) {
    const RayCaster caster(mesh.positions, mesh.indices);
    const ReferenceDirections directions =
        makeReferenceDirections(std::span(&environment, 1), std::vector<double>{0.0}, baseCount);
    return traceReference(caster, surface, directions)[0];
}

TEST(Reference, OpenPlane) {
    for (const float radiance : {1.0f, 2.5f}) {
        const SurfaceImage surface = surfaceOf({{0, 0, 0}, {0.5f, 0, 0.2f}}, {0, 1, 0});
        for (const float e : irradiance(shapes::floorSquare(5), surface, 4096, uniformSky(radiance)))
            EXPECT_NEAR(e, kPi * double(radiance), 0.002 * kPi * double(radiance));
    }
}

// Geometric horizon, tilted cosine: (π/2)(1 + cos δ).
TEST(Reference, TiltedShadingNormal) {
    SurfaceImage surface = surfaceOf({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {0, 1, 0});
    const double tilts[] = {0, 20, 35, 60};
    for (size_t i = 0; i < 4; ++i) {
        const double a = tilts[i] * kPi / 180;
        surface.shadingNormal[i] = Vec3d(0.6 * std::sin(a), std::cos(a), -0.8 * std::sin(a)).cast<float>();
    }
    const std::vector<float> e = irradiance(shapes::floorSquare(5), surface);
    for (size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(e[3 * i], kPi / 2 * (1 + std::cos(tilts[i] * kPi / 180)), 0.003 * kPi) << tilts[i];
}

// The wedge: floor beside a wall of height h without end, E = π(1 − ½(1 − d/√(d² + h²))).
TEST(Reference, PlaneUnderAWall) {
    Mesh mesh = shapes::quad({0, 0, 4000}, {8000, 0, 4000}, {8000, 0, -4000}, {0, 0, -4000});
    mesh.add(shapes::quad({0, 0, 4000}, {0, 0, -4000}, {0, 2, -4000}, {0, 2, 4000}));
    std::vector<Vec3f> positions;
    for (const float d : {0.05f, 0.3f, 1.0f, 2.0f, 5.0f, 30.0f}) positions.push_back({d, 0, 0});
    const std::vector<float> e = irradiance(mesh, surfaceOf(positions, {0, 1, 0}));
    for (size_t i = 0; i < positions.size(); ++i) {
        const double d = double(positions[i].x());
        EXPECT_NEAR(e[3 * i], kPi * (0.5 + 0.5 * d / std::hypot(d, 2)), 0.005 * kPi) << d;
    }
}

// A sphere of radius r resting on the plane hides (r/D)² cos θ of the cosine, D the distance to its centre.
TEST(Reference, SphereRestingOnAPlane) {
    Mesh mesh = shapes::floorSquare(50);
    mesh.add(shapes::sphere(1, {0, 1, 0}, 5));
    std::vector<Vec3f> positions;
    for (const float x : {0.2f, 0.5f, 1.0f, 1.5f, 2.0f, 4.0f, 8.0f})
        positions.push_back({0.6f * x, 0, 0.8f * x});
    const std::vector<float> e = irradiance(mesh, surfaceOf(positions, {0, 1, 0}), 16384);
    for (size_t i = 0; i < positions.size(); ++i) {
        const double squared = 1 + double(positions[i].squaredNorm());
        EXPECT_NEAR(e[3 * i], kPi * (1 - std::pow(squared, -1.5)), 0.004 * kPi) << positions[i].transpose();
    }
}

TEST(Reference, ConvergesWithTheNumberOfDirections) {
    Mesh mesh = shapes::floorSquare(50);
    mesh.add(shapes::sphere(1, {0, 1, 0}, 5));
    std::vector<Vec3f> positions;
    for (int i = 0; i < 200; ++i) positions.push_back({0.3f + 0.02f * float(i), 0, 0.1f * float(i % 7)});
    const SurfaceImage surface = surfaceOf(positions, {0, 1, 0});
    double last = 1e9;
    for (const int baseCount : {256, 2048, 16384}) {
        const std::vector<float> e = irradiance(mesh, surface, baseCount);
        double sum = 0;
        for (size_t i = 0; i < positions.size(); ++i)
            sum += std::pow(
                double(e[3 * i]) / kPi - (1 - std::pow(1 + double(positions[i].squaredNorm()), -1.5)), 2);
        const double rms = std::sqrt(sum / double(positions.size()));
        EXPECT_LT(rms, last / 2);
        last = rms;
    }
    EXPECT_LT(last, 0.0015);
}

// A sun of one texel: E = L ΔΩ cos θ, wherever it stands; blocked behind a wall.
TEST(Reference, SmallSun) {
    Environment environment = uniformSky(0);
    environment.image = {512, 256, 3, std::vector<float>(512 * 256 * 3, 0.0f)};
    const int x = 128, y = 60;  // longitude π/2: +X
    environment.image.at(x, y)[1] = 1000;
    const double latitude = kPi / 2 - kPi * (y + 0.5) / 256;
    const double sr = 2 * kPi / 512 * (std::cos(kPi * y / 256) - std::cos(kPi * (y + 1) / 256));
    Mesh mesh = shapes::floorSquare(50);
    mesh.add(shapes::quad({2, 0, -5}, {2, 0, 5}, {2, 5, 5}, {2, 5, -5}));
    const SurfaceImage surface = surfaceOf({{1, 0, 0}, {3, 0, 0}, {-20, 0, 0}}, {0, 1, 0});
    const std::vector<float> e = irradiance(mesh, surface, 1024, environment);
    EXPECT_EQ(e[1], 0.0f);
    EXPECT_NEAR(e[4], 1000 * sr * std::sin(latitude), 1e-3 * 1000 * sr);
    EXPECT_NEAR(e[7], 1000 * sr * std::sin(latitude), 1e-3 * 1000 * sr);
    EXPECT_EQ(e[3], 0.0f);
    EXPECT_EQ(e[5], 0.0f);
}

// One pass over several environments gives what one pass each gives, the visitor sees what was summed, and
// threads do not matter.
TEST(Reference, OnePassForAllEnvironments) {
    const Mesh mesh = clutter();
    const Scene scene = sceneOf(mesh);
    const RayCaster caster(mesh.positions, mesh.indices);
    Camera camera;
    camera.eye = {3, 3, 4};
    const SurfaceImage surface = castPrimaryRays(caster, scene, camera, 41, 23);
    std::vector<Environment> environments = {uniformSky(), uniformSky(0)};
    for (int x = 0; x < 16; ++x) environments[1].image.at(x, 2)[0] = float(x);
    const std::vector<double> rotations = {0, 0.3};
    const ReferenceDirections directions = makeReferenceDirections(environments, rotations, 600);

    std::vector<std::vector<uint8_t>> seen(surface.pixels());
    setThreadCount(1);
    const auto one =
        traceReference(caster, surface, directions, [&](size_t pixel, std::span<const uint8_t> visible) {
            EXPECT_TRUE(seen[pixel].empty());
            seen[pixel].assign(visible.begin(), visible.end());
        });
    setThreadCount(2);
    std::atomic<size_t> calls{0};
    const auto two =
        traceReference(caster, surface, directions, [&](size_t, std::span<const uint8_t>) { ++calls; });
    setThreadCount(0);
    EXPECT_EQ(one, two);

    size_t covered = 0;
    for (size_t pixel = 0; pixel < surface.pixels(); ++pixel) {
        if (surface.triangle[pixel] == kNoTriangle) {
            EXPECT_TRUE(seen[pixel].empty());
            for (size_t c = 0; c < 3; ++c) EXPECT_EQ(one[0][3 * pixel + c], 0.0f);
            continue;
        }
        ++covered;
        ASSERT_EQ(seen[pixel].size(), directions.direction.size());
        for (size_t e = 0; e < 2; ++e)
            for (size_t c = 0; c < 3; ++c) {
                double expected = 0;
                for (size_t k = 0; k < seen[pixel].size(); ++k) {
                    if (surface.geometricNormal[pixel].dot(directions.direction[k]) <= 0) {
                        EXPECT_EQ(seen[pixel][k], 0);
                    }
                    if (!seen[pixel][k]) continue;
                    expected +=
                        std::max(0.0, double(surface.shadingNormal[pixel].dot(directions.direction[k]))) *
                        double(directions.radiance[e][3 * k + c]) * double(directions.solidAngleSr[k]);
                }
                EXPECT_NEAR(one[e][3 * pixel + c], expected, 1e-5 * (1 + expected));
            }
    }
    EXPECT_EQ(calls, covered);
    EXPECT_GT(covered, 200u);
    EXPECT_LT(covered, surface.pixels());
}

// Positions that a rasteriser left above or below the surface are put back on it.
TEST(Reference, PositionsOffTheSurfaceDoNotMatter) {
    const Mesh mesh = shapes::floorSquare(5);
    SurfaceImage exact = surfaceOf({{0.3f, 0, 0.7f}, {1, 0, 2}}, {0, 1, 0});
    SurfaceImage off = exact;
    off.position[0].y() = -3e-5f;
    off.position[1].y() = 3e-5f;
    EXPECT_EQ(irradiance(mesh, exact), irradiance(mesh, off));
    EXPECT_GT(irradiance(mesh, off)[0], 3.0f);
}

TEST(Reference, CanBeInterrupted) {
    const SurfaceImage surface = surfaceOf({{0, 0, 0}}, {0, 1, 0});
    requestInterrupt();
    EXPECT_THROW(irradiance(shapes::floorSquare(5), surface), Interrupted);
    clearInterrupt();
}

TEST(PrimaryRays, PixelsProjectBackOntoThemselves) {
    const Mesh mesh = clutter();
    Scene scene = sceneOf(mesh);
    const RayCaster caster(mesh.positions, mesh.indices);
    for (const bool normals : {false, true}) {
        if (normals)
            for (const Vec3f& p : mesh.positions) scene.normals.push_back((p - Vec3f(0, -1, 0)).normalized());
        Camera camera;
        camera.eye = {2, 2.5f, 5};
        camera.target = {0.2f, 0.3f, 0};
        camera.verticalFovDeg = 50;
        const int width = 64, height = 40;
        const SurfaceImage image = castPrimaryRays(caster, scene, camera, width, height);
        ASSERT_EQ(image.pixels(), size_t(width * height));
        const Vec3d forward = (camera.target - camera.eye).cast<double>().normalized();
        const Vec3d right = forward.cross(Vec3d(0, 1, 0)).normalized(), up = right.cross(forward);
        EXPECT_GT(right.x(), 0);  // seen from +z, +x is to the right
        size_t covered = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const size_t i = size_t(y * width + x);
                if (image.triangle[i] == kNoTriangle) continue;
                ++covered;
                const Vec3d offset = image.position[i].cast<double>() - camera.eye.cast<double>();
                const double depth = offset.dot(forward), focal = height / 2.0 / std::tan(25 * kPi / 180);
                EXPECT_NEAR(width / 2.0 + focal * offset.dot(right) / depth, x + 0.5, 1e-3);
                EXPECT_NEAR(height / 2.0 - focal * offset.dot(up) / depth, y + 0.5, 1e-3);
                const Vec3f face = mesh.normal(image.triangle[i]);
                EXPECT_LT((image.geometricNormal[i] - face).norm(), 1e-6f);
                EXPECT_LT(
                    (caster.snapToPlane(image.position[i], image.triangle[i]) - image.position[i]).norm(),
                    2e-6f);
                EXPECT_NEAR(image.shadingNormal[i].norm(), 1, 1e-6);
                if (!normals) {
                    EXPECT_EQ(image.shadingNormal[i], image.geometricNormal[i]);
                }
                EXPECT_EQ(image.albedo[i], Vec3f(1, 1, 1));
            }
        EXPECT_GT(covered, 500u);
        EXPECT_LT(covered, image.pixels());
    }
}

}  // namespace
}  // namespace prt
