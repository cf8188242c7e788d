// Weighted least squares for the weights of principal vectors; metrics are made once per different normal.
#include "compress/irradiance_weights.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

// Points that one task takes, in the order of their normals.
constexpr size_t kBlockPoints = 2048;

using RowMatrixXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The points in the order of their normals, so that points of one normal follow each other.
std::vector<uint32_t> pointsByNormal(std::span<const Vec3f> normals) {
    struct Key {
        std::array<uint32_t, 3> bits;
        uint32_t point;
        auto operator<=>(const Key&) const = default;
    };
    std::vector<Key> keys(normals.size());
    for (size_t i = 0; i < keys.size(); ++i) {
        const Vec3f& n = normals[i];
        keys[i] = {
            {std::bit_cast<uint32_t>(n.x()), std::bit_cast<uint32_t>(n.y()), std::bit_cast<uint32_t>(n.z())},
            uint32_t(i)};
    }
    std::sort(keys.begin(), keys.end());
    std::vector<uint32_t> points(keys.size());
    std::transform(keys.begin(), keys.end(), points.begin(), [](const Key& key) { return key.point; });
    return points;
}

bool sameBits(const Vec3f& a, const Vec3f& b) {
    for (int k = 0; k < 3; ++k)
        if (std::bit_cast<uint32_t>(a[k]) != std::bit_cast<uint32_t>(b[k])) return false;
    return true;
}

// Calls body(first, last) for every run of points of one normal in points[begin, end).
template <class Body>
void forEachNormal(std::span<const uint32_t> points, std::span<const Vec3f> normals, size_t begin, size_t end,
                   const Body& body) {
    for (size_t first = begin; first < end;) {
        size_t last = first + 1;
        while (last < end && sameBits(normals[points[last]], normals[points[first]])) ++last;
        body(first, last);
        first = last;
    }
}

}  // namespace

IrradianceErrorSums& IrradianceErrorSums::operator+=(const IrradianceErrorSums& other) {
    error += other.error;
    square += other.square;
    return *this;
}

double IrradianceErrorSums::relativeRmse() const {
    return square > 0 ? std::sqrt(std::max(0.0, error) / square) : 0.0;
}

struct IrradianceFit::State {
    PcaResult pca;
    int dimension;
    IrradianceMetric metrics;
    Eigen::MatrixXf basis;    // [M×n²]
    Eigen::MatrixXf vectors;  // its transpose

    State(const PcaResult& result, int shOrder, const IrradianceWeight& weight)
        : pca(result),
          dimension(shCount(shOrder)),
          metrics(shOrder, weight),
          basis(Eigen::Map<const RowMatrixXf>(result.basis.data(), result.components, dimension)),
          vectors(basis.transpose()) {}

    struct Points {
        std::span<const float> rows;
        std::span<const Vec3f> normals;
        std::span<const uint8_t> use;
        std::span<const float> rowWeights;
    };
    template <bool Fits, bool Sums, class Weight>
    IrradianceErrorSums visit(const Points& all, std::span<Weight> weights) const;
};

