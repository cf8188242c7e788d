// Weighted least squares for the weights of principal vectors.
//
// The mean over the cone convolves the squared cosine with a cap: the bands of one are scaled by those of the
// other, the Funk-Hecke theorem [RamamoorthiHanrahan2001]. The metric is the matrix of
// "multiply by w" [Ren2006]: the tripling coefficients, summed once per different normal.
#include "compress/irradiance_weights.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"
#include "precompute/math/sh_product.h"

namespace prt {
namespace {

// Points that one task takes, in the order of their normals.
constexpr size_t kBlockPoints = 2048;

using RowMatrixXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Mean of the Legendre polynomial P_band over the cap z >= cosine.
double capMean(int band, double cosine) {
    if (band == 0) return 1;
    const double low = std::legendre(unsigned(band - 1), cosine);
    const double high = std::legendre(unsigned(band + 1), cosine);
    return (low - high) / ((2 * band + 1) * (1 - cosine));
}

// 2π ∫₀¹ z² Y_l0 dz of all bands.
std::vector<double> squaredCosineZonal(int bands) {
    std::vector<double> zonal(static_cast<size_t>(bands)), values(size_t(legendreCount(bands)));
    for (const LineNode& node : gaussLegendre(bands / 2 + 2)) {
        const double z = (node.z + 1) / 2;
        evalShLegendre(bands, z, values);
        for (int l = 0; l < bands; ++l)
            zonal[size_t(l)] += std::numbers::pi * node.weight * z * z * values[size_t(legendreIndex(l, 0))];
    }
    return zonal;
}

bool isUsable(const Vec3f& normal) {
    const double square = normal.cast<double>().squaredNorm();
    return std::isfinite(square) && square > 1e-30;
}

// Makes the metrics of normals; what they share is computed once.
class MetricBuilder {
  public:
    explicit MetricBuilder(int shOrder) : shOrder_(shOrder), bands_(2 * shOrder - 1) {
        PRT_CHECK_LE(1, shOrder);
        PRT_CHECK_LE(shOrder, kMaxBundleShOrder);
        const std::vector<double> zonal = irradianceWeightZonal(bands_);
        for (int l = 0; l < bands_; ++l)
            bandScale_.push_back(zonal[size_t(l)] * std::sqrt(4 * std::numbers::pi / (2 * l + 1)));
        for (const TriplingCoefficient& t : triplingCoefficients(shOrder, shOrder, bands_))
            if (t.i >= t.j) lower_.push_back(t);
        std::sort(lower_.begin(), lower_.end(),
                  [](const TriplingCoefficient& a, const TriplingCoefficient& b) {
                      return std::array{a.j, a.i, a.k} < std::array{b.j, b.i, b.k};
                  });
    }

    void build(const Vec3f& normal, Eigen::MatrixXf& metric) const {
        std::array<float, shCount(2 * kMaxBundleShOrder - 1)> f;
        rotatedWeight(normal, f);
        metric.setZero(shCount(shOrder_), shCount(shOrder_));
        for (const TriplingCoefficient& t : lower_) metric(t.i, t.j) += f[t.k] * t.value;
        metric.triangularView<Eigen::StrictlyUpper>() = metric.transpose();
    }

  private:
    // w about the normal, by coefficients: Y_lm(n) times the zonal coefficient of the band.
    void rotatedWeight(const Vec3f& normal, std::span<float> f) const {
        std::fill(f.begin(), f.end(), 0.0f);
        std::array<double, shCount(2 * kMaxBundleShOrder - 1)> y;
        const bool usable = isUsable(normal);
        const Vec3d direction = usable ? Vec3d(normal.cast<double>().normalized()) : Vec3d(0, 0, 1);
        evalSh(bands_, direction, {y.data(), size_t(shCount(bands_))});
        for (int l = 0; l < (usable ? bands_ : 1); ++l)
            for (int k = shIndex(l, -l); k <= shIndex(l, l); ++k)
                f[size_t(k)] = float(bandScale_[size_t(l)] * y[size_t(k)]);
    }

