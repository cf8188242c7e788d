// Baked visibility against closed forms and brute force.
#include "precompute/visibility/bake.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/directions.h"
#include "precompute/math/irradiance_projection.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation.h"
#include "tests/rays/shapes.h"

namespace prt {
namespace {

using shapes::Mesh;
constexpr double kPi = std::numbers::pi;

std::vector<SurfacePoint> pointsOn(const Mesh& mesh, size_t stride = 1) {
    std::vector<SurfacePoint> points;
    for (size_t t = 0; t < mesh.triangles(); t += stride) {
        const double u = 0.1 + 0.05 * double(t % 11), v = 0.1 + 0.02 * double(t % 7);
        points.push_back({mesh.point(t, u, v), mesh.normal(t), uint32_t(t)});
    }
    return points;
}

BakeResult bakeMesh(const Mesh& mesh, std::span<const SurfacePoint> points, int shOrder, int rays,
                    const Projection& projection = kPlainProjection) {
    const RayCaster caster(mesh.positions, mesh.indices);
    BakeOptions options;
    options.shOrder = shOrder;
    options.rays = rays;
    options.projection = projection;
    return bakeVisibility(caster, points, options);
}

// Σ_i v_i h_i, the irradiance under L = 1 from a surface with shading normal n.
double whiteIrradiance(std::span<const float> coefficients, int shOrder, const Vec3f& normal) {
    std::vector<float> cosine(size_t(shCount(shOrder)));
    evalClampedCosineSh(shOrder, normal, cosine);
    double sum = 0;
    for (size_t i = 0; i < cosine.size(); ++i) sum += double(coefficients[i]) * double(cosine[i]);
    return sum;
}

// ∫ f over the sphere piece [zLow, zHigh] × [phiLow, phiHigh] (polar axis +Z), midpoint rule.
Vec3d directionAt(double z, double phi) {
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
}
std::vector<double> projectPiece(int shOrder, double zLow, double zHigh, double phiLow, double phiHigh,
                                 int steps) {
    std::vector<double> sum(size_t(shCount(shOrder)), 0.0), basis(sum.size());
    const double dz = (zHigh - zLow) / steps, dphi = (phiHigh - phiLow) / steps;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            evalSh(shOrder, directionAt(zLow + (i + 0.5) * dz, phiLow + (j + 0.5) * dphi), basis);
            for (size_t c = 0; c < sum.size(); ++c) sum[c] += basis[c] * dz * dphi;
        }
    return sum;
}

double relativeL2(std::span<const float> a, std::span<const double> b) {
    double difference = 0, norm = 0;
    for (size_t i = 0; i < b.size(); ++i) {
        difference += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
        norm += b[i] * b[i];
    }
    return std::sqrt(difference / norm);
}

Vec3f tilted(const Vec3f& normal, double angleDeg, double aroundRad) {
    const Frame frame = frameAround(normal);
    const double a = angleDeg * kPi / 180;
    return (float(std::cos(a)) * normal + float(std::sin(a)) * (float(std::cos(aroundRad)) * frame.tangent +
                                                                float(std::sin(aroundRad)) * frame.bitangent))
        .normalized();
}

// Irradiance under L = 1 of an open surface with shading normal tilted by δ, V kept to n bands: Σ_l of zonal
// coefficients of the hemisphere times those of the clamped cosine times P_l(cos δ).
double truncatedTiltedIrradiance(int shOrder, double tiltRad) {
    const std::vector<double> hemisphere = projectPiece(shOrder, 0, 1, 0, 2 * kPi, 400);
    std::vector<float> cosine(size_t(shCount(shOrder)));
    evalClampedCosineSh(shOrder, Vec3f(float(std::sin(tiltRad)), 0, float(std::cos(tiltRad))), cosine);
    double sum = 0;
    for (size_t i = 0; i < cosine.size(); ++i) sum += hemisphere[i] * double(cosine[i]);
    return sum;
}

TEST(Bake, OpenSphereUnderConstantLight) {
    const Mesh mesh = shapes::sphere(1, {0, 0, 0}, 3);
    const std::vector<SurfacePoint> points = pointsOn(mesh, 3);
    const size_t columns = 36;
    const BakeResult result = bakeMesh(mesh, points, 6, 1024);
    ASSERT_EQ(result.coefficients.size(), points.size() * columns);
    for (size_t i = 0; i < points.size(); ++i) {
        const std::span v(&result.coefficients[i * columns], columns);
        EXPECT_EQ(result.ao[i], 1.0f);
        EXPECT_EQ(result.inside[i], 0);
        EXPECT_NEAR(whiteIrradiance(v, 6, points[i].normal), kPi, 0.005 * kPi);
    }
    EXPECT_FALSE(result.windingSuspect);
    // Half of the directions lie above each horizon.
    EXPECT_NEAR(double(result.rays) / double(points.size()), 512, 8);
}

TEST(Bake, TiltedShadingNormalsOfAnOpenSphere) {
    const Mesh mesh = shapes::sphere(1, {0, 0, 0}, 2);
    const std::vector<SurfacePoint> points = pointsOn(mesh, 2);
    for (const int shOrder : {2, 3, 4, 6, 8, 10}) {
        const size_t columns = size_t(shCount(shOrder));
        const BakeResult result = bakeMesh(mesh, points, shOrder, 4096);
        for (const double tiltDeg : {0.0, 20.0, 35.0}) {
            const double tilt = tiltDeg * kPi / 180;
            const double exact = kPi / 2 * (1 + std::cos(tilt));
            const double truncated = truncatedTiltedIrradiance(shOrder, tilt);
            for (size_t i = 0; i < points.size(); ++i) {
                const std::span v(&result.coefficients[i * columns], columns);
                const double baked =
                    whiteIrradiance(v, shOrder, tilted(points[i].normal, tiltDeg, double(i)));
                EXPECT_NEAR(baked, truncated, 0.005 * kPi) << shOrder << " bands, " << tiltDeg << "°";
                EXPECT_LE(std::abs(baked - exact), std::abs(truncated - exact) + 0.005 * kPi);
            }
        }
    }
}

// L = 1 + ½ Y_lm for every l, m < n over an open floor and beside a wall. Exact for the baked order: V
// projected by fine quadrature; against the whole truth: within what the cut after n bands loses.
TEST(Bake, BandLimitedLightsAgainstQuadrature) {
    const int shOrder = 5;
    const size_t columns = size_t(shCount(shOrder));
    Mesh wedge = shapes::quad({0, 0, 4000}, {8000, 0, 4000}, {8000, 0, -4000}, {0, 0, -4000});
    wedge.add(shapes::quad({0, 0, 4000}, {0, 0, -4000}, {0, 8000, -4000}, {0, 8000, 4000}));
    const std::vector<SurfacePoint> points = {{{1, 0, 0}, {0, 1, 0}, 0}};
    const BakeResult beside = bakeMesh(wedge, points, shOrder, 4096);
    const BakeResult open = bakeMesh(shapes::floorSquare(10), points, shOrder, 4096);
    // Above the floor y > 0; beside the wall x > 0 too. Polar axis z.
    const int steps = 300;
    for (const bool wall : {false, true}) {
        const double phiHigh = wall ? kPi / 2 : kPi;
        const std::vector<double> exactV = projectPiece(shOrder, -1, 1, 0, phiHigh, steps);
        const Vec3f normal = tilted({0, 1, 0}, 15, 1.0);
        for (size_t lm = 0; lm < columns; ++lm) {
            double truth = 0;
            std::vector<double> lightCosine(columns, 0.0), basis(columns);
            const double dz = 2.0 / steps, dphi = 2 * kPi / (2 * steps);
            for (int i = 0; i < steps; ++i)
                for (int j = 0; j < 2 * steps; ++j) {
                    const double phi = (j + 0.5) * dphi;
                    const Vec3d direction = directionAt(-1 + (i + 0.5) * dz, phi);
                    evalSh(shOrder, direction, basis);
                    const double light = 1 + 0.5 * basis[lm];
                    const double value =
                        light * std::max(0.0, normal.cast<double>().dot(direction)) * dz * dphi;
                    truth += phi < phiHigh ? value : 0;
                    for (size_t c = 0; c < columns; ++c) lightCosine[c] += value * basis[c];
                }
            double truncated = 0, baked = 0;
            const std::vector<float>& coefficients = (wall ? beside : open).coefficients;
            for (size_t c = 0; c < columns; ++c) {
                truncated += exactV[c] * lightCosine[c];
                baked += double(coefficients[c]) * lightCosine[c];
            }
            EXPECT_NEAR(baked, truncated, 0.003 * kPi) << "function " << lm;
            EXPECT_LE(std::abs(baked - truth), std::abs(truncated - truth) + 0.003 * kPi);
        }
    }
}

TEST(Bake, InfiniteWedge) {
    Mesh wedge = shapes::quad({0, 0, 4000}, {8000, 0, 4000}, {8000, 0, -4000}, {0, 0, -4000});
    wedge.add(shapes::quad({0, 0, 4000}, {0, 0, -4000}, {0, 8000, -4000}, {0, 8000, 4000}));
    std::vector<SurfacePoint> points;
    for (const float d : {0.05f, 1.0f, 4.0f}) points.push_back({{d, 0, 0.3f * d}, {0, 1, 0}, 0});
    for (const float d : {0.05f, 1.0f, 4.0f}) points.push_back({{0, d, 0.3f * d}, {1, 0, 0}, 2});
    for (const int shOrder : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}) {
        const BakeResult result = bakeMesh(wedge, points, shOrder, 4096);
        const std::vector<double> exact = projectPiece(shOrder, -1, 1, 0, kPi / 2, 300);
        const size_t columns = exact.size();
        for (size_t i = 0; i < points.size(); ++i) {
            const std::span v(&result.coefficients[i * columns], columns);
            EXPECT_LT(relativeL2(v, exact), 0.01) << shOrder << " bands, point " << i;
            EXPECT_NEAR(result.ao[i], 0.5, 0.005);
        }
    }
}

