// Weighted least squares of expansions with one linear constraint, solved once per order in the frame of the
// surface; world expansions are turned there and back [Kautz2002].
#include "precompute/math/irradiance_projection.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "precompute/base/check.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"
#include "precompute/math/sh_rotation.h"
#include "precompute/math/sh_rotation_soa.h"
#include "precompute/math/zonal_map.h"

namespace prt {
namespace {

constexpr size_t kMostCoefficients = size_t(shCount(kMaxBundleShOrder));
// Below this floor the map's condition asks for rotations in double.
constexpr double kFloatFloor = 1e-4;

std::vector<Eigen::MatrixXd> matrices(const std::vector<std::vector<double>>& blocks) {
    std::vector<Eigen::MatrixXd> result;
    for (const std::vector<double>& block : blocks) {
        const auto size = Eigen::Index(std::lround(std::sqrt(double(block.size()))));
        result.emplace_back(Eigen::Map<const Eigen::MatrixXd>(block.data(), size, size));
    }
    return result;
}

// ∫ Y_i Y_j over z > 0 as blocks of equal m.
std::vector<Eigen::MatrixXd> upperHalf(int shOrder) {
    std::vector<Eigen::MatrixXd> blocks;
    for (int m = 0; m < shOrder; ++m) blocks.emplace_back(Eigen::MatrixXd::Zero(shOrder - m, shOrder - m));
    std::vector<double> values(size_t(legendreCount(shOrder)));
    for (const LineNode& node : gaussLegendre(shOrder)) {  // exact: the integrands' degree is 2n − 2
        evalShLegendre(shOrder, (node.z + 1) / 2, values);
        for (int m = 0; m < shOrder; ++m) {
            Eigen::VectorXd y(shOrder - m);
            for (int l = m; l < shOrder; ++l) y[l - m] = values[size_t(legendreIndex(l, m))];
            blocks[size_t(m)] += (m == 0 ? 1 : 0.5) * std::numbers::pi * node.weight * y * y.transpose();
        }
    }
    return blocks;
}

bool isUnit(const Vec3f& normal) { return std::abs(normal.squaredNorm() - 1) < 1e-4f; }

}  // namespace

struct IrradianceProjection::State {
    int shOrder;
    bool useFloat;
    ZonalMap inverse, metric, cut;
    std::vector<double> perIrradiance;  // [n] what one unit of irradiance adds to the functions of m = 0

