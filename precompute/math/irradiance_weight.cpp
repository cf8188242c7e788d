// Mean squared clamped cosine over a cone of normals: as a function, as a zonal series (Funk-Hecke, as in
// [RamamoorthiHanrahan2001]) and as the metric it makes of expansions ("multiply by w" [Ren2006]).
#include "precompute/math/irradiance_weight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"
#include "precompute/math/sh_product.h"

namespace prt {
namespace {

double coneCosine(const IrradianceWeight& weight) {
    PRT_CHECK(isValid(weight));
    return std::cos(weight.coneDegrees * std::numbers::pi / 180);
}

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

// Mean over azimuth of max(0, a + b cos φ)², b >= 0.
double ringMean(double a, double b) {
    if (a >= b) return a * a + b * b / 2;
    if (a <= -b) return 0;
    const double end = std::acos(-a / b);
    return ((a * a + b * b / 2) * end + 2 * a * b * std::sin(end) + b * b / 4 * std::sin(2 * end)) /
           std::numbers::pi;
}

bool isUsable(const Vec3f& normal) {
    const double square = normal.cast<double>().squaredNorm();
    return std::isfinite(square) && square > 1e-30;
}

}  // namespace

bool isValid(const IrradianceWeight& weight) {
    return weight.coneDegrees > 0 && weight.coneDegrees <= 90 && weight.floor >= 0 && weight.floor <= 1;
}

double irradianceWeight(double cosine, const IrradianceWeight& weight) {
    static const std::vector<LineNode> nodes = gaussLegendre(48);
    const double cone = std::acos(coneCosine(weight)), angle = std::acos(std::clamp(cosine, -1.0, 1.0));
    // Rings of the cap by their angle t; the integrand's kink lies at the ring that touches the horizon.
    const double kink = std::clamp(std::abs(std::numbers::pi / 2 - angle), 0.0, cone);
    double sum = 0;
    for (const auto [low, high] : {std::array{0.0, kink}, std::array{kink, cone}}) {
        // t = low + (high − low) s²: the half powers at the kink become whole ones.
        for (const LineNode& node : nodes) {
            const double s = (node.z + 1) / 2, t = low + (high - low) * s * s;
            sum += node.weight * s * (high - low) * std::sin(t) *
                   ringMean(std::cos(angle) * std::cos(t), std::sin(angle) * std::sin(t));
        }
    }
    return sum / (1 - std::cos(cone)) + weight.floor * largestIrradianceWeight(weight);
}

double largestIrradianceWeight(const IrradianceWeight& weight) {
    const double cosine = coneCosine(weight);
    return (1 + cosine + cosine * cosine) / 3;
}

std::vector<double> irradianceWeightZonal(int bands, const IrradianceWeight& weight) {
    PRT_CHECK_LE(1, bands);
    PRT_CHECK_LE(bands, kMaxShOrder);
    const double cosine = coneCosine(weight);
    std::vector<double> zonal = squaredCosineZonal(bands);
    for (int l = 0; l < bands; ++l) zonal[size_t(l)] *= capMean(l, cosine);
    zonal[0] += weight.floor * largestIrradianceWeight(weight) * std::sqrt(4 * std::numbers::pi);
    return zonal;
}

struct IrradianceMetric::State {
    int shOrder, bands;
    std::vector<double> bandScale;
    std::vector<TriplingCoefficient> lower;  // of the lower triangle, sorted by place

    // w about the normal, by coefficients: Y_lm(n) times the zonal coefficient of the band.
    void rotatedWeight(const Vec3f& normal, std::span<float> f) const {
        std::fill(f.begin(), f.end(), 0.0f);
        std::array<double, shCount(2 * kMaxBundleShOrder - 1)> y;
        const bool usable = isUsable(normal);
        const Vec3d direction = usable ? Vec3d(normal.cast<double>().normalized()) : Vec3d(0, 0, 1);
        evalSh(bands, direction, {y.data(), size_t(shCount(bands))});
        for (int l = 0; l < (usable ? bands : 1); ++l)
            for (int k = shIndex(l, -l); k <= shIndex(l, l); ++k)
                f[size_t(k)] = float(bandScale[size_t(l)] * y[size_t(k)]);
    }
};

IrradianceMetric::IrradianceMetric(int shOrder, const IrradianceWeight& weight)
    : state_(std::make_unique<State>()) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxBundleShOrder);
    state_->shOrder = shOrder;
    state_->bands = 2 * shOrder - 1;
    const std::vector<double> zonal = irradianceWeightZonal(state_->bands, weight);
    for (int l = 0; l < state_->bands; ++l)
        state_->bandScale.push_back(zonal[size_t(l)] * std::sqrt(4 * std::numbers::pi / (2 * l + 1)));
    for (const TriplingCoefficient& t : triplingCoefficients(shOrder, shOrder, state_->bands))
        if (t.i >= t.j) state_->lower.push_back(t);
    std::sort(state_->lower.begin(), state_->lower.end(),
              [](const TriplingCoefficient& a, const TriplingCoefficient& b) {
                  return std::array{a.j, a.i, a.k} < std::array{b.j, b.i, b.k};
              });
}
IrradianceMetric::~IrradianceMetric() = default;
IrradianceMetric::IrradianceMetric(IrradianceMetric&&) noexcept = default;

void IrradianceMetric::evaluate(const Vec3f& normal, std::span<float> out) const {
    const size_t dimension = size_t(shCount(state_->shOrder));
    PRT_CHECK_EQ(out.size(), dimension * dimension);
    std::array<float, shCount(2 * kMaxBundleShOrder - 1)> f;
    state_->rotatedWeight(normal, f);
    std::fill(out.begin(), out.end(), 0.0f);
    for (const TriplingCoefficient& t : state_->lower) out[t.j * dimension + t.i] += f[t.k] * t.value;
    for (size_t j = 0; j < dimension; ++j)
        for (size_t i = j + 1; i < dimension; ++i) out[i * dimension + j] = out[j * dimension + i];
}

std::vector<std::vector<double>> irradianceMetricBlocks(int shOrder, const IrradianceWeight& weight) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxBundleShOrder);
    // The series up to the bands that products of two functions reach is as good as w itself.
    const int bands = 2 * shOrder - 1;
    const std::vector<double> zonal = irradianceWeightZonal(bands, weight);
    std::vector<std::vector<double>> blocks(static_cast<size_t>(shOrder));
    for (int m = 0; m < shOrder; ++m) blocks[size_t(m)].assign(size_t((shOrder - m) * (shOrder - m)), 0.0);
    std::vector<double> values(size_t(legendreCount(bands)));
    for (const LineNode& node : gaussLegendre(2 * shOrder)) {
        evalShLegendre(bands, node.z, values);
        double w = 0;
        for (int l = 0; l < bands; ++l) w += zonal[size_t(l)] * values[size_t(legendreIndex(l, 0))];
        for (int m = 0; m < shOrder; ++m) {
            const int size = shOrder - m;
            const double scale = (m == 0 ? 2 : 1) * std::numbers::pi * node.weight * w;
            for (int a = 0; a < size; ++a)
                for (int b = 0; b < size; ++b)
                    blocks[size_t(m)][size_t(a * size + b)] += scale *
                                                               values[size_t(legendreIndex(m + a, m))] *
                                                               values[size_t(legendreIndex(m + b, m))];
        }
    }
    return blocks;
}

}  // namespace prt