// A wall of height h at distance d, without end to the sides: form factor ½(1 − d/√(d² + h²)).
TEST(Bake, AmbientOcclusionBesideAWall) {
    Mesh mesh = shapes::quad({0, 0, 4000}, {8000, 0, 4000}, {8000, 0, -4000}, {0, 0, -4000});
    mesh.add(shapes::quad({0, 0, 4000}, {0, 0, -4000}, {0, 2, -4000}, {0, 2, 4000}));
    std::vector<SurfacePoint> points;
    for (const float d : {0.2f, 0.5f, 1.0f, 2.0f, 4.0f, 10.0f}) points.push_back({{d, 0, 0}, {0, 1, 0}, 0});
    const BakeResult result = bakeMesh(mesh, points, 2, 8192);
    for (size_t i = 0; i < points.size(); ++i) {
        const double d = double(points[i].position.x());
        EXPECT_NEAR(result.ao[i], 1 - 0.5 * (1 - d / std::hypot(d, 2.0)), 0.003) << d;
    }
}

bool slowlyBlocked(const Mesh& mesh, const Vec3d& origin, const Vec3d& direction) {
    for (size_t t = 0; t < mesh.triangles(); ++t) {
        const Vec3d a = mesh.corner(t, 0), e1 = mesh.corner(t, 1) - a, e2 = mesh.corner(t, 2) - a;
        const Vec3d p = direction.cross(e2), s = origin - a, q = s.cross(e1);
        const double det = e1.dot(p);
        if (det == 0) continue;
        const double u = s.dot(p) / det, v = direction.dot(q) / det;
        if (u >= 0 && v >= 0 && u + v <= 1 && e2.dot(q) / det > 0) return true;
    }
    return false;
}

