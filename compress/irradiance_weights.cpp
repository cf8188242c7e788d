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

size_t checkedCount(const PcaResult& pca, std::span<const float> rows, std::span<const Vec3f> normals,
                    int shOrder) {
    const size_t dimension = size_t(shCount(shOrder));
    PRT_CHECK_EQ(pca.mean.size(), dimension);
    PRT_CHECK_EQ(pca.basis.size(), dimension * size_t(pca.components));
    PRT_CHECK_EQ(rows.size(), normals.size() * dimension);
    PRT_CHECK_LE(normals.size(), size_t(UINT32_MAX));
    return normals.size();
}

}  // namespace

std::vector<float> projectPcaForIrradiance(const PcaResult& pca, std::span<const float> rows,
                                           std::span<const Vec3f> normals, int shOrder,
                                           const IrradianceWeight& weight) {
    const size_t count = checkedCount(pca, rows, normals, shOrder);
    const int dimension = shCount(shOrder);
    if (pca.components == dimension) return projectPca(pca, rows, dimension);  // there is nothing to trade
    const Eigen::MatrixXf basis = Eigen::Map<const RowMatrixXf>(pca.basis.data(), pca.components, dimension);
    const Eigen::Map<const Eigen::VectorXf> mean(pca.mean.data(), dimension);
    const IrradianceMetric metrics(shOrder, weight);
    const std::vector<uint32_t> points = pointsByNormal(normals);
    std::vector<float> result(count * size_t(pca.components));
    parallelFor(count, kBlockPoints, [&](size_t begin, size_t end) {
        throwIfInterrupted();
        Eigen::MatrixXf metric(dimension, dimension), projection, fit, gram;
        Eigen::VectorXf row(dimension), fitted(pca.components);
        Eigen::LLT<Eigen::MatrixXf> cholesky(pca.components);
        forEachNormal(points, normals, begin, end, [&](size_t first, size_t last) {
            metrics.evaluate(normals[points[first]], {metric.data(), size_t(metric.size())});
            projection.noalias() = basis * metric;
            gram.noalias() = projection * basis.transpose();
            cholesky.compute(gram);
            fit = cholesky.solve(projection);
            // One by one: the bits of a weight then depend on its own point alone.
            for (size_t k = first; k < last; ++k) {
                const size_t point = points[k];
                row = Eigen::Map<const Eigen::VectorXf>(rows.data() + point * size_t(dimension), dimension) -
                      mean;
                fitted.noalias() = fit * row;
                std::copy_n(fitted.data(), pca.components, result.data() + point * size_t(pca.components));
            }
        });
    });
    return result;
}

double irradianceRelativeRmse(const PcaResult& pca, std::span<const float> rows,
                              std::span<const float> weights, std::span<const Vec3f> normals,
                              std::span<const uint8_t> use, int shOrder, const IrradianceWeight& weight) {
    const size_t count = checkedCount(pca, rows, normals, shOrder);
    PRT_CHECK_EQ(weights.size(), count * size_t(pca.components));
    if (!use.empty()) PRT_CHECK_EQ(use.size(), count);
    const int dimension = shCount(shOrder);
    const Eigen::MatrixXf vectors =
        Eigen::Map<const RowMatrixXf>(pca.basis.data(), pca.components, dimension).transpose();
    const Eigen::Map<const Eigen::VectorXf> mean(pca.mean.data(), dimension);
    const IrradianceMetric metrics(shOrder, weight);
    const std::vector<uint32_t> points = pointsByNormal(normals);
    struct Sums {
        double error = 0, square = 0;
    };
    std::vector<Sums> partial((count + kBlockPoints - 1) / kBlockPoints);
    parallelFor(count, kBlockPoints, [&](size_t begin, size_t end) {
        throwIfInterrupted();
        Sums& sums = partial[begin / kBlockPoints];
        Eigen::MatrixXf metric(dimension, dimension);
        Eigen::VectorXf error(dimension), product(dimension);
        forEachNormal(points, normals, begin, end, [&](size_t first, size_t last) {
            metrics.evaluate(normals[points[first]], {metric.data(), size_t(metric.size())});
            for (size_t k = first; k < last; ++k) {
                const size_t point = points[k];
                if (!use.empty() && !use[point]) continue;
                const Eigen::Map<const Eigen::VectorXf> row(rows.data() + point * size_t(dimension),
                                                            dimension);
                const Eigen::Map<const Eigen::VectorXf> fitted(
                    weights.data() + point * size_t(pca.components), pca.components);
                error = row - mean;
                error.noalias() -= vectors * fitted;
                product.noalias() = metric * error;
                sums.error += double(error.dot(product));
                product.noalias() = metric * row;
                sums.square += double(row.dot(product));
            }
        });
    });
    Sums total;
    for (const Sums& sums : partial) {
        total.error += sums.error;
        total.square += sums.square;
    }
    return total.square > 0 ? std::sqrt(std::max(0.0, total.error) / total.square) : 0.0;
}

}  // namespace prt
