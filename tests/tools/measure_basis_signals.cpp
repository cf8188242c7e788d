// Signals of `prt measure basis` against integrals taken another way, and closed forms.
#include "tools/measure/basis_signals.h"

#include <cmath>
#include <numbers>

#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"

namespace prt::tools {
namespace {

using std::numbers::pi;
constexpr RadianceModel kModels[] = {RadianceModel::AboveSurface, RadianceModel::FullSphere};

double smoothRadiance(const Radiance& radiance, const Vec3d& direction) {
    std::vector<double> values(radiance.smooth.size());
    evalSh(kSmoothOrder, direction, values);
    double sum = 0;
    for (size_t j = 0; j < values.size(); ++j) sum += radiance.smooth[j] * values[j];
    return sum;
}

/// ∫_{z≥0} L max(0, n·ω) in polar coordinates about n: rings of constant cosine, cut where the horizon
/// crosses them. The rings' lengths have a square root where the cut begins: t² there.
double clippedIrradiance(const Radiance& radiance, const Vec3d& normal) {
    const double psi = std::acos(normal.z()), sine = std::sin(psi);
    const Vec3d u = Vec3d(normal.z() * normal.x(), normal.z() * normal.y(), -sine * sine) / sine;  // down
    const Vec3d v = normal.cross(u);
    const std::vector<LineNode> nodes = gaussLegendre(40);
    double sum = 0;
    const auto ring = [&](double theta, double weight) {
        // z = cosθ cosψ − sinθ sinψ cosφ >= 0, φ measured from u
        const double bound = std::cos(theta) * std::cos(psi) / (std::sin(theta) * sine);
        const double first = bound >= 1 ? 0 : std::acos(bound);
        for (const LineNode& node : nodes) {
            const double phi = pi + (pi - first) * node.z;
            const Vec3d direction =
                std::cos(theta) * normal + std::sin(theta) * (std::cos(phi) * u + std::sin(phi) * v);
            sum += weight * (pi - first) * node.weight * std::cos(theta) * std::sin(theta) *
                   smoothRadiance(radiance, direction);
        }
    };
    const double start = std::max(0.0, pi / 2 - psi);
    for (const LineNode& node : nodes) {
        ring(start * (1 + node.z) / 2, node.weight * start / 2);
        const double t = (1 + node.z) / 2, span = pi / 2 - start;
        ring(start + span * t * t, node.weight * span * t);
    }
    return sum;
}

TEST(BasisSignals, IrradianceIsTheIntegral) {
    SignalRandom random(7);
    std::vector<DomainNode> nodes;
    for (int k = 0; k < 21; ++k) {  // not a multiple of any vector length
        Vec3d normal = random.direction();
        normal.z() = std::abs(normal.z());
        nodes.push_back({normal, 1});
    }
    const IrradianceTruth truth(nodes);
    std::vector<double> irradiance(nodes.size());
    for (const RadianceModel model : kModels) {
        Radiance radiance = drawRadiance(model, 5, 1, random);
        radiance.directions.push_back({0.6, 0, -0.8});
        radiance.fluxes.push_back(3);
        truth.eval(model, radiance, irradiance);
        const bool above = model == RadianceModel::AboveSurface;
        const auto sphere = sphereQuadrature(300);
        for (size_t k = 0; k < nodes.size(); ++k) {
            const Vec3d& n = nodes[k].direction;
            double expected = 0;
            for (size_t i = 0; i < radiance.directions.size(); ++i)
                if (!above || radiance.directions[i].z() >= 0)
                    expected += radiance.fluxes[i] * std::max(0.0, n.dot(radiance.directions[i]));
            if (above) {
                expected += clippedIrradiance(radiance, n);
            } else {
                for (const SphereNode& node : sphere)
                    expected += node.weightSr * smoothRadiance(radiance, node.direction) *
                                std::max(0.0, n.dot(node.direction));
            }
            EXPECT_NEAR(irradiance[k], expected, above ? 1e-9 : 2e-5) << k;
        }
    }
}

TEST(BasisSignals, StraightUpTheClippedPartIsAPolynomialIntegral) {
    SignalRandom random(9);
    const Radiance radiance = drawRadiance(RadianceModel::AboveSurface, 0, 1, random);
    const std::vector<DomainNode> up = {{Vec3d::UnitZ(), 1}};
    double value = 0, expected = 0;
    IrradianceTruth(up).eval(RadianceModel::AboveSurface, radiance, {&value, 1});
    for (const DomainNode& node : domainQuadrature(BasisDomain::UpperHemisphere, 9))
        expected += node.weightSr * node.direction.z() * smoothRadiance(radiance, node.direction);
    EXPECT_NEAR(value, expected, 1e-13);
}

TEST(BasisSignals, Sh9IsTheProjectionOverTheSphereOfNormals) {
    SignalRandom random(11);
    std::vector<DomainNode> nodes;
    for (const SphereNode& node : sphereQuadrature(80)) nodes.push_back({node.direction, node.weightSr});
    const IrradianceTruth truth(nodes);
    std::vector<double> irradiance(nodes.size()), values(9);
    for (const RadianceModel model : kModels) {
        const Radiance radiance = drawRadiance(model, 3, 1, random);
        truth.eval(model, radiance, irradiance);
        std::vector<double> expected(9, 0.0);
        for (size_t k = 0; k < nodes.size(); ++k) {
            evalSh(3, nodes[k].direction, values);
            for (size_t j = 0; j < 9; ++j) expected[j] += nodes[k].weightSr * irradiance[k] * values[j];
        }
        const auto sh9 = irradianceSh9(model, radiance);
        for (size_t j = 0; j < 9; ++j) EXPECT_NEAR(sh9[j], expected[j], 1e-3) << j;  // kinks of E
    }
}

TEST(BasisSignals, RandomRadianceIsWhatItsDocumentationSays) {
    for (const RadianceModel model : kModels) {
        const bool above = model == RadianceModel::AboveSurface;
        double flux = 0;
        for (uint64_t seed = 0; seed < 400; ++seed) {
            SignalRandom random(seed), again(seed);
            const Radiance radiance = drawRadiance(model, 5, 0.75, random);
            EXPECT_EQ(radiance.fluxes, drawRadiance(model, 5, 0.75, again).fluxes);
            ASSERT_EQ(radiance.directions.size(), 5u);
            for (const Vec3d& direction : radiance.directions) {
                EXPECT_NEAR(direction.norm(), 1, 1e-14);
                EXPECT_GE(direction.z(), above ? 0 : -1);
            }
            for (const double f : radiance.fluxes) flux += f;
            double smooth = 0, lowest = 1, highest = 0;
            for (const DomainNode& node :
                 domainQuadrature(above ? BasisDomain::UpperHemisphere : BasisDomain::Sphere, 12)) {
                const double value = smoothRadiance(radiance, node.direction);
                smooth += node.weightSr * value;
                lowest = std::min(lowest, value);
                highest = std::max(highest, value);
            }
            EXPECT_NEAR(smooth, 0.75, 1e-12);
            EXPECT_GT(lowest, -0.03 * highest);
            EXPECT_LT(lowest, 0.1 * highest);
        }
        EXPECT_NEAR(flux / 400, 1, 5 / std::sqrt(5 * 400.0));  // five standard deviations
    }
    SignalRandom random(1);
    EXPECT_TRUE(drawRadiance(RadianceModel::FullSphere, 0, 0, random).smooth.empty());
}

TEST(BasisSignals, RandomNumbersHaveTheirMoments) {
    SignalRandom random(3);
    constexpr int kCount = 20000;
    double exponential = 0, normal = 0, squares = 0;
    Vec3d sum = Vec3d::Zero(), turned = Vec3d::Zero();
    for (int k = 0; k < kCount; ++k) {
        exponential += random.exponential();
        const double x = random.normal();
        normal += x;
        squares += x * x;
        sum += random.direction();
        const Mat3d rotation = random.rotation();
        EXPECT_NEAR((rotation * rotation.transpose() - Mat3d::Identity()).norm(), 0, 1e-13);
        EXPECT_GT(rotation.determinant(), 0);
        turned += rotation * Vec3d::UnitX();
    }
    const double sigma = 1 / std::sqrt(double(kCount));
    EXPECT_NEAR(exponential / kCount, 1, 5 * sigma);
    EXPECT_NEAR(normal / kCount, 0, 5 * sigma);
    EXPECT_NEAR(squares / kCount, 1, 5 * std::numbers::sqrt2 * sigma);
    EXPECT_LT((sum / kCount).norm(), 5 * sigma);
    EXPECT_LT((turned / kCount).norm(), 5 * sigma);
}

TEST(BasisSignals, EnvironmentBecomesLights) {
    Environment environment;
    environment.name = environment.source = "patch";
    environment.image = {512, 256, 3, std::vector<float>(512 * 256 * 3, 0.0f)};
    const int x = 401, y = 77;
    for (int dy = 0; dy < 4; ++dy)  // one texel of the reduced image
        for (int dx = 0; dx < 4; ++dx) environment.image.at(x / 4 * 4 + dx, y / 4 * 4 + dy)[1] = 2.0f;
    const EnvironmentLights lights = environmentLights(environment);
    ASSERT_EQ(lights.directions.size(), 128u * 64u);
    double red = 0, green = 0;
    Vec3d towards = Vec3d::Zero();
    for (size_t k = 0; k < lights.directions.size(); ++k) {
        red += lights.fluxes[0][k];
        green += lights.fluxes[1][k];
        towards += lights.fluxes[1][k] * lights.directions[k];
    }
    EXPECT_EQ(red, 0);
    EXPECT_NEAR(green, 3, 1e-12);
    EXPECT_LT((towards / 3 - latLongDirection(x / 4 * 4 + 2, y / 4 * 4 + 2, 512, 256)).norm(), 1e-12);
    const Mat3d turn = Eigen::AngleAxisd(0.7, Vec3d(1, 2, 2) / 3).toRotationMatrix();
    EXPECT_LT((turnedDirections(lights, turn)[5] - turn * lights.directions[5]).norm(), 1e-15);
}

TEST(BasisSignals, ConstantEnvironmentGivesConstantIrradiance) {
    const EnvironmentLights lights = environmentLights(loadEnvironment("sky:uniform"));
    EXPECT_EQ(lights.name, "sky:uniform");
    const auto nodes = domainQuadrature(BasisDomain::UpperHemisphere, 5);
    const IrradianceTruth truth(nodes);
    std::vector<double> sphere(nodes.size(), 0.0), above(nodes.size(), 0.0);
    const std::span<const double> flux(lights.fluxes[0]);
    for (const bool upper : {false, true}) {
        const std::span<double> out(upper ? above : sphere);
        truth.addLights(lights.directions, upper, {&flux, 1}, {&out, 1});
    }
    for (size_t k = 0; k < nodes.size(); ++k) {
        // radiance 1/4π: E = 1/4, and (1 + cosθ)/8 of the half above the surface
        EXPECT_NEAR(sphere[k], 0.25, 2e-4);
        EXPECT_NEAR(above[k], (1 + nodes[k].direction.z()) / 8, 4e-3);  // texels straddle the horizon
    }
}

TEST(BasisSignals, PhongLobe) {
    const Lobe lobe = phongLobe(30);
    EXPECT_EQ(lobe.name, "tilt-30");
    EXPECT_NEAR(lobe.function({0.5, 0, std::sqrt(0.75)}), 1, 1e-15);
    EXPECT_NEAR(lobe.function({0, 0, 1}), std::pow(std::sqrt(0.75), 5), 1e-15);
    EXPECT_EQ(lobe.function({0.8, 0, -0.6}), 0);
    EXPECT_EQ(lobe.function(Vec3d(-1, 0, 0.1).normalized()), 0);
}

/// By angles, as the paper writes it.
double wardByAngles(const Vec3d& in, const Vec3d& out, double alphaX, double alphaY) {
    const Vec3d half = (in + out).normalized();
    const double delta = std::acos(half.z()), phi = std::atan2(half.y(), half.x());
    const double slope = std::pow(std::tan(delta), 2) *
                         (std::pow(std::cos(phi) / alphaX, 2) + std::pow(std::sin(phi) / alphaY, 2));
    return std::exp(-slope) / std::sqrt(in.z() * out.z()) / (4 * pi * alphaX * alphaY);
}

TEST(BasisSignals, WardLobe) {
    SignalRandom random(5);
    for (const double theta : {0.0, 30.0, 60.0})
        for (const double phi : {0.0, 90.0}) {
            const Lobe raw = wardLobe(theta, phi, WardVariant::RawCut89);
            const Lobe cosine = wardLobe(theta, phi, WardVariant::TimesCosine);
            const double t = theta * pi / 180, p = phi * pi / 180;
            const Vec3d out(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t));
            for (int k = 0; k < 50; ++k) {
                Vec3d in = random.direction();
                in.z() = std::abs(in.z());
                const double expected = wardByAngles(in, out, 0.2, 0.5);
                EXPECT_NEAR(raw.function(in), in.z() > raw.lowestZ ? expected : 0, 1e-12 * expected);
                EXPECT_NEAR(cosine.function(in), expected * in.z(), 1e-12 * expected);
            }
            EXPECT_EQ(cosine.lowestZ, 0);
            EXPECT_NEAR(raw.lowestZ, std::cos(89 * pi / 180), 1e-15);
            EXPECT_EQ(raw.function(Vec3d(1, 0, 0.017).normalized()), 0);
            EXPECT_GT(raw.function(Vec3d(1, 0, 0.018).normalized()), 0);
            EXPECT_EQ(cosine.function(Vec3d(1, 0, -0.1).normalized()), 0);
        }
}

}  // namespace
}  // namespace prt::tools