Mesh clutter() {
    Mesh mesh = shapes::floorSquare(3);
    mesh.add(shapes::box({-0.5f, 0, -0.5f}, {0.5f, 1.2f, 0.5f}));
    mesh.add(shapes::sphere(0.5, {1.2, 0.7, 0.1}, 1));
    mesh.add(shapes::box({-2, 0, -2}, {-1.7f, 2, 2}));
    return mesh;
}

TEST(Bake, MatchesBruteForce) {
    const Mesh mesh = clutter();
    const RayCaster caster(mesh.positions, mesh.indices);
    const std::vector<SurfacePoint> points = pointsOn(mesh);
    const int rays = 300;
    const std::vector<Vec3f> directions = sphericalFibonacci(rays);
    for (const int shOrder : {1, 4, 7}) {
        const size_t columns = size_t(shCount(shOrder));
        const BakeResult result = bakeMesh(mesh, points, shOrder, rays);
        uint64_t traced = 0;
        for (size_t i = 0; i < points.size(); ++i) {
            std::vector<double> expected(columns, 0.0), basis(columns);
            double seen = 0, all = 0;
            const Vec3d origin = caster.offsetOrigin(points[i].position, points[i].normal).cast<double>();
            for (const Vec3f& direction : directions) {
                const double cosine = double(points[i].normal.dot(direction));
                if (!(cosine > 0)) continue;
                ++traced;
                all += cosine;
                if (slowlyBlocked(mesh, origin, direction.cast<double>())) continue;
                seen += cosine;
                evalSh(shOrder, direction.cast<double>(), basis);
                for (size_t c = 0; c < columns; ++c) expected[c] += basis[c] * 4 * kPi / rays;
            }
            EXPECT_NEAR(result.ao[i], seen / all, 1e-5);
            for (size_t c = 0; c < columns; ++c)
                EXPECT_NEAR(result.coefficients[i * columns + c], expected[c], 2e-5) << i << " " << c;
        }
        EXPECT_EQ(result.rays, traced);
    }
}

