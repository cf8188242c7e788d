// Principal component analysis of visibility, the compression of [IwanickiSloan2012, Sec. 4].
//
// The covariance is summed in float over blocks of 1024 rows (fast, and exact enough over so few) and in
// double over blocks: plain float sums put small eigenvalues off by parts in a thousand.
#include "compress/pca.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "compress/leading_vectors.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"

namespace prt {
namespace {

constexpr size_t kBlockRows = 1024;
// Rows that one task sums: their partial sums are added in order, whatever the number of threads.
constexpr size_t kTaskRows = 16 * kBlockRows;

using RowMatrixXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

size_t rowCount(std::span<const float> rows, std::span<const uint8_t> use, int dimension) {
    PRT_CHECK_LE(1, dimension);
    PRT_CHECK_EQ(rows.size() % size_t(dimension), size_t(0));
    const size_t count = rows.size() / size_t(dimension);
    if (!use.empty()) PRT_CHECK_EQ(use.size(), count);
    return count;
}

auto rowAt(std::span<const float> rows, size_t index, int dimension) {
    return Eigen::Map<const Eigen::VectorXf>(rows.data() + index * size_t(dimension), dimension);
}

std::vector<size_t> rowsInUse(std::span<const float> rows, std::span<const uint8_t> use, int dimension) {
    const size_t count = rowCount(rows, use, dimension);
    std::vector<size_t> indices;
    indices.reserve(count);
    for (size_t i = 0; i < count; ++i)
        if (use.empty() || use[i]) indices.push_back(i);
    if (indices.empty())
        throw InputError("visibility coefficients", fmt::format("none of {} points is valid", count),
                         "bake a mesh with at least one visible surface point");
    return indices;
}

// Roughly the mean: subtracted before squaring, so that the covariance is no small difference of large sums.
Eigen::VectorXf provisionalMean(std::span<const float> rows, std::span<const size_t> indices, int dimension) {
    const size_t step = std::max<size_t>(1, indices.size() / kBlockRows);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(dimension);
    size_t taken = 0;
    for (size_t k = 0; k < indices.size(); k += step, ++taken)
        sum += rowAt(rows, indices[k], dimension).cast<double>();
    return (sum / double(taken)).cast<float>();
}

struct Moments {
    Eigen::VectorXd sum;      // Σ (x − provisional mean)
    Eigen::MatrixXd squares;  // Σ (x − provisional mean)(x − provisional mean)ᵀ, lower triangle
};

Moments momentsOf(std::span<const float> rows, std::span<const size_t> indices,
                  const Eigen::VectorXf& provisional) {
    const int dimension = int(provisional.size());
    Moments moments{Eigen::VectorXd::Zero(dimension), Eigen::MatrixXd::Zero(dimension, dimension)};
    Eigen::MatrixXf block(dimension, Eigen::Index(std::min(kBlockRows, indices.size())));
    Eigen::MatrixXf product(dimension, dimension);
    for (size_t first = 0; first < indices.size(); first += kBlockRows) {
        const size_t count = std::min(kBlockRows, indices.size() - first);
        for (size_t k = 0; k < count; ++k) {
            block.col(Eigen::Index(k)) = rowAt(rows, indices[first + k], dimension) - provisional;
            moments.sum += block.col(Eigen::Index(k)).cast<double>();
        }
        product.setZero();
        product.selfadjointView<Eigen::Lower>().rankUpdate(block.leftCols(Eigen::Index(count)));
        moments.squares += product.cast<double>();
    }
    return moments;
}

// Partial sums of all tasks, added in order.
Moments totalMoments(std::span<const float> rows, std::span<const size_t> indices,
                     const Eigen::VectorXf& provisional) {
    const size_t tasks = (indices.size() + kTaskRows - 1) / kTaskRows;
    std::vector<Moments> partial(tasks);
    parallelFor(indices.size(), kTaskRows, [&](size_t begin, size_t end) {
        partial[begin / kTaskRows] = momentsOf(rows, indices.subspan(begin, end - begin), provisional);
    });
    for (size_t task = 1; task < tasks; ++task) {
        partial[0].sum += partial[task].sum;
        partial[0].squares += partial[task].squares;
    }
    return partial[0];
}

[[noreturn]] void throwNotFinite(std::span<const float> rows, std::span<const size_t> indices,
                                 int dimension) {
    for (const size_t index : indices)
        if (!rowAt(rows, index, dimension).allFinite())
            throw InputError("visibility coefficients", fmt::format("point {} is not a finite number", index),
                             "bake the mesh again");
    throw InputError("visibility coefficients", "values are too large to be squared",
                     "bake the mesh again; coefficients of visibility are below 4");
}

}  // namespace

PcaResult computePca(std::span<const float> rows, std::span<const uint8_t> use, int dimension,
                     int components) {
    PRT_CHECK_LE(1, components);
    PRT_CHECK_LE(components, dimension);
    const std::vector<size_t> indices = rowsInUse(rows, use, dimension);
    const Eigen::VectorXf provisional = provisionalMean(rows, indices, dimension);
    Moments moments = totalMoments(rows, indices, provisional);

    const double count = double(indices.size());
    const Eigen::VectorXd shift = moments.sum / count;
    Eigen::MatrixXd covariance = moments.squares.selfadjointView<Eigen::Lower>();
    covariance = covariance / count - shift * shift.transpose();
    if (!covariance.allFinite()) throwNotFinite(rows, indices, dimension);

    const LeadingVectors leading =
        leadingVectors({covariance.data(), size_t(covariance.size())}, dimension, components);
    PcaResult result;
    result.components = components;
    result.mean.resize(size_t(dimension));
    Eigen::Map<Eigen::VectorXf>(result.mean.data(), dimension) =
        (provisional.cast<double>() + shift).cast<float>();
    result.basis.assign(leading.vectors.begin(), leading.vectors.end());
    result.variance.assign(leading.values.begin(), leading.values.end());
    result.totalVariance = std::max(0.0, covariance.trace());
    double explained = 0;
    for (const double value : leading.values) explained += value;
    result.explainedVariance =
        result.totalVariance > 0 ? std::min(1.0, explained / result.totalVariance) : 1.0;
    return result;
}

std::vector<float> projectPca(const PcaResult& pca, std::span<const float> rows, int dimension) {
    const size_t count = rowCount(rows, {}, dimension);
    const Eigen::Map<const RowMatrixXf> basis(pca.basis.data(), pca.components, dimension);
    const Eigen::Map<const Eigen::RowVectorXf> mean(pca.mean.data(), dimension);
    std::vector<float> weights(count * size_t(pca.components));
    parallelFor(count, kBlockRows, [&](size_t begin, size_t end) {
        const auto size = Eigen::Index(end - begin);
        const Eigen::Map<const RowMatrixXf> block(rows.data() + begin * size_t(dimension), size, dimension);
        Eigen::Map<RowMatrixXf> out(weights.data() + begin * size_t(pca.components), size, pca.components);
        out.noalias() = (block.rowwise() - mean) * basis.transpose();
    });
    return weights;
}

PcaError pcaError(const PcaResult& pca, std::span<const float> rows, std::span<const float> weights,
                  std::span<const uint8_t> use, int dimension) {
    const size_t count = rowCount(rows, use, dimension);
    PRT_CHECK_EQ(weights.size(), count * size_t(pca.components));
    const Eigen::Map<const RowMatrixXf> basis(pca.basis.data(), pca.components, dimension);
    const Eigen::Map<const Eigen::RowVectorXf> mean(pca.mean.data(), dimension);
    struct Sums {
        double error = 0, square = 0;
        size_t rows = 0;
    };
    std::vector<Sums> partial((count + kBlockRows - 1) / kBlockRows);
    parallelFor(count, kBlockRows, [&](size_t begin, size_t end) {
        const auto size = Eigen::Index(end - begin);
        const Eigen::Map<const RowMatrixXf> block(rows.data() + begin * size_t(dimension), size, dimension);
        const Eigen::Map<const RowMatrixXf> weight(weights.data() + begin * size_t(pca.components), size,
                                                   pca.components);
        RowMatrixXf difference = block.rowwise() - mean;
        difference.noalias() -= weight * basis;
        Sums& sums = partial[begin / kBlockRows];
        for (size_t i = begin; i < end; ++i) {
            if (!use.empty() && !use[i]) continue;
            sums.error += difference.row(Eigen::Index(i - begin)).cast<double>().squaredNorm();
            sums.square += block.row(Eigen::Index(i - begin)).cast<double>().squaredNorm();
            ++sums.rows;
        }
    });
    Sums total;
    for (const Sums& sums : partial) {
        total.error += sums.error;
        total.square += sums.square;
        total.rows += sums.rows;
    }
    PcaError error;
    if (total.square > 0) error.relativeRmse = std::sqrt(total.error / total.square);
    if (total.rows > 0) error.rmse = std::sqrt(total.error / (double(total.rows) * dimension));
    return error;
}

double pcaRelativeRmse(const PcaResult& pca, std::span<const float> rows, std::span<const float> weights,
                       std::span<const uint8_t> use, int dimension) {
    return pcaError(pca, rows, weights, use, dimension).relativeRmse;
}

}  // namespace prt
