// Ray casting against closed forms and a slow reference.
#include "precompute/rays/ray_caster.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "tests/rays/shapes.h"

namespace prt {
namespace {

using shapes::Mesh;

// Möller–Trumbore in double.
double slowHit(const Mesh& mesh, size_t t, const Vec3d& origin, const Vec3d& direction) {
    const Vec3d a = mesh.corner(t, 0), e1 = mesh.corner(t, 1) - a, e2 = mesh.corner(t, 2) - a;
    const Vec3d p = direction.cross(e2);
    const double det = e1.dot(p);
    if (std::abs(det) < 1e-300) return -1;
    const Vec3d s = origin - a, q = s.cross(e1);
    const double u = s.dot(p) / det, v = direction.dot(q) / det;
    if (u < 0 || v < 0 || u + v > 1) return -1;
    return e2.dot(q) / det;
}

std::vector<Vec3f> directions(int count, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    std::vector<Vec3f> result;
    for (int i = 0; i < count; ++i)
        result.push_back(Vec3f(normal(random), normal(random), normal(random)).normalized());
    return result;
}

Mesh clutter() {
    Mesh mesh = shapes::sphere(1, {0, 0, 0}, 2);
    mesh.add(shapes::box({2, -1, -1}, {3, 1, 1}));
    mesh.add(shapes::sphere(0.3, {-2, 0.5, 0}, 1));
    return mesh;
}

TEST(RayCaster, FirstHitMatchesSlowReference) {
    const Mesh mesh = clutter();
    const RayCaster caster(mesh.positions, mesh.indices);
    ASSERT_EQ(caster.triangleCount(), mesh.triangles());
    const Vec3f origin(0.1f, 1.5f, 0.2f);
    int hits = 0;
    for (const Vec3f& direction : directions(2000, 1)) {
        double nearest = std::numeric_limits<double>::infinity();
        size_t triangle = 0;
        for (size_t t = 0; t < mesh.triangles(); ++t) {
            const double distance = slowHit(mesh, t, origin.cast<double>(), direction.cast<double>());
            if (distance > 0 && distance < nearest) nearest = distance, triangle = t;
        }
        const RayHit hit = caster.firstHit(origin, direction);
        if (!std::isfinite(nearest)) {
            EXPECT_EQ(hit.triangle, 0xffffffffu);
            continue;
        }
        ++hits;
        ASSERT_NE(hit.triangle, 0xffffffffu);
        EXPECT_NEAR(hit.distance, nearest, 1e-5 * nearest);
        // The barycentric coordinates lead to the same point as the distance.
        const Vec3f onTriangle = mesh.point(hit.triangle, double(hit.u), double(hit.v));
        EXPECT_LT((onTriangle - (origin + hit.distance * direction)).norm(), 1e-5);
        EXPECT_EQ(hit.backFace, mesh.normal(hit.triangle).dot(direction) > 0);
        if (triangle != hit.triangle) {
            EXPECT_NEAR(slowHit(mesh, hit.triangle, origin.cast<double>(), direction.cast<double>()), nearest,
                        1e-5);
        }
    }
    EXPECT_GT(hits, 100);
}

TEST(RayCaster, BackFacesAreToldFromInside) {
    const Mesh mesh = shapes::sphere(1, {0, 0, 0}, 2);
    const RayCaster caster(mesh.positions, mesh.indices);
    for (const Vec3f& direction : directions(200, 2)) {
        const RayHit outwards = caster.firstHit({0, 0, 0}, direction);
        ASSERT_NE(outwards.triangle, 0xffffffffu);
        EXPECT_TRUE(outwards.backFace);
        const RayHit inwards = caster.firstHit(-3 * direction, direction);
        ASSERT_NE(inwards.triangle, 0xffffffffu);
        EXPECT_FALSE(inwards.backFace);
    }
}

TEST(RayCaster, StreamsAgreeWithSingleRays) {
    const Mesh mesh = clutter();
    const RayCaster caster(mesh.positions, mesh.indices);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-3, 3);
    std::vector<Vec3f> origins;
    for (int i = 0; i < 1111; ++i) origins.push_back({uniform(random), uniform(random), uniform(random)});
    for (const Vec3f& direction : directions(20, 4)) {
        std::vector<uint8_t> blocked(origins.size(), 7);
        caster.occluded(origins, direction, blocked);
        for (size_t i = 0; i < origins.size(); ++i) {
            const bool hit = caster.firstHit(origins[i], direction).triangle != 0xffffffffu;
            EXPECT_EQ(blocked[i], hit ? 1 : 0) << i;
        }
    }
    const std::vector<Vec3f> many = directions(777, 5);
    for (size_t i = 0; i < 50; ++i) {
        std::vector<uint8_t> blocked(many.size(), 7);
        caster.occluded(origins[i], many, blocked);
        for (size_t k = 0; k < many.size(); ++k)
            EXPECT_EQ(blocked[k], caster.firstHit(origins[i], many[k]).triangle != 0xffffffffu ? 1 : 0);
    }
}

// What comes out for a ray must not depend on the others that are cast with it: here rays along the faces,
// edges and diagonals of boxes on a lattice, in different company.
TEST(RayCaster, StreamsDoNotDependOnCompany) {
    std::mt19937 random(8);
    const auto lattice = [&](int from, int to) {
        return float(from + int(random() % uint32_t(to - from + 1)));
    };
    Mesh mesh;
    for (int i = 0; i < 100; ++i) {
        const Vec3f low(lattice(0, 15), lattice(0, 15), lattice(0, 15));
        mesh.add(shapes::box(low, low + Vec3f(lattice(1, 3), lattice(1, 3), lattice(1, 3))));
    }
    const RayCaster caster(mesh.positions, mesh.indices);
    size_t hits = 0;
    for (int round = 0; round < 200; ++round) {
        Vec3f direction(lattice(-2, 2), lattice(-2, 2), lattice(-2, 2));
        if (direction.isZero()) direction.y() = 1;
        direction.normalize();
        std::vector<Vec3f> origins(300), shuffled;
        for (Vec3f& origin : origins) origin = {lattice(-3, 18), lattice(-3, 18), lattice(-3, 18)};
        std::vector<size_t> order(origins.size());
        std::iota(order.begin(), order.end(), size_t(0));
        std::shuffle(order.begin(), order.end(), random);
        order.resize(170);
        for (const size_t i : order) shuffled.push_back(origins[i]);
        std::vector<uint8_t> all(origins.size()), some(shuffled.size()), alone(1);
        caster.occluded(origins, direction, all);
        caster.occluded(shuffled, direction, some);
        for (size_t j = 0; j < order.size(); ++j) ASSERT_EQ(some[j], all[order[j]]) << round;
        for (size_t i = 0; i < 20; ++i) {
            caster.occluded(std::span(origins).subspan(i, 1), direction, alone);
            ASSERT_EQ(alone[0], all[i]) << round;
        }
        hits += size_t(std::count(all.begin(), all.end(), 1));
    }
    EXPECT_GT(hits, 20000u);
    EXPECT_LT(hits, 50000u);
}

// Rays from surfaces in directions aligned with nothing: packets find what streams find.
TEST(RayCaster, PacketsAgreeWithStreams) {
    Mesh mesh = shapes::heightField(
        60, [](double x, double z) { return 0.2 * std::sin(11 * x) * std::cos(9 * z) + 0.1 * x; });
    mesh.add(shapes::box({-0.3f, 0.3f, -0.2f}, {0.2f, 0.5f, 0.4f}));
    const RayCaster caster(mesh.positions, mesh.indices);
    size_t hits = 0, rays = 0;
    for (const size_t count : {size_t(0), size_t(1), size_t(16), size_t(17), size_t(255), size_t(1000)})
        for (const Vec3f& direction : directions(60, unsigned(count))) {
            std::vector<Vec3f> origins;
            for (size_t i = 0; i < count; ++i)
                origins.push_back(caster.offsetOrigin(mesh.point(7 * i, 0.3, 0.4), mesh.normal(7 * i)));
            std::vector<uint8_t> streams(count, 7), packets(count, 7);
            caster.occluded(origins, direction, streams);
            caster.occludedPackets(origins, std::vector<Vec3f>(origins.size(), direction), packets);
            EXPECT_EQ(streams, packets) << count;
            hits += size_t(std::count(streams.begin(), streams.end(), 1));
            rays += count;
        }
    EXPECT_GT(hits, rays / 5);
    EXPECT_LT(hits, rays * 4 / 5);
}

TEST(RayCaster, PacketsAreForOriginsCloserThanTriangles) {
    const Mesh mesh = shapes::floorSquare(1);  // two triangles of area 2
    const RayCaster caster(mesh.positions, mesh.indices);
    EXPECT_FALSE(caster.packetsAreFaster(1.0f));
    const std::string isa = caster.instructionSet();
    EXPECT_EQ(caster.packetsAreFaster(0.01f), isa == "AVX512" || isa == "AVX2");
    EXPECT_FALSE(RayCaster({}, {}).packetsAreFaster(0.01f));
}

TEST(RayCaster, NoRayPassesBetweenFaces) {
    const Mesh mesh = shapes::sphere(1, {0, 0, 0}, 4);
    const RayCaster caster(mesh.positions, mesh.indices);
    // Aim at every vertex and every middle of an edge from inside.
    std::vector<Vec3f> aims = mesh.positions;
    for (size_t t = 0; t < mesh.triangles(); ++t) aims.push_back(mesh.point(t, 0.5, 0.5));
    for (Vec3f& aim : aims) aim.normalize();
    std::vector<uint8_t> blocked(aims.size());
    caster.occluded(Vec3f(0.01f, 0.02f, -0.03f), aims, blocked);
    EXPECT_EQ(std::count(blocked.begin(), blocked.end(), 1), std::ptrdiff_t(aims.size()));
    for (size_t i = 0; i < aims.size(); ++i)
        EXPECT_NE(caster.firstHit({0, 0, 0}, aims[i]).triangle, 0xffffffffu);
}

TEST(RayCaster, EmptyMeshBlocksNothing) {
    const RayCaster caster({}, {});
    std::vector<uint8_t> blocked(2, 7);
    const std::vector<Vec3f> origins = {{0, 0, 0}, {1, 2, 3}};
    caster.occluded(origins, {0, 1, 0}, blocked);
    EXPECT_EQ(blocked, (std::vector<uint8_t>{0, 0}));
    EXPECT_EQ(caster.triangleCount(), 0u);
    EXPECT_EQ(caster.extent(), 0.0f);
}

TEST(RayCaster, RefusesPositionsThatAreNotFinite) {
    const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                         3e18f};
    for (const float value : bad) {
        const std::vector<Vec3f> positions = {{0, 0, 0}, {1, 0, 0}, {0, value, 0}};
        const std::vector<uint32_t> indices = {0, 1, 2};
        EXPECT_THROW(RayCaster(positions, indices), InputError);
    }
    // A vertex that no face uses does no harm.
    const std::vector<Vec3f> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, bad[0], 0}};
    const std::vector<uint32_t> indices = {0, 1, 2};
    EXPECT_EQ(RayCaster(positions, indices).triangleCount(), 1u);
}