// The same bits however many threads there are, and whatever other points share the block.
TEST(Bake, BitsDoNotDependOnThreadsOrBlocks) {
    const Mesh mesh = clutter();
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 40; ++i)
        for (int j = 0; j < 40; ++j)
            points.push_back({{float(i) * 0.07f - 1.4f, 0, float(j) * 0.07f - 1.4f}, {0, 1, 0}, 0});
    const std::vector<SurfacePoint> others = pointsOn(mesh);
    points.insert(points.end(), others.begin(), others.end());
    for (const Projection& projection : {kPlainProjection, Projection{}}) {
        setThreadCount(1);
        const BakeResult one = bakeMesh(mesh, points, 5, 700, projection);
        setThreadCount(2);
        const BakeResult two = bakeMesh(mesh, points, 5, 700, projection);
        setThreadCount(0);
        EXPECT_EQ(one.coefficients, two.coefficients);
        EXPECT_EQ(one.ao, two.ao);
        EXPECT_EQ(one.inside, two.inside);
        EXPECT_EQ(one.rays, two.rays);

        std::vector<SurfacePoint> some;
        for (size_t i = 0; i < points.size(); i += 37) some.push_back(points[points.size() - 1 - i]);
        const BakeResult alone = bakeMesh(mesh, some, 5, 700, projection);
        for (size_t i = 0; i < some.size(); ++i) {
            const size_t whole = points.size() - 1 - 37 * i;
            EXPECT_EQ(alone.ao[i], one.ao[whole]);
            EXPECT_EQ(alone.inside[i], one.inside[whole]);
            EXPECT_TRUE(std::equal(&alone.coefficients[i * 25], &alone.coefficients[i * 25 + 25],
                                   &one.coefficients[whole * 25]));
        }
    }
}

