// Bands of the clamped cosine against closed forms and quadrature.
#include "precompute/math/clamped_cosine.h"

#include <cmath>
#include <numbers>

#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"
#include "precompute/math/sh_rotation.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(ClampedCosine, KnownBands) {
    const double expected[] = {kPi, 2 * kPi / 3, kPi / 4, 0, -kPi / 24, 0, kPi / 64, 0, -kPi / 128};
    for (int l = 0; l < 9; ++l) EXPECT_NEAR(clampedCosineBand(l), expected[l], 1e-15) << l;
}

TEST(ClampedCosine, EveryBandIsItsIntegral) {
    // 2π ∫_0^1 z P_l(z) dz; the nodes are moved to [0, 1], the polynomial has degree 24 at most
    const std::vector<LineNode> nodes = gaussLegendre(20);
    for (int l = 0; l < kMaxShOrder; ++l) {
        double sum = 0;
        for (const LineNode& node : nodes) {
            const double z = 0.5 * (node.z + 1);
            sum += kPi * node.weight * z * std::legendre(unsigned(l), z);
        }
        EXPECT_NEAR(clampedCosineBand(l), sum, 1e-14) << l;
    }
}

TEST(ClampedCosine, ExpansionIsTheTurnedOneAboutZ) {
    test::RandomInput random(21);
    for (int k = 0; k < 20; ++k) {
        const Vec3d n = random.direction();
        std::vector<float> aboutZ(576), expected(576), actual(576);
        evalClampedCosineSh(kMaxShOrder, Vec3f(0, 0, 1), aboutZ);
        const Mat3d rotation =
            Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(n))
                .toRotationMatrix();
        rotateSh(rotation, kMaxShOrder, std::span<const float>(aboutZ), std::span<float>(expected));
        evalClampedCosineSh(kMaxShOrder, n.cast<float>(), actual);
        for (size_t i = 0; i < 576; ++i) EXPECT_NEAR(actual[i], expected[i], 2e-6f) << i;
    }
}

TEST(ClampedCosine, ExpansionConvergesToTheFunction) {
    // A_l (2l + 1) P_l(0) ~ l^-2: the largest error, at the kink, falls like 1 / L; A_l² (2l + 1) ~ l^-4: the
    // mean square falls like L^-3, where L is the first even band left out.
    const Vec3d n = Vec3d(1, 2, -2) / 3;
    std::vector<double> scaled;
    for (const int bands : {3, 5, 12, 24}) {
        const int missing = bands + bands % 2;
        std::vector<float> c(size_t(shCount(bands)));
        evalClampedCosineSh(bands, n.cast<float>(), c);
        double squares = 0, worst = 0;
        for (const float v : c) squares += double(v) * double(v);
        // Parseval: ∫ max(0, n·ω)² = 2π/3
        scaled.push_back((2 * kPi / 3 - squares) * std::pow(missing - 0.5, 3));
        for (const SphereNode& node : sphereQuadrature(40))
            worst = std::max(worst, std::abs(evalShExpansion(bands, c, node.direction) -
                                             std::max(0.0, n.dot(node.direction))));
        EXPECT_LT(worst, 0.4 / missing) << bands;
        EXPECT_GT(worst, 0.2 / missing) << bands;
    }
    for (const double s : scaled) EXPECT_NEAR(s, scaled[0], 0.2 * scaled[0]);
}

TEST(ClampedCosine, ConstantLightGivesPiForEveryNormal) {
    // E = Σ A_0 L_00 Y_00 with L = 1
    std::vector<float> c(9);
    evalClampedCosineSh(3, Vec3f(0.6f, 0, 0.8f), c);
    EXPECT_NEAR(double(c[0]) * std::sqrt(4 * kPi), kPi, 1e-6);
}

}  // namespace
}  // namespace prt
