// The judge of prt measure projection against irradiance in closed form, and the study on small meshes.
#include "tools/measure/projection.h"

#include <cmath>
#include <numbers>

#include "precompute/base/error.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/bake.h"
#include "tools/measure/surface_points.h"

namespace prt::tools {
namespace {

constexpr double kPi = std::numbers::pi;

// A unit square floor (y up), and a second one twice as large below it.
Scene floors() {
    Scene scene;
    for (const auto& [half, y] : {std::pair{0.5f, 0.0f}, std::pair{0.5f * std::sqrt(2.0f), -1.0f}}) {
        const uint32_t first = uint32_t(scene.positions.size());
        for (const auto& [x, z] : {std::pair{-1, 1}, std::pair{1, 1}, std::pair{1, -1}, std::pair{-1, -1}})
            scene.positions.emplace_back(half * float(x), y, half * float(z));
        for (const uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) scene.indices.push_back(first + k);
    }
    return scene;
}

TEST(RandomSurfacePoints, AreUniformOverTheArea) {
    const Scene scene = floors();
    const std::vector<SurfacePoint> points = randomSurfacePoints(scene, 6000, 5);
    ASSERT_EQ(points.size(), 6000u);
    size_t lower = 0;
    Vec3d mean = Vec3d::Zero();
    for (const SurfacePoint& point : points) {
        EXPECT_EQ(point.normal, Vec3f(0, 1, 0));
        EXPECT_EQ(point.position.y() < -0.5f, point.triangle >= 2);
        lower += point.triangle >= 2;
        mean += point.position.cast<double>() / 6000;
    }
    EXPECT_NEAR(double(lower), 4000, 5 * std::sqrt(6000 * 2.0 / 9));  // five standard deviations
    EXPECT_NEAR(mean.x(), 0, 0.03);
    EXPECT_NEAR(mean.z(), 0, 0.03);
    EXPECT_EQ(randomSurfacePoints(scene, 10, 5)[9].position, points[9].position);
    EXPECT_THROW(randomSurfacePoints(Scene{}, 1, 1), InputError);
}

// A uniform sky over an open point: truth π(1 + cos tilt)/2 whatever is expanded, and the estimate of an
// expansion is its white irradiance.
TEST(IrradianceJudge, KnowsAnOpenPointUnderAUniformSky) {
    const Scene scene = floors();
    const RayCaster caster(scene.positions, scene.indices);
    const std::vector<SurfacePoint> points = {{Vec3f(0.1f, 0, 0.2f), Vec3f(0, 1, 0), 0}};
    const std::vector<Environment> environments = {loadEnvironment("sky:uniform")};
    const std::vector<double> tilts = {0, 30};
    const IrradianceJudge judge(caster, points, environments, tilts, 5, 1);
    for (const size_t tilt : {0u, 1u}) {
        const double truth = kPi * (1 + std::cos(tilts[tilt] * kPi / 180)) / 2;
        for (const double scale : {0.0, 1.0, 1.7}) {
            // A constant visibility: irradiance π times it.
            std::vector<float> constant(25, 0.0f);
            constant[0] = float(scale * std::sqrt(4 * kPi));
            EXPECT_NEAR(judge.relativeRmse(constant, 5, tilt), std::abs(scale * kPi - truth) / truth, 1e-3);
            EXPECT_NEAR(judge.relativeRmse(std::span(constant).first(4), 2, tilt),
                        std::abs(scale * kPi - truth) / truth, 1e-3);
        }
    }
}

TEST(IrradianceJudge, HighOrdersComeNear) {
    // A smooth sky, without a sun whose place in the ripples of an expansion decides.
    const Scene scene = floors();
    const RayCaster caster(scene.positions, scene.indices);
    const std::vector<SurfacePoint> points = randomSurfacePoints(scene, 6, 1);
    const std::vector<Environment> environments = {loadEnvironment("sky:overcast")};
    const std::vector<double> tilts = {0};
    const IrradianceJudge judge(caster, points, environments, tilts, 10, 1);
    double last = 1;
    for (const int shOrder : {2, 4, 10}) {
        BakeOptions options;
        options.shOrder = shOrder;
        options.rays = 4096;
        const double error =
            judge.relativeRmse(bakeVisibility(caster, points, options).coefficients, shOrder, 0);
        EXPECT_LT(error, last);
        last = error;
    }
    EXPECT_LT(last, 0.01);
}

TEST(StudyProjection, WeightedBeatsPlainAndRepeats) {
    const Scene scene = floors();
    const std::vector<Environment> environments = {loadEnvironment("sky:overcast"),
                                                   loadEnvironment("sky:sunset")};
    ProjectionStudy study;
    study.orders = {3, 5};
    study.tiltsDeg = {0, 20};
    study.points = 12;
    study.population = 300;
    study.rays = 512;
    const ProjectionResult result = studyProjection(scene, environments, study);
    ASSERT_EQ(result.rows.size(), 4u);
    EXPECT_GT(result.meanAo, 0.5);
    for (const ProjectionRow& row : result.rows) {
        EXPECT_LT(row.weighted, row.plain) << row.order << " " << row.tiltDeg;
        EXPECT_GT(row.weighted, 0);
        if (row.order == 3) {  // 16 vectors hold all 9 coefficients
            EXPECT_NEAR(row.pcaPlain, row.plain, 1e-4);
            EXPECT_NEAR(row.pcaWeighted, row.weighted, 1e-4);
        }
    }
    const ProjectionResult again = studyProjection(scene, environments, study);
    for (size_t r = 0; r < 4; ++r) EXPECT_EQ(again.rows[r].pcaWeighted, result.rows[r].pcaWeighted);
}

}  // namespace
}  // namespace prt::tools
