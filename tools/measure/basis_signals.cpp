// Signals for comparing bases: random irradiance as in [HabelWimmer2010, Sec. 5], Phong lobes and the
// anisotropic reflectance of [Ward1992] as in [Gautron2004, Sec. 5].
#include "tools/measure/basis_signals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"

namespace prt::tools {
namespace {

using std::numbers::pi;
constexpr double kRadPerDeg = pi / 180;
constexpr size_t kSmoothCount = size_t(shCount(kSmoothOrder));

typedef double Lanes __attribute__((vector_size(64)));
constexpr size_t kLanes = 8;

/// E_c(n) += Σ_k flux_ck max(0, n·d_k), for eight normals at a time and up to three channels.
struct LightSum {
    const double *x, *y, *z;     ///< normals [nodes], padded
    const double *dx, *dy, *dz;  ///< lights [lights]
    const double* flux[3];       ///< [lights]
    double* out[3];              ///< [nodes], padded
    size_t nodes, lights;
};
template <int Channels>
[[gnu::always_inline]] inline void sumLights(const LightSum& s) {
    const Lanes zero{};
    for (size_t i = 0; i < s.nodes; i += kLanes) {
        Lanes x, y, z, sum[Channels] = {};
        __builtin_memcpy(&x, s.x + i, sizeof x);
        __builtin_memcpy(&y, s.y + i, sizeof y);
        __builtin_memcpy(&z, s.z + i, sizeof z);
        for (size_t k = 0; k < s.lights; ++k) {
            const Lanes cosine = x * s.dx[k] + y * s.dy[k] + z * s.dz[k];
            const Lanes seen = cosine > zero ? cosine : zero;
            for (int c = 0; c < Channels; ++c) sum[c] += seen * s.flux[c][k];
        }
        for (int c = 0; c < Channels; ++c) __builtin_memcpy(s.out[c] + i, &sum[c], sizeof sum[c]);
    }
}
PRT_TARGET_CLONES void sumLights1(const LightSum& s) { sumLights<1>(s); }
PRT_TARGET_CLONES void sumLights3(const LightSum& s) { sumLights<3>(s); }

/// ∫ Y_j(ω) max(0, n·ω) over ω above the horizon, for the first kSmoothOrder bands. What n and the surface
/// both see is a lune: azimuth [ψ − π/2, π/2] about the line where their horizons cross, with ψ the angle
/// between the normals. In these angles the integrand is a trigonometric polynomial of low degree, which
/// 20 Gauss nodes each way integrate to rounding.
void addClippedIrradiance(const Vec3d& normal, const std::vector<LineNode>& nodes, std::span<double> out) {
    const Vec3d up = Vec3d::UnitZ();
    const double sine = std::hypot(normal.x(), normal.y());
    const Vec3d towards = sine > 0 ? Vec3d(normal.x() / sine, normal.y() / sine, 0) : Vec3d::UnitX();
    const Vec3d axis = up.cross(towards);
    const double width = pi - std::atan2(sine, normal.z());
    double values[kSmoothCount];
    for (const LineNode& a : nodes)
        for (const LineNode& p : nodes) {
            const double azimuth = pi / 2 - width * (1 - a.z) / 2, polar = pi * (1 + p.z) / 2;
            const Vec3d direction = std::cos(polar) * axis +
                                    std::sin(polar) * (std::cos(azimuth) * up + std::sin(azimuth) * towards);
            evalSh(kSmoothOrder, direction, values);
            const double weight = a.weight * width / 2 * p.weight * pi / 2 * std::sin(polar) *
                                  std::max(0.0, normal.dot(direction));
            for (size_t j = 0; j < kSmoothCount; ++j) out[j] += weight * values[j];
        }
}

/// ∫_{z≥0} Y_i Y_j of the first kSmoothOrder bands.
const std::vector<double>& hemisphereOverlap() {
    static const std::vector<double> overlap = makeBasis("lsosh", kSmoothOrder)->gram();
    return overlap;
}

/// Over the sphere, or its upper half.
double smoothFlux(RadianceModel model, std::span<const double> smooth) {
    if (model == RadianceModel::FullSphere) return std::sqrt(4 * pi) * smooth[0];
    double flux = 0;
    for (size_t j = 0; j < kSmoothCount; ++j) flux += hemisphereOverlap()[j] * smooth[j];
    return std::sqrt(4 * pi) * flux;
}

/// Functions of the first bands where the lowest radiance is looked for.
struct SearchGrid {
    std::vector<std::array<double, kSmoothCount>> values;
};
const SearchGrid& searchGrid(RadianceModel model) {
    static const auto make = [](BasisDomain domain) {
        SearchGrid grid;
        for (const DomainNode& node : domainQuadrature(domain, 31))
            evalSh(kSmoothOrder, node.direction, grid.values.emplace_back());
        for (int k = 0; k < 64; ++k) {  // no node is on the rim
            const double azimuth = 2 * pi * k / 64;
            evalSh(kSmoothOrder, Vec3d(std::cos(azimuth), std::sin(azimuth), 0), grid.values.emplace_back());
        }
        return grid;
    };
    static const SearchGrid sphere = make(BasisDomain::Sphere), above = make(BasisDomain::UpperHemisphere);
    return model == RadianceModel::FullSphere ? sphere : above;
}

std::vector<double> drawSmooth(RadianceModel model, double flux, SignalRandom& random) {
    std::vector<double> smooth(kSmoothCount);
    for (double& c : smooth) c = random.normal();
    double lowest = std::numeric_limits<double>::infinity();
    for (const auto& values : searchGrid(model).values) {
        double sum = 0;
        for (size_t j = 0; j < kSmoothCount; ++j) sum += smooth[j] * values[j];
        lowest = std::min(lowest, sum);
    }
    smooth[0] -= lowest * std::sqrt(4 * pi);
    const double scale = flux / smoothFlux(model, smooth);
    for (double& c : smooth) c *= scale;
    return smooth;
}

}  // namespace

double SignalRandom::exponential() { return -std::log1p(-uniform()); }

double SignalRandom::normal() {
    const double radius = std::sqrt(2 * exponential());
    return radius * std::cos(2 * pi * uniform());
}

Vec3d SignalRandom::direction() {
    const double z = 1 - 2 * uniform(), azimuth = 2 * pi * uniform();
    const double radius = std::sqrt((1 - z) * (1 + z));
    return {radius * std::cos(azimuth), radius * std::sin(azimuth), z};
}

Mat3d SignalRandom::rotation() {
    Eigen::Quaterniond q;
    q.w() = normal();
    q.x() = normal();
    q.y() = normal();
    q.z() = normal();
    return q.normalized().toRotationMatrix();
}

Radiance drawRadiance(RadianceModel model, int lights, double smoothFluxSum, SignalRandom& random) {
    PRT_CHECK_LE(0, lights);
    PRT_CHECK(smoothFluxSum >= 0);
    Radiance radiance;
    for (int k = 0; k < lights; ++k) {
        Vec3d direction = random.direction();
        if (model == RadianceModel::AboveSurface) direction.z() = std::abs(direction.z());
        radiance.directions.push_back(direction);
        radiance.fluxes.push_back(random.exponential() / lights);
    }
    if (smoothFluxSum > 0) radiance.smooth = drawSmooth(model, smoothFluxSum, random);
    return radiance;
}

EnvironmentLights environmentLights(const Environment& environment) {
    const LatLongView image = environment.view();
    const int width = std::min(image.width, 128), height = std::min(image.height, 64);
    const size_t count = size_t(width) * size_t(height);
    EnvironmentLights lights{environment.source.starts_with("sky:") ? environment.source : environment.name,
                             std::vector<Vec3d>(count),
                             {}};
    for (auto& channel : lights.fluxes) channel.assign(count, 0.0);
    for (size_t i = 0; i < count; ++i)
        lights.directions[i] =
            latLongDirection(double(i % size_t(width)) + 0.5, double(i / size_t(width)) + 0.5, width, height);
    double total = 0;
    for (int y = 0; y < image.height; ++y) {
        const double solidAngle = latLongTexelSolidAngle(y, image.width, image.height);
        for (int x = 0; x < image.width; ++x) {
            const size_t at =
                size_t(y * height / image.height) * size_t(width) + size_t(x * width / image.width);
            const float* texel = image.rgb.data() + 3 * (size_t(y) * size_t(image.width) + size_t(x));
            for (size_t c = 0; c < 3; ++c) {
                lights.fluxes[c][at] += solidAngle * double(texel[c]);
                total += solidAngle * double(texel[c]);
            }
        }
    }
    if (total > 0)
        for (auto& channel : lights.fluxes)
            for (double& flux : channel) flux *= 3 / total;
    return lights;
}

std::vector<Vec3d> turnedDirections(const EnvironmentLights& lights, const Mat3d& localFromWorld) {
    std::vector<Vec3d> turned;
    turned.reserve(lights.directions.size());
    for (const Vec3d& direction : lights.directions) turned.push_back(localFromWorld * direction);
    return turned;
}

IrradianceTruth::IrradianceTruth(std::span<const DomainNode> nodes) : count_(nodes.size()) {
    const size_t padded = (count_ + kLanes - 1) / kLanes * kLanes;
    for (auto* column : {&x_, &y_, &z_}) column->assign(padded, 0.0);
    smoothFull_.resize(count_ * kSmoothCount);
    smoothAbove_.assign(count_ * kSmoothCount, 0.0);
    const std::vector<LineNode> line = gaussLegendre(20);
    parallelFor(count_, 64, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const Vec3d& n = nodes[i].direction;
            x_[i] = n.x();
            y_[i] = n.y();
            z_[i] = n.z();
            const std::span<double> full(smoothFull_.data() + i * kSmoothCount, kSmoothCount);
            evalSh(kSmoothOrder, n, full);
            for (int l = 0; l < kSmoothOrder; ++l)
                for (int m = -l; m <= l; ++m) full[size_t(shIndex(l, m))] *= clampedCosineBand(l);
            addClippedIrradiance(n, line, {smoothAbove_.data() + i * kSmoothCount, kSmoothCount});
        }
    });
}