// Fits weights (or takes those given), and sums what error they leave.
template <bool Fits, bool Sums, class Weight>
IrradianceErrorSums IrradianceFit::State::visit(const Points& all, std::span<Weight> weights) const {
    const size_t count = all.normals.size(), d = size_t(dimension), components = size_t(pca.components);
    PRT_CHECK_EQ(all.rows.size(), count * d);
    PRT_CHECK_EQ(weights.size(), count * components);
    if (!all.use.empty()) PRT_CHECK_EQ(all.use.size(), count);
    if (!all.rowWeights.empty()) PRT_CHECK_EQ(all.rowWeights.size(), count);
    PRT_CHECK_LE(count, size_t(UINT32_MAX));
    const Eigen::Map<const Eigen::VectorXf> mean(pca.mean.data(), dimension);
    const std::vector<uint32_t> points = pointsByNormal(all.normals);
    std::vector<IrradianceErrorSums> partial((count + kBlockPoints - 1) / kBlockPoints);
    parallelFor(count, kBlockPoints, [&](size_t begin, size_t end) {
        throwIfInterrupted();
        IrradianceErrorSums& sums = partial[begin / kBlockPoints];
        Eigen::MatrixXf metric(dimension, dimension), projection, gram;
        Eigen::VectorXf error(dimension), product(dimension), fitted(pca.components);
        Eigen::LLT<Eigen::MatrixXf> cholesky(pca.components);
        forEachNormal(points, all.normals, begin, end, [&](size_t first, size_t last) {
            metrics.evaluate(all.normals[points[first]], {metric.data(), size_t(metric.size())});
            if constexpr (Fits) {
                projection.noalias() = basis * metric;
                gram.noalias() = projection * vectors;
                cholesky.compute(gram);
            }
            // One by one: the bits of a weight then depend on its own point alone.
            for (size_t k = first; k < last; ++k) {
                const size_t point = points[k];
                const Eigen::Map<const Eigen::VectorXf> row(all.rows.data() + point * d, dimension);
                error = row - mean;
                if constexpr (Fits) {
                    fitted.noalias() = projection * error;
                    cholesky.solveInPlace(fitted);
                    std::copy_n(fitted.data(), components, weights.data() + point * components);
                } else {
                    fitted = Eigen::Map<const Eigen::VectorXf>(weights.data() + point * components,
                                                               pca.components);
                }
                if (!Sums || (!all.use.empty() && !all.use[point])) continue;
                const double counts = all.rowWeights.empty() ? 1.0 : double(all.rowWeights[point]);
                error.noalias() -= vectors * fitted;
                product.noalias() = metric * error;
                sums.error += counts * double(error.dot(product));
                product.noalias() = metric * row;
                sums.square += counts * double(row.dot(product));
            }
        });
    });
    IrradianceErrorSums total;
    for (const IrradianceErrorSums& sums : partial) total += sums;
    return total;
}

IrradianceFit::IrradianceFit(const PcaResult& pca, int shOrder, const IrradianceWeight& weight) {
    const size_t dimension = size_t(shCount(shOrder));
    PRT_CHECK_EQ(pca.mean.size(), dimension);
    PRT_CHECK_EQ(pca.basis.size(), dimension * size_t(pca.components));
    state_ = std::make_unique<State>(pca, shOrder, weight);
}

IrradianceFit::~IrradianceFit() = default;

void IrradianceFit::fit(std::span<const float> rows, std::span<const Vec3f> normals,
                        std::span<float> weights) const {
    if (state_->pca.components < state_->dimension) {
        state_->visit<true, false>({rows, normals, {}, {}}, weights);
        return;
    }
    // There is nothing to trade.
    PRT_CHECK_EQ(rows.size(), normals.size() * size_t(state_->dimension));
    projectPca(state_->pca, rows, state_->dimension, weights);
}

IrradianceErrorSums IrradianceFit::fitAndSum(std::span<const float> rows, std::span<const Vec3f> normals,
                                             std::span<const uint8_t> use, std::span<const float> rowWeights,
                                             std::span<float> weights) const {
    if (state_->pca.components < state_->dimension)
        return state_->visit<true, true>({rows, normals, use, rowWeights}, weights);
    fit(rows, normals, weights);
    return sum(rows, normals, use, rowWeights, weights);
}

IrradianceErrorSums IrradianceFit::sum(std::span<const float> rows, std::span<const Vec3f> normals,
                                       std::span<const uint8_t> use, std::span<const float> rowWeights,
                                       std::span<const float> weights) const {
    return state_->visit<false, true>({rows, normals, use, rowWeights}, weights);
}

std::vector<float> projectPcaForIrradiance(const PcaResult& pca, std::span<const float> rows,
                                           std::span<const Vec3f> normals, int shOrder,
                                           const IrradianceWeight& weight) {
    std::vector<float> result(normals.size() * size_t(pca.components));
    IrradianceFit(pca, shOrder, weight).fit(rows, normals, result);
    return result;
}

double irradianceRelativeRmse(const PcaResult& pca, std::span<const float> rows,
                              std::span<const float> weights, std::span<const Vec3f> normals,
                              std::span<const uint8_t> use, int shOrder, const IrradianceWeight& weight) {
    return IrradianceFit(pca, shOrder, weight).sum(rows, normals, use, {}, weights).relativeRmse();
}

}  // namespace prt