TEST(RayCaster, MovingKeepsTheScene) {
    const Mesh mesh = shapes::sphere(1, {0, 0, 0}, 1);
    RayCaster first(mesh.positions, mesh.indices);
    RayCaster second = std::move(first);
    EXPECT_NE(second.firstHit({0, 0, 0}, {0, 1, 0}).triangle, 0xffffffffu);
    const RayCaster none({}, {});
    EXPECT_EQ(none.firstHit({0, 0, 0}, {0, 1, 0}).triangle, 0xffffffffu);
}

TEST(RayCaster, NamesTheInstructionSet) {
    const RayCaster caster({}, {});
    EXPECT_THAT(caster.instructionSet(), testing::AnyOf("SSE2", "AVX", "AVX2", "AVX512"));
}

TEST(RayCaster, ResultsDoNotDependOnTheUnitOfLength) {
    const Mesh mesh = clutter();
    const RayCaster caster(mesh.positions, mesh.indices);
    for (const int exponent : {-40, -10, 10, 30}) {
        Mesh scaled = mesh;
        for (Vec3f& p : scaled.positions) p *= std::ldexp(1.0f, exponent);
        const RayCaster other(scaled.positions, scaled.indices);
        for (const Vec3f& direction : directions(500, 6)) {
            const Vec3f origin = mesh.point(7, 0.3, 0.3);
            const RayHit a = caster.firstHit(caster.offsetOrigin(origin, mesh.normal(7)), direction);
            const Vec3f scaledOrigin = origin * std::ldexp(1.0f, exponent);
            const RayHit b = other.firstHit(other.offsetOrigin(scaledOrigin, mesh.normal(7)), direction);
            EXPECT_EQ(a.triangle, b.triangle);
            EXPECT_EQ(a.u, b.u);
            EXPECT_EQ(a.v, b.v);
            EXPECT_EQ(std::ldexp(a.distance, exponent), b.distance);
        }
    }
}

