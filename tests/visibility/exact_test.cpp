// What is exact in a bake: all of a constant light where nothing hides it, and independence of the scale, the
// place and the axes of the scene.
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "precompute/base/parallel.h"
#include "precompute/io/projection_attributes.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/irradiance_norm.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation.h"
#include "precompute/mesh/atlas.h"
#include "precompute/visibility/bake.h"
#include "tests/mesh/mesh_kinds.h"
#include "tests/rays/shapes.h"

namespace prt {
namespace {

using shapes::Mesh;
constexpr double kPi = std::numbers::pi;

Scene sceneWithNormals(const Mesh& mesh) {
    Scene scene = sceneOf(mesh.positions, mesh.indices);
    scene.normals.assign(scene.positions.size(), Vec3f(0, 1, 0));
    return scene;
}

constexpr int kAtlas = 32;

Scene unwrapped(const Mesh& mesh) {
    Scene scene = sceneWithNormals(mesh);
    AtlasOptions options;
    options.texels = kAtlas;
    buildAtlas(scene, options);
    return scene;
}

// Uniform sets of several sizes (error 0), and adaptive ones.
struct Sampling {
    int rays;
    double error;
};
constexpr Sampling kSamplings[] = {{64, 0}, {512, 0}, {1024, 0}, {0, 0.01}};

std::string nameOf(int shOrder, const Sampling& sampling) {
    return std::to_string(shOrder) + " bands, " +
           (sampling.rays > 0 ? std::to_string(sampling.rays) + " directions" : "adaptive");
}

BakeOptions optionsOf(int shOrder, const Sampling& sampling) {
    BakeOptions options;
    options.shOrder = shOrder;
    options.error = sampling.error;
    if (sampling.rays > 0) options.rays = sampling.rays;
    return options;
}

// ∫ V̂ max(0, n·ω) dω with every band of the cosine that V̂ has.
double whiteIrradiance(const BakeResult& baked, size_t point, int shOrder, const Vec3f& normal) {
    const size_t columns = size_t(shCount(shOrder));
    std::vector<float> cosine(columns);
    evalClampedCosineSh(shOrder, normal, cosine);
    double sum = 0;
    for (size_t c = 0; c < columns; ++c)
        sum += double(baked.coefficients[point * columns + c]) * double(cosine[c]);
    return sum;
}

TEST(ExactBake, PointsOfAnOpenSphereReceiveAllOfConstantLight) {
    const Mesh mesh = shapes::sphere(1, {0, 0, 0}, 2);
    const RayCaster caster(mesh.positions, mesh.indices);
    std::vector<SurfacePoint> points;
    for (uint32_t t = 0; t < mesh.triangles(); t += 3)
        points.push_back({mesh.point(t, 0.2, 0.3), mesh.normal(t), t});
    for (const Sampling& sampling : kSamplings)
        for (int shOrder = 1; shOrder <= kMaxBundleShOrder; ++shOrder) {
            const BakeResult baked = bakeVisibility(caster, points, optionsOf(shOrder, sampling));
            for (size_t i = 0; i < points.size(); ++i) {
                EXPECT_EQ(baked.ao[i], 1);
                EXPECT_NEAR(whiteIrradiance(baked, i, shOrder, points[i].normal), kPi, 1e-5 * kPi)
                    << nameOf(shOrder, sampling);
            }
        }
}

// Irradiance about a normal n of sub-points with normals m_p, each with a horizon of its own: π/2 (1 +
// n·m_p).
double openIrradiance(const Vec3f& normal, const SurfacePoint& part) {
    return kPi / 2 * (1 + double(normal.dot(part.normal)));
}

TEST(ExactBake, TexelsOfAnOpenSphereReceiveAllOfConstantLight) {
    const Scene scene = unwrapped(shapes::sphere(1, {0, 0, 0}, 3));
    const TexelSurface surface = rasterizeTexels(scene, kAtlas, kAtlas);
    const RayCaster caster(scene.positions, scene.indices);
    for (const Sampling& sampling : kSamplings)
        for (int shOrder = 1; shOrder <= kMaxBundleShOrder; ++shOrder) {
            SCOPED_TRACE(nameOf(shOrder, sampling));
            const BakeResult baked = bakeTexelVisibility(caster, surface, optionsOf(shOrder, sampling));
            size_t whole = 0;
            for (size_t i = 0; i < surface.points.size(); ++i) {
                const Vec3f& normal = surface.points[i].normal;
                double expected = 0;
                for (uint32_t p = surface.firstPart[i]; p < surface.firstPart[i + 1]; ++p)
                    expected += double(surface.parts[p].share) *
                                openIrradiance(normal, surface.subPoints[surface.parts[p].subPoint]);
                whole += surface.whole[i];
                if (surface.whole[i]) {
                    EXPECT_EQ(baked.ao[i], 1);
                    EXPECT_NEAR(whiteIrradiance(baked, i, shOrder, normal), kPi, 1e-5 * kPi);
                } else {
                    EXPECT_EQ(baked.ao[i], 1);
                    // Shares are dealt in steps of 1/256.
                    EXPECT_NEAR(whiteIrradiance(baked, i, shOrder, normal), expected, 2e-3 * kPi);
                }
            }
            EXPECT_GT(whole, 100u);
        }
}

// Faces of so fine a sphere lean from a vertex's normal by 2 degrees at most, which hides at most 0.06 % of
// what it receives.
TEST(ExactBake, VerticesOfAnOpenSphereReceiveAllOfConstantLight) {
    const Scene scene = sceneWithNormals(shapes::sphere(1, {0, 0, 0}, 4));
    const RayCaster caster(scene.positions, scene.indices);
    VertexPoints vertices = makeVertexPoints(scene);
    constexpr size_t kSome = 162;  // spread over the sphere: those of a coarser one come first
    vertices.sameAs.resize(kSome);
    vertices.normals.resize(kSome);
    vertices.firstPoint.resize(kSome + 1);
    vertices.points.resize(vertices.firstPoint.back());
    vertices.share.resize(vertices.firstPoint.back());
    for (const Sampling& sampling : kSamplings)
        for (int shOrder = 1; shOrder <= kMaxBundleShOrder; ++shOrder) {
            SCOPED_TRACE(nameOf(shOrder, sampling));
            const BakeResult baked = bakeVertexVisibility(caster, vertices, optionsOf(shOrder, sampling));
            for (size_t v = 0; v < kSome; ++v) {
                EXPECT_EQ(baked.ao[v], 1);
                EXPECT_NEAR(whiteIrradiance(baked, v, shOrder, vertices.normals[v]) / kPi, 1, 1e-3);
            }
        }
}

// Oblique convex solids: nothing of them is along an axis.
std::vector<Mesh> convexSolids() {
    Mesh box = shapes::box({-1, -1.5f, -2}, {1, 1.5f, 2});
    const Mat3d turn(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.36, 0.48, 0.8)).toRotationMatrix());
    for (Vec3f& p : box.positions) p = (turn * p.cast<double>()).cast<float>();
    Mesh tetrahedron{{{0, 1.1f, 0.2f}, {-0.9f, -0.4f, 0.6f}, {0.8f, -0.5f, 0.7f}, {0.1f, -0.3f, -1}},
                     {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2}};
    return {box, tetrahedron, shapes::sphere(1, {0, 0, 0}, 0)};
}

