// World areas of texels and vertices, against sampling and sums that must come out.
#include "compress/point_areas.h"

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "precompute/base/error.h"

namespace prt {
namespace {

// Triangles anywhere in space, and anywhere in the atlas (they may overlap there).
Scene randomScene(size_t triangles, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform;
    Scene scene;
    for (size_t k = 0; k < 3 * triangles; ++k) {
        scene.positions.emplace_back(uniform(random), uniform(random), uniform(random));
        scene.uv1.emplace_back(uniform(random), uniform(random));
        scene.indices.push_back(uint32_t(k));
    }
    scene.uv1[0] = Vec2f(0, 0);
    scene.uv1[1] = Vec2f(1, 1);
    scene.uv1[2] = Vec2f(1, 0);
    return scene;
}

double worldArea(const Scene& scene, size_t t) {
    Vec3d p[3];
    for (size_t k = 0; k < 3; ++k) p[k] = scene.positions[scene.indices[3 * t + k]].cast<double>();
    return (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2;
}

double totalArea(const Scene& scene) {
    double total = 0;
    for (size_t t = 0; t < scene.triangleCount(); ++t) total += worldArea(scene, t);
    return total;
}

double sum(const std::vector<float>& values) {
    double total = 0;
    for (const float value : values) total += double(value);
    return total;
}

TEST(PointAreas, TexelsAreTheWholeMesh) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        const Scene scene = randomScene(9, seed);
        const PointGrid grid{PointDomain::Texel, 13 + int(seed), 29, size_t(13 + seed) * 29};
        std::vector<float> areas;
        PointAreas(scene, grid).evaluate(0, 29, areas);
        EXPECT_NEAR(sum(areas), totalArea(scene), 1e-5 * totalArea(scene));
        for (const float area : areas) EXPECT_GE(area, 0.0f);
    }
}

TEST(PointAreas, TexelsAreWhatSamplesHit) {
    const Scene scene = randomScene(2, 4);
    const int size = 8, samples = 64;
    std::vector<float> areas;
    PointAreas(scene, {PointDomain::Texel, size, size, size_t(size) * size}).evaluate(0, size, areas);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            double expected = 0, densities = 0;
            for (size_t t = 0; t < 2; ++t) {
                const Eigen::Vector2d a = scene.uv1[3 * t].cast<double>(),
                                      b = scene.uv1[3 * t + 1].cast<double>(),
                                      c = scene.uv1[3 * t + 2].cast<double>();
                const auto side = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q,
                                     const Eigen::Vector2d& r) {
                    return (q.x() - p.x()) * (r.y() - p.y()) - (q.y() - p.y()) * (r.x() - p.x());
                };
                const double density =
                    worldArea(scene, t) / std::abs(side(a, b, c) / 2) / (size * size * samples * samples);
                densities += density;
                for (int k = 0; k < samples * samples; ++k) {
                    const Eigen::Vector2d p((x + (k % samples + 0.5) / samples) / size,
                                            (y + (k / samples + 0.5) / samples) / size);
                    const double u = side(a, b, p), v = side(b, c, p), w = side(c, a, p);
                    if ((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0)) expected += density;
                }
            }
            // An edge crosses at most 2·64 cells of a texel; half of each may be counted wrongly.
            EXPECT_NEAR(areas[size_t(y * size + x)], expected, 3 * samples * densities);
        }
}

TEST(PointAreas, BandsAreTheWhole) {
    const Scene scene = randomScene(20, 9);
    const PointAreas areas(scene, {PointDomain::Texel, 40, 50, 2000});
    std::vector<float> all, band;
    areas.evaluate(0, 50, all);
    for (int row = 0; row < 50; row += 7) {
        const int rows = std::min(7, 50 - row);
        areas.evaluate(row, rows, band);
        ASSERT_EQ(band.size(), size_t(rows) * 40);
        for (size_t k = 0; k < band.size(); ++k) EXPECT_EQ(band[k], all[size_t(row) * 40 + k]);
    }
}

TEST(PointAreas, VerticesShareTheirTriangles) {
    Scene scene = randomScene(400, 3);
    scene.uv1.clear();
    const PointGrid grid = vertexGrid(1200);
    std::vector<float> areas;
    PointAreas(scene, grid).evaluate(0, grid.height, areas);
    ASSERT_EQ(areas.size(), size_t(2) * size_t(kVertexRowLength));
    EXPECT_NEAR(areas[700], worldArea(scene, 233) / 3, 1e-6);
    EXPECT_NEAR(sum(areas), totalArea(scene), 1e-5 * totalArea(scene));
    EXPECT_EQ(areas[1200], 0.0f);
    EXPECT_THROW(PointAreas(scene, vertexGrid(1199)), InputError);
    EXPECT_THROW(PointAreas(scene, {PointDomain::Texel, 4, 4, 16}), InputError);
}

TEST(PointAreas, TrianglesWithoutAreaInTheAtlasCountNothing) {
    Scene scene = randomScene(1, 2);
    scene.uv1.assign(3, Vec2f(0.5f, 0.5f));
    std::vector<float> areas;
    PointAreas(scene, {PointDomain::Texel, 4, 4, 16}).evaluate(0, 4, areas);
    EXPECT_EQ(sum(areas), 0.0);
}

}  // namespace
}  // namespace prt
