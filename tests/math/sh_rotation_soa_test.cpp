// Rotation of many vectors at once, exact and by Taylor series, against one at a time.
#include "precompute/math/sh_rotation_soa.h"

#include "precompute/math/sh_rotation_taylor.h"
#include "tests/math/sh_rotation_input.h"

namespace prt {
namespace {

using test::largestDifference;
using test::SoaInput;

constexpr std::pair<size_t, size_t> kSizes[] = {{1, 1},   {15, 15},     {16, 16},
                                                {17, 23}, {1000, 1000}, {1000, 1024}};

TEST(ShRotationSoa, EveryVectorByItsOwnRotation) {
    for (const int n : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 24})
        for (const auto& [count, stride] : kSizes) {
            if (n > 12 && count > 100) continue;
            const SoaInput input(n, count, stride, 71);
            std::vector<float> out(input.soaVectors.size(), SoaInput::kUntouched), inPlace = input.soaVectors;
            rotateShSoa(input.soaRotations, n, count, stride, input.soaVectors, out);
            rotateShSoa(input.soaRotations, n, count, stride, inPlace, inPlace);
            ASSERT_EQ(out, inPlace) << n;
            ASSERT_TRUE(input.gapsUntouched(out));
            for (size_t k = 0; k < count; ++k)
                // angles are rounded to float and multiplied by up to n − 1, on bands of length √(2l + 1)/√3
                ASSERT_LT(
                    largestDifference(input.vector(out, k), test::rotated(input.rotations[k], n,
                                                                          input.vector(input.soaVectors, k))),
                    (1e-7 * n + 3e-7) * std::sqrt(2 * n - 1))
                    << n << ' ' << count << ' ' << k;
        }
}

TEST(ShRotationSoa, AllVectorsByOneRotation) {
    for (const int n : {1, 2, 3, 6, 10, 12, 24})
        for (const auto& [count, stride] : kSizes) {
            if (n > 12 && count > 100) continue;
            const SoaInput input(n, count, stride, 72);
            std::vector<float> out(input.soaVectors.size(), SoaInput::kUntouched), inPlace = input.soaVectors;
            const Mat3d& r = input.rotations[0];
            rotateShSoa(r, n, count, stride, input.soaVectors, out);
            rotateShSoa(r, n, count, stride, inPlace, inPlace);
            ASSERT_EQ(out, inPlace);
            ASSERT_TRUE(input.gapsUntouched(out));
            for (size_t k = 0; k < count; ++k)
                ASSERT_LT(largestDifference(input.vector(out, k),
                                            test::rotated(r, n, input.vector(input.soaVectors, k))),
                          4e-7 * std::sqrt(2 * n - 1))
                    << n << ' ' << count;
        }
}

TEST(ShRotationSoa, SurvivesThePolesOfTheEulerAngles) {
    const std::vector<Mat3d> rotations = test::awkwardRotations();
    const size_t count = rotations.size();
    std::vector<float> soaRotations(9 * count), vectors(100 * count);
    test::RandomInput random(73);
    for (float& v : vectors) v = float(random.uniform(-1, 1));
    for (size_t i = 0; i < 9 * count; ++i)
        soaRotations[i] =
            float(rotations[i % count](Eigen::Index(i / count / 3), Eigen::Index(i / count % 3)));
    std::vector<float> out(vectors.size());
    rotateShSoa(soaRotations, 10, count, count, vectors, out);
    for (size_t k = 0; k < count; ++k) {
        std::vector<double> c(100), result(100);
        for (size_t i = 0; i < 100; ++i) {
            c[i] = double(vectors[i * count + k]);
            result[i] = double(out[i * count + k]);
        }
        EXPECT_LT(largestDifference(result, test::rotated(rotations[k], 10, c)), 5e-6) << rotations[k];
    }
}

TEST(ShRotationSoa, TaylorEqualsOneAtATime) {
    for (const ShTaylorOrder order : {ShTaylorOrder::One, ShTaylorOrder::OneAndHalf, ShTaylorOrder::Two})
        for (const int n : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 24})
            for (const auto& [count, stride] : kSizes) {
                if (n > 12 && count > 100) continue;
                const SoaInput input(n, count, stride, 74, 0.4);
                std::vector<float> out(input.soaVectors.size(), SoaInput::kUntouched),
                    inPlace = input.soaVectors;
                rotateShTaylorSoa(input.soaRotations, order, n, count, stride, input.soaVectors, out);
                rotateShTaylorSoa(input.soaRotations, order, n, count, stride, inPlace, inPlace);
                ASSERT_EQ(out, inPlace);
                ASSERT_TRUE(input.gapsUntouched(out));
                std::vector<double> expected(size_t(shCount(n)));
                for (size_t k = 0; k < count; ++k) {
                    const std::vector<double> c = input.vector(input.soaVectors, k);
                    rotateShTaylor(zyzFromRotation(input.rotations[k]), order, n, std::span<const double>(c),
                                   std::span<double>(expected));
                    // the series grows to 1 + nβ + (nβ)²/2
                    const double growth = 1 + 0.4 * n + 0.08 * n * n;
                    ASSERT_LT(largestDifference(input.vector(out, k), expected),
                              (1e-7 * n + 3e-7) * std::sqrt(2 * n - 1) * growth)
                        << n << ' ' << count;
                }
            }
}

TEST(ShRotationSoa, NoVectorsIsNoWork) {
    std::vector<float> nothing;
    rotateShSoa(nothing, 3, 0, 0, nothing, nothing);
    rotateShSoa(Mat3d::Identity(), 3, 0, 0, nothing, nothing);
    rotateShTaylorSoa(nothing, ShTaylorOrder::Two, 3, 0, 0, nothing, nothing);
}

TEST(ShRotationSoaDeathTest, RefusesShortArraysAndReflections) {
    const SoaInput input(3, 20, 24, 75);
    std::vector<float> out(9 * 24), shorter(9 * 24 - 5);
    EXPECT_DEATH(rotateShSoa(input.soaRotations, 3, 20, 24, input.soaVectors, shorter), "stride");
    EXPECT_DEATH(rotateShSoa(input.soaRotations, 3, 20, 19, input.soaVectors, out), "stride");
    EXPECT_DEATH(rotateShSoa(std::vector<float>(24), 3, 20, 24, input.soaVectors, out), "stride");
    EXPECT_DEATH(rotateShSoa(input.soaRotations, 25, 20, 24, input.soaVectors, out), "shOrder");
    std::vector<float> mirrored = input.soaRotations;
    for (size_t i = 0; i < 3; ++i) mirrored[i * 24 + 18] *= -1;
    EXPECT_DEATH(rotateShSoa(mirrored, 3, 20, 24, input.soaVectors, out), "Rotations");
    mirrored[18] = std::nanf("");
    EXPECT_DEATH(rotateShTaylorSoa(mirrored, ShTaylorOrder::One, 3, 20, 24, input.soaVectors, out),
                 "Rotations");
}

}  // namespace
}  // namespace prt