struct NormalBake {
    BakeResult baked;
    std::vector<Vec3f> normals;
};
struct DomainBakes {
    NormalBake points, texels, vertices;
};

// In all three domains.
DomainBakes bakeAll(const Scene& scene, const BakeOptions& options) {
    const RayCaster caster(scene.positions, scene.indices);
    std::vector<SurfacePoint> points;
    for (uint32_t t = 0; t < scene.triangleCount(); ++t) {
        const auto corner = [&](size_t k) {
            return scene.positions[scene.indices[3 * t + k]].cast<double>();
        };
        points.push_back({(0.5 * corner(0) + 0.3 * corner(1) + 0.2 * corner(2)).cast<float>(),
                          triangleNormal(scene, t), t});
    }
    const TexelSurface surface = rasterizeTexels(scene, kAtlas, kAtlas);
    const VertexPoints vertices = makeVertexPoints(scene);
    const auto normalsOf = [](const std::vector<SurfacePoint>& of) {
        std::vector<Vec3f> normals;
        for (const SurfacePoint& point : of) normals.push_back(point.normal);
        return normals;
    };
    return {{bakeVisibility(caster, points, options), normalsOf(points)},
            {bakeTexelVisibility(caster, surface, options), normalsOf(surface.points)},
            {bakeVertexVisibility(caster, vertices, options), vertices.normals}};
}