    int shOrder_, bands_;
    std::vector<double> bandScale_;
    std::vector<TriplingCoefficient> lower_;
};

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

std::vector<double> irradianceWeightZonal(int bands) {
    PRT_CHECK_LE(1, bands);
    PRT_CHECK_LE(bands, kMaxShOrder);
    const double cosine = std::cos(kIrradianceConeDegrees * std::numbers::pi / 180);
    std::vector<double> zonal = squaredCosineZonal(bands);
    for (int l = 0; l < bands; ++l) zonal[size_t(l)] *= capMean(l, cosine);
    // Largest along the normal: the mean of z² over the cap, which lies in the upper half.
    const double largest = (1 + cosine + cosine * cosine) / 3;
    zonal[0] += kIrradianceFloor * largest * std::sqrt(4 * std::numbers::pi);
    return zonal;
}

std::vector<float> irradianceMetric(const Vec3f& normal, int shOrder) {
    Eigen::MatrixXf metric;
    MetricBuilder(shOrder).build(normal, metric);
    return {metric.data(), metric.data() + metric.size()};
}

std::vector<float> projectPcaForIrradiance(const PcaResult& pca, std::span<const float> rows,
                                           std::span<const Vec3f> normals, int shOrder) {
    const size_t count = checkedCount(pca, rows, normals, shOrder);
    const int dimension = shCount(shOrder);
    const Eigen::MatrixXf basis = Eigen::Map<const RowMatrixXf>(pca.basis.data(), pca.components, dimension);
    const Eigen::Map<const Eigen::VectorXf> mean(pca.mean.data(), dimension);
    const MetricBuilder builder(shOrder);
    const std::vector<uint32_t> points = pointsByNormal(normals);
    std::vector<float> weights(count * size_t(pca.components));
    parallelFor(count, kBlockPoints, [&](size_t begin, size_t end) {
        throwIfInterrupted();
        Eigen::MatrixXf metric, projection, fit, gram;
        Eigen::VectorXf row(dimension), weight(pca.components);
        Eigen::LLT<Eigen::MatrixXf> cholesky(pca.components);
        forEachNormal(points, normals, begin, end, [&](size_t first, size_t last) {
            builder.build(normals[points[first]], metric);
            projection.noalias() = basis * metric;
            gram.noalias() = projection * basis.transpose();
            cholesky.compute(gram);
            fit = cholesky.solve(projection);
            // One by one: the bits of a weight then depend on its own point alone.
            for (size_t k = first; k < last; ++k) {
                const size_t point = points[k];
                row = Eigen::Map<const Eigen::VectorXf>(rows.data() + point * size_t(dimension), dimension) -
                      mean;
                weight.noalias() = fit * row;
                std::copy_n(weight.data(), pca.components, weights.data() + point * size_t(pca.components));
            }
        });
    });
    return weights;
}

double irradianceRelativeRmse(const PcaResult& pca, std::span<const float> rows,
                              std::span<const float> weights, std::span<const Vec3f> normals,
                              std::span<const uint8_t> use, int shOrder) {
    const size_t count = checkedCount(pca, rows, normals, shOrder);
    PRT_CHECK_EQ(weights.size(), count * size_t(pca.components));
    if (!use.empty()) PRT_CHECK_EQ(use.size(), count);
    const int dimension = shCount(shOrder);
    const Eigen::MatrixXf vectors =
        Eigen::Map<const RowMatrixXf>(pca.basis.data(), pca.components, dimension).transpose();
    const Eigen::Map<const Eigen::VectorXf> mean(pca.mean.data(), dimension);
    const MetricBuilder builder(shOrder);
    const std::vector<uint32_t> points = pointsByNormal(normals);
    struct Sums {
        double error = 0, square = 0;
    };
    std::vector<Sums> partial((count + kBlockPoints - 1) / kBlockPoints);
    parallelFor(count, kBlockPoints, [&](size_t begin, size_t end) {
        throwIfInterrupted();
        Sums& sums = partial[begin / kBlockPoints];
        Eigen::MatrixXf metric;
        Eigen::VectorXf error(dimension), product(dimension);
        forEachNormal(points, normals, begin, end, [&](size_t first, size_t last) {
            builder.build(normals[points[first]], metric);
            for (size_t k = first; k < last; ++k) {
                const size_t point = points[k];
                if (!use.empty() && !use[point]) continue;
                const Eigen::Map<const Eigen::VectorXf> row(rows.data() + point * size_t(dimension),
                                                            dimension);
                const Eigen::Map<const Eigen::VectorXf> weight(
                    weights.data() + point * size_t(pca.components), pca.components);
                error = row - mean;
                error.noalias() -= vectors * weight;
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