// Whether rays are blocked must not depend on how many threads built the hierarchy.
TEST(RayCaster, ThreadsOfTheBuildDoNotMatter) {
    const Mesh mesh = shapes::heightField(300, [](double x, double z) {
        return 0.1 * std::sin(9 * x) * std::cos(11 * z) + 0.01 * std::sin(90 * x + 70 * z);
    });
    ASSERT_GT(mesh.triangles(), 150000u);
    std::vector<Vec3f> origins, aims = directions(200, 7);
    std::vector<std::vector<uint8_t>> results;
    for (const int threads : {1, 2, 4, 1}) {
        setThreadCount(threads);
        const RayCaster caster(mesh.positions, mesh.indices);
        std::vector<uint8_t> blocked(256), all;
        for (size_t k = 0; k < aims.size(); ++k) {
            origins.clear();
            for (size_t i = 0; i < 256; ++i) {
                const size_t t = (k * 7919 + i * 131) % mesh.triangles();
                origins.push_back(caster.offsetOrigin(mesh.point(t, 0.25, 0.5), mesh.normal(t)));
            }
            caster.occluded(origins, aims[k], blocked);
            all.insert(all.end(), blocked.begin(), blocked.end());
        }
        results.push_back(all);
    }
    setThreadCount(0);
    EXPECT_GT(std::count(results[0].begin(), results[0].end(), 1), 1000);
    EXPECT_GT(std::count(results[0].begin(), results[0].end(), 0), 1000);
    for (const auto& result : results) EXPECT_EQ(result, results[0]);
}