// b and E summed in double over the bake's own directions, then the projection under test elsewhere.
TEST(Bake, WeightedForIrradianceMatchesBruteForce) {
    const Mesh mesh = clutter();
    const RayCaster caster(mesh.positions, mesh.indices);
    const std::vector<SurfacePoint> points = pointsOn(mesh);
    const int rays = 300;
    const std::vector<Vec3f> directions = sphericalFibonacci(rays);
    for (const IrradianceWeight& weight : {IrradianceWeight{}, IrradianceWeight{20, 0.05}})
        for (const int shOrder : {1, 4, 7}) {
            const size_t columns = size_t(shCount(shOrder));
            const IrradianceProjection projection(shOrder, weight);
            const BakeResult result =
                bakeMesh(mesh, points, shOrder, rays, {ProjectionKind::Irradiance, weight});
            const BakeResult plain = bakeMesh(mesh, points, shOrder, rays);
            EXPECT_EQ(result.ao, plain.ao);
            EXPECT_EQ(result.inside, plain.inside);
            EXPECT_EQ(result.rays, plain.rays);
            for (size_t i = 0; i < points.size(); ++i) {
                std::vector<double> sum(columns, 0.0), basis(columns);
                const Vec3d origin = caster.offsetOrigin(points[i].position, points[i].normal).cast<double>();
                for (const Vec3f& direction : directions) {
                    const double cosine = double(points[i].normal.dot(direction));
                    if (!(cosine > 0) || slowlyBlocked(mesh, origin, direction.cast<double>())) continue;
                    evalSh(shOrder, direction.cast<double>(), basis);
                    for (size_t c = 0; c < columns; ++c)
                        sum[c] += irradianceWeight(cosine, weight) * basis[c] * 4 * kPi / rays;
                }
                const std::vector<float> b(sum.begin(), sum.end());
                std::vector<float> expected(columns);
                projection.solve(points[i].normal, b, float(kPi) * result.ao[i], expected);
                // Errors of b in float, amplified by up to the inverse of the floor.
                for (size_t c = 0; c < columns; ++c)
                    EXPECT_NEAR(result.coefficients[i * columns + c], expected[c], 1e-6 / weight.floor);
                EXPECT_NEAR(
                    whiteIrradiance({&result.coefficients[i * columns], columns}, shOrder, points[i].normal),
                    kPi * double(result.ao[i]), 2e-5);
            }
        }
}

TEST(Bake, OpenSphereReceivesAllOfConstantLightAtEveryOrder) {
    const Mesh mesh = shapes::sphere(1, {0, 0, 0}, 2);
    const std::vector<SurfacePoint> points = pointsOn(mesh, 3);
    for (const int rays : {64, 1024})
        for (int shOrder = 1; shOrder <= 10; ++shOrder) {
            const BakeResult result = bakeMesh(mesh, points, shOrder, rays, Projection{});
            const size_t columns = size_t(shCount(shOrder));
            for (size_t i = 0; i < points.size(); ++i)
                EXPECT_NEAR(
                    whiteIrradiance({&result.coefficients[i * columns], columns}, shOrder, points[i].normal),
                    kPi, 1e-4 * kPi)
                    << shOrder << " bands, " << rays << " rays";
        }
}

// Tilted shading normals: within the cone weighted projection is nearer to the truth than plain.
TEST(Bake, WeightedForIrradianceBeatsPlainOnAnOpenSphere) {
    const Mesh mesh = shapes::sphere(1, {0, 0, 0}, 2);
    const std::vector<SurfacePoint> points = pointsOn(mesh, 3);
    for (const int shOrder : {3, 4, 6}) {
        const size_t columns = size_t(shCount(shOrder));
        const BakeResult weighted = bakeMesh(mesh, points, shOrder, 4096, Projection{});
        for (const double tiltDeg : {0.0, 10.0, 20.0, 35.0}) {
            const double exact = kPi / 2 * (1 + std::cos(tiltDeg * kPi / 180));
            for (size_t i = 0; i < points.size(); ++i)
                EXPECT_NEAR(whiteIrradiance({&weighted.coefficients[i * columns], columns}, shOrder,
                                            tilted(points[i].normal, tiltDeg, double(i))),
                            exact, (tiltDeg > 20 ? 0.025 : 0.01) * kPi)
                    << shOrder << " bands, " << tiltDeg << " degrees";
        }
    }
}

TEST(Bake, ConvexPolyhedraDoNotDependOnScaleOrPosition) {
    const auto bakeAt = [](float scale, const Vec3f& offset) {
        Mesh mesh = shapes::box({-1, -1.5f, -2}, {1, 1.5f, 2});
        for (Vec3f& p : mesh.positions) p = scale * p + offset;
        return bakeMesh(mesh, pointsOn(mesh), 6, 512, Projection{});
    };
    const BakeResult reference = bakeAt(1, {0, 0, 0});
    for (const float scale : {1e-3f, 1.0f, 4096.0f, 1e6f})
        for (const Vec3f& offset : {Vec3f(0, 0, 0), Vec3f(scale * Vec3f(1000, -500, 300))}) {
            const BakeResult result = bakeAt(scale, offset);
            EXPECT_EQ(result.ao, reference.ao) << scale;
            ASSERT_EQ(result.coefficients.size(), reference.coefficients.size());
            for (size_t k = 0; k < result.coefficients.size(); ++k)
                EXPECT_NEAR(result.coefficients[k], reference.coefficients[k], 1e-5f) << scale;
        }
}

