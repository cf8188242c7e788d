// Rotation of hemispherical harmonics, three ways, against rotating the function itself.
#include "precompute/math/hsh_rotation.h"

#include <functional>

#include "precompute/math/sh_legendre.h"
#include "tests/math/sh_rotation_input.h"

namespace prt {
namespace {

using test::kPi;
using test::largestDifference;

void evalHsh(int order, const Vec3d& d, std::vector<double>& out) {
    const double z = std::max(0.0, d.z()), stretch = 2 * std::sqrt(z / (1 + z));
    evalSh(order, Vec3d(stretch * d.x(), stretch * d.y(), 2 * z - 1), std::span<double>(out));
    for (double& v : out) v *= std::numbers::sqrt2;
}

/// Calls visit(node, weight) for Gauss-Legendre nodes in low..high, crowded at both ends so that roots there
/// are smooth.
void forNodes(double low, double high, const std::function<void(double, double)>& visit) {
    for (const LineNode& n : gaussLegendre(64)) {
        const double u = 0.5 * kPi * (n.z + 1);
        visit(low + (high - low) * 0.5 * (1 - std::cos(u)),
              0.25 * kPi * (high - low) * std::sin(u) * n.weight);
    }
}

/// Coefficients of the function after the rotation, 0 where it comes from below: in z and azimuth, split
/// where the circle of latitude first touches what is empty.
std::vector<double> projectRotated(const Mat3d& r, int order,
                                   const std::function<double(const Vec3d&)>& function) {
    const Vec3d up = r.col(2);  // where the pole went
    const double sine = std::hypot(up.x(), up.y()), azimuth = std::atan2(up.y(), up.x());
    std::vector<double> result(size_t(shCount(order)), 0.0), h(result.size());
    const auto addLatitude = [&](double z, double zWeight) {
        const double radius = std::sqrt((1 - z) * (1 + z));
        double half = kPi;
        if (radius * sine > 1e-14)
            half = std::acos(std::clamp(-z * up.z() / (radius * sine), -1.0, 1.0));
        else if (up.z() < 0)
            return;
        forNodes(azimuth - half, azimuth + half, [&](double phi, double weight) {
            const Vec3d d(radius * std::cos(phi), radius * std::sin(phi), z);
            const double value = weight * zWeight * function(r.transpose() * d);
            evalHsh(order, d, h);
            for (size_t i = 0; i < h.size(); ++i) result[i] += value * h[i];
        });
    };
    forNodes(0, sine, addLatitude);
    forNodes(sine, 1, addLatitude);
    return result;
}

std::vector<double> projectRotated(const Mat3d& r, int order, const std::vector<double>& c) {
    std::vector<double> h(c.size());
    return projectRotated(r, order, [&](const Vec3d& d) {
        evalHsh(order, d, h);
        double sum = 0;
        for (size_t i = 0; i < h.size(); ++i) sum += c[i] * h[i];
        return sum;
    });
}

std::vector<double> times(const std::vector<double>& matrix, const std::vector<double>& v) {
    std::vector<double> result(v.size(), 0.0);
    for (size_t r = 0; r < v.size(); ++r)
        for (size_t c = 0; c < v.size(); ++c) result[r] += matrix[r * v.size() + c] * v[c];
    return result;
}

double relativeError(const std::vector<float>& a, const std::vector<double>& exact) {
    double error = 0, length = 0;
    for (size_t i = 0; i < exact.size(); ++i) {
        error += (double(a[i]) - exact[i]) * (double(a[i]) - exact[i]);
        length += exact[i] * exact[i];
    }
    return std::sqrt(error / length);
}

TEST(HshTurnMatrices, SpecialAngles) {
    for (const int n : {1, 3, 6}) {
        const size_t count = size_t(shCount(n));
        const std::vector<double> removal = hshDigonRemoval(n, 0), turn = hshYRotation(n, 0);
        for (size_t i = 0; i < count * count; ++i) {
            EXPECT_NEAR(removal[i], i % (count + 1) == 0 ? 1 : 0, 1e-12);
            EXPECT_NEAR(turn[i], i % (count + 1) == 0 ? 1 : 0, 1e-12);
        }
        for (const double v : hshYRotation(n, kPi)) EXPECT_NEAR(v, 0, 1e-15);
        for (const double v : hshDigonRemoval(n, kPi)) EXPECT_NEAR(v, 0, 1e-15);
    }
    // of the constant remains the share of the hemisphere
    for (const double beta : {0.1, 1.0, 2.0}) {
        EXPECT_NEAR(hshDigonRemoval(2, beta)[0], (kPi - beta) / kPi, 1e-13);
        EXPECT_NEAR(hshYRotation(2, beta)[0], (kPi - beta) / kPi, 1e-13);
    }
    // half the hemisphere: the functions even in x keep half of themselves
    const std::vector<double> half = hshDigonRemoval(3, kPi / 2);
    for (const auto& [l, m] : {std::pair{1, 0}, {1, -1}, {2, 0}, {2, 2}})
        EXPECT_NEAR(half[size_t(shIndex(l, m)) * 10], 0.5, 1e-13);
}

TEST(HshTurnMatrices, EqualProjectingTheTurnedFunction) {
    constexpr int kOrder = 5;
    test::RandomInput random(81);
    for (const double beta : {0.02, 0.3, 1.2, kPi / 2, 2.5}) {
        const std::vector<double> c = random.coefficients<double>(shCount(kOrder));
        EXPECT_LT(largestDifference(times(hshYRotation(kOrder, beta), c),
                                    projectRotated(rotationAboutUp(beta), kOrder, c)),
                  1e-8)
            << beta;
        // removing the digon = turning it away and the rest back
        const std::vector<double> kept = times(hshDigonRemoval(kOrder, beta), c);
        std::vector<double> h(c.size());
        const auto masked = [&](const Vec3d& d) {
            if ((rotationAboutUp(beta) * d).z() < 0) return 0.0;
            evalHsh(kOrder, d, h);
            double sum = 0;
            for (size_t i = 0; i < h.size(); ++i) sum += c[i] * h[i];
            return sum;
        };
        const Mat3d back = rotationAboutUp(-beta);
        const std::vector<double> expected =
            projectRotated(back, kOrder, [&](const Vec3d& d) { return masked(back * d); });
        EXPECT_LT(largestDifference(kept, expected), 1e-8) << beta;
    }
}

TEST(HshTurnMatrices, RemovalIsSymmetricAndTakesAway) {
    constexpr int kOrder = 7;
    test::RandomInput random(82);
    const std::vector<double> m = hshDigonRemoval(kOrder, 0.7);
    const size_t count = size_t(shCount(kOrder));
    for (size_t i = 0; i < count; ++i)
        for (size_t j = 0; j < i; ++j) EXPECT_NEAR(m[i * count + j], m[j * count + i], 1e-14);
    for (int k = 0; k < 20; ++k) {
        const std::vector<double> c = random.coefficients<double>(int(count)), left = times(m, c);
        double kept = 0, whole = 0;
        for (size_t i = 0; i < count; ++i) {
            kept += c[i] * left[i];
            whole += c[i] * c[i];
        }
        EXPECT_GT(kept, 0);
        EXPECT_LT(kept, whole);
    }
}

TEST(HshTurnMatrices, TurnBackIsTheTranspose) {
    // ∫ H_i(ω) H_j(Rᵀω) over what is above before and after
    const std::vector<double> forth = hshYRotation(4, 0.8);
    test::RandomInput random(83);
    const std::vector<double> c = random.coefficients<double>(16);
    std::vector<double> expected = projectRotated(rotationAboutUp(-0.8), 4, c), back(16, 0.0);
    for (size_t i = 0; i < 16; ++i)
        for (size_t j = 0; j < 16; ++j) back[i] += forth[j * 16 + i] * c[j];
    EXPECT_LT(largestDifference(back, expected), 1e-9);
}

TEST(HshShAngle, IsGautronsFormula) {
    EXPECT_EQ(hshShAngle(0), 0);
    for (double beta = 0.05; beta < kPi / 2; beta += 0.05)
        EXPECT_NEAR(hshShAngle(beta), std::acos(2 * std::cos(beta) - 1), 1e-13);
    EXPECT_NEAR(hshShAngle(1e-6), std::sqrt(2.0) * 1e-6, 1e-18);
    EXPECT_NEAR(hshShAngle(kPi / 2), kPi, 1e-7);
    EXPECT_NEAR(hshShAngle(2.5), kPi, 1e-15);
}

TEST(HshRotationTable, EqualsRotatingTheFunctionAtTabulatedAngles) {
    constexpr int kOrder = 6;
    const HshRotationTable table(kOrder, 19);  // every 10°
    test::RandomInput random(84);
    for (const double betaDeg : {0.0, 10.0, 40.0, 90.0, 130.0, 180.0}) {
        const Mat3d r = rotationFromZyz({random.uniform(-3, 3), betaDeg * kPi / 180, random.uniform(-3, 3)});
        const std::vector<float> c = random.coefficients<float>(shCount(kOrder));
        std::vector<float> out(c.size());
        table.rotateByTable(r, c, out);
        EXPECT_LT(largestDifference(out, projectRotated(r, kOrder, std::vector<double>(c.begin(), c.end()))),
                  2e-6)
            << betaDeg;
        std::vector<float> inPlace = c;
        table.rotateByTable(r, inPlace, inPlace);
        EXPECT_EQ(inPlace, out);
        table.rotateByDigonRemoval(r, c, out);
        inPlace = c;
        table.rotateByDigonRemoval(r, inPlace, inPlace);
        EXPECT_EQ(inPlace, out);
    }
}

TEST(HshRotationTable, AboutThePoleAllMethodsAreExact) {
    const HshRotationTable table(8, 5);
    const HshRotationThroughSh through(8, 24);
    test::RandomInput random(85);
    const std::vector<float> c = random.coefficients<float>(64);
    const std::vector<double> exact =
        test::rotated(test::about(Vec3d::UnitZ(), 0.8), 8, {c.begin(), c.end()});
    std::vector<float> out(64);
    table.rotateByTable(test::about(Vec3d::UnitZ(), 0.8), c, out);
    EXPECT_LT(largestDifference(out, exact), 1e-6);
    table.rotateByDigonRemoval(test::about(Vec3d::UnitZ(), 0.8), c, out);
    EXPECT_LT(largestDifference(out, exact), 1e-6);
    // through spherical harmonics it is C Cᵀ, which misses what the functions have above 24 bands
    through.rotate(test::about(Vec3d::UnitZ(), 0.8), c, out);
    EXPECT_LT(relativeError(out, exact), 0.2);
}

TEST(HshRotationTable, ErrorFallsWithTheSquareOfTheDistanceOfAngles) {
    constexpr int kOrder = 6;
    test::RandomInput random(86);
    const std::vector<float> c = random.coefficients<float>(shCount(kOrder));
    double before = 0, beforeAtPole = 0;
    for (const int steps : {9, 18, 36, 72}) {
        const HshRotationTable table(kOrder, steps + 1);
        const double step = kPi / steps;
        // the worst place of an interval is its middle
        const auto errorNear = [&](double angle) {
            const double beta = (std::floor(angle / step) + 0.5) * step;
            const std::vector<double> exact =
                times(hshYRotation(kOrder, beta), std::vector<double>(c.begin(), c.end()));
            std::vector<float> out(c.size());
            table.rotateByTable(rotationAboutUp(beta), c, out);
            return relativeError(out, exact);
        };
        const double worst = std::max(errorNear(0.9), errorNear(1.9)), atPole = errorNear(0);
        if (before > 0) {
            EXPECT_LT(worst, before / 3);
            EXPECT_GT(worst, before / 6);
            EXPECT_LT(atPole, beforeAtPole / 2.2);
        }
        before = worst;
        beforeAtPole = atPole;
    }
    EXPECT_LT(before, 0.02);
    EXPECT_LT(beforeAtPole, 0.02);
}

/// max(0, cos)⁵ about a direction tilted towards +x.
double lobe(const Vec3d& d, double tiltDeg) {
    const double tilt = tiltDeg * kPi / 180;
    return std::pow(std::max(0.0, std::sin(tilt) * d.x() + std::cos(tilt) * d.z()), 5);
}

TEST(HshRotationMethods, ErrorsOfACosineLobe) {
    constexpr int kOrder = 10;
    const HshRotationTable table(kOrder, 37);  // every 5°
    const HshRotationThroughSh through(kOrder, kMaxShOrder);
    const auto project = [](const Mat3d& r) {
        return projectRotated(r, kOrder, [](const Vec3d& d) { return lobe(d, 45); });
    };
    const std::vector<double> before = project(Mat3d::Identity());
    const std::vector<float> c(before.begin(), before.end());
    for (const auto& [betaDeg, digonError] : {std::pair{5.0, 0.08}, {10.0, 0.16}, {20.0, 0.32}}) {
        const Mat3d r = rotationAboutUp(betaDeg * kPi / 180);
        const std::vector<double> exact = project(r);
        std::vector<float> out(c.size());
        table.rotateByTable(r, c, out);
        const double byTable = relativeError(out, exact);
        table.rotateByDigonRemoval(r, c, out);
        const double byDigon = relativeError(out, exact);
        through.rotate(r, c, out);
        const double throughSh = relativeError(out, exact);
        EXPECT_LT(byTable, 0.01);
        EXPECT_LT(throughSh, 0.01);
        EXPECT_NEAR(byDigon, digonError, 0.02) << betaDeg;
    }
}

TEST(HshRotationThroughSh, ErrorFallsWithTheIntermediateOrder) {
    constexpr int kOrder = 6;
    test::RandomInput random(87);
    const Mat3d r = rotationFromZyz({0.4, 0.5, -1});
    const std::vector<double> c =
        projectRotated(Mat3d::Identity(), kOrder, [](const Vec3d& d) { return lobe(d, 30); });
    const std::vector<double> exact = projectRotated(r, kOrder, c);
    const std::vector<float> in(c.begin(), c.end());
    double before = 1e30;
    for (const int between : {4, 6, 9, 14, 24}) {
        std::vector<float> out(in.size());
        HshRotationThroughSh(kOrder, between).rotate(r, in, out);
        const double error = relativeError(out, exact);
        EXPECT_LT(error, before) << between;
        before = error;
    }
    EXPECT_LT(before, 0.01);
}

TEST(HshRotationDeathTest, RefusesWrongArguments) {
    const HshRotationThroughSh through(3, 5);
    std::vector<float> v(9), shorter(4);
    EXPECT_DEATH(through.rotate(Mat3d::Identity(), shorter, v), "in == ");
    EXPECT_DEATH(through.rotate(2 * Mat3d::Identity(), v, v), "deviationFromRotation");
    EXPECT_DEATH(HshRotationTable(3, 1), "angleCount");
    EXPECT_DEATH(HshRotationTable(0, 3), "hshOrder");
    EXPECT_DEATH((void)hshYRotation(3, -0.1), "betaRad");
    EXPECT_DEATH((void)hshDigonRemoval(3, 3.2), "betaRad");
}

}  // namespace
}  // namespace prt
