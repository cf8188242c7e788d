// Shadows of a disc: a roof's edge in closed form, contact with a box, vertices.
#include "precompute/visibility/sun_shadow.h"

#include <cmath>
#include <numbers>

#include "tests/visibility/shape_scene.h"

namespace prt {
namespace {

using shapes::Mesh;
constexpr int kAtlas = 64;

// A floor over the texels [2, 62]² of the atlas, one unit a texel, from (0, 0, 0) to (60, 0, 60), and
// something on or over it that takes no area of the atlas.
struct Floor {
    Scene scene;
    PointGrid grid{PointDomain::Texel, kAtlas, kAtlas, size_t(kAtlas* kAtlas)};
    std::vector<Validity> validity = std::vector<Validity>(grid.count, Validity::Valid);

    explicit Floor(const Mesh& blocker) {
        Mesh mesh = shapes::quad({0, 0, 60}, {60, 0, 60}, {60, 0, 0}, {0, 0, 0});
        mesh.add(blocker);
        scene = sceneOf(mesh);
        scene.uv1.assign(scene.positions.size(), Vec2f::Zero());
        for (size_t v = 0; v < 4; ++v)
            scene.uv1[v] = Vec2f(2 + scene.positions[v].x(), 2 + scene.positions[v].z()) / float(kAtlas);
    }
    std::vector<float> shadow(const Vec3d& direction, double radius, int rays = kSunRays) const {
        const RayCaster caster(scene.positions, scene.indices);
        return sunShadow(caster, scene, grid, validity, {direction.normalized(), radius}, rays);
    }
    // Of the texel whose middle is at (x, z).
    static float at(const std::vector<float>& shadow, double x, double z) {
        return shadow[size_t(int(z + 2) * kAtlas + int(x + 2))];
    }
};

// Share of a disc of directions of this radius about +Y that lean towards +X by more than `angle`.
double shareBeyond(double angle, double radius) {
    const int rings = 100, spokes = 200;
    double beyond = 0;
    for (int i = 0; i < rings; ++i) {
        const double height = 1 - (1 - std::cos(radius)) * (i + 0.5) / rings;
        for (int k = 0; k < spokes; ++k) {
            const double across =
                std::sqrt(1 - height * height) * std::cos(2 * std::numbers::pi * (k + 0.5) / spokes);
            beyond += std::atan2(across, height) > angle;
        }
    }
    return beyond / (rings * spokes);
}

TEST(SunShadow, PenumbraOfARoof) {
    // From x = 30 to the left, thin, at a height of 10.
    const Floor floor(shapes::box({-200, 10, -200}, {30, 10.001f, 260}));
    const double radius = 0.4;
    const std::vector<float> shadow = floor.shadow({0, 1, 0}, radius);
    const std::vector<float> fine = floor.shadow({0, 1, 0}, radius, 4096);
    for (double x = 20.5; x < 40; x += 1) {
        // The mean over the texel and half of its neighbours, weighted as bilinear lookups are squared.
        double expected = 0, weights = 0;
        for (double t = -0.95; t < 1; t += 0.1) {
            const double weight = std::pow(1 - std::abs(t), 2);
            expected += weight * shareBeyond(std::atan2(30 - x - t, 10.0), radius);
            weights += weight;
        }
        for (const double z : {20.5, 30.5, 41.5}) {
            EXPECT_NEAR(Floor::at(shadow, x, z), expected / weights, 0.05) << x;
            EXPECT_NEAR(Floor::at(fine, x, z), expected / weights, 0.012) << x;
        }
    }
    EXPECT_EQ(Floor::at(shadow, 10.5, 30.5), 0.0f);
    EXPECT_EQ(Floor::at(shadow, 50.5, 30.5), 1.0f);
}

TEST(SunShadow, NoDarkRimWhereABoxStandsOnTheFloor) {
    Floor floor(shapes::box({20.4f, -2, 20.4f}, {30.6f, 6, 40.6f}));
    for (int z = 21; z < 40; ++z)
        for (int x = 21; x < 30; ++x)
            floor.validity[size_t((z + 2) * kAtlas + x + 2)] = Validity::InsideFilled;
    const std::vector<float> shadow = floor.shadow({1, 1, 0}, 0.01);
    // Its sunny side stands in the middle of this texel, its other side throws a shadow of 6.
    EXPECT_EQ(Floor::at(shadow, 30.5, 30.5), 1.0f);
    EXPECT_EQ(Floor::at(shadow, 31.5, 30.5), 1.0f);
    EXPECT_EQ(Floor::at(shadow, 29.5, 30.5), 1.0f);  // inside, filled from the lit side
    EXPECT_EQ(Floor::at(shadow, 20.5, 30.5), 0.0f);
    EXPECT_EQ(Floor::at(shadow, 16.5, 30.5), 0.0f);
    EXPECT_EQ(Floor::at(shadow, 12.5, 30.5), 1.0f);
}

TEST(SunShadow, BelowTheHorizonIsDark) {
    const Floor floor(shapes::box({20, 100, 20}, {21, 101, 21}));
    for (const float value : floor.shadow({0.1, -1, 0}, 0.05)) EXPECT_EQ(value, 0.0f);
    // Half of a disc on the horizon is above it.
    EXPECT_NEAR(Floor::at(floor.shadow({1, 0, 0}, 0.05), 10.5, 50.5), 0.5, 0.04);
}

TEST(SunShadow, PerVertex) {
    Mesh mesh = shapes::quad({0, 0, 10}, {10, 0, 10}, {10, 0, 0}, {0, 0, 0});
    mesh.add(shapes::quad({100, 0, 10}, {110, 0, 10}, {110, 0, 0}, {100, 0, 0}));
    mesh.add(shapes::box({-50, 10, -50}, {60, 11, 60}));
    const Scene scene = sceneOf(mesh);
    const RayCaster caster(scene.positions, scene.indices);
    const PointGrid grid = vertexGrid(scene.vertexCount());
    const std::vector<Validity> validity(grid.count, Validity::Valid);
    const std::vector<float> shadow = sunShadow(caster, scene, grid, validity, {Vec3d::UnitY(), 0.02});
    for (size_t v = 0; v < 8; ++v) EXPECT_EQ(shadow[v], v < 4 ? 0.0f : 1.0f) << v;
    EXPECT_EQ(shadow.size(), scene.vertexCount());
}

}  // namespace
}  // namespace prt
