// Compression of plain and of weighted visibility: what is compared, what is kept.
#include "compress/compress_visibility.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "compress/irradiance_weights.h"
#include "compress/refine_basis.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "precompute/math/irradiance_projection.h"
#include "precompute/math/sh.h"
#include "tests/compress/test_points.h"

namespace prt {
namespace {

using RowMatrixXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

TEST(CompressVisibility, OfPlainRowsIsPcaWithTheWeightsAskedFor) {
    const int shOrder = 4, dimension = shCount(shOrder);
    const Points points = testPoints(shOrder, 500, 3, 60);
    const PcaResult pca = computePca(points.rows, {}, dimension, 6);
    const auto compressed = [&](WeightsFit fit, Covariance covariance) {
        return compressVisibility(points.rows, {}, points.normals, shOrder, kPlainProjection, 6, fit,
                                  covariance);
    };
    for (const Covariance covariance : {Covariance::Plain, Covariance::Irradiance}) {
        const CompressedVisibility plain = compressed(WeightsFit::Plain, covariance);
        EXPECT_EQ(plain.pca.basis, pca.basis);
        EXPECT_EQ(plain.weights, projectPca(pca, points.rows, dimension));
    }
    const CompressedVisibility fitted = compressed(WeightsFit::Irradiance, Covariance::Plain);
    EXPECT_EQ(fitted.pca.basis, pca.basis);
    EXPECT_EQ(fitted.weights, projectPcaForIrradiance(pca, points.rows, points.normals, shOrder));
    const CompressedVisibility refined = compressed(WeightsFit::Irradiance, Covariance::Irradiance);
    EXPECT_LT(irradianceRelativeRmse(refined.pca, points.rows, refined.weights, points.normals, {}, shOrder),
              irradianceRelativeRmse(pca, points.rows, fitted.weights, points.normals, {}, shOrder));
}

// Weighted expansions of the same visibility.
Points weightedPoints(int shOrder, size_t count, unsigned seed, size_t distinctNormals) {
    return testPoints(shOrder, count, seed, distinctNormals, Projection{});
}

TEST(CompressVisibility, BeatsPcaOfWeightedRows) {
    for (const int shOrder : {4, 5, 6}) {
        const int dimension = shCount(shOrder), components = 12;
        const Points points = weightedPoints(shOrder, 1500, 5, 1500);
        const CompressedVisibility result = compressVisibility(
            points.rows, {}, points.normals, shOrder, Projection{}, components, WeightsFit::Irradiance);
        const PcaResult direct = computePca(points.rows, {}, dimension, components);
        const double error =
            irradianceRelativeRmse(result.pca, points.rows, result.weights, points.normals, {}, shOrder);
        EXPECT_LT(error,
                  irradianceRelativeRmse(direct, points.rows, projectPca(direct, points.rows, dimension),
                                         points.normals, {}, shOrder));
    }
}

TEST(CompressVisibility, BasisIsOrthonormalWithFallingVariance) {
    const int shOrder = 5, dimension = shCount(shOrder), components = 9;
    const Points points = weightedPoints(shOrder, 800, 7, 300);
    for (const WeightsFit fit : {WeightsFit::Irradiance, WeightsFit::Plain}) {
        const PcaResult pca =
            compressVisibility(points.rows, {}, points.normals, shOrder, Projection{}, components, fit).pca;
        const RowMatrixXf basis = Eigen::Map<const RowMatrixXf>(pca.basis.data(), components, dimension);
        EXPECT_LT((basis * basis.transpose() - Eigen::MatrixXf::Identity(components, components))
                      .cwiseAbs()
                      .maxCoeff(),
                  2e-6f);
        EXPECT_TRUE(std::is_sorted(pca.variance.rbegin(), pca.variance.rend()));
        EXPECT_GT(pca.explainedVariance, 0.5);
        EXPECT_LE(pca.explainedVariance, 1);
        for (Eigen::Index m = 0; m < components; ++m) {
            Eigen::Index largest = 0;
            basis.row(m).cwiseAbs().maxCoeff(&largest);
            EXPECT_GT(basis(m, largest), 0);
        }
    }
}

TEST(CompressVisibility, AllComponentsKeepEveryRow) {
    for (const int shOrder : {1, 3, 6}) {
        const int dimension = shCount(shOrder);
        const Points points = weightedPoints(shOrder, 300, 9, 40);
        const CompressedVisibility result = compressVisibility(
            points.rows, {}, points.normals, shOrder, Projection{}, dimension, WeightsFit::Irradiance);
        EXPECT_LT(pcaRelativeRmse(result.pca, points.rows, result.weights, {}, dimension), 1e-5);
    }
}

TEST(CompressVisibility, IsTheSameForAnyNumberOfThreads) {
    const int shOrder = 4;
    const Points points = weightedPoints(shOrder, 6000, 11, 6000);
    const auto compressed = [&](int threads) {
        setThreadCount(threads);
        const CompressedVisibility result = compressVisibility(points.rows, {}, points.normals, shOrder,
                                                               Projection{}, 5, WeightsFit::Irradiance);
        setThreadCount(0);
        return result;
    };
    const CompressedVisibility one = compressed(1), three = compressed(3);
    EXPECT_EQ(one.pca.mean, three.pca.mean);
    EXPECT_EQ(one.pca.basis, three.pca.basis);
    EXPECT_EQ(one.weights, three.weights);
}

TEST(CompressVisibility, RowsNotInUseDoNotCount) {
    const int shOrder = 3, dimension = shCount(shOrder);
    Points points = weightedPoints(shOrder, 400, 13, 100);
    const CompressedVisibility expected =
        compressVisibility(points.rows, {}, points.normals, shOrder, Projection{}, 4, WeightsFit::Irradiance);
    std::vector<uint8_t> use(points.normals.size(), 1);
    for (const Vec3f& normal : {Vec3f(0, 0, 0), Vec3f(0, 1, 0)}) {
        points.rows.insert(points.rows.end(), size_t(dimension), 1000.0f);
        points.normals.push_back(normal);
        use.push_back(0);
    }
    const CompressedVisibility result = compressVisibility(points.rows, use, points.normals, shOrder,
                                                           Projection{}, 4, WeightsFit::Irradiance);
    EXPECT_EQ(result.pca.mean, expected.pca.mean);
    EXPECT_EQ(result.pca.basis, expected.pca.basis);
    for (const float weight : result.weights) EXPECT_TRUE(std::isfinite(weight));
}

std::vector<double> covarianceOf(std::span<const float> rows, int dimension) {
    RowMoments moments(dimension);
    moments.add(rows);
    return moments.covariance();
}

PcaResult refined(const PcaResult& pca, const Points& points, std::span<const float> weights, int shOrder,
                  std::span<const float> rowWeights = {}) {
    return refineForIrradiance(pca, points.rows, weights, points.normals, rowWeights,
                               covarianceOf(points.rows, shCount(shOrder)), shOrder, {});
}

TEST(RefineBasis, LowersTheErrorThatItMinimises) {
    const int shOrder = 5, dimension = shCount(shOrder), components = 8;
    const Points points = weightedPoints(shOrder, 1000, 17, 1000);
    PcaResult pca = computePca(points.rows, {}, dimension, components);
    double last = std::numeric_limits<double>::infinity();
    for (int step = 0; step < 4; ++step) {
        const std::vector<float> weights = projectPcaForIrradiance(pca, points.rows, points.normals, shOrder);
        const double error = irradianceRelativeRmse(pca, points.rows, weights, points.normals, {}, shOrder);
        EXPECT_LT(error, last) << step;
        last = error;
        pca = refined(pca, points, weights, shOrder);
    }
}

TEST(RefineBasis, FindsABasisThatExplainsTheRows) {
    // Rows made of a mean and two vectors are explained by them, whatever the metrics.
    const int shOrder = 3, dimension = shCount(shOrder);
    Points points = testPoints(shOrder, 300, 19, 300);
    const PcaResult truth = computePca(points.rows, {}, dimension, 2);
    const std::vector<float> exact = projectPca(truth, points.rows, dimension);
    for (size_t i = 0; i < points.normals.size(); ++i)
        for (size_t c = 0; c < size_t(dimension); ++c)
            points.rows[i * size_t(dimension) + c] = truth.mean[c] + exact[2 * i] * truth.basis[c] +
                                                     exact[2 * i + 1] * truth.basis[size_t(dimension) + c];
    PcaResult start = computePca(points.rows, {}, dimension, 2);
    start.mean = truth.mean;
    for (size_t k = 0; k < start.basis.size(); ++k) start.basis[k] = k % size_t(dimension + 1) == 0 ? 1 : 0;
    const PcaResult found = refineForIrradiance(start, points.rows, exact, points.normals, {},
                                                covarianceOf(points.rows, dimension), shOrder, {});
    EXPECT_LT(pcaRelativeRmse(found, points.rows, projectPca(found, points.rows, dimension), {}, dimension),
              1e-4);
    EXPECT_NEAR(found.explainedVariance, 1, 1e-5);
}

TEST(RefineBasis, WholeWeightsAreRepetitions) {
    const int shOrder = 3, components = 3;
    const Points points = weightedPoints(shOrder, 200, 31, 200);
    Points repeated;
    std::vector<float> rowWeights;
    const size_t dimension = size_t(shCount(shOrder));
    for (size_t i = 0; i < 200; ++i) {
        rowWeights.push_back(float(i % 4));
        for (size_t k = 0; k < i % 4; ++k) {
            repeated.normals.push_back(points.normals[i]);
            const auto row = points.rows.begin() + ptrdiff_t(i * dimension);
            repeated.rows.insert(repeated.rows.end(), row, row + ptrdiff_t(dimension));
        }
    }
    const PcaResult pca = computePca(points.rows, {}, int(dimension), components);
    const auto step = [&](const Points& p, std::span<const float> counts) {
        return refineForIrradiance(pca, p.rows, projectPcaForIrradiance(pca, p.rows, p.normals, shOrder),
                                   p.normals, counts, covarianceOf(points.rows, int(dimension)), shOrder, {});
    };
    const PcaResult a = step(points, rowWeights), b = step(repeated, {});
    for (size_t k = 0; k < dimension; ++k) EXPECT_NEAR(a.mean[k], b.mean[k], 1e-4);
    for (size_t k = 0; k < a.basis.size(); ++k) EXPECT_NEAR(a.basis[k], b.basis[k], 1e-3);
}

TEST(RefineBasis, LeavesManyVectorsAlone) {
    const int shOrder = kMaxBundleShOrder, dimension = shCount(shOrder), components = 40;
    const Points points = testPoints(shOrder, 60, 23, 60);
    const PcaResult pca = computePca(points.rows, {}, dimension, components);
    const std::vector<float> weights = projectPca(pca, points.rows, dimension);
    EXPECT_EQ(refined(pca, points, weights, shOrder).basis, pca.basis);
}

// All points look alike but for noise, so that most vectors are arbitrary.
TEST(CompressVisibility, RowsOfFewDimensionsStayBounded) {
    constexpr int kOrder = 6;
    const size_t columns = size_t(shCount(kOrder)), count = 600;
    for (const int distinct : {1, 2, 4}) {
        std::vector<std::vector<float>> kinds;
        std::vector<float> rows;
        std::vector<Vec3f> normals;
        const Vec3f up(0, 1, 0);
        const IrradianceProjection projection(kOrder);
        for (int kind = 0; kind < distinct; ++kind) {
            std::vector<float> b(columns), row(columns), basis(columns);
            const std::vector<Vec3f> directions = sphericalFibonacci(128 + 16 * kind);
            for (const Vec3f& direction : directions) {
                if (!(direction.y() > 0)) continue;
                evalSh(kOrder, direction, basis);
                for (size_t c = 0; c < columns; ++c)
                    b[c] += float(irradianceWeight(double(direction.y())) * 4 * M_PI) * basis[c] /
                            float(directions.size());
            }
            projection.solve(up, b, float(M_PI), row);
            kinds.push_back(row);
        }
        for (size_t i = 0; i < count; ++i) {
            const std::vector<float>& row = kinds[i % kinds.size()];
            rows.insert(rows.end(), row.begin(), row.end());
            normals.push_back(up);
        }
        const CompressedVisibility compressed =
            compressVisibility(rows, {}, normals, kOrder, Projection{}, 16, WeightsFit::Irradiance);
        for (const float weight : compressed.weights) EXPECT_LT(std::abs(weight), 100);
        for (const float mean : compressed.pca.mean) EXPECT_LT(std::abs(mean), 100);
        EXPECT_LT(irradianceRelativeRmse(compressed.pca, rows, compressed.weights, normals, {}, kOrder, {}),
                  0.1)
            << distinct;
    }
}

}  // namespace
}  // namespace prt
