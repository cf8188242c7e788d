// PCA against closed forms and a full decomposition, and the properties every result must have.
#include "compress/pca.h"

#include <Eigen/Core>
#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <random>

#include "compress/leading_vectors.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"

namespace prt {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Orthonormal columns in random directions.
Eigen::MatrixXd randomAxes(int dimension, std::mt19937& random) {
    std::normal_distribution<double> normal;
    Eigen::MatrixXd axes(dimension, dimension);
    for (double& value : axes.reshaped()) value = normal(random);
    for (int k = 0; k < dimension; ++k) {  // Gram-Schmidt, twice is enough
        for (int pass = 0; pass < 2; ++pass)
            for (int j = 0; j < k; ++j) axes.col(k) -= axes.col(j).dot(axes.col(k)) * axes.col(j);
        axes.col(k).normalize();
    }
    return axes;
}

// Rows with falling, unequal deviations along random axes, around a mean far from zero.
std::vector<float> randomRows(size_t count, int dimension, unsigned seed, double ratio = 0.8) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const Eigen::MatrixXd axes = randomAxes(dimension, random);
    Eigen::VectorXd mean(dimension);
    for (double& value : mean) value = normal(random);
    std::vector<float> rows;
    rows.reserve(count * size_t(dimension));
    for (size_t i = 0; i < count; ++i) {
        Eigen::VectorXd row = mean;
        for (int k = 0; k < dimension; ++k) row += std::pow(ratio, k) * normal(random) * axes.col(k);
        for (const double value : row) rows.push_back(float(value));
    }
    return rows;
}

using RowMatrixXd = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

RowMatrixXd inDouble(std::span<const float> values, int columns) {
    return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
               values.data(), Eigen::Index(values.size() / size_t(columns)), columns)
        .cast<double>();
}