TEST(Bake, LowerOrdersArePrefixes) {
    const Mesh mesh = clutter();
    const std::vector<SurfacePoint> points = pointsOn(mesh, 3);
    const BakeResult most = bakeMesh(mesh, points, 10, 512);
    for (int shOrder = 1; shOrder < 10; ++shOrder) {
        const BakeResult result = bakeMesh(mesh, points, shOrder, 512);
        const size_t columns = size_t(shCount(shOrder));
        for (size_t i = 0; i < points.size(); ++i)
            for (size_t c = 0; c < columns; ++c)
                EXPECT_NEAR(result.coefficients[i * columns + c], most.coefficients[i * 100 + c], 1e-6);
        EXPECT_EQ(result.ao, most.ao);
    }
}

TEST(Bake, SpheresOfEveryScaleAreOpen) {
    for (const double radius : {1e-3, 1.0, 1e6})
        for (const double away : {0.0, 1e6}) {
            const Mesh mesh = shapes::sphere(radius, Vec3d(0.6, -0.48, 0.64) * radius * away, 3);
            const std::vector<SurfacePoint> points = pointsOn(mesh, 5);
            const BakeResult result = bakeMesh(mesh, points, 4, 512);
            for (size_t i = 0; i < points.size(); ++i) {
                if (points[i].normal.isZero()) continue;
                // So far away, faces stand at angles of their own and hide a little of each other's horizon.
                EXPECT_GE(result.ao[i], away > 0 ? 0.999f : 1.0f) << radius << " " << away;
                EXPECT_NEAR(whiteIrradiance({&result.coefficients[i * 16], 16}, 4, points[i].normal), kPi,
                            0.01 * kPi);
            }
        }
}

// Sampling converges: the error of a spherical Fibonacci set falls faster than N^-1/2.
TEST(Bake, ConvergesWithRays) {
    const Mesh mesh = clutter();
    const std::vector<SurfacePoint> points = pointsOn(mesh);
    const BakeResult truth = bakeMesh(mesh, points, 4, 65536);
    double last = 1e9;
    for (const int rays : {256, 1024, 4096}) {
        const BakeResult result = bakeMesh(mesh, points, 4, rays);
        double sum = 0;
        for (size_t i = 0; i < truth.coefficients.size(); ++i)
            sum += std::pow(double(result.coefficients[i] - truth.coefficients[i]), 2);
        const double rms = std::sqrt(sum / double(truth.coefficients.size()));
        EXPECT_LT(rms, last / 2);
        last = rms;
    }
    EXPECT_LT(last, 0.005);
}

TEST(Bake, FindsPointsInsideGeometry) {
    // A floor that runs through a house: under the house it is inside.
    Mesh mesh = shapes::floorSquare(3);
    mesh.add(shapes::box({-1, -0.5f, -1}, {1, 1, 1}));
    std::vector<SurfacePoint> points;
    for (float x = -2.9f; x < 3; x += 0.2f)
        for (float z = -2.9f; z < 3; z += 0.2f) points.push_back({{x, 0, z}, {0, 1, 0}, 0});
    const BakeResult result = bakeMesh(mesh, points, 2, 256);
    for (size_t i = 0; i < points.size(); ++i) {
        const Vec3f& p = points[i].position;
        const bool inside = std::max(std::abs(p.x()), std::abs(p.z())) < 1;
        EXPECT_EQ(result.inside[i], inside ? 1 : 0) << p.transpose();
        if (inside) {
            EXPECT_EQ(result.ao[i], 0.0f);
        }
    }
    EXPECT_FALSE(result.windingSuspect);

    // Not asked for, or both sides of the house are outsides: nothing is inside.
    const RayCaster caster(mesh.positions, mesh.indices);
    BakeOptions options;
    options.shOrder = 2;
    options.rays = 256;
    options.findInside = false;
    const std::vector<uint8_t> none(points.size(), 0);
    EXPECT_EQ(bakeVisibility(caster, points, options).inside, none);
    options.findInside = true;
    const std::vector<uint8_t> doubleSided(mesh.triangles(), 1);
    options.doubleSided = doubleSided;
    EXPECT_EQ(bakeVisibility(caster, points, options).inside, none);
}

