// Principal component analysis of visibility, the compression of [IwanickiSloan2012, Sec. 4], with moments of
// parts joined as in [ChanGolubLeVeque1983].
//
// The covariance is summed in float over blocks of 1024 rows (fast, and exact enough over so few) and in
// double over blocks: plain float sums put small eigenvalues off by parts in a thousand.
#include "compress/pca.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "compress/leading_vectors.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh_lanes.h"

namespace prt {
namespace {

constexpr size_t kBlockRows = 1024;
// Rows that one task sums: their partial sums are added in order, whatever the number of threads.
constexpr size_t kTaskRows = 16 * kBlockRows;
// Tasks between two joins: bounds the memory that partial sums take.
constexpr size_t kRoundTasks = 64;

using RowMatrixXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using RowMatrixXd = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

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

struct Moments {
    double weight = 0;
    Eigen::VectorXd mean;
    Eigen::MatrixXd squares;  // Σ a (x − mean)(x − mean)ᵀ, lower triangle

    explicit Moments(int dimension)
        : mean(Eigen::VectorXd::Zero(dimension)), squares(Eigen::MatrixXd::Zero(dimension, dimension)) {}

    void join(const Moments& other) {
        if (other.weight <= 0) return;
        const double total = weight + other.weight;
        const Eigen::VectorXd delta = other.mean - mean;
        squares += other.squares;
        squares.selfadjointView<Eigen::Lower>().rankUpdate(delta, weight * (other.weight / total));
        mean += delta * (other.weight / total);
        weight = total;
    }
};

// Scratch of the sums of one block.
struct Block {
    Eigen::MatrixXf centred, product;
    Moments moments;

    Block(int dimension, size_t rows)
        : centred(dimension, Eigen::Index(rows)), product(dimension, dimension), moments(dimension) {}