void IrradianceTruth::addLights(std::span<const Vec3d> directions, bool above,
                                std::span<const std::span<const double>> fluxes,
                                std::span<const std::span<double>> out) const {
    PRT_CHECK(fluxes.size() == 1 || fluxes.size() == 3);
    PRT_CHECK_EQ(fluxes.size(), out.size());
    std::vector<double> lights[6];
    for (size_t k = 0; k < directions.size(); ++k) {
        if (above && directions[k].z() < 0) continue;
        for (int i = 0; i < 3; ++i) lights[i].push_back(directions[k][i]);
        for (size_t c = 0; c < fluxes.size(); ++c) lights[3 + c].push_back(fluxes[c][k]);
    }
    std::vector<double> sums(out.size() * x_.size());
    LightSum sum{x_.data(),
                 y_.data(),
                 z_.data(),
                 lights[0].data(),
                 lights[1].data(),
                 lights[2].data(),
                 {lights[3].data(), lights[4].data(), lights[5].data()},
                 {},
                 x_.size(),
                 lights[0].size()};
    for (size_t c = 0; c < out.size(); ++c) sum.out[c] = sums.data() + c * x_.size();
    out.size() == 1 ? sumLights1(sum) : sumLights3(sum);
    for (size_t c = 0; c < out.size(); ++c) {
        PRT_CHECK_EQ(fluxes[c].size(), directions.size());
        PRT_CHECK_EQ(out[c].size(), count_);
        for (size_t i = 0; i < count_; ++i) out[c][i] += sum.out[c][i];
    }
}

