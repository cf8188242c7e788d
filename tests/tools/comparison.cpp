#include "tools/comparison.h"

#include <cmath>
#include <numbers>

#include "precompute/math/sh.h"

namespace prt::tools {
namespace {

constexpr double kPi = std::numbers::pi;

SurfaceImage onePixel(const Vec3f& normal) {
    SurfaceImage surface{1, 1, {0}, {Vec3f::Zero()}, {normal}, {normal}, {Vec3f::Ones()}};
    return surface;
}

TEST(CompareIrradiance, MeasuresAKnownDifferenceOverCoveredPixelsOnly) {
    SurfaceImage surface = onePixel(Vec3f::UnitY());
    surface.width = 2;
    surface.triangle = {0, kNoTriangle};
    const std::vector<float> truth = {1, 2, 2, 100, 100, 100}, estimate = {1, 2, 2.3f, 0, 0, 0};
    const IrradianceError error = compareIrradiance(estimate, truth, surface);
    EXPECT_NEAR(error.relativeRmse, 0.1, 1e-6);
    EXPECT_NEAR(error.psnrDb, 20 * std::log10(2 / (0.3 / std::sqrt(3.0))), 1e-4);
    EXPECT_TRUE(std::isinf(compareIrradiance(truth, truth, surface).psnrDb));
    EXPECT_EQ(compareIrradiance(truth, truth, surface).relativeRmse, 0);
}

/// Truncating the visibility of an open plane to n bands leaves a known irradiance: Σ_{l<n} of the product of
/// the hemisphere's and the tilted cosine's zonal coefficients.
TEST(TruncationFloor, EqualsTheSeriesOfAHemisphere) {
    ReferenceDirections directions;
    for (const SphereNode& node : sphereQuadrature(201)) {
        directions.direction.push_back(node.direction.cast<float>());
        directions.solidAngleSr.push_back(float(node.weightSr));
    }
    const size_t count = directions.direction.size();
    directions.radiance.assign(2, std::vector<float>(3 * count, 1.0f));
    for (float& value : directions.radiance[1]) value = 2;
    std::vector<uint8_t> visible(count);
    std::vector<double> hemisphere(count);
    for (size_t k = 0; k < count; ++k) visible[k] = directions.direction[k].y() > 0;

    for (const int shOrder : {1, 3, 6}) {
        for (const double tilt : {0.0, 0.6}) {
            SurfaceImage surface = onePixel(Vec3f::UnitY());
            surface.shadingNormal[0] = Vec3f(float(std::sin(tilt)), float(std::cos(tilt)), 0);
            TruncationFloor floor(surface, directions, shOrder);
            floor.visitor()(0, visible);
            const Vec3d normal = surface.shadingNormal[0].cast<double>();
            const auto v = projectSh(
                shOrder, [](const Vec3d& w) { return w.y() > 0 ? 1.0 : 0.0; }, 401);
            const auto h = projectSh(
                shOrder, [&](const Vec3d& w) { return std::max(0.0, normal.dot(w)); }, 401);
            double expected = 0;
            for (size_t i = 0; i < v.size(); ++i) expected += v[i] * h[i];
            EXPECT_NEAR(floor.irradiance()[0][0], expected, 0.01 * kPi) << shOrder << " " << tilt;
            EXPECT_NEAR(floor.irradiance()[1][2], 2 * floor.irradiance()[0][2], 1e-4);
        }
    }
}

/// With the projection of the bake: exact under constant light for the geometric normal, near the truth for
/// tilted ones, whatever blocks the view.
TEST(TruncationFloor, WeightedProjectionKeepsConstantLight) {
    ReferenceDirections directions;
    for (const SphereNode& node : sphereQuadrature(121)) {
        directions.direction.push_back(node.direction.cast<float>());
        directions.solidAngleSr.push_back(float(node.weightSr));
    }
    const size_t count = directions.direction.size();
    directions.radiance.assign(1, std::vector<float>(3 * count, 1.0f));
    std::vector<uint8_t> visible(count);
    for (const float wall : {2.0f, 0.3f}) {
        double seen = 0, open = 0, seenTilted = 0;
        SurfaceImage surface = onePixel(Vec3f::UnitY());
        surface.geometricNormal[0] = Vec3f::UnitY();
        const Vec3f tilted = Vec3f(0.3f, 0.9f, 0.1f).normalized();
        for (size_t k = 0; k < count; ++k) {
            const Vec3f& d = directions.direction[k];
            visible[k] = d.y() > 0 && d.x() < wall;
            const double weight = double(directions.solidAngleSr[k]);
            open += std::max(0.0f, d.y()) * weight;
            seen += visible[k] * double(d.y()) * weight;
            seenTilted += visible[k] * double(std::max(0.0f, d.dot(tilted))) * weight;
        }
        for (const int shOrder : {1, 3, 6}) {
            surface.shadingNormal[0] = Vec3f::UnitY();
            TruncationFloor straight(surface, directions, shOrder, Projection{});
            straight.visitor()(0, visible);
            EXPECT_NEAR(straight.irradiance()[0][0], kPi * seen / open, 0.005 * kPi) << shOrder;
            if (shOrder == 1) continue;
            surface.shadingNormal[0] = tilted;
            TruncationFloor turned(surface, directions, shOrder, Projection{});
            turned.visitor()(0, visible);
            EXPECT_NEAR(turned.irradiance()[0][0], seenTilted, 0.02 * kPi) << shOrder;
        }
    }
}

}  // namespace
}  // namespace prt::tools
