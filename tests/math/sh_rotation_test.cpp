// Rotation of expansions: special angles, composition, inverse.
#include "precompute/math/sh_rotation.h"

#include <cmath>

#include "precompute/math/sh_rotation_bands.h"
#include "tests/math/sh_rotation_input.h"

namespace prt {
namespace {

using test::about;
using test::awkwardRotations;
using test::kPi;
using test::largestDifference;
using test::rotated;

TEST(ShRotation, MovesADeltaToTheTurnedDirection) {
    // the expansion Y(ω0) of a delta at ω0 becomes Y(R ω0)
    test::RandomInput random(52);
    for (const Mat3d& r : awkwardRotations()) {
        const Vec3d direction = random.direction();
        std::vector<double> before(576), expected(576);
        evalSh(kMaxShOrder, direction, std::span<double>(before));
        evalSh(kMaxShOrder, Vec3d(r * direction), std::span<double>(expected));
        EXPECT_LT(largestDifference(rotated(r, kMaxShOrder, before), expected), 1e-11) << r;
    }
}

TEST(ShRotation, FirstBandTurnsAsAVector) {
    // f = v·ω has band-1 coefficients √(4π/3) (−v.y, v.z, −v.x)
    test::RandomInput random(53);
    const double c = std::sqrt(4 * kPi / 3);
    for (int k = 0; k < 50; ++k) {
        const Mat3d r = random.rotation();
        const Vec3d v = random.direction(), w = r * v;
        const std::vector<double> out = rotated(r, 2, {0.25, -c * v.y(), c * v.z(), -c * v.x()});
        EXPECT_LT(largestDifference(out, std::vector{0.25, -c * w.y(), c * w.z(), -c * w.x()}), 1e-14);
    }
}

TEST(ShRotation, ComposesInvertsAndKeepsLengthPerBand) {
    test::RandomInput random(54);
    const std::vector<Mat3d> rotations = awkwardRotations();
    const std::vector<double> c = random.coefficients<double>(576);
    for (size_t k = 1; k < rotations.size(); ++k) {
        const Mat3d &a = rotations[k], &b = rotations[k - 1];
        const std::vector<double> once = rotated(b, kMaxShOrder, c), twice = rotated(a, kMaxShOrder, once);
        EXPECT_LT(largestDifference(twice, rotated(a * b, kMaxShOrder, c)), 1e-11);
        EXPECT_LT(largestDifference(rotated(b.transpose(), kMaxShOrder, once), c), 1e-11);
        for (int l = 0; l < kMaxShOrder; ++l) {
            double before = 0, after = 0;
            for (int i = l * l; i < (l + 1) * (l + 1); ++i) {
                before += c[size_t(i)] * c[size_t(i)];
                after += once[size_t(i)] * once[size_t(i)];
            }
            EXPECT_NEAR(before, after, 1e-11);
        }
    }
}

TEST(ShRotation, IdentityAndZonalTurnsAboutZChangeNothing) {
    test::RandomInput random(55);
    const std::vector<double> c = random.coefficients<double>(576);
    EXPECT_LT(largestDifference(rotated(Mat3d::Identity(), kMaxShOrder, c), c), 1e-12);
    std::vector<double> zonal(576, 0.0);
    for (int l = 0; l < kMaxShOrder; ++l) zonal[size_t(shIndex(l, 0))] = 1 + l;
    EXPECT_LT(largestDifference(rotated(about(Vec3d::UnitZ(), 1.234), kMaxShOrder, zonal), zonal), 1e-11);
}

TEST(ShRotation, WorksInPlaceAndInFloat) {
    test::RandomInput random(56);
    const Mat3d r = random.rotation();
    const std::vector<float> c = random.coefficients<float>(100);
    std::vector<float> apart(100), inPlace = c;
    rotateSh(r, 10, std::span<const float>(c), std::span<float>(apart));
    rotateSh(r, 10, std::span<const float>(inPlace), std::span<float>(inPlace));
    EXPECT_EQ(apart, inPlace);
    const std::vector<double> exact = rotated(r, 10, std::vector<double>(c.begin(), c.end()));
    // three turns and two exchanges in float, on bands of length up to √(19/3)
    for (size_t i = 0; i < 100; ++i) EXPECT_NEAR(double(apart[i]), exact[i], 6e-7);
}

TEST(ShRotation, FloatFollowsDoubleForAllOrdersAndAngles) {
    test::RandomInput random(58);
    for (const int n : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 24})
        for (const Mat3d& r : awkwardRotations()) {
            const std::vector<float> c = random.coefficients<float>(shCount(n));
            std::vector<float> out(c.size());
            rotateSh(r, n, std::span<const float>(c), std::span<float>(out));
            const std::vector<double> exact = rotated(r, n, std::vector<double>(c.begin(), c.end()));
            for (int l = 0; l < n; ++l) {
                const size_t first = size_t(l * l), size = size_t(2 * l + 1);
                double length = 0, worst = 0;
                for (size_t i = first; i < first + size; ++i) {
                    length += exact[i] * exact[i];
                    worst = std::max(worst, std::abs(double(out[i]) - exact[i]));
                }
                EXPECT_LE(worst, 1e-6 * std::sqrt(length)) << n << ' ' << l;
            }
        }
}

TEST(ShRotation, ExchangeOfYAndZIsWhatProjectionSays) {
    for (int l = 1; l < detail::kUnrolledBands; ++l) {
        const int size = 2 * l + 1;
        std::vector<double> expected(size_t(size * size), 0.0), y(size_t(shCount(l + 1))), swapped(y.size());
        for (const SphereNode& node : sphereQuadrature(2 * l)) {
            const Vec3d& d = node.direction;
            evalSh(l + 1, d, std::span<double>(y));
            evalSh(l + 1, Vec3d(d.x(), d.z(), d.y()), std::span<double>(swapped));
            for (int i = 0; i < size * size; ++i)
                expected[size_t(i)] +=
                    node.weightSr * y[size_t(l * l + i / size)] * swapped[size_t(l * l + i % size)];
        }
        for (int i = 0; i < size * size; ++i)
            EXPECT_NEAR(detail::kSwapTables[size_t(l)][size_t(i / size)][size_t(i % size)],
                        expected[size_t(i)], 1e-13);
    }
}

TEST(ZyzAngles, RebuildTheMatrixEvenAtThePoles) {
    for (const Mat3d& r : awkwardRotations()) {
        const ZyzAngles a = zyzFromRotation(r);
        EXPECT_LT((rotationFromZyz(a) - r).cwiseAbs().maxCoeff(), 2e-15) << r;
        EXPECT_LE(0, a.betaRad);
        EXPECT_LE(a.betaRad, kPi);
        EXPECT_LE(std::abs(a.alphaRad), kPi);
        EXPECT_LE(std::abs(a.gammaRad), kPi);
    }
    for (const double beta : {0.0, kPi}) {
        const ZyzAngles pole = zyzFromRotation(rotationFromZyz({0, beta, 0.75}));
        EXPECT_NEAR(pole.alphaRad, 0, 1e-15);
        EXPECT_NEAR(pole.betaRad, beta, 2e-16);
        EXPECT_NEAR(pole.gammaRad, 0.75, 1e-15);
    }
}

TEST(ZyzAngles, AreFoundAgain) {
    test::RandomInput random(59);
    for (int k = 0; k < 200; ++k) {
        const ZyzAngles a{random.uniform(-kPi, kPi), random.uniform(0.01, kPi - 0.01),
                          random.uniform(-kPi, kPi)};
        const ZyzAngles found = zyzFromRotation(rotationFromZyz(a));
        EXPECT_NEAR(found.alphaRad, a.alphaRad, 1e-13);
        EXPECT_NEAR(found.betaRad, a.betaRad, 1e-13);
        EXPECT_NEAR(found.gammaRad, a.gammaRad, 1e-13);
    }
}

TEST(ShRotation, ToleratesMatricesOfFloatPrecision) {
    test::RandomInput random(57);
    const Mat3d r = random.rotation();
    const Mat3d rough = r.cast<float>().cast<double>();
    const std::vector<double> c = random.coefficients<double>(100);
    EXPECT_LT(largestDifference(rotated(rough, 10, c), rotated(r, 10, c)), 2e-5);
}

TEST(ShRotationDeathTest, RefusesReflectionsAndScales) {
    std::vector<double> c(4);
    Mat3d mirror = Mat3d::Identity();
    mirror(2, 2) = -1;
    EXPECT_DEATH(rotateSh(mirror, 2, std::span<const double>(c), std::span<double>(c)),
                 "deviationFromRotation");
    const Mat3d scale = 2 * Mat3d::Identity();
    EXPECT_DEATH(rotateSh(scale, 2, std::span<const double>(c), std::span<double>(c)),
                 "deviationFromRotation");
}

TEST(RotationAboutUp, TurnsPlusZTowardsPlusX) {
    for (const double longitude : {-2.0, 0.0, 0.5, 3.0})
        for (const double angle : {-1.0, 0.25, 4.0}) {
            const Vec3d turned =
                rotationAboutUp(angle) * Vec3d(std::sin(longitude), 0.3, std::cos(longitude));
            const Vec3d expected(std::sin(longitude + angle), 0.3, std::cos(longitude + angle));
            EXPECT_LT((turned - expected).norm(), 1e-15);
        }
    EXPECT_LT((rotationAboutUp(kPi / 2) * Vec3d(0, 0, 1) - Vec3d(1, 0, 0)).norm(), 1e-15);
}

}  // namespace
}  // namespace prt
