// Rotation matrices by recurrence, and the derivatives of the turn about y.
#include "precompute/math/sh_rotation_matrix.h"

#include "tests/math/sh_rotation_input.h"

namespace prt {
namespace {

using test::applied;
using test::awkwardRotations;
using test::kPi;
using test::largestDifference;
using test::largestEntryDifference;

TEST(ShRotationMatrix, EqualsTheFastRotation) {
    test::RandomInput random(61);
    for (const Mat3d& r : awkwardRotations()) {
        const std::vector<double> c = random.coefficients<double>(shCount(kMaxShOrder));
        const ShRotationMatrix matrix(r, kMaxShOrder);
        EXPECT_LT(largestDifference(applied(matrix, c), test::rotated(r, kMaxShOrder, c)), 1e-12) << r;
    }
}

TEST(ShRotationMatrix, EqualsProjectingTheRotatedFunction) {
    test::RandomInput random(62);
    for (const int n : {1, 2, 3, 6, 10, kMaxShOrder}) {
        const Mat3d r = random.rotation();
        const std::vector<double> c = random.coefficients<double>(shCount(n));
        EXPECT_LT(largestDifference(applied(ShRotationMatrix(r, n), c), test::projectRotated(r, n, c)), 1e-12)
            << n;
    }
}

TEST(ShRotationMatrix, IsOrthogonalAndMultiplies) {
    test::RandomInput random(63);
    const Mat3d a = random.rotation(), b = random.rotation();
    const std::vector<double> c = random.coefficients<double>(shCount(kMaxShOrder));
    const ShRotationMatrix ma(a, kMaxShOrder), mb(b, kMaxShOrder), mab(a * b, kMaxShOrder),
        inverse(a.transpose(), kMaxShOrder);
    EXPECT_LT(largestDifference(applied(ma, applied(mb, c)), applied(mab, c)), 1e-12);
    EXPECT_LT(largestDifference(applied(inverse, applied(ma, c)), c), 1e-12);
    for (int l = 0; l < kMaxShOrder; ++l)
        for (int i = 0; i < 2 * l + 1; ++i)
            for (int j = 0; j < 2 * l + 1; ++j)
                EXPECT_NEAR(ma.block(l)[size_t(i * (2 * l + 1) + j)],
                            inverse.block(l)[size_t(j * (2 * l + 1) + i)], 1e-13);
}

TEST(ShRotationMatrix, AppliesInPlaceInFloatAndToManyVectors) {
    for (const int n : {1, 2, 5, 6, 10, 13})
        for (const auto& [count, stride] :
             {std::pair<size_t, size_t>{1, 1}, {15, 15}, {16, 20}, {17, 17}, {100, 131}}) {
            const test::SoaInput input(n, count, stride, 64);
            const ShRotationMatrix matrix(input.rotations[0], n);
            std::vector<float> out(input.soaVectors.size(), test::SoaInput::kUntouched),
                inPlace = input.soaVectors;
            matrix.applySoa(count, stride, input.soaVectors, out);
            matrix.applySoa(count, stride, inPlace, inPlace);
            EXPECT_EQ(out, inPlace);
            EXPECT_TRUE(input.gapsUntouched(out));
            for (size_t k = 0; k < count; ++k) {
                const std::vector<double> exact = applied(matrix, input.vector(input.soaVectors, k));
                EXPECT_LT(largestDifference(input.vector(out, k), exact), 3e-6);
            }
            std::vector<float> single(size_t(shCount(n)));
            for (size_t i = 0; i < single.size(); ++i) single[i] = input.soaVectors[i * stride];
            matrix.apply(std::span<const float>(single), std::span<float>(single));
            EXPECT_LT(largestDifference(single, applied(matrix, input.vector(input.soaVectors, 0))), 4e-7);
        }
}

TEST(ShRotationMatrix, HoldsAsManyEntriesAsThePaperCounts) {
    for (int n = 1; n <= kMaxShOrder; ++n)
        EXPECT_EQ(ShBandMatrix(n).entryCount(), size_t(ivanicMultiplications(n)));
    EXPECT_EQ(ivanicMultiplications(5), 165);
    EXPECT_EQ(ivanicMultiplications(10), 1330);
}

TEST(ShYRotationDerivatives, ZerothIsTheRotation) {
    for (const double beta : {0.0, 0.3, -1.7, kPi, 10.0}) {
        const auto d = shYRotationDerivatives(kMaxShOrder, beta, 0);
        ASSERT_EQ(d.size(), 1u);
        EXPECT_LT(largestEntryDifference(d[0], ShRotationMatrix(rotationAboutUp(beta), kMaxShOrder)), 1e-13);
    }
}

TEST(ShYRotationDerivatives, EqualFiniteDifferences) {
    // fourth-order differences of the derivative before: the error is h⁴/30 of the fifth after it, (n − 1)^(k
    // + 4)
    constexpr int kOrder = 10, kLast = 4;
    constexpr double kStep = 1e-3;
    for (const double beta : {0.0, 0.4, 2.0}) {
        const auto here = shYRotationDerivatives(kOrder, beta, kLast);
        std::vector<std::vector<ShBandMatrix>> at;
        for (const int i : {-2, -1, 1, 2})
            at.push_back(shYRotationDerivatives(kOrder, beta + i * kStep, kLast));
        for (int k = 1; k <= kLast; ++k) {
            ShBandMatrix difference(kOrder);
            const double weights[] = {1, -8, 8, -1};
            for (size_t i = 0; i < 4; ++i) difference.add(weights[i] / (12 * kStep), at[i][size_t(k - 1)]);
            const double bound = std::pow(kStep, 4) / 30 * std::pow(9, k + 4) + 1e-10 * std::pow(9, k);
            EXPECT_LT(largestEntryDifference(difference, here[size_t(k)]), bound) << beta << ' ' << k;
        }
    }
}

TEST(ShYRotationDerivatives, RepeatAsPowersOfTheFirst) {
    // d^(k+1)R/dβ^(k+1) = G d^kR/dβ^k with the antisymmetric G = dR/dβ at 0
    constexpr int kOrder = 12, kLast = 6;
    const ShBandMatrix generator = shYRotationDerivatives(kOrder, 0, 1)[1];
    test::RandomInput random(65);
    const std::vector<double> c = random.coefficients<double>(shCount(kOrder));
    for (const double beta : {0.0, 0.9}) {
        const auto d = shYRotationDerivatives(kOrder, beta, kLast);
        for (int k = 0; k < kLast; ++k)
            EXPECT_LT(
                largestDifference(applied(generator, applied(d[size_t(k)], c)), applied(d[size_t(k) + 1], c)),
                1e-12 * std::pow(kOrder, k + 1));
    }
    for (int l = 0; l < kOrder; ++l)
        for (int i = 0; i < 2 * l + 1; ++i)
            for (int j = 0; j < 2 * l + 1; ++j)
                EXPECT_NEAR(generator.block(l)[size_t(i * (2 * l + 1) + j)],
                            -generator.block(l)[size_t(j * (2 * l + 1) + i)], 1e-13);
}

TEST(ShYRotationDerivatives, AreThePapersWithTheOtherSign) {
    // Krivanek's Figure 2 shows the inverse rotation: first derivatives change sign, second ones do not.
    const auto d = shYRotationDerivatives(4, 0, 2);
    const auto entry = [&](int k, int l, int row, int column) {
        return d[size_t(k)].block(l)[size_t((row + l) * (2 * l + 1) + column + l)];
    };
    EXPECT_NEAR(entry(1, 1, 0, 1), 1, 1e-15);
    EXPECT_NEAR(entry(1, 2, -2, -1), -1, 1e-15);
    EXPECT_NEAR(entry(1, 2, 1, 0), -std::sqrt(3.0), 1e-15);
    EXPECT_NEAR(entry(1, 3, 0, 1), std::sqrt(6.0), 1e-14);
    EXPECT_NEAR(entry(1, 3, 2, 3), std::sqrt(1.5), 1e-14);
    EXPECT_NEAR(entry(2, 2, 0, 0), -3, 1e-14);
    EXPECT_NEAR(entry(2, 3, 1, 1), -8.5, 1e-14);
    EXPECT_NEAR(entry(2, 3, 0, 2), std::sqrt(15.0), 1e-14);
    EXPECT_NEAR(entry(2, 3, -3, -1), 0.5 * std::sqrt(15.0), 1e-14);
}

TEST(ShRotationMatrixDeathTest, RefusesWrongSizesAndReflections) {
    std::vector<double> c(9), shorter(4);
    EXPECT_DEATH(ShRotationMatrix(-Mat3d::Identity(), 3), "deviationFromRotation");
    EXPECT_DEATH(ShRotationMatrix(Mat3d::Identity(), 0), "shOrder");
    EXPECT_DEATH(ShRotationMatrix(Mat3d::Identity(), kMaxShOrder + 1), "shOrder");
    const ShRotationMatrix matrix(Mat3d::Identity(), 3);
    EXPECT_DEATH(matrix.apply(std::span<const double>(shorter), std::span<double>(c)), "in.size");
    EXPECT_DEATH((void)matrix.block(3), "band");
}

}  // namespace
}  // namespace prt