TEST(RayCaster, SnapsToThePlaneOfATriangle) {
    const Mesh mesh = clutter();
    const RayCaster caster(mesh.positions, mesh.indices);
    for (size_t t = 0; t < mesh.triangles(); t += 5) {
        const Vec3f on = mesh.point(t, 0.2, 0.3);
        const Vec3f snapped = caster.snapToPlane(on + 1e-4f * mesh.normal(t), uint32_t(t));
        EXPECT_LT((snapped - on).norm(), 1e-6f) << t;
        const Vec3f far = on + 0.1f * mesh.normal(t);
        EXPECT_EQ(caster.snapToPlane(far, uint32_t(t)), far);
    }
}

TEST(RayCaster, ManyFirstHitsAreEachOfThem) {
    const shapes::Mesh mesh = shapes::sphere(2, {0.5, 0, 0}, 4);
    const RayCaster caster(mesh.positions, mesh.indices);
    std::mt19937 random(8);
    std::normal_distribution<float> gauss;
    std::vector<Vec3f> origins, directions;
    for (int i = 0; i < 1000; ++i) {
        origins.push_back(3 * Vec3f(gauss(random), gauss(random), gauss(random)));
        directions.push_back(Vec3f(gauss(random), gauss(random), gauss(random)).normalized());
    }
    std::vector<RayHit> hits(1000);
    caster.firstHits(origins, directions, hits);
    RayStream stream(caster);
    int found = 0;
    for (size_t i = 0; i < 1000; ++i) {
        const RayHit one = caster.firstHit(origins[i], directions[i]);
        EXPECT_EQ(hits[i].triangle, one.triangle);
        EXPECT_EQ(hits[i].backFace, one.backFace);
        EXPECT_NEAR(hits[i].distance, one.distance, 1e-5f * (1 + one.distance));
        stream.clear();
        stream.add(origins[i], directions[i]);
        stream.cast();
        EXPECT_EQ(stream.blocked(0), one.triangle != RayHit{}.triangle);
        if (one.triangle == RayHit{}.triangle) continue;
        ++found;
        EXPECT_EQ(caster.firstHit(origins[i], directions[i], 0.99f * one.distance).triangle,
                  RayHit{}.triangle);
        EXPECT_EQ(caster.firstHit(origins[i], directions[i], 1.01f * one.distance).triangle, one.triangle);
    }
    EXPECT_GT(found, 100);
}

}  // namespace
}  // namespace prt