    template <class Value, class Map>
    void inLocalFrame(const Vec3f& normal, std::span<const float> in, std::span<float> out,
                      const Map& map) const {
        const size_t count = size_t(shCount(shOrder));
        PRT_CHECK_EQ(in.size(), count);
        PRT_CHECK_EQ(out.size(), count);
        std::array<Value, kMostCoefficients> before, after;
        std::copy(in.begin(), in.end(), before.begin());
        const Mat3d rotation = localFromWorld(normal);
        rotateSh(rotation, shOrder, std::span<const Value>(before.data(), count),
                 std::span<Value>(before.data(), count));
        map(before.data(), after.data());
        rotateSh(rotation.transpose(), shOrder, std::span<const Value>(after.data(), count),
                 std::span<Value>(after.data(), count));
        std::copy_n(after.begin(), count, out.begin());
    }
    template <class Map>
    void apply(const Vec3f& normal, std::span<const float> in, std::span<float> out, const Map& map) const {
        PRT_CHECK(isUnit(normal));
        if (useFloat)
            inLocalFrame<float>(normal, in, out, map);
        else
            inLocalFrame<double>(normal, in, out, map);
    }
    template <class Value>
    void addIrradiance(double irradiance, Value* out) const {
        for (int l = 0; l < shOrder; ++l) out[shIndex(l, 0)] += Value(perIrradiance[size_t(l)] * irradiance);
    }
};

IrradianceProjection::IrradianceProjection(int shOrder, const IrradianceWeight& weight) {
    const std::vector<Eigen::MatrixXd> metric = matrices(irradianceMetricBlocks(shOrder, weight));
    std::vector<Eigen::MatrixXd> inverse;
    for (const Eigen::MatrixXd& block : metric)
        inverse.push_back(block.llt().solve(Eigen::MatrixXd::Identity(block.rows(), block.rows())));
    Eigen::VectorXd h(shOrder);
    for (int l = 0; l < shOrder; ++l)
        h[l] = clampedCosineBand(l) * std::sqrt((2 * l + 1) / (4 * std::numbers::pi));
    const Eigen::VectorXd response = inverse[0] * h, perIrradiance = response / h.dot(response);
    inverse[0] -= perIrradiance * response.transpose();
    state_ =
        std::make_unique<State>(State{shOrder,
                                      weight.floor >= kFloatFloor,
                                      ZonalMap(inverse),
                                      ZonalMap(metric),
                                      ZonalMap(upperHalf(shOrder)),
                                      {perIrradiance.data(), perIrradiance.data() + perIrradiance.size()}});
}
IrradianceProjection::~IrradianceProjection() = default;
IrradianceProjection::IrradianceProjection(IrradianceProjection&&) noexcept = default;

void IrradianceProjection::solve(const Vec3f& normal, std::span<const float> b, float irradiance,
                                 std::span<float> out) const {
    state_->apply(normal, b, out, [&](const auto* in, auto* result) {
        state_->inverse.apply(in, result);
        state_->addIrradiance(double(irradiance), result);
    });
}

void IrradianceProjection::solveSoa(std::span<const Vec3f> normals, size_t stride, std::span<const float> b,
                                    std::span<const float> irradiance, std::span<float> out) const {
    const size_t count = normals.size(), columns = size_t(shCount(state_->shOrder));
    PRT_CHECK_LE(paddedSoaCount(count), stride);
    PRT_CHECK_LE(columns * stride, b.size());
    PRT_CHECK_LE(columns * stride, out.size());
    PRT_CHECK_EQ(irradiance.size(), count);
    if (!state_->useFloat) {
        std::array<float, kMostCoefficients> one;
        for (size_t k = 0; k < count; ++k) {
            for (size_t c = 0; c < columns; ++c) one[c] = b[c * stride + k];
            const std::span single(one.data(), columns);
            solve(normals[k], single, irradiance[k], single);
            for (size_t c = 0; c < columns; ++c) out[c * stride + k] = one[c];
        }
        return;
    }
    for (const Vec3f& normal : normals) PRT_CHECK(isUnit(normal));
    const size_t padded = paddedSoaCount(count);
    const LocalRotations rotations(normals, stride);
    std::vector<float> local(columns * stride), solved(columns * stride);
    rotateShSoa(rotations.fromWorld, state_->shOrder, count, stride, b, local);
    state_->inverse.applySoa(padded, stride, local.data(), solved.data());
    for (int l = 0; l < state_->shOrder; ++l)
        for (size_t k = 0; k < count; ++k)
            solved[size_t(shIndex(l, 0)) * stride + k] +=
                float(state_->perIrradiance[size_t(l)] * double(irradiance[k]));
    rotateShSoa(rotations.toWorld, state_->shOrder, count, stride, solved, out);
}

void IrradianceProjection::solveLocal(std::span<const double> b, double irradiance,
                                      std::span<double> out) const {
    PRT_CHECK_EQ(b.size(), size_t(shCount(state_->shOrder)));
    PRT_CHECK_EQ(out.size(), b.size());
    PRT_CHECK(b.data() != out.data());
    state_->inverse.apply(b.data(), out.data());
    state_->addIrradiance(irradiance, out.data());
}

void IrradianceProjection::weigh(const Vec3f& normal, std::span<const float> c, std::span<float> out) const {
    state_->apply(normal, c, out, [&](const auto* in, auto* result) { state_->metric.apply(in, result); });
}

void IrradianceProjection::cutAtHorizon(const Vec3f& normal, std::span<const float> c,
                                        std::span<float> out) const {
    state_->apply(normal, c, out, [&](const auto* in, auto* result) { state_->cut.apply(in, result); });
}

}  // namespace prt
