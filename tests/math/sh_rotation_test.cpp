// Rotation of expansions: special angles, composition, inverse.
#include "precompute/math/sh_rotation.h"

#include <cmath>
#include <numbers>

#include "precompute/math/sh.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<double> rotated(const Mat3d& r, int shOrder, const std::vector<double>& c) {
    std::vector<double> out(c.size());
    rotateSh(r, shOrder, std::span<const double>(c), std::span<double>(out));
    return out;
}

double largestDifference(const std::vector<double>& a, const std::vector<double>& b) {
    double worst = 0;
    for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
    return worst;
}

Mat3d about(const Vec3d& axis, double angle) { return Eigen::AngleAxisd(angle, axis).toRotationMatrix(); }

/// Rotations at and near the poles of the Euler angles, and plain ones.
std::vector<Mat3d> awkwardRotations() {
    std::vector<Mat3d> result = {Mat3d::Identity()};
    const Vec3d axes[] = {Vec3d::UnitX(), Vec3d::UnitY(), Vec3d::UnitZ(), Vec3d(1, 1, 0).normalized()};
    for (const Vec3d& axis : axes)
        for (const double angle : {kPi / 2, -kPi / 2, kPi, 1e-3, 1e-8, 1e-15, kPi - 1e-8, kPi - 1e-15, 2.0})
            for (const double twist : {0.0, 0.7, kPi})
                result.push_back(about(Vec3d::UnitZ(), twist) * about(axis, angle));
    test::RandomInput random(51);
    for (int k = 0; k < 10; ++k) result.push_back(random.rotation());
    return result;
}

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
        EXPECT_LT(largestDifference(out, {0.25, -c * w.y(), c * w.z(), -c * w.x()}), 1e-14);
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
    for (size_t i = 0; i < 100; ++i) EXPECT_NEAR(double(apart[i]), exact[i], 3e-7);
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