// How far two bakes may be apart. Plain expansions of open points are sums of the same directions, bit by
// bit; the least squares of irradiance magnify what rounding does to normals and sums by up to the inverse of
// the weight's floor, where irradiance does not look: as irradiance it does not show.
struct Tolerance {
    float coefficients = 0;
    double irradiance = 0;  // of IrradianceNorm
    float error = 0;        // of the estimates
};

void expectNear(const NormalBake& one, const NormalBake& other, int shOrder, const Tolerance& tolerance,
                const std::string& what) {
    SCOPED_TRACE(what);
    const BakeResult &a = one.baked, &b = other.baked;
    EXPECT_EQ(a.ao, b.ao);
    ASSERT_EQ(a.error.size(), b.error.size());
    ASSERT_EQ(a.coefficients.size(), b.coefficients.size());
    for (size_t i = 0; i < a.error.size(); ++i) EXPECT_NEAR(a.error[i], b.error[i], tolerance.error);
    for (size_t i = 0; i < a.coefficients.size(); ++i)
        ASSERT_NEAR(a.coefficients[i], b.coefficients[i], tolerance.coefficients) << i;
    const IrradianceNorm norm(shOrder);
    const size_t columns = size_t(shCount(shOrder));
    std::vector<float> difference(columns);
    for (size_t i = 0; i < a.ao.size(); ++i) {
        for (size_t c = 0; c < columns; ++c)
            difference[c] = a.coefficients[i * columns + c] - b.coefficients[i * columns + c];
        EXPECT_LE(norm.evaluate(one.normals[i], difference), tolerance.irradiance) << i;
    }
}
void expectNear(const DomainBakes& a, const DomainBakes& b, int shOrder, const Tolerance& tolerance,
                const std::string& what) {
    expectNear(a.points, b.points, shOrder, tolerance, what + ", points");
    expectNear(a.texels, b.texels, shOrder, tolerance, what + ", texels");
    expectNear(a.vertices, b.vertices, shOrder, tolerance, what + ", vertices");
}

Scene movedScene(const Scene& scene, double scale, const Vec3d& offset) {
    Scene moved = scene;
    for (Vec3f& p : moved.positions) p = (scale * p.cast<double>() + offset).cast<float>();
    return moved;
}

// Plain and weighted, uniform and adaptive.
struct Setting {
    std::string name;
    BakeOptions options;
};
std::vector<Setting> settings(int shOrder) {
    std::vector<Setting> all;
    for (const Sampling& sampling : {Sampling{512, 0}, Sampling{0, 0.01}})
        for (const Projection& projection : {kPlainProjection, Projection{}}) {
            BakeOptions options = optionsOf(shOrder, sampling);
            options.projection = projection;
            options.finestSet = 1024;  // the tables of more take longer than these few points
            all.push_back({nameOf(shOrder, sampling) + ", " + projectionName(projection.kind), options});
        }
    return all;
}
Tolerance toleranceOf(const Setting& setting) {
    // Measured: coefficients 1.6e-3, irradiance 1.5e-6, estimates 8e-5 (plain, adaptive) at most.
    if (setting.options.projection == kPlainProjection) return {0, 0, 2e-4f};
    return {4e-3f, 4e-6, 2e-4f};
}

// Shapes that hide parts of themselves: a floor with a box and a ball on it.
Mesh clutter() {
    Mesh mesh = shapes::floorSquare(3);
    mesh.add(shapes::box({-0.5f, 0, -0.5f}, {0.5f, 1.2f, 0.5f}));
    mesh.add(shapes::sphere(0.5, {1.2, 0.7, 0.1}, 1));
    return mesh;
}

TEST(ExactBake, PowersOfTwoInScaleChangeNoBit) {
    for (const Mesh& mesh : {clutter(), convexSolids()[1]})
        for (const Setting& setting : settings(4)) {
            const Scene scene = unwrapped(mesh);
            const DomainBakes reference = bakeAll(scene, setting.options);
            for (const double scale : {0x1p-40, 0x1p-3, 0x1p40})
                expectNear(bakeAll(movedScene(scene, scale, {0, 0, 0}), setting.options), reference, 4, {},
                           setting.name + ", scale " + std::to_string(scale));
        }
}