TEST(Bake, ClosedRoomSeenFromWithinIsDarkNotInside) {
    Mesh mesh = shapes::box({-1, -1, -1}, {1, 1, 1});
    mesh.flip();
    const std::vector<SurfacePoint> points = pointsOn(mesh);
    const BakeResult result = bakeMesh(mesh, points, 4, 1024);
    for (const float c : result.coefficients) EXPECT_EQ(c, 0.0f);
    for (const float ao : result.ao) EXPECT_EQ(ao, 0.0f);
    for (const uint8_t inside : result.inside) EXPECT_EQ(inside, 0);
}

TEST(Bake, InsideOutMeshIsSuspected) {
    Mesh mesh = shapes::sphere(1, {0, 0, 0}, 2);
    const std::vector<SurfacePoint> points = pointsOn(mesh);
    std::vector<SurfacePoint> turned = points;
    for (SurfacePoint& point : turned) point.normal = -point.normal;
    const BakeResult result = bakeMesh(mesh, turned, 3, 256);
    EXPECT_TRUE(result.windingSuspect);
    for (const uint8_t inside : result.inside) EXPECT_EQ(inside, 0);
}

TEST(Bake, RefusesOptionsOutOfRange) {
    const Mesh mesh = shapes::floorSquare(1);
    const std::vector<SurfacePoint> points = {{{0, 0, 0}, {0, 1, 0}, 0}};
    for (const int shOrder : {-1, 0, 11}) EXPECT_THROW(bakeMesh(mesh, points, shOrder, 64), UsageError);
    for (const int rays : {-5, 0, kMaxBakeRays + 1})
        EXPECT_THROW(bakeMesh(mesh, points, 3, rays), UsageError);
    EXPECT_EQ(bakeMesh(mesh, {}, 3, 64).coefficients.size(), 0u);
    EXPECT_EQ(bakeMesh(mesh, points, 3, 1).coefficients.size(), 9u);
}

TEST(Bake, CanBeInterrupted) {
    const Mesh mesh = clutter();
    const std::vector<SurfacePoint> points = pointsOn(mesh);
    requestInterrupt();
    EXPECT_THROW(bakeMesh(mesh, points, 3, 64), Interrupted);
    clearInterrupt();
    EXPECT_EQ(bakeMesh(mesh, points, 3, 64).ao.size(), points.size());
}

// Turning the world turns the result: baked coefficients of the turned scene against rotated coefficients.
// Only sampling differs.
TEST(Bake, TurnsWithTheScene) {
    const Mesh mesh = clutter();
    const std::vector<SurfacePoint> points = pointsOn(mesh, 2);
    const Mat3d turn(Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, 0.8, -0.5).normalized()).toRotationMatrix());
    Mesh turnedMesh = mesh;
    for (Vec3f& p : turnedMesh.positions) p = (turn * p.cast<double>()).cast<float>();
    std::vector<SurfacePoint> turned = points;
    for (SurfacePoint& p : turned) {
        p.position = (turn * p.position.cast<double>()).cast<float>();
        p.normal = (turn * p.normal.cast<double>()).cast<float>();
    }
    const BakeResult a = bakeMesh(mesh, points, 4, 16384), b = bakeMesh(turnedMesh, turned, 4, 16384);
    std::vector<float> rotated(16);
    for (size_t i = 0; i < points.size(); ++i) {
        rotateSh(turn, 4, std::span<const float>(&a.coefficients[i * 16], 16), std::span<float>(rotated));
        for (size_t c = 0; c < 16; ++c) EXPECT_NEAR(rotated[c], b.coefficients[i * 16 + c], 0.006);
        EXPECT_NEAR(a.ao[i], b.ao[i], 0.003);
    }
}

}  // namespace
}  // namespace prt
