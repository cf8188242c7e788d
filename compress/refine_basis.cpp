// Weighted low-rank approximation by alternating least squares [SrebroJaakkola2003]: weights are fitted for a
// basis, then the basis for the weights. The metric of every point couples all vectors, so the basis is one
// linear system.
#include "compress/refine_basis.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

// Floats of all metrics held at once, and points at most.
constexpr size_t kMetricFloats = size_t(1) << 24;
constexpr size_t kMostPoints = 8192;
constexpr Eigen::Index kChunkPoints = 256;  // summed in float, beyond that in double
constexpr size_t kTaskColumns = 16;
// Holds directions that the rows do not determine where they are, as a share of the mean diagonal.
constexpr double kRidge = 1e-6;
// Mean and vectors move by less than their length where rows determine them: .1 to .4 on three scenes.
constexpr double kLargestStep = 2;

using RowMatrixXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using RowMatrixXd = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// a · b with sums over chunks of the inner index in double; columns of b are dealt to tasks.
Eigen::MatrixXd product(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b) {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(a.rows(), b.cols());
    parallelFor(size_t(b.cols()), kTaskColumns, [&](size_t begin, size_t end) {
        throwIfInterrupted();
        const auto first = Eigen::Index(begin), count = Eigen::Index(end - begin);
        Eigen::MatrixXf part(a.rows(), count);
        for (Eigen::Index p = 0; p < a.cols(); p += kChunkPoints) {
            const Eigen::Index points = std::min(kChunkPoints, a.cols() - p);
            part.noalias() = a.middleCols(p, points) * b.block(p, first, points, count);
            sum.middleCols(first, count) += part.cast<double>();
        }
    });
    return sum;
}

// What the normal equations are made of, one column per point.
struct Sample {
    Eigen::MatrixXf metric;        // [n⁴ × P]
    Eigen::MatrixXf weighted;      // [n² × P] A(n) row
    Eigen::MatrixXf coefficients;  // [P × (M+1)] 1, then the weights
};

Sample takeSample(std::span<const float> rows, std::span<const float> weights, std::span<const Vec3f> normals,
                  std::span<const float> rowWeights, int components, int shOrder,
                  const IrradianceWeight& weight) {
    const Eigen::Index dimension = shCount(shOrder), count = Eigen::Index(normals.size());
    double total = 0;
    for (const float one : rowWeights) total += double(one);
    const float scale = total > 0 ? float(double(rowWeights.size()) / total) : 1.0f;
    Sample sample{Eigen::MatrixXf(dimension * dimension, count), Eigen::MatrixXf(dimension, count),
                  Eigen::MatrixXf(count, components + 1)};
    const IrradianceMetric metrics(shOrder, weight);
    parallelFor(normals.size(), size_t(kChunkPoints), [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            const auto column = Eigen::Index(k);
            metrics.evaluate(normals[k], {sample.metric.col(column).data(), size_t(dimension * dimension)});
            if (!rowWeights.empty()) sample.metric.col(column) *= scale * rowWeights[k];
            const Eigen::Map<const Eigen::MatrixXf> metric(sample.metric.col(column).data(), dimension,
                                                           dimension);
            sample.weighted.col(column).noalias() =
                metric * Eigen::Map<const Eigen::VectorXf>(&rows[k * size_t(dimension)], dimension);
            sample.coefficients(column, 0) = 1;
            sample.coefficients.row(column).tail(components) =
                Eigen::Map<const Eigen::RowVectorXf>(&weights[k * size_t(components)], components);
        }
    });
    return sample;
}

// The mean and the vectors below each other, [(M+1)×n²].
RowMatrixXd solveBasis(const Sample& sample, const RowMatrixXd& start) {
    const Eigen::Index vectors = start.rows(), dimension = start.cols(), size = vectors * dimension;
    Eigen::MatrixXf pairs(sample.coefficients.rows(), vectors * (vectors + 1) / 2);
    for (Eigen::Index m = 0, column = 0; m < vectors; ++m)
        for (Eigen::Index k = 0; k <= m; ++k, ++column)
            pairs.col(column) = sample.coefficients.col(m).cwiseProduct(sample.coefficients.col(k));
    const Eigen::MatrixXd blocks = product(sample.metric, pairs);
    Eigen::MatrixXd system(size, size);
    for (Eigen::Index m = 0, column = 0; m < vectors; ++m)
        for (Eigen::Index k = 0; k <= m; ++k, ++column)
            system.block(m * dimension, k * dimension, dimension, dimension) =
                Eigen::Map<const Eigen::MatrixXd>(blocks.col(column).data(), dimension, dimension);
    const Eigen::MatrixXd right = product(sample.weighted, sample.coefficients);
    const double ridge = kRidge * system.diagonal().mean();
    system.diagonal().array() += ridge;
    const Eigen::VectorXd solution = system.selfadjointView<Eigen::Lower>().llt().solve(
        Eigen::Map<const Eigen::VectorXd>(right.data(), size) +
        ridge * Eigen::Map<const Eigen::VectorXd>(start.data(), size));
    return Eigen::Map<const RowMatrixXd>(solution.data(), vectors, dimension);
}

}  // namespace

size_t mostRefinementRows(int shOrder) {
    const size_t dimension = size_t(shCount(shOrder));
    return std::min(kMostPoints, kMetricFloats / (dimension * dimension));
}

PcaResult refineForIrradiance(const PcaResult& pca, std::span<const float> rows,
                              std::span<const float> weights, std::span<const Vec3f> normals,
                              std::span<const float> rowWeights, std::span<const double> covariance,
                              int shOrder, const IrradianceWeight& weight) {
    const int dimension = shCount(shOrder);
    PRT_CHECK_EQ(pca.mean.size(), size_t(dimension));
    PRT_CHECK_EQ(rows.size(), normals.size() * size_t(dimension));
    PRT_CHECK_EQ(weights.size(), normals.size() * size_t(pca.components));
    PRT_CHECK_LE(normals.size(), mostRefinementRows(shOrder));
    if (!rowWeights.empty()) PRT_CHECK_EQ(rowWeights.size(), normals.size());
    if ((pca.components + 1) * dimension > kMostRefinedValues || pca.components == dimension) return pca;
    RowMatrixXd start(pca.components + 1, dimension);
    start.row(0) = Eigen::Map<const Eigen::RowVectorXf>(pca.mean.data(), dimension).cast<double>();
    start.bottomRows(pca.components) =
        Eigen::Map<const RowMatrixXf>(pca.basis.data(), pca.components, dimension).cast<double>();
    const RowMatrixXd solved =
        solveBasis(takeSample(rows, weights, normals, rowWeights, pca.components, shOrder, weight), start);
    // Rows of fewer dimensions than vectors leave some of these to rounding.
    if (!solved.allFinite() || (solved - start).norm() > kLargestStep * start.norm()) return pca;
    const Eigen::MatrixXd vectors = solved.bottomRows(pca.components).transpose();
    const Eigen::MatrixXd orthonormal = Eigen::HouseholderQR<Eigen::MatrixXd>(vectors).householderQ() *
                                        Eigen::MatrixXd::Identity(dimension, pca.components);
    PcaResult result = pca;
    Eigen::Map<Eigen::RowVectorXf>(result.mean.data(), dimension) = solved.row(0).cast<float>();
    Eigen::Map<RowMatrixXf>(result.basis.data(), pca.components, dimension) =
        orthonormal.transpose().cast<float>();
    return alignToCovariance(result, covariance);
}

}  // namespace prt