// What every PCA must fulfil, whatever the rows.
void expectWellFormed(const PcaResult& pca, int dimension) {
    ASSERT_EQ(pca.mean.size(), size_t(dimension));
    ASSERT_EQ(pca.variance.size(), size_t(pca.components));
    ASSERT_EQ(pca.basis.size(), size_t(pca.components) * size_t(dimension));
    const RowMatrixXd basis = inDouble(pca.basis, dimension);
    const RowMatrixXd gram = basis * basis.transpose();
    EXPECT_LT((gram - RowMatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(), 1e-6);
    for (int m = 0; m < pca.components; ++m) {
        EXPECT_GE(pca.variance[size_t(m)], 0.0f);
        if (m > 0) {
            EXPECT_LE(pca.variance[size_t(m)], pca.variance[size_t(m - 1)]);
        }
        const double largest = basis.row(m).cwiseAbs().maxCoeff();
        Eigen::Index first = 0;
        while (std::abs(basis(m, first)) < largest * (1 - 1e-6)) ++first;
        EXPECT_GT(basis(m, first), 0) << "vector " << m;
    }
    EXPECT_GE(pca.explainedVariance, 0.0);
    EXPECT_LE(pca.explainedVariance, 1.0);
}

class PcaShapes : public testing::TestWithParam<std::tuple<int, int, int>> {};

TEST_P(PcaShapes, EqualsSingularValueDecomposition) {
    const auto [count, dimension, components] = GetParam();
    const std::vector<float> rows = randomRows(size_t(count), dimension, 7);
    const PcaResult pca = computePca(rows, {}, dimension, components);
    expectWellFormed(pca, dimension);

    RowMatrixXd centred = inDouble(rows, dimension);
    const Eigen::RowVectorXd mean = centred.colwise().mean();
    centred.rowwise() -= mean;
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(centred / std::sqrt(double(count)), Eigen::ComputeThinV);
    const Eigen::VectorXd variance = svd.singularValues().array().square();
    const double total = variance.sum();
    EXPECT_NEAR(pca.totalVariance, total, 2e-6 * total);
    EXPECT_LT((inDouble(pca.mean, dimension) - mean).cwiseAbs().maxCoeff(), 1e-6);
    for (int m = 0; m < components; ++m) {
        const double expected = m < variance.size() ? variance[m] : 0.0;
        EXPECT_NEAR(double(pca.variance[size_t(m)]), expected, 2e-6 * total) << "component " << m;
        if (m >= variance.size() || expected < 1e-4 * total) continue;
        // Neighbouring eigenvalues differ by a third at least, so vectors are as exact as the sums.
        const double cosine = std::abs(inDouble(pca.basis, dimension).row(m).dot(svd.matrixV().col(m)));
        EXPECT_NEAR(cosine, 1.0, 1e-4) << "component " << m;
    }
}

TEST_P(PcaShapes, MeanErrorIsWhatTheDiscardedEigenvaluesSay) {
    const auto [count, dimension, components] = GetParam();
    const std::vector<float> rows = randomRows(size_t(count), dimension, 11);
    const PcaResult pca = computePca(rows, {}, dimension, components);
    const PcaError error = pcaError(pca, rows, projectPca(pca, rows, dimension), {}, dimension);
    const double discarded = pca.totalVariance * (1 - pca.explainedVariance);
    EXPECT_NEAR(error.rmse * error.rmse * dimension, discarded, 4e-6 * pca.totalVariance);
    const double meanSquare = inDouble(rows, dimension).squaredNorm() / count;
    EXPECT_NEAR(error.relativeRmse, error.rmse * std::sqrt(dimension / meanSquare), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Sizes, PcaShapes,
                         testing::Values(std::tuple{500, 9, 4}, std::tuple{500, 9, 9},
                                         std::tuple{3000, 16, 3}, std::tuple{2048, 36, 16},
                                         std::tuple{2500, 36, 30}, std::tuple{1500, 100, 24},
                                         std::tuple{1025, 4, 1}, std::tuple{1024, 1, 1},
                                         std::tuple{12, 36, 16}, std::tuple{3, 16, 7}, std::tuple{2, 9, 9}));

TEST(Pca, ClosedFormCovariance) {
    // The 2d points ±s_k e_k have mean 0 and covariance diag(s_k²) / d.
    const int dimension = 16;
    std::vector<float> rows;
    for (int k = 0; k < dimension; ++k)
        for (const float sign : {-1.0f, 1.0f}) {
            std::vector<float> row(size_t(dimension), 0.0f);
            row[size_t((k * 7) % dimension)] = sign * float(dimension - k);
            rows.insert(rows.end(), row.begin(), row.end());
        }
    for (const int components : {5, 16}) {
        const PcaResult pca = computePca(rows, {}, dimension, components);
        expectWellFormed(pca, dimension);
        for (int m = 0; m < components; ++m) {
            const double s = dimension - m;
            EXPECT_NEAR(pca.variance[size_t(m)], s * s / dimension, 1e-5);
            EXPECT_NEAR(pca.basis[size_t(m * dimension + (m * 7) % dimension)], 1.0f, 1e-6);
        }
        EXPECT_NEAR(pca.totalVariance, 1496.0 / 16.0, 1e-9);  // Σ k² of 1…16
    }
}

TEST(LeadingVectors, FindsEveryCopyOfEqualEigenvalues) {
    // Symmetric shapes have equal eigenvalues, of which Lanczos alone misses copies in one of ten such cases.
    std::mt19937 random(1);
    for (int trial = 0; trial < 400; ++trial) {
        const int dimension = std::array{16, 25, 36, 64, 100}[size_t(trial) % 5];
        const int count = 1 + int(random() % unsigned((dimension - 1) / 2));
        const Eigen::MatrixXd axes =
            trial % 3 ? randomAxes(dimension, random) : Eigen::MatrixXd::Identity(dimension, dimension);
        Eigen::VectorXd values(dimension);
        double value = 10;
        for (int k = 0; k < dimension; value *= 0.3 + 0.006 * double(random() % 100))
            for (int copies = 1 + int(random() % 7); copies > 0 && k < dimension; --copies)
                values[k++] = value;
        Eigen::MatrixXd matrix = axes * values.asDiagonal() * axes.transpose();
        matrix = ((matrix + matrix.transpose()) / 2).eval();
        const LeadingVectors leading =
            leadingVectors({matrix.data(), size_t(matrix.size())}, dimension, count);
        const Eigen::Map<const RowMatrixXd> vectors(leading.vectors.data(), count, dimension);
        for (int m = 0; m < count; ++m)
            ASSERT_NEAR(leading.values[size_t(m)], values[m], 1e-7) << "trial " << trial;
        ASSERT_LT(
            (vectors * vectors.transpose() - Eigen::MatrixXd::Identity(count, count)).cwiseAbs().maxCoeff(),
            1e-9);
        const Eigen::MatrixXd scaled = values.head(count).asDiagonal() * vectors;
        ASSERT_LT((vectors * matrix - scaled).cwiseAbs().maxCoeff(), 1e-6);
        ASSERT_EQ(leading.vectors,
                  leadingVectors({matrix.data(), size_t(matrix.size())}, dimension, count).vectors);
    }
}

TEST(LeadingVectors, ProductsAloneGiveTheSame) {
    // The covariance of rows, never formed: to the mean's distances and back.
    const int dimension = 36;
    const RowMatrixXd rows = inDouble(randomRows(3000, dimension, 17), dimension);
    const RowMatrixXd centred = rows.rowwise() - rows.colwise().mean();
    const Eigen::MatrixXd covariance = centred.transpose() * centred / double(rows.rows());
    size_t products = 0;
    const auto product = [&](std::span<const double> x, std::span<double> y) {
        ++products;
        const Eigen::Map<const Eigen::VectorXd> in(x.data(), dimension);
        Eigen::Map<Eigen::VectorXd>(y.data(), dimension) =
            centred.transpose() * (centred * in) / double(rows.rows());
    };
    for (const int count : {1, 5, 17, 36}) {
        products = 0;
        const LeadingVectors implicit = leadingVectors(product, covariance.trace(), dimension, count);
        const LeadingVectors dense =
            leadingVectors({covariance.data(), size_t(covariance.size())}, dimension, count);
        for (size_t m = 0; m < size_t(count); ++m)
            EXPECT_NEAR(implicit.values[m], dense.values[m], 1e-9 * covariance.trace());
        // Deviations of neighbouring axes differ by a fifth.
        for (size_t k = 0; k < implicit.vectors.size(); ++k)
            EXPECT_NEAR(implicit.vectors[k], dense.vectors[k], 1e-6);
        EXPECT_LE(products, size_t(2 * std::max(dimension, 4 * count + 20)));
    }
}

TEST(Pca, AllComponentsReconstructExactly) {
    for (const int dimension : {1, 4, 9, 36, 100}) {
        const std::vector<float> rows = randomRows(1500, dimension, unsigned(dimension));
        const PcaResult pca = computePca(rows, {}, dimension, dimension);
        const std::vector<float> weights = projectPca(pca, rows, dimension);
        const RowMatrixXd basis = inDouble(pca.basis, dimension);
        RowMatrixXd rebuilt = inDouble(weights, dimension) * basis;
        rebuilt.rowwise() += inDouble(pca.mean, dimension).row(0);
        EXPECT_LT((rebuilt - inDouble(rows, dimension)).cwiseAbs().maxCoeff(), 1e-5);
        EXPECT_NEAR(pca.explainedVariance, 1.0, 1e-9);
    }
}

TEST(Pca, ErrorFallsWithComponents) {
    const std::vector<float> rows = randomRows(4000, 36, 3, 0.9);
    double previous = std::numeric_limits<double>::infinity();
    for (int components = 1; components <= 36; ++components) {
        const PcaResult pca = computePca(rows, {}, 36, components);
        const double error = pcaRelativeRmse(pca, rows, projectPca(pca, rows, 36), {}, 36);
        EXPECT_LT(error, previous);
        previous = error;
    }
    EXPECT_LT(previous, 1e-6);
}

TEST(Pca, WeightsAreCentredUncorrelatedAndOfTheStatedVariance) {
    const std::vector<float> rows = randomRows(70000, 16, 5);
    const PcaResult pca = computePca(rows, {}, 16, 6);
    const RowMatrixXd weights = inDouble(projectPca(pca, rows, 16), 6);
    EXPECT_LT(weights.colwise().mean().cwiseAbs().maxCoeff(), 1e-5);
    RowMatrixXd covariance = weights.transpose() * weights / double(weights.rows());
    covariance.diagonal() -= inDouble(pca.variance, 1);
    EXPECT_LT(covariance.cwiseAbs().maxCoeff(), 5e-6 * pca.totalVariance);
}

TEST(Pca, RowsNotInUseDoNotMatter) {
    const int dimension = 16;
    const std::vector<float> rows = randomRows(2000, dimension, 9);
    std::vector<float> mixed;
    std::vector<uint8_t> use;
    for (size_t i = 0; i < 2000; ++i) {
        for (size_t k = 0; k < i % 4; ++k) {
            mixed.insert(mixed.end(), size_t(dimension), k % 2 ? kNan : 1e30f);
            use.push_back(0);
        }
        mixed.insert(mixed.end(), rows.begin() + ptrdiff_t(i) * dimension,
                     rows.begin() + ptrdiff_t(i + 1) * dimension);
        use.push_back(1);
    }
    const PcaResult a = computePca(rows, {}, dimension, 5), b = computePca(mixed, use, dimension, 5);
    EXPECT_EQ(a.mean, b.mean);
    EXPECT_EQ(a.basis, b.basis);
    EXPECT_EQ(a.variance, b.variance);
    EXPECT_EQ(a.totalVariance, b.totalVariance);
    EXPECT_NEAR(pcaRelativeRmse(a, rows, projectPca(a, rows, dimension), {}, dimension),
                pcaRelativeRmse(b, mixed, projectPca(b, mixed, dimension), use, dimension), 1e-12);
}

TEST(Pca, DoesNotDependOnThreadsOrRepetition) {
    const std::vector<float> rows = randomRows(150000, 9, 2);
    // All threads first: a process that starts with one may keep to it.
    const PcaResult all = computePca(rows, {}, 9, 4);
    const std::vector<float> weights = projectPca(all, rows, 9);
    const double error = pcaRelativeRmse(all, rows, weights, {}, 9);
    setThreadCount(1);
    const PcaResult one = computePca(rows, {}, 9, 4);
    EXPECT_EQ(one.mean, all.mean);
    EXPECT_EQ(one.basis, all.basis);
    EXPECT_EQ(one.variance, all.variance);
    EXPECT_EQ(projectPca(one, rows, 9), weights);
    EXPECT_EQ(pcaRelativeRmse(one, rows, weights, {}, 9), error);
    setThreadCount(0);
}

TEST(Pca, LargeMeansDoNotDrownSmallVariances) {
    // Deviation 1e-3 around 1000 in steps that float holds: cancellation would leave nothing of it.
    const int dimension = 9;
    const size_t count = 200000;
    std::mt19937 random(4);
    std::vector<float> rows(count * size_t(dimension));
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(dimension), square = sum;
    for (size_t i = 0; i < rows.size(); ++i) {
        const double offset = double(int(random() % 65) - 32) / 8192.0;
        rows[i] = float(1000.0 + offset);
        sum[Eigen::Index(i % size_t(dimension))] += offset;
        square[Eigen::Index(i % size_t(dimension))] += offset * offset;
    }
    const double expected = (square / double(count) - (sum / double(count)).cwiseAbs2()).sum();
    const PcaResult pca = computePca(rows, {}, dimension, dimension);
    EXPECT_NEAR(pca.totalVariance, expected, 1e-5 * expected);
}

TEST(Pca, OrderOfRowsDoesNotMatter) {
    // Sorted: every block of rows lies far from the mean of all.
    const int dimension = 9;
    std::vector<float> rows;
    for (int i = 0; i < 40000; ++i)
        for (int k = 0; k < dimension; ++k)
            rows.push_back(float(i) * 1e-3f * float(k % 3) + std::sin(float(i * (k + 1))));
    std::vector<float> strided;
    for (size_t i = 0; i < 40000; ++i) {
        const auto row = rows.begin() + ptrdiff_t(i * 7919 % 40000) * dimension;
        strided.insert(strided.end(), row, row + dimension);
    }
    const PcaResult a = computePca(rows, {}, dimension, 4), b = computePca(strided, {}, dimension, 4);
    EXPECT_NEAR(a.totalVariance, b.totalVariance, 1e-6 * a.totalVariance);
    for (size_t m = 0; m < 4; ++m) EXPECT_NEAR(a.variance[m], b.variance[m], 1e-6 * a.totalVariance);
    for (size_t k = 0; k < 9; ++k) EXPECT_NEAR(a.mean[k], b.mean[k], 1e-6 * 40);
}

TEST(Pca, RowsThatAreAllEqual) {
    for (const size_t count : {size_t(1), size_t(2), size_t(5000)}) {
        std::vector<float> rows;
        for (size_t i = 0; i < count; ++i) rows.insert(rows.end(), {0.1f, -2.3f, 5.7f, 1e-3f});
        for (int components = 1; components <= 4; ++components) {
            const PcaResult pca = computePca(rows, {}, 4, components);
            expectWellFormed(pca, 4);
            EXPECT_EQ(pca.mean, std::vector<float>(rows.begin(), rows.begin() + 4));
            EXPECT_EQ(pca.totalVariance, 0.0);
            EXPECT_EQ(pca.explainedVariance, 1.0);
            for (const float weight : projectPca(pca, rows, 4)) EXPECT_EQ(weight, 0.0f);
        }
    }
    const std::vector<float> zeros(16 * 3, 0.0f);
    const PcaResult pca = computePca(zeros, {}, 16, 2);
    expectWellFormed(pca, 16);
    EXPECT_EQ(pcaRelativeRmse(pca, zeros, projectPca(pca, zeros, 16), {}, 16), 0.0);
}

TEST(Pca, BeyondTheRankVectorsAreOrthonormalWithZeroVariance) {
    const int dimension = 36;
    const std::vector<float> pattern = randomRows(2, dimension, 8);
    std::vector<float> rows;
    for (int i = 0; i < 3000; ++i) {  // rank 2
        const float a = std::sin(float(i)), b = std::cos(1.7f * float(i));
        for (int k = 0; k < dimension; ++k)
            rows.push_back(a * pattern[size_t(k)] + b * pattern[size_t(dimension + k)]);
    }
    for (const int components : {2, 10, 36}) {
        const PcaResult pca = computePca(rows, {}, dimension, components);
        expectWellFormed(pca, dimension);
        EXPECT_NEAR(pca.explainedVariance, 1.0, 1e-6);
        for (int m = 2; m < components; ++m) EXPECT_LT(pca.variance[size_t(m)], 1e-6 * pca.totalVariance);
        EXPECT_LT(pcaRelativeRmse(pca, rows, projectPca(pca, rows, dimension), {}, dimension), 1e-5);
    }
}

TEST(Pca, RefusesRowsItCannotUse) {
    EXPECT_THROW(computePca({}, {}, 4, 1), InputError);
    std::vector<float> rows(4 * 10, 1.0f);
    EXPECT_THROW(computePca(rows, std::vector<uint8_t>(10, 0), 4, 1), InputError);
    rows[4 * 7 + 2] = kNan;
    try {
        computePca(rows, {}, 4, 1);
        FAIL() << "a row that is not finite was taken";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("point 7"));
    }
    rows[4 * 7 + 2] = std::numeric_limits<float>::infinity();
    EXPECT_THROW(computePca(rows, {}, 4, 1), InputError);
    rows[4 * 7 + 2] = 1e30f;
    EXPECT_THROW(computePca(rows, {}, 4, 1), InputError);
}

TEST(PcaDeath, ComponentsOutOfRange) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const std::vector<float> rows(4 * 10, 1.0f);
    EXPECT_DEATH(computePca(rows, {}, 4, 5), "components");
    EXPECT_DEATH(computePca(rows, {}, 4, 0), "components");
}

}  // namespace
}  // namespace prt