    void sum(std::span<const float> rows, std::span<const size_t> indices,
             std::span<const float> rowWeights) {
        const int dimension = int(product.rows());
        moments.weight = 0;
        moments.mean.setZero();
        for (const size_t index : indices) {
            const double weight = rowWeights.empty() ? 1.0 : double(rowWeights[index]);
            moments.weight += weight;
            moments.mean += weight * rowAt(rows, index, dimension).cast<double>();
        }
        if (moments.weight <= 0) return;
        moments.mean /= moments.weight;
        const Eigen::VectorXf about = moments.mean.cast<float>();
        for (size_t k = 0; k < indices.size(); ++k) {
            auto column = centred.col(Eigen::Index(k));
            column = rowAt(rows, indices[k], dimension) - about;
            if (!rowWeights.empty()) column *= std::sqrt(rowWeights[indices[k]]);
        }
        product.setZero();
        product.selfadjointView<Eigen::Lower>().rankUpdate(centred.leftCols(Eigen::Index(indices.size())));
        moments.squares = product.cast<double>();
        // The mean has more digits than what was subtracted.
        const Eigen::VectorXd rounding = moments.mean - about.cast<double>();
        moments.squares.selfadjointView<Eigen::Lower>().rankUpdate(rounding, -moments.weight);
    }
};

Moments momentsOf(std::span<const float> rows, std::span<const size_t> indices,
                  std::span<const float> rowWeights, int dimension) {
    Moments total(dimension);
    Block block(dimension, std::min(kBlockRows, indices.size()));
    for (size_t first = 0; first < indices.size(); first += kBlockRows) {
        block.sum(rows, indices.subspan(first, std::min(kBlockRows, indices.size() - first)), rowWeights);
        total.join(block.moments);
    }
    return total;
}

[[noreturn]] void throwNotFinite(std::span<const float> rows, std::span<const size_t> indices,
                                 size_t firstIndex, int dimension) {
    for (const size_t index : indices)
        if (!rowAt(rows, index, dimension).allFinite())
            throw InputError("visibility coefficients",
                             fmt::format("point {} is not a finite number", firstIndex + index),
                             "bake the mesh again");
    throw InputError("visibility coefficients", "values are too large to be squared",
                     "bake the mesh again; coefficients of visibility are below 4");
}

void setVariance(PcaResult& pca, const std::vector<double>& values) {
    pca.variance.assign(values.begin(), values.end());
    double explained = 0;
    for (const double value : values) explained += value;
    pca.explainedVariance = pca.totalVariance > 0 ? std::min(1.0, explained / pca.totalVariance) : 1.0;
}

}  // namespace

struct RowMoments::State {
    size_t seen = 0, used = 0;
    Moments moments;
    explicit State(int dimension) : moments(dimension) {}
};

RowMoments::RowMoments(int dimension) : state_(std::make_unique<State>(dimension)) {
    PRT_CHECK_LE(1, dimension);
}
RowMoments::~RowMoments() = default;
RowMoments::RowMoments(RowMoments&&) noexcept = default;

int RowMoments::dimension() const { return int(state_->moments.mean.size()); }
size_t RowMoments::rowsSeen() const { return state_->seen; }
size_t RowMoments::rowsUsed() const { return state_->used; }
double RowMoments::weight() const { return state_->moments.weight; }

void RowMoments::add(std::span<const float> rows, std::span<const uint8_t> use,
                     std::span<const float> rowWeights) {
    const int d = dimension();
    const size_t count = rowCount(rows, use, d);
    if (!rowWeights.empty()) PRT_CHECK_EQ(rowWeights.size(), count);
    std::vector<size_t> indices;
    for (size_t next = 0; next < count;) {
        throwIfInterrupted();
        indices.clear();
        for (; next < count && indices.size() < kRoundTasks * kTaskRows; ++next)
            if (use.empty() || use[next]) indices.push_back(next);
        std::vector<Moments> partial((indices.size() + kTaskRows - 1) / kTaskRows, Moments(d));
        parallelFor(indices.size(), kTaskRows, [&](size_t begin, size_t end) {
            partial[begin / kTaskRows] =
                momentsOf(rows, std::span(indices).subspan(begin, end - begin), rowWeights, d);
        });
        for (size_t task = 0; task < partial.size(); ++task) {
            if (!partial[task].mean.allFinite() || !partial[task].squares.allFinite())
                throwNotFinite(rows, std::span(indices).subspan(task * kTaskRows), state_->seen, d);
            state_->moments.join(partial[task]);
        }
        state_->used += indices.size();
    }
    state_->seen += count;
}

std::vector<double> RowMoments::mean() const {
    PRT_CHECK(weight() > 0);
    const Eigen::VectorXd& mean = state_->moments.mean;
    return {mean.data(), mean.data() + mean.size()};
}

std::vector<double> RowMoments::covariance() const {
    PRT_CHECK(weight() > 0);
    Eigen::MatrixXd covariance = state_->moments.squares.selfadjointView<Eigen::Lower>();
    covariance /= weight();
    return {covariance.data(), covariance.data() + covariance.size()};
}

PcaResult principalComponents(const RowMoments& moments, int components) {
    const int dimension = moments.dimension();
    PRT_CHECK_LE(1, components);
    PRT_CHECK_LE(components, dimension);
    if (moments.rowsUsed() == 0)
        throw InputError("visibility coefficients",
                         fmt::format("none of {} points is valid", moments.rowsSeen()),
                         "bake a mesh with at least one visible surface point");
    if (moments.weight() <= 0)
        throw InputError("visibility coefficients",
                         fmt::format("all {} valid points have the weight zero", moments.rowsUsed()),
                         "compress without weights");
    const std::vector<double> mean = moments.mean(), covariance = moments.covariance();
    const LeadingVectors leading = leadingVectors(covariance, dimension, components);
    PcaResult result;
    result.components = components;
    result.mean.assign(mean.begin(), mean.end());
    result.basis.assign(leading.vectors.begin(), leading.vectors.end());
    for (size_t k = 0; k < mean.size(); ++k) result.totalVariance += covariance[k * (mean.size() + 1)];
    setVariance(result, leading.values);
    return result;
}

PcaResult alignToCovariance(const PcaResult& pca, std::span<const double> covariance) {
    const Eigen::Index dimension = Eigen::Index(pca.mean.size());
    PRT_CHECK_EQ(covariance.size(), pca.mean.size() * pca.mean.size());
    const RowMatrixXd basis =
        Eigen::Map<const RowMatrixXf>(pca.basis.data(), pca.components, dimension).cast<double>();
    const Eigen::Map<const RowMatrixXd> all(covariance.data(), dimension, dimension);
    const RowMatrixXd within = basis * all * basis.transpose();
    const LeadingVectors axes =
        leadingVectors({within.data(), size_t(within.size())}, pca.components, pca.components);
    PcaResult result = pca;
    RowMatrixXd turned =
        Eigen::Map<const RowMatrixXd>(axes.vectors.data(), pca.components, pca.components) * basis;
    for (Eigen::Index m = 0; m < turned.rows(); ++m)
        turned.row(m) *= canonicalSign({turned.row(m).data(), size_t(dimension)});
    std::copy_n(turned.data(), turned.size(), result.basis.begin());
    setVariance(result, axes.values);
    return result;
}

PcaResult computePca(std::span<const float> rows, std::span<const uint8_t> use, int dimension, int components,
                     std::span<const float> rowWeights) {
    RowMoments moments(dimension);
    moments.add(rows, use, rowWeights);
    return principalComponents(moments, components);
}

std::vector<float> projectPca(const PcaResult& pca, std::span<const float> rows, int dimension) {
    std::vector<float> weights(rowCount(rows, {}, dimension) * size_t(pca.components));
    projectPca(pca, rows, dimension, weights);
    return weights;
}

namespace {

using detail::kLanes;
using detail::Lanes;

constexpr size_t kRowsAtOnce = 4;  // as many sums as registers hold beside a row of the basis

// Weights of up to four rows for sixteen vectors. Rows without a pair are done as four too, so that the bits
// of a weight do not depend on its neighbours.
// @param columns  [d×16] the vectors, side by side
PRT_TARGET_CLONES void projectRows(const float* rows, size_t count, size_t dimension, const float* mean,
                                   const float* columns, float* weights, size_t components, size_t vectors) {
    for (size_t first = 0; first < count; first += kRowsAtOnce) {
        const float* row[kRowsAtOnce];
        for (size_t r = 0; r < kRowsAtOnce; ++r) row[r] = rows + std::min(first + r, count - 1) * dimension;
        Lanes a{}, b{}, c{}, d{};
        for (size_t k = 0; k < dimension; ++k) {
            const Lanes column = detail::lanesAt(columns + k * kLanes).value;
            a += (row[0][k] - mean[k]) * column;
            b += (row[1][k] - mean[k]) * column;
            c += (row[2][k] - mean[k]) * column;
            d += (row[3][k] - mean[k]) * column;
        }
        const Lanes sums[kRowsAtOnce] = {a, b, c, d};
        for (size_t r = 0; r < kRowsAtOnce && first + r < count; ++r) {
            float* out = weights + (first + r) * components;
            if (vectors == kLanes)
                detail::lanesAt(out) = sums[r];
            else
                std::memcpy(out, &sums[r], vectors * sizeof(float));
        }
    }
}

}  // namespace

void projectPca(const PcaResult& pca, std::span<const float> rows, int dimension, std::span<float> weights) {
    const size_t count = rowCount(rows, {}, dimension), d = size_t(dimension);
    const size_t components = size_t(pca.components);
    PRT_CHECK_EQ(weights.size(), count * components);
    // Sixteen vectors after sixteen, zeros behind the last.
    const size_t groups = (components + kLanes - 1) / kLanes;
    std::vector<float> columns(groups * d * kLanes);
    for (size_t m = 0; m < components; ++m)
        for (size_t k = 0; k < d; ++k)
            columns[(m / kLanes * d + k) * kLanes + m % kLanes] = pca.basis[m * d + k];
    parallelFor(count, kBlockRows, [&](size_t begin, size_t end) {
        for (size_t group = 0; group < groups; ++group)
            projectRows(&rows[begin * d], end - begin, d, pca.mean.data(), &columns[group * d * kLanes],
                        &weights[begin * components + group * kLanes], components,
                        std::min(kLanes, components - group * kLanes));
    });
}

PcaErrorSums& PcaErrorSums::operator+=(const PcaErrorSums& other) {
    error += other.error;
    square += other.square;
    weight += other.weight;
    return *this;
}

PcaError PcaErrorSums::result(int dimension) const {
    return {square > 0 ? std::sqrt(error / square) : 0.0,
            weight > 0 ? std::sqrt(error / (weight * dimension)) : 0.0};
}

PcaErrorSums pcaErrorSums(const PcaResult& pca, std::span<const float> rows, std::span<const float> weights,
                          std::span<const uint8_t> use, int dimension, std::span<const float> rowWeights) {
    const size_t count = rowCount(rows, use, dimension);
    PRT_CHECK_EQ(weights.size(), count * size_t(pca.components));
    if (!rowWeights.empty()) PRT_CHECK_EQ(rowWeights.size(), count);
    const Eigen::Map<const RowMatrixXf> basis(pca.basis.data(), pca.components, dimension);
    const Eigen::Map<const Eigen::RowVectorXf> mean(pca.mean.data(), dimension);
    std::vector<PcaErrorSums> partial((count + kBlockRows - 1) / kBlockRows);
    parallelFor(count, kBlockRows, [&](size_t begin, size_t end) {
        const auto size = Eigen::Index(end - begin);
        const Eigen::Map<const RowMatrixXf> block(rows.data() + begin * size_t(dimension), size, dimension);
        const Eigen::Map<const RowMatrixXf> weight(weights.data() + begin * size_t(pca.components), size,
                                                   pca.components);
        RowMatrixXf difference = block.rowwise() - mean;
        difference.noalias() -= weight * basis;
        PcaErrorSums& sums = partial[begin / kBlockRows];
        for (size_t i = begin; i < end; ++i) {
            if (!use.empty() && !use[i]) continue;
            const double counts = rowWeights.empty() ? 1.0 : double(rowWeights[i]);
            sums.error += counts * difference.row(Eigen::Index(i - begin)).cast<double>().squaredNorm();
            sums.square += counts * block.row(Eigen::Index(i - begin)).cast<double>().squaredNorm();
            sums.weight += counts;
        }
    });
    PcaErrorSums total;
    for (const PcaErrorSums& sums : partial) total += sums;
    return total;
}

PcaError pcaError(const PcaResult& pca, std::span<const float> rows, std::span<const float> weights,
                  std::span<const uint8_t> use, int dimension) {
    return pcaErrorSums(pca, rows, weights, use, dimension).result(dimension);
}

double pcaRelativeRmse(const PcaResult& pca, std::span<const float> rows, std::span<const float> weights,
                       std::span<const uint8_t> use, int dimension) {
    return pcaError(pca, rows, weights, use, dimension).relativeRmse;
}

}  // namespace prt
