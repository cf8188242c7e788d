// Weights fitted for irradiance against a direct quadrature of everything they are made of.
#include "compress/irradiance_weights.h"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "tests/compress/test_points.h"
#include "tests/math/slow_irradiance_weight.h"

namespace prt {
namespace {

float largestDifference(const std::vector<float>& a, const std::vector<float>& b) {
    EXPECT_EQ(a.size(), b.size());
    float result = 0;
    for (size_t i = 0; i < a.size(); ++i) result = std::max(result, std::abs(a[i] - b[i]));
    return result;
}

using RowMatrixXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::MatrixXd metricOf(const Vec3f& normal, int shOrder) {
    const int dimension = shCount(shOrder);
    std::vector<float> values(size_t(dimension) * size_t(dimension));
    IrradianceMetric(shOrder).evaluate(normal, values);
    return Eigen::Map<const RowMatrixXf>(values.data(), dimension, dimension).cast<double>();
}

TEST(IrradianceWeights, SolveTheLeastSquaresOfTheDirectQuadrature) {
    // Rows sqrt(w·weight)·Y(ω) of one least-squares problem per point, solved by QR.
    const int shOrder = 4, dimension = shCount(shOrder), components = 5;
    const Points points = testPoints(shOrder, 60, 3, 4);
    const PcaResult pca = computePca(points.rows, {}, dimension, components);
    const std::vector<float> weights = projectPcaForIrradiance(pca, points.rows, points.normals, shOrder);
    const Eigen::MatrixXd basis =
        Eigen::Map<const RowMatrixXf>(pca.basis.data(), components, dimension).cast<double>();
    const Eigen::VectorXd mean = Eigen::Map<const Eigen::VectorXf>(pca.mean.data(), dimension).cast<double>();
    const std::vector<SphereNode> nodes = sphereQuadrature(47);
    std::vector<double> y(static_cast<size_t>(dimension));
    for (size_t i = 0; i < 6; ++i) {
        Eigen::MatrixXd system(Eigen::Index(nodes.size()), dimension);
        for (size_t k = 0; k < nodes.size(); ++k) {
            evalSh(shOrder, nodes[k].direction, y);
            const double w = slow::irradianceWeight(points.normals[i].cast<double>(), nodes[k].direction);
            system.row(Eigen::Index(k)) =
                std::sqrt(w * nodes[k].weightSr) * Eigen::Map<const Eigen::RowVectorXd>(y.data(), dimension);
        }
        const Eigen::VectorXd row =
            Eigen::Map<const Eigen::VectorXf>(points.rows.data() + i * size_t(dimension), dimension)
                .cast<double>();
        const Eigen::VectorXd expected =
            (system * basis.transpose()).colPivHouseholderQr().solve(system * (row - mean));
        for (int m = 0; m < components; ++m)
            EXPECT_NEAR(weights[i * components + size_t(m)], expected[m], 3e-3) << "point " << i;
    }
}

TEST(IrradianceWeights, AreTheMinimumOfTheMetric) {
    // A minimum: moving along any vector raises the error of each point.
    const int shOrder = 5, dimension = shCount(shOrder), components = 7;
    const Points points = testPoints(shOrder, 200, 5, 200);
    const PcaResult pca = computePca(points.rows, {}, dimension, components);
    const std::vector<float> weights = projectPcaForIrradiance(pca, points.rows, points.normals, shOrder);
    const Eigen::MatrixXd basis =
        Eigen::Map<const RowMatrixXf>(pca.basis.data(), components, dimension).cast<double>();
    for (size_t i = 0; i < 200; ++i) {
        Eigen::VectorXd error(dimension);
        for (int c = 0; c < dimension; ++c)
            error[c] = double(points.rows[i * size_t(dimension) + size_t(c)]) - double(pca.mean[size_t(c)]);
        for (int m = 0; m < components; ++m)
            error -= double(weights[i * components + size_t(m)]) * basis.row(m).transpose();
        const Eigen::VectorXd gradient = basis * metricOf(points.normals[i], shOrder) * error;
        EXPECT_LT(gradient.cwiseAbs().maxCoeff(), 1e-5) << "point " << i;
    }
}

TEST(IrradianceWeights, AllComponentsGivePlainProjection) {
    for (const int shOrder : {1, 3, 6, kMaxBundleShOrder}) {
        const int dimension = shCount(shOrder);
        const Points points = testPoints(shOrder, 400, 7, 50);
        const PcaResult pca = computePca(points.rows, {}, dimension, dimension);
        const std::vector<float> weights = projectPcaForIrradiance(pca, points.rows, points.normals, shOrder);
        EXPECT_LT(largestDifference(weights, projectPca(pca, points.rows, dimension)), 1e-4f);
        EXPECT_LT(irradianceRelativeRmse(pca, points.rows, weights, points.normals, {}, shOrder), 1e-4);
    }
}

TEST(IrradianceWeights, AreNeverWorseThanPlainForIrradianceNorBetterForCoefficients) {
    for (const int shOrder : {2, 3, 6}) {
        const int dimension = shCount(shOrder);
        const Points points = testPoints(shOrder, 600, 11, 100);
        double previous = std::numeric_limits<double>::infinity();
        for (int components = 1; components < dimension; components += 3) {
            const PcaResult pca = computePca(points.rows, {}, dimension, components);
            const std::vector<float> plain = projectPca(pca, points.rows, dimension),
                                     fitted =
                                         projectPcaForIrradiance(pca, points.rows, points.normals, shOrder);
            const double error =
                irradianceRelativeRmse(pca, points.rows, fitted, points.normals, {}, shOrder);
            EXPECT_LT(error, irradianceRelativeRmse(pca, points.rows, plain, points.normals, {}, shOrder));
            EXPECT_GT(pcaRelativeRmse(pca, points.rows, fitted, {}, dimension),
                      pcaRelativeRmse(pca, points.rows, plain, {}, dimension));
            EXPECT_LT(error, previous);
            previous = error;
        }
    }
}

TEST(IrradianceWeights, WithoutANormalAreThoseOfPlainProjection) {
    const int shOrder = 4, dimension = shCount(shOrder);
    Points points = testPoints(shOrder, 50, 13, 5);
    const PcaResult pca = computePca(points.rows, {}, dimension, 6);
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const Vec3f& normal : {Vec3f(0, 0, 0), Vec3f(0, nan, 1), Vec3f(inf, 0, 0), Vec3f(0, -0.0f, 0)}) {
        std::fill(points.normals.begin(), points.normals.end(), normal);
        const std::vector<float> weights = projectPcaForIrradiance(pca, points.rows, points.normals, shOrder);
        EXPECT_LT(largestDifference(weights, projectPca(pca, points.rows, dimension)), 1e-5f);
    }
}

TEST(IrradianceWeights, OfAPointDependOnItsOwnRowAndNormalAlone) {
    // Flat faces of many points and points of their own normal, in many blocks.
    const int shOrder = 3, dimension = shCount(shOrder), components = 4;
    Points points = testPoints(shOrder, 9000, 17, 3);
    const Points curved = testPoints(shOrder, 3000, 19, 3000);
    points.rows.insert(points.rows.end(), curved.rows.begin(), curved.rows.end());
    points.normals.insert(points.normals.end(), curved.normals.begin(), curved.normals.end());
    const PcaResult pca = computePca(points.rows, {}, dimension, components);
    const std::vector<float> all = projectPcaForIrradiance(pca, points.rows, points.normals, shOrder);
    const double error = irradianceRelativeRmse(pca, points.rows, all, points.normals, {}, shOrder);

    std::vector<size_t> order(points.normals.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::shuffle(order.begin(), order.end(), std::mt19937(23));
    Points shuffled;
    std::vector<float> expected;
    for (const size_t i : order) {
        const auto row = points.rows.begin() + ptrdiff_t(i) * dimension;
        shuffled.rows.insert(shuffled.rows.end(), row, row + dimension);
        shuffled.normals.push_back(points.normals[i]);
        expected.insert(expected.end(), all.begin() + ptrdiff_t(i) * components,
                        all.begin() + ptrdiff_t(i + 1) * components);
    }
    EXPECT_EQ(projectPcaForIrradiance(pca, shuffled.rows, shuffled.normals, shOrder), expected);
    for (const size_t i : {size_t(0), size_t(8999), size_t(11000)}) {
        const std::vector<float> one = projectPcaForIrradiance(
            pca, std::span(points.rows).subspan(i * size_t(dimension), size_t(dimension)),
            std::span(points.normals).subspan(i, 1), shOrder);
        EXPECT_TRUE(std::equal(one.begin(), one.end(), all.begin() + ptrdiff_t(i) * components));
    }
    setThreadCount(1);
    EXPECT_EQ(projectPcaForIrradiance(pca, points.rows, points.normals, shOrder), all);
    EXPECT_EQ(irradianceRelativeRmse(pca, points.rows, all, points.normals, {}, shOrder), error);
    setThreadCount(0);
}

TEST(IrradianceWeights, RowsNotInUseDoNotCountInTheError) {
    const int shOrder = 3, dimension = shCount(shOrder);
    Points points = testPoints(shOrder, 300, 29, 10);
    const PcaResult pca = computePca(points.rows, {}, dimension, 3);
    const auto errorOf = [&](const Points& p, std::span<const uint8_t> use) {
        const std::vector<float> weights = projectPcaForIrradiance(pca, p.rows, p.normals, shOrder);
        return irradianceRelativeRmse(pca, p.rows, weights, p.normals, use, shOrder);
    };
    const double expected = errorOf(points, {});
    Points more = points;
    more.rows.insert(more.rows.end(), size_t(dimension) * 2, std::numeric_limits<float>::quiet_NaN());
    more.normals.insert(more.normals.end(), 2, points.normals[0]);
    std::vector<uint8_t> use(300, 1);
    use.insert(use.end(), 2, 0);
    EXPECT_NEAR(errorOf(more, use), expected, 1e-12);
    EXPECT_EQ(errorOf(more, std::vector<uint8_t>(302, 0)), 0.0);
}

TEST(IrradianceWeightsDeath, SizesThatDoNotFit) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const Points points = testPoints(3, 20, 31, 4);
    const PcaResult pca = computePca(points.rows, {}, 9, 3);
    EXPECT_DEATH(projectPcaForIrradiance(pca, points.rows, std::span(points.normals).first(19), 3), "rows");
    EXPECT_DEATH(projectPcaForIrradiance(pca, points.rows, points.normals, 4), "dimension");
}

}  // namespace
}  // namespace prt
