// The weight of irradiance and its metric against a direct quadrature of everything they are made of.
#include "precompute/math/irradiance_weight.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "precompute/math/sh.h"
#include "tests/math/slow_irradiance_weight.h"

namespace prt {
namespace {

using RowMatrixXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::MatrixXd metricOf(const Vec3f& normal, int shOrder, const IrradianceWeight& weight = {}) {
    const int dimension = shCount(shOrder);
    std::vector<float> values(size_t(dimension) * size_t(dimension));
    IrradianceMetric(shOrder, weight).evaluate(normal, values);
    return Eigen::Map<const RowMatrixXf>(values.data(), dimension, dimension).cast<double>();
}

const std::vector<IrradianceWeight> kWeights = {{}, {35, 0.002}, {5, 0}, {90, 0.1}};

TEST(IrradianceWeight, EqualsTheDefinition) {
    for (const IrradianceWeight& weight : kWeights)
        for (double degrees = 0; degrees <= 180; degrees += 3.75) {
            const double angle = degrees * M_PI / 180;
            const Vec3d direction(std::sin(angle), 0, std::cos(angle));
            EXPECT_NEAR(irradianceWeight(direction.z(), weight),
                        slow::irradianceWeight(Vec3d(0, 0, 1), direction, weight, 200, 400), 2e-5)
                << degrees << " degrees, cone " << weight.coneDegrees;
        }
}

TEST(IrradianceWeight, FallsFromItsLargestValueToTheFloor) {
    for (const IrradianceWeight& weight : kWeights) {
        const double largest = largestIrradianceWeight(weight);
        EXPECT_NEAR(irradianceWeight(1, weight), (1 + weight.floor) * largest, 1e-12);
        const double blind = -std::sin(weight.coneDegrees * M_PI / 180);
        EXPECT_NEAR(irradianceWeight(blind, weight), weight.floor * largest, 1e-12);
        EXPECT_NEAR(irradianceWeight(-1, weight), weight.floor * largest, 1e-12);
        for (double z = -1; z < 1; z += 0.01)
            EXPECT_LE(irradianceWeight(z, weight), irradianceWeight(z + 0.01, weight) + 1e-12);
        // Rounding may carry a cosine beyond 1.
        EXPECT_EQ(irradianceWeight(1 + 1e-7, weight), irradianceWeight(1, weight));
    }
}

TEST(IrradianceWeight, ZonalSeriesConvergesToTheFunction) {
    const std::vector<double> zonal = irradianceWeightZonal(kMaxShOrder);
    std::vector<double> y(size_t(shCount(kMaxShOrder)));
    for (double degrees = 0; degrees <= 180; degrees += 7.5) {
        const double angle = degrees * M_PI / 180;
        evalSh(kMaxShOrder, Vec3d(std::sin(angle), 0, std::cos(angle)), y);
        double value = 0;
        for (int l = 0; l < kMaxShOrder; ++l) value += zonal[size_t(l)] * y[size_t(shIndex(l, 0))];
        EXPECT_NEAR(value, irradianceWeight(std::cos(angle)), 3e-4) << degrees << " degrees";
    }
}

TEST(IrradianceWeight, ZonalSeriesIsTheProjectionOfTheFunction) {
    for (const IrradianceWeight& weight : kWeights) {
        const std::vector<double> zonal = irradianceWeightZonal(12, weight);
        const std::vector<double> projected = projectSh(
            12, [&](const Vec3d& d) { return irradianceWeight(d.z(), weight); }, 255);
        for (int l = 0; l < 12; ++l)
            EXPECT_NEAR(zonal[size_t(l)], projected[size_t(shIndex(l, 0))], 2e-6) << l;
    }
}

TEST(IrradianceWeight, RangesOfParameters) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const IrradianceWeight& weight : kWeights) EXPECT_TRUE(isValid(weight));
    for (const IrradianceWeight& weight : std::vector<IrradianceWeight>{
             {0, 0.1}, {-1, 0.1}, {90.1, 0.1}, {nan, 0.1}, {40, -1e-9}, {40, 1.1}, {40, nan}})
        EXPECT_FALSE(isValid(weight)) << weight.coneDegrees << " " << weight.floor;
}

TEST(IrradianceMetric, EqualsQuadratureOfTheDefinition) {
    for (const Vec3f& normal : {Vec3f(0, 0, 1), Vec3f(0, -1, 0), Vec3f(0.6f, -0.48f, 0.64f)})
        EXPECT_LT(
            (metricOf(normal, 4) - slow::irradianceMetric(normal.cast<double>(), 4)).cwiseAbs().maxCoeff(),
            3e-4);
}

TEST(IrradianceMetric, IsSymmetricAndBoundedByTheWeight) {
    const IrradianceWeight weight{40, 0.002};
    const double largest = largestIrradianceWeight(weight);
    for (const int shOrder : {1, 2, 3, 6, kMaxBundleShOrder})
        for (const Vec3f& normal : {Vec3f(0, 1, 0), Vec3f(-0.36f, 0.48f, -0.8f)}) {
            const Eigen::MatrixXd metric = metricOf(normal, shOrder, weight);
            EXPECT_EQ(metric, metric.transpose());
            const Eigen::VectorXd values =
                Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(metric).eigenvalues();
            EXPECT_GT(values.minCoeff(), weight.floor * largest - 1e-5);
            EXPECT_LT(values.maxCoeff(), (1 + weight.floor) * largest + 1e-5);
        }
}

TEST(IrradianceMetric, WithoutANormalIsAMultipleOfTheIdentity) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const Vec3f& normal : {Vec3f(0, 0, 0), Vec3f(nan, 0, 1)}) {
        const Eigen::MatrixXd metric = metricOf(normal, 3);
        EXPECT_GT(metric(0, 0), 0);
        EXPECT_LT((metric - metric(0, 0) * Eigen::MatrixXd::Identity(9, 9)).cwiseAbs().maxCoeff(), 1e-6);
    }
}

TEST(IrradianceMetric, BlocksAreThoseOfANormalAlongZ) {
    for (const int shOrder : {1, 2, 5, kMaxBundleShOrder}) {
        const std::vector<std::vector<double>> blocks = irradianceMetricBlocks(shOrder);
        ASSERT_EQ(blocks.size(), size_t(shOrder));
        Eigen::MatrixXd expanded = Eigen::MatrixXd::Zero(shCount(shOrder), shCount(shOrder));
        for (int m = 1 - shOrder; m < shOrder; ++m) {
            const int first = std::abs(m), size = shOrder - first;
            const std::vector<double>& block = blocks[size_t(first)];
            ASSERT_EQ(block.size(), size_t(size * size));
            for (int a = 0; a < size; ++a)
                for (int b = 0; b < size; ++b)
                    expanded(shIndex(first + a, m), shIndex(first + b, m)) = block[size_t(a * size + b)];
        }
        EXPECT_LT((metricOf(Vec3f(0, 0, 1), shOrder) - expanded).cwiseAbs().maxCoeff(), 2e-6);
    }
}

TEST(IrradianceWeightDeath, OutOfRange) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_DEATH(IrradianceMetric(kMaxBundleShOrder + 1), "shOrder");
    EXPECT_DEATH(irradianceWeight(0, {0, 0}), "isValid");
    EXPECT_DEATH(irradianceWeightZonal(kMaxShOrder + 1), "bands");
}

}  // namespace
}  // namespace prt