void IrradianceTruth::eval(RadianceModel model, const Radiance& radiance, std::span<double> out) const {
    PRT_CHECK_EQ(out.size(), count_);
    std::fill(out.begin(), out.end(), 0.0);
    const bool above = model == RadianceModel::AboveSurface;
    if (!radiance.directions.empty()) {
        const std::span<const double> fluxes(radiance.fluxes);
        addLights(radiance.directions, above, {&fluxes, 1}, {&out, 1});
    }
    if (radiance.smooth.empty()) return;
    PRT_CHECK_EQ(radiance.smooth.size(), kSmoothCount);
    const std::vector<double>& table = above ? smoothAbove_ : smoothFull_;
    for (size_t i = 0; i < count_; ++i)
        for (size_t j = 0; j < kSmoothCount; ++j) out[i] += table[i * kSmoothCount + j] * radiance.smooth[j];
}

std::array<double, 9> irradianceSh9(RadianceModel model, std::span<const Vec3d> directions,
                                    std::span<const double> fluxes) {
    PRT_CHECK_EQ(directions.size(), fluxes.size());
    std::array<double, 9> sum{}, values;
    for (size_t k = 0; k < directions.size(); ++k) {
        if (model == RadianceModel::AboveSurface && directions[k].z() < 0) continue;
        evalSh(3, directions[k], values);
        for (size_t j = 0; j < 9; ++j) sum[j] += fluxes[k] * values[j];
    }
    for (int l = 0; l < 3; ++l)
        for (int m = -l; m <= l; ++m) sum[size_t(shIndex(l, m))] *= clampedCosineBand(l);
    return sum;
}

