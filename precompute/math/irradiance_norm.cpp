// Errors of visibility as irradiance shows them: light is random with the power spectrum of natural
// environments, so the mean square is a quadratic form, one block per m in the frame of the normal.
#include "precompute/math/irradiance_norm.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "precompute/base/check.h"
#include "precompute/math/sh_legendre.h"
#include "precompute/math/sh_rotation.h"
#include "precompute/math/sh_rotation_soa.h"
#include "precompute/math/zonal_map.h"

namespace prt {

double naturalLightPower(int band) {
    PRT_CHECK_LE(0, band);
    return band == 0 ? 1.0 : 0.3 * std::pow(double(band), -0.6);
}

struct IrradianceNorm::State {
    int shOrder;
    ZonalMap roots;  // Uᵀ U is the quadratic form
};

namespace {

// Node by node: f(±m alike) over z > 0, for functions of m of all bands.
template <class Body>
void overUpperHalf(const Body& body) {
    std::vector<double> values(static_cast<size_t>(legendreCount(kMaxShOrder)));
    // Exact: products of a function of a bundle's order, one of the light and the cosine.
    for (const LineNode& node : gaussLegendre((kMaxShOrder + kMaxBundleShOrder) / 2 + 1)) {
        const double z = (node.z + 1) / 2;
        evalShLegendre(kMaxShOrder, z, values);
        body(z, node.weight / 2, values);
    }
}

// Σ_l C_l (∫ Y_l0 max(0, z) dω)²: the mean square of an open point.
double openMeanSquare() {
    std::array<double, kMaxShOrder> integral{};
    overUpperHalf([&](double z, double weight, const std::vector<double>& values) {
        for (int l = 0; l < kMaxShOrder; ++l)
            integral[size_t(l)] += 2 * std::numbers::pi * weight * z * values[size_t(legendreIndex(l, 0))];
    });
    double sum = 0;
    for (int l = 0; l < kMaxShOrder; ++l)
        sum += naturalLightPower(l) * integral[size_t(l)] * integral[size_t(l)];
    return sum;
}

std::vector<Eigen::MatrixXd> normBlocks(int shOrder) {
    std::vector<Eigen::MatrixXd> products;  // [m] ∫ Y_am Y_bm max(0, z) dω, a < n, b < kMaxShOrder
    for (int m = 0; m < shOrder; ++m)
        products.emplace_back(Eigen::MatrixXd::Zero(shOrder - m, kMaxShOrder - m));
    overUpperHalf([&](double z, double weight, const std::vector<double>& values) {
        for (int m = 0; m < shOrder; ++m) {
            Eigen::VectorXd y(kMaxShOrder - m);
            for (int l = m; l < kMaxShOrder; ++l) y[l - m] = values[size_t(legendreIndex(l, m))];
            products[size_t(m)] +=
                (m == 0 ? 2 : 1) * std::numbers::pi * weight * z * y.head(shOrder - m) * y.transpose();
        }
    });
    const double open = openMeanSquare();
    std::vector<Eigen::MatrixXd> blocks;
    for (int m = 0; m < shOrder; ++m) {
        Eigen::VectorXd power(kMaxShOrder - m);
        for (int l = m; l < kMaxShOrder; ++l) power[l - m] = naturalLightPower(l) / open;
        blocks.push_back(products[size_t(m)] * power.asDiagonal() * products[size_t(m)].transpose());
    }
    return blocks;
}

// Upper triangles U with Uᵀ U = block: |U e|² cannot turn negative by rounding.
std::vector<Eigen::MatrixXd> rootsOf(const std::vector<Eigen::MatrixXd>& blocks) {
    std::vector<Eigen::MatrixXd> roots;
    for (const Eigen::MatrixXd& block : blocks) roots.emplace_back(block.llt().matrixU());
    return roots;
}

}  // namespace

IrradianceNorm::IrradianceNorm(int shOrder) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxBundleShOrder);
    state_ = std::make_unique<State>(State{shOrder, ZonalMap(rootsOf(normBlocks(shOrder)))});
}
IrradianceNorm::~IrradianceNorm() = default;
IrradianceNorm::IrradianceNorm(IrradianceNorm&&) noexcept = default;

double IrradianceNorm::evaluate(const Vec3f& normal, std::span<const float> coefficients) const {
    const size_t count = size_t(shCount(state_->shOrder));
    PRT_CHECK_EQ(coefficients.size(), count);
    PRT_CHECK(std::abs(normal.squaredNorm() - 1) < 1e-4f);
    std::array<float, size_t(shCount(kMaxBundleShOrder))> local, root;
    rotateSh(localFromWorld(normal), state_->shOrder, coefficients, std::span(local.data(), count));
    state_->roots.apply(local.data(), root.data());
    double sum = 0;
    for (size_t i = 0; i < count; ++i) sum += double(root[i]) * double(root[i]);
    return std::sqrt(sum);
}

void IrradianceNorm::evaluateSoa(std::span<const Vec3f> normals, size_t stride,
                                 std::span<const float> coefficients, std::span<float> out) const {
    const size_t count = normals.size(), columns = size_t(shCount(state_->shOrder));
    PRT_CHECK_LE(paddedSoaCount(count), stride);
    PRT_CHECK_LE(columns * stride, coefficients.size());
    PRT_CHECK_EQ(out.size(), count);
    const LocalRotations rotations(normals, stride);
    std::vector<float> local(columns * stride), roots(columns * stride);
    rotateShSoa(rotations.fromWorld, state_->shOrder, count, stride, coefficients, local);
    state_->roots.applySoa(paddedSoaCount(count), stride, local.data(), roots.data());
    std::vector<double> sums(count, 0.0);
    for (size_t c = 0; c < columns; ++c)
        for (size_t k = 0; k < count; ++k)
            sums[k] += double(roots[c * stride + k]) * double(roots[c * stride + k]);
    for (size_t k = 0; k < count; ++k) out[k] = float(std::sqrt(sums[k]));
}

}  // namespace prt