TEST(ExactBake, ConvexSolidsDoNotDependOnScaleOrPosition) {
    for (const Mesh& mesh : convexSolids())
        for (const Setting& setting : settings(6)) {
            const Scene scene = unwrapped(mesh);
            const DomainBakes reference = bakeAll(scene, setting.options);
            for (const float ao : reference.points.baked.ao) EXPECT_EQ(ao, 1);
            for (const double scale : {1e-6, 3.0, 1e6})
                expectNear(bakeAll(movedScene(scene, scale, {0, 0, 0}), setting.options), reference, 6,
                           toleranceOf(setting), setting.name + ", scale " + std::to_string(scale));
            for (const Vec3d& offset : {Vec3d(1, -2, 3), Vec3d(-30, 20, 10), Vec3d(2000, -1000, 1500)}) {
                // Far away rounding of the corners tilts faces by 1e-4: a direction on a horizon may change
                // sides, 4π/1024 of the sphere.
                const Tolerance far{0.1f, 4e-3, 2e-3f};
                expectNear(bakeAll(movedScene(scene, 1, offset), setting.options), reference, 6,
                           offset.x() > 1000 ? far : toleranceOf(setting),
                           setting.name + ", offset " + std::to_string(offset.x()));
            }
        }
}

TEST(ExactBake, ThreadsAndBlocksChangeNoBit) {
    const Scene scene = unwrapped(clutter());
    for (const Setting& setting : settings(4)) {
        const auto bakeWith = [&](int threads, int blockPoints) {
            const ScopedThreadCount scope(threads);
            BakeOptions options = setting.options;
            options.blockPoints = blockPoints;
            return bakeAll(scene, options);
        };
        const DomainBakes reference = bakeWith(1, 256);
        for (const int blockPoints : {64, 128, 192}) {
            const DomainBakes other = bakeWith(2, blockPoints);
            expectNear(other, reference, 4, {}, setting.name + ", blocks of " + std::to_string(blockPoints));
            EXPECT_EQ(other.texels.baked.inside, reference.texels.baked.inside);
            EXPECT_EQ(other.texels.baked.rays, reference.texels.baked.rays);
            EXPECT_EQ(other.vertices.baked.inside, reference.vertices.baked.inside);
            EXPECT_EQ(other.vertices.baked.rays, reference.vertices.baked.rays);
        }
    }
}

// x to y to z to x: the directions do not turn with the solid, so that only sampling differs.
TEST(ExactBake, ConvexSolidsTurnWithTheirAxes) {
    Mat3d turn;
    turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    const int shOrder = 4;
    const size_t columns = size_t(shCount(shOrder));
    const IrradianceNorm norm(shOrder);
    for (const Mesh& mesh : convexSolids())
        for (const Sampling& sampling : {Sampling{1024, 0}, Sampling{0, 0.01}}) {
            const Scene scene = unwrapped(mesh);
            Scene turned = scene;
            const BakeResult reference = bakeAll(scene, optionsOf(shOrder, sampling)).points.baked;
            for (Vec3f& p : turned.positions) p = (turn * p.cast<double>()).cast<float>();
            const BakeResult result = bakeAll(turned, optionsOf(shOrder, sampling)).points.baked;
            EXPECT_EQ(result.ao, reference.ao);
            std::vector<float> difference(columns);
            for (size_t i = 0; i < result.ao.size(); ++i) {
                rotateSh(turn, shOrder, std::span(&reference.coefficients[i * columns], columns),
                         std::span<float>(difference));
                for (size_t c = 0; c < columns; ++c) difference[c] -= result.coefficients[i * columns + c];
                // Nine of ten errors are below twice their estimates: two of them, added.
                EXPECT_LE(norm.evaluate(triangleNormal(turned, uint32_t(i)), difference),
                          4 * (result.error[i] + reference.error[i]) + 1e-4f)
                    << nameOf(shOrder, sampling);
            }
        }
}

}  // namespace
}  // namespace prt