std::array<double, 9> irradianceSh9(RadianceModel model, const Radiance& radiance) {
    std::array<double, 9> sum = irradianceSh9(model, radiance.directions, radiance.fluxes);
    if (radiance.smooth.empty()) return sum;
    for (int l = 0; l < 3; ++l)
        for (int m = -l; m <= l; ++m) {
            const size_t j = size_t(shIndex(l, m));
            double coefficient = radiance.smooth[j];
            if (model == RadianceModel::AboveSurface) {
                coefficient = 0;
                for (size_t i = 0; i < kSmoothCount; ++i)
                    coefficient += hemisphereOverlap()[j * kSmoothCount + i] * radiance.smooth[i];
            }
            sum[j] += clampedCosineBand(l) * coefficient;
        }
    return sum;
}

Lobe phongLobe(double tiltDeg, double exponent) {
    const Vec3d axis(std::sin(tiltDeg * kRadPerDeg), 0, std::cos(tiltDeg * kRadPerDeg));
    return {fmt::format("tilt-{:g}", tiltDeg), tiltDeg, 0, [=](const Vec3d& w) {
                const double cosine = w.dot(axis);
                return w.z() < 0 || cosine <= 0 ? 0.0 : std::pow(cosine, exponent);
            }};
}

Lobe wardLobe(double outgoingThetaDeg, double outgoingPhiDeg, WardVariant variant) {
    constexpr double kAlphaX = 0.2, kAlphaY = 0.5;
    const double theta = outgoingThetaDeg * kRadPerDeg, phi = outgoingPhiDeg * kRadPerDeg;
    const Vec3d out(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    const double lowestZ = variant == WardVariant::RawCut89 ? std::cos(89 * kRadPerDeg) : 0;
    return {fmt::format("theta-{:g}-phi-{:g}", outgoingThetaDeg, outgoingPhiDeg), outgoingThetaDeg,
            outgoingPhiDeg,
            [=](const Vec3d& in) {
                if (in.z() <= lowestZ) return 0.0;
                const Vec3d h = in + out;
                const double a = h.x() / kAlphaX, b = h.y() / kAlphaY;
                const double f = std::exp(-(a * a + b * b) / (h.z() * h.z())) /
                                 (4 * pi * kAlphaX * kAlphaY * std::sqrt(in.z() * out.z()));
                return variant == WardVariant::TimesCosine ? f * in.z() : f;
            },
            lowestZ};
}

}  // namespace prt::tools
