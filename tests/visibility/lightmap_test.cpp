// Lightmaps against closed forms and against traced paths, per texel and per vertex.
#include "precompute/visibility/lightmap.h"

#include <array>
#include <cmath>
#include <numbers>

#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/lightmap_points.h"
#include "runtime/reference/reference.h"
#include "tests/reference/reference_scenes.h"

namespace prt {
namespace {

using shapes::Mesh;
constexpr double kPi = std::numbers::pi;

// Bright from one side, dim from the others.
Environment sideLight() {
    Environment environment = uniformSky(0.3f);
    environment.image = {32, 16, 3, std::vector<float>(32 * 16 * 3, 0.3f)};
    for (int y = 2; y < 6; ++y)
        for (int x = 4; x < 8; ++x) {
            environment.image.at(x, y)[0] = 9;
            environment.image.at(x, y)[1] = 6;
        }
    return environment;
}

// A scene with both kinds of points: a box without a lid that is seen from inside, every wall a grid of quads
// with its own place in the atlas.
struct OpenBox {
    static constexpr int kCells = 12, kAtlas = 96;
    Scene scene;
    PointGrid texels{PointDomain::Texel, kAtlas, kAtlas, size_t(kAtlas* kAtlas)};
    PointGrid vertices;

    OpenBox() {
        Mesh mesh;
        std::vector<Vec2f> uv1;
        std::vector<Vec3f> normals;
        const auto wall = [&](const Vec3f& corner, const Vec3f& across, const Vec3f& along, int place) {
            const auto first = uint32_t(mesh.positions.size());
            for (int j = 0; j <= kCells; ++j)
                for (int i = 0; i <= kCells; ++i) {
                    const float u = float(i) / kCells, v = float(j) / kCells;
                    mesh.positions.push_back(corner + u * across + v * along);
                    normals.push_back(across.cross(along).normalized());
                    uv1.push_back(
                        Vec2f(float(place % 3) * 32 + 2 + 28 * u, float(place / 3) * 32 + 2 + 28 * v) /
                        float(kAtlas));
                }
            const auto at = [&](int i, int j) { return first + uint32_t(j * (kCells + 1) + i); };
            for (int j = 0; j < kCells; ++j)
                for (int i = 0; i < kCells; ++i)
                    for (const uint32_t index :
                         {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)})
                        mesh.indices.push_back(index);
        };
        wall({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0);     // floor, up
        wall({-1, 0, -1}, {2, 0, 0}, {0, 1.5f, 0}, 1);  // towards +z
        wall({1, 0, 1}, {-2, 0, 0}, {0, 1.5f, 0}, 2);   // towards −z
        wall({-1, 0, 1}, {0, 0, -2}, {0, 1.5f, 0}, 3);  // towards +x
        wall({1, 0, -1}, {0, 0, 2}, {0, 1.5f, 0}, 4);   // towards −x
        scene = sceneOf(mesh);
        scene.normals = normals;
        scene.uv1 = uv1;
        scene.materials[0].baseColor = Vec3f(0.8f, 0.5f, 0.2f);
        vertices = vertexGrid(scene.vertexCount());
    }
    // Middles of triangles spread over the box.
    SurfaceImage samples(uint32_t step = 23) const {
        std::vector<Vec3f> positions, normals;
        std::vector<uint32_t> triangles;
        for (uint32_t t = 13; t < scene.triangleCount(); t += step) {
            const auto corner = [&](size_t k) { return scene.positions[scene.indices[3 * t + k]]; };
            positions.push_back((corner(0) + corner(1) + corner(2)) / 3);
            normals.push_back(triangleNormal(scene, t));
            triangles.push_back(t);
        }
        SurfaceImage surface = surfaceOf(positions, {0, 1, 0});
        surface.triangle = triangles;
        surface.geometricNormal = surface.shadingNormal = normals;
        return surface;
    }
};

struct Baked {
    LightmapBake bake;
    std::vector<float> at;  ///< [samples×3] irradiance between the points
};

Baked bakeOf(const Scene& scene, const PointGrid& grid, const Environment& environment,
             const LightmapOptions& options, const SurfaceImage& samples, double rotationRad = 0) {
    const RayCaster caster(scene.positions, scene.indices);
    const std::vector<Validity> validity(grid.count, Validity::Valid);
    const EnvironmentSampler light(environment.view(), rotationRad);
    Baked baked{bakeLightmap(caster, scene, SurfaceAlbedo(scene), grid, validity, light, options), {}};
    const LightmapPoints points(scene, grid, validity);
    for (size_t i = 0; i < samples.pixels(); ++i) {
        const Vec3f e = points.at(baked.bake.irradiance, samples.triangle[i], 1.0f / 3, 1.0f / 3);
        baked.at.insert(baked.at.end(), {e.x(), e.y(), e.z()});
    }
    return baked;
}

std::vector<float> pathsOf(const Scene& scene, const Environment& environment, const SurfaceImage& samples,
                           int bounces, double rotationRad = 0) {
    const RayCaster caster(scene.positions, scene.indices);
    const ReferenceDirections directions =
        makeReferenceDirections(std::span(&environment, 1), std::vector{rotationRad}, 8192);
    return traceReferenceBounces(caster, samples, directions, SurfaceAlbedo(scene), {bounces, 1024, 1})
        .irradiance[0];
}

double relativeRmse(const std::vector<float>& values, const std::vector<float>& truth) {
    EXPECT_EQ(values.size(), truth.size());
    double error = 0, square = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        error += std::pow(double(values[i]) - double(truth[i]), 2);
        square += std::pow(double(truth[i]), 2);
    }
    return std::sqrt(error / square);
}

double sumOf(const std::vector<float>& values) {
    double sum = 0;
    for (const float value : values) sum += double(value);
    return sum;
}

float irradianceOf(const LightmapBake& bake, size_t point, size_t colour, const Vec3f& normal) {
    std::array<float, kLightmapCoefficients> cosine{};
    evalClampedCosineSh(kLightmapShOrder, normal, cosine);
    float sum = 0;
    for (size_t i = 0; i < cosine.size(); ++i)
        sum += cosine[i] * bake.coefficients[(point * 3 + colour) * cosine.size() + i];
    return sum;
}

// Both kinds of points against paths, which share nothing with them but the albedo; hence against each other.
TEST(Lightmap, TexelsAndVerticesAgreeWithPaths) {
    const OpenBox box;
    const Environment environment = sideLight();
    const SurfaceImage samples = box.samples();
    for (const int bounces : {0, 2}) {
        const std::vector<float> truth = pathsOf(box.scene, environment, samples, bounces, 0.7);
        const LightmapOptions options{bounces, 256, {}};
        const Baked texels = bakeOf(box.scene, box.texels, environment, options, samples, 0.7);
        const Baked vertices = bakeOf(box.scene, box.vertices, environment, options, samples, 0.7);
        // The noise of 256 rays, and what penumbras lose between points; on the whole they agree.
        EXPECT_LT(relativeRmse(texels.at, truth), 0.05) << bounces;
        EXPECT_LT(relativeRmse(vertices.at, truth), 0.08) << bounces;
        EXPECT_NEAR(sumOf(texels.at), sumOf(truth), 0.01 * sumOf(truth)) << bounces;
        EXPECT_NEAR(sumOf(vertices.at), sumOf(truth), 0.03 * sumOf(truth)) << bounces;
        EXPECT_LT(texels.bake.relativeError, 0.04);
        EXPECT_GT(texels.bake.relativeError, 0.0005);
    }
}

TEST(Lightmap, ExpansionHasTheIrradianceOfTheGeometricNormal) {
    const OpenBox box;
    const SurfaceImage samples = box.samples();
    const Baked baked = bakeOf(box.scene, box.vertices, sideLight(), {2, 64, {}}, samples);
    double error = 0, square = 0;
    const Baked plain = bakeOf(box.scene, box.vertices, sideLight(), {2, 64, kPlainProjection}, samples);
    EXPECT_EQ(plain.bake.irradiance, baked.bake.irradiance);
    for (size_t v = 0; v < box.scene.vertexCount(); ++v)
        for (size_t c = 0; c < 3; ++c) {
            const float e = baked.bake.irradiance[3 * v + c];
            EXPECT_NEAR(irradianceOf(baked.bake, v, c, box.scene.normals[v]), e, 2e-4f * (1 + e));
            error += std::pow(double(irradianceOf(plain.bake, v, c, box.scene.normals[v]) - e), 2);
            square += double(e) * double(e);
        }
    Lightmap map;
    map.grid = box.vertices;
    map.coefficients = baked.bake.coefficients;
    const FloatImage image = lightmapIrradiance(map, box.scene.normals);
    ASSERT_EQ(image.pixels.size(), size_t(kVertexRowLength) * size_t(map.grid.height) * 3);
    for (size_t i = 0; i < baked.bake.irradiance.size(); ++i)
        EXPECT_NEAR(image.pixels[i], baked.bake.irradiance[i], 2e-4f * (1 + baked.bake.irradiance[i]));
    // Three bands of a plain expansion: 3.5 % here.
    EXPECT_LT(std::sqrt(error / square), 0.08);
    EXPECT_GT(std::sqrt(error / square), 0.005);
}

// The inside of a sphere with a hole, as in the reference's test: E_k = π L f Σ_{j ≤ k} (ρ (1 − f))^j.
TEST(Lightmap, InsideOfASphereWithAHole) {
    Mesh sphere = shapes::sphere(1, {0, 0, 0}, 4);
    sphere.flip();
    Mesh mesh;
    mesh.positions = sphere.positions;
    double whole = 0, kept = 0;
    for (size_t t = 0; t < sphere.triangles(); ++t) {
        const Vec3d a = sphere.corner(t, 0);
        const double area = (sphere.corner(t, 1) - a).cross(sphere.corner(t, 2) - a).norm() / 2;
        whole += area;
        if (sphere.point(t, 1.0 / 3, 1.0 / 3).y() > 0.3f) continue;
        kept += area;
        for (size_t k = 0; k < 3; ++k) mesh.indices.push_back(sphere.indices[3 * t + k]);
    }
    const double hole = 1 - kept / whole, rho = 0.75;
    Scene scene = sceneOf(mesh);
    scene.materials[0].baseColor = Vec3f(float(rho), 1, 0);
    const PointGrid grid = vertexGrid(scene.vertexCount());
    for (const int bounces : {0, 3}) {
        const Baked baked = bakeOf(scene, grid, uniformSky(2), {bounces, 256, {}}, {});
        double sum = 0;
        size_t count = 0;
        for (size_t v = 0; v < grid.count; ++v) {
            if (scene.positions[v].y() > 0.2f) continue;
            sum += double(baked.bake.irradiance[3 * v]);
            ++count;
        }
        double factor = 0;
        for (int j = 0; j <= bounces; ++j) factor += std::pow(rho * (1 - hole), j);
        const double expected = 2 * kPi * hole * factor;
        EXPECT_NEAR(sum / double(count), expected, 0.006 * expected) << bounces;
    }
}

// What is white under a uniform sky is as bright as the sky, after enough bounces.
TEST(Lightmap, WhiteFurnace) {
    OpenBox box;
    box.scene.materials[0].baseColor = Vec3f(1, 1, 1);
    box.scene.materials[0].doubleSided = true;  // so that no light is lost at the backs of the walls
    const SurfaceImage samples = box.samples();
    const Baked baked = bakeOf(box.scene, box.vertices, uniformSky(), {24, 32, {}}, samples);
    for (const float e : baked.at) EXPECT_NEAR(e, kPi, 0.04 * kPi);
}

TEST(Lightmap, BacksAreBlackUnlessDoubleSided) {
    Mesh mesh = shapes::floorSquare(3);
    mesh.add(shapes::floorSquare(1, 1));
    Scene scene = sceneOf(mesh);
    // The roof has vertices of its own in a finer grid's stead: four corners see what its middle sees,
    // nearly.
    const PointGrid grid = vertexGrid(scene.vertexCount());
    const Baked direct = bakeOf(scene, grid, uniformSky(), {0, 512, {}}, {});
    const Baked black = bakeOf(scene, grid, uniformSky(), {2, 512, {}}, {});
    EXPECT_NEAR(direct.bake.irradiance[0], black.bake.irradiance[0], 0.01 * kPi);
    scene.materials[0].doubleSided = true;
    const Baked lit = bakeOf(scene, grid, uniformSky(), {2, 512, {}}, {});
    EXPECT_GT(lit.bake.irradiance[0], black.bake.irradiance[0] + 0.001f);
}

// Open ground: V is 1 above it, so that the light with three bands is what irradiance asks of the bundle.
TEST(Lightmap, DirectLightOnOpenGroundIsVisibilityTimesLight) {
    Scene scene = sceneOf(shapes::floorSquare(4));
    scene.normals.assign(4, Vec3f(0, 1, 0));
    const PointGrid grid = vertexGrid(4);
    Environment sky = uniformSky();
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 16; ++x)
            for (int c = 0; c < 3; ++c)
                sky.image.at(x, y)[c] = 1.5f + std::sin(float(x + 3 * c) * 0.39f) - 0.1f * float(y);
    const Baked baked = bakeOf(scene, grid, sky, {0, 4096, {}}, {});
    const EnvironmentSampler light(sky.view(), 0);
    for (const double tiltDeg : {0.0, 20.0, 35.0}) {
        const double tilt = tiltDeg * kPi / 180;
        const Vec3f normal = Vec3d(0.6 * std::sin(tilt), std::cos(tilt), 0.8 * std::sin(tilt)).cast<float>();
        Vec3d expected = Vec3d::Zero();
        for (const SphereNode& node : sphereQuadrature(255)) {
            if (node.direction.y() <= 0) continue;
            const double cosine = node.direction.dot(normal.cast<double>());
            if (cosine <= 0) continue;
            expected +=
                node.weightSr * cosine * light.evaluate(node.direction.cast<float>()).radiance.cast<double>();
        }
        for (size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(irradianceOf(baked.bake, 0, c, normal), expected[int(c)], 0.03 * expected[int(c)])
                << tiltDeg;
    }
}

TEST(Lightmap, SameForAnyNumberOfThreads) {
    const OpenBox box;
    setThreadCount(1);
    const Baked one = bakeOf(box.scene, box.vertices, sideLight(), {2, 32, {}}, {});
    setThreadCount(3);
    const Baked three = bakeOf(box.scene, box.vertices, sideLight(), {2, 32, {}}, {});
    setThreadCount(0);
    EXPECT_EQ(one.bake.coefficients, three.bake.coefficients);
    EXPECT_EQ(one.bake.relativeError, three.bake.relativeError);
    EXPECT_EQ(one.bake.rays, three.bake.rays);
}

TEST(Lightmap, EstimatedNoiseIsNearTheTrueOne) {
    const OpenBox box;
    const Environment environment = sideLight();
    const std::vector<float> truth =
        bakeOf(box.scene, box.vertices, environment, {1, 2048, {}}, {}).bake.irradiance;
    for (const int rays : {32, 128}) {
        const Baked baked = bakeOf(box.scene, box.vertices, environment, {1, rays, {}}, {});
        const double error = relativeRmse(baked.bake.irradiance, truth);
        EXPECT_LT(error, 1.6 * baked.bake.relativeError) << rays;
        EXPECT_GT(error, baked.bake.relativeError / 4) << rays;
    }
}

TEST(Lightmap, InsideTexelsAreFilled) {
    const OpenBox box;
    const RayCaster caster(box.scene.positions, box.scene.indices);
    std::vector<Validity> validity(box.vertices.count, Validity::Valid);
    const size_t middle = size_t(12 * 25 + 12);  // of the floor
    validity[middle] = Validity::InsideFilled;
    const Environment sky = sideLight();
    const EnvironmentSampler light(sky.view(), 0);
    const LightmapBake bake =
        bakeLightmap(caster, box.scene, SurfaceAlbedo(box.scene), box.vertices, validity, light, {0, 64, {}});
    // Its neighbours' mean by the inverse of the edges: between them.
    float low = 1e9f, high = 0;
    for (const int step : {-1, 1, -13, 13, 14, -14}) {
        const float e = bake.irradiance[3 * size_t(int(middle) + step)];
        low = std::min(low, e);
        high = std::max(high, e);
    }
    EXPECT_GE(bake.irradiance[3 * middle], low - 1e-4f);
    EXPECT_LE(bake.irradiance[3 * middle], high + 1e-4f);
}

TEST(Lightmap, DarknessOptionsAndInterruption) {
    const Scene scene = sceneOf(shapes::floorSquare(4));
    const PointGrid grid = vertexGrid(4);
    const Baked dark = bakeOf(scene, grid, uniformSky(0), {2, 16, {}}, {});
    for (const float value : dark.bake.coefficients) EXPECT_EQ(value, 0.0f);
    EXPECT_EQ(dark.bake.relativeError, 0);
    for (const LightmapOptions& options :
         {LightmapOptions{-1, 64, {}}, LightmapOptions{kMaxLightmapBounces + 1, 64, {}},
          LightmapOptions{1, kMinLightmapRays - 1, {}}, LightmapOptions{1, kMaxLightmapRays + 1, {}}})
        EXPECT_THROW(bakeOf(scene, grid, uniformSky(), options, {}), UsageError);
    requestInterrupt();
    EXPECT_THROW(bakeOf(scene, grid, uniformSky(), {1, 64, {}}, {}), Interrupted);
    clearInterrupt();
}

}  // namespace
}  // namespace prt
