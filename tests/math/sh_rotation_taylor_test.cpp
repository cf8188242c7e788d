// The truncated Taylor series of the turn about y: against its matrices, and its errors against the paper's.
#include "precompute/math/sh_rotation_taylor.h"

#include "precompute/math/sh_rotation_taylor_bands.h"
#include "tests/math/sh_rotation_input.h"

namespace prt {
namespace {

using test::applied;
using test::kPi;
using test::largestDifference;
using test::largestEntryDifference;
using test::largestSingularValue;

constexpr ShTaylorOrder kOrders[] = {ShTaylorOrder::One, ShTaylorOrder::OneAndHalf, ShTaylorOrder::Two};

ShBandMatrix errorMatrix(double betaDeg, ShTaylorOrder order, int n) {
    const double beta = betaDeg * kPi / 180;
    ShBandMatrix d = shYTaylorMatrix(beta, order, n);
    d.add(-1, ShRotationMatrix(rotationAboutUp(beta), n));
    return d;
}

TEST(ShTaylor, GeneratorIsTheFirstDerivative) {
    EXPECT_LT(largestEntryDifference(shYRotationGenerator(kMaxShOrder),
                                     shYRotationDerivatives(kMaxShOrder, 0, 1)[1]),
              1e-12);
}

TEST(ShTaylor, MatricesAreTheSeriesOfDerivatives) {
    constexpr double kBeta = 0.3;
    const auto d = shYRotationDerivatives(10, 0, 2);
    ShBandMatrix sum = ShBandMatrix::identity(10);
    sum.add(kBeta, d[1]);
    EXPECT_LT(largestEntryDifference(shYTaylorMatrix(kBeta, ShTaylorOrder::One, 10), sum), 1e-13);
    ShBandMatrix half = sum;
    for (int l = 0; l < 10; ++l)
        for (size_t i = 0; i < size_t(2 * l + 1); ++i)
            half.block(l)[i * size_t(2 * l + 2)] += kBeta * kBeta / 2 * d[2].block(l)[i * size_t(2 * l + 2)];
    EXPECT_LT(largestEntryDifference(shYTaylorMatrix(kBeta, ShTaylorOrder::OneAndHalf, 10), half), 1e-13);
    sum.add(kBeta * kBeta / 2, d[2]);
    EXPECT_LT(largestEntryDifference(shYTaylorMatrix(kBeta, ShTaylorOrder::Two, 10), sum), 1e-13);
}

TEST(ShTaylor, WholeSeriesIsTheRotation) {
    for (const double beta : {0.1, 1.0, -2.5}) {
        const ShRotationMatrix exact(rotationAboutUp(beta), 10);
        EXPECT_LT(largestEntryDifference(shYTaylorSeries(beta, 90, 10), exact), 1e-6) << beta;
    }
    EXPECT_LT(
        largestEntryDifference(shYTaylorSeries(0.3, 40, 10), ShRotationMatrix(rotationAboutUp(0.3), 10)),
        1e-13);
    EXPECT_LT(largestEntryDifference(shYTaylorSeries(0.3, 0, 5), ShBandMatrix::identity(5)), 1e-16);
}

TEST(ShTaylor, FunctionsFollowTheMatrices) {
    test::RandomInput random(66);
    for (const ShTaylorOrder order : kOrders)
        for (const int n : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 24})
            for (const double beta : {0.0, 0.1, -0.3}) {
                const std::vector<double> c = random.coefficients<double>(shCount(n));
                const std::vector<double> exact = applied(shYTaylorMatrix(beta, order, n), c);
                std::vector<double> out(c.size()), inPlace = c;
                rotateShYTaylor(beta, order, n, std::span<const double>(c), std::span<double>(out));
                rotateShYTaylor(beta, order, n, std::span<const double>(inPlace), std::span<double>(inPlace));
                EXPECT_LT(largestDifference(out, exact), 1e-13 * n);
                EXPECT_EQ(out, inPlace);

                const ZyzAngles angles{0.7, beta, -1.1};
                const std::vector<double> whole =
                    test::rotated(rotationFromZyz({0.7, 0, 0}), n,
                                  applied(shYTaylorMatrix(beta, order, n),
                                          test::rotated(rotationFromZyz({0, 0, -1.1}), n, c)));
                rotateShTaylor(angles, order, n, std::span<const double>(c), std::span<double>(out));
                EXPECT_LT(largestDifference(out, whole), 1e-12 * n);

                const std::vector<float> rough(c.begin(), c.end());
                std::vector<float> outFloat(c.size()), again = rough;
                const double tolerance = 1e-6 * std::sqrt(n) * (1 + 0.3 * n + 0.05 * n * n);
                rotateShTaylor(angles, order, n, std::span<const float>(rough), std::span<float>(outFloat));
                EXPECT_LT(largestDifference(outFloat, whole), tolerance) << n;
                rotateShTaylor(angles, order, n, std::span<const float>(again), std::span<float>(again));
                EXPECT_EQ(outFloat, again);
                if (beta >= 0) {
                    rotateShTaylor(rotationFromZyz(angles), order, n, std::span<const float>(rough),
                                   std::span<float>(outFloat));
                    EXPECT_LT(largestDifference(outFloat, whole), tolerance) << n;
                }
                rotateShYTaylor(beta, order, n, std::span<const float>(rough), std::span<float>(outFloat));
                EXPECT_LT(largestDifference(outFloat, exact), tolerance);
            }
}

TEST(ShTaylor, MatrixGivesTheAngleUpToHalfATurn) {
    // order One of band 1: f = Y10 becomes cos-free: the coefficient of Y11 is −β itself
    for (double beta = 0; beta <= kPi; beta += 0.01) {
        const std::vector<float> c = {0, 0, 1, 0};
        std::vector<float> out(4);
        rotateShTaylor(rotationAboutUp(beta), ShTaylorOrder::One, 2, std::span<const float>(c),
                       std::span<float>(out));
        EXPECT_NEAR(std::hypot(double(out[1]), double(out[3])), beta, 5e-7) << beta;
    }
}

TEST(ShTaylor, ErrorFallsWithTheOrderOfExpansionAtSmallAngles) {
    for (const int n : {5, 8})
        for (const double betaDeg : {1.0, 2.0, 5.0, 10.0}) {
            double before = 1e30;
            for (const ShTaylorOrder order : kOrders) {
                const double error = largestSingularValue(errorMatrix(betaDeg, order, n));
                EXPECT_LT(error, before) << n << ' ' << betaDeg;
                before = error;
            }
        }
}

TEST(ShTaylor, LargestErrorIsThatOfTheLargestEigenvalue) {
    // exp(βG) has the eigenvalues e^(imβ), m <= n − 1
    for (const int n : {3, 5, 8})
        for (const double betaDeg : {3.0, 10.0, 25.0}) {
            const double x = (n - 1) * betaDeg * kPi / 180;
            EXPECT_NEAR(largestSingularValue(errorMatrix(betaDeg, ShTaylorOrder::One, n)),
                        std::hypot(std::cos(x) - 1, std::sin(x) - x), 1e-6);
            EXPECT_NEAR(largestSingularValue(errorMatrix(betaDeg, ShTaylorOrder::Two, n)),
                        std::hypot(std::cos(x) - 1 + x * x / 2, std::sin(x) - x), 1e-6);
        }
}

TEST(ShTaylor, MoreTermsAreNoBetterAtLargeAngles) {
    const double expected[] = {3.58, 3.79, 3.99};
    for (size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(largestSingularValue(errorMatrix(25, kOrders[i], 8)), expected[i], 0.006);
}

// A number that counts its multiplications: the kernels run on it as on floats.
struct Counted {
    static inline int multiplications = 0;
    double value = 0;
};
Counted operator+(const Counted& a, const Counted& b) { return {a.value + b.value}; }
Counted operator-(const Counted& a, const Counted& b) { return {a.value - b.value}; }
Counted operator*(const Counted& a, const Counted& b) {
    ++Counted::multiplications;
    return {a.value * b.value};
}
/// A constant; ±1 costs nothing.
struct CountedConstant {
    double value;
    explicit constexpr CountedConstant(double v) : value(v) {}
};
Counted operator*(const CountedConstant& a, const Counted& b) {
    if (a.value == 1 || a.value == -1) return {a.value * b.value};
    ++Counted::multiplications;
    return {a.value * b.value};
}

int countZxzxz(int n) {
    detail::ZyzMultiples<Counted> angles{};
    Counted::multiplications = 0;
    const auto in = [](size_t, Counted& value) { value = {1}; };
    const auto out = [](size_t, const Counted&) {};
    detail::rotateUnrolledBands<CountedConstant, Counted>(n, angles, in, out,
                                                          std::make_index_sequence<detail::kUnrolledBands>());
    return Counted::multiplications;
}

TEST(ShRotationCounts, PapersFormulas) {
    EXPECT_EQ(zxzxzMultiplications(6), 332);
    EXPECT_EQ(zxzxzMultiplications(10), 1220);
    EXPECT_EQ(taylorMultiplications(6), 300);
    for (int n = 1; n <= 10; ++n) {
        int sum = 6 * n * (n - 1);  // three turns about z
        for (int i = 1; i <= n; ++i) sum += 2 * (i * i - i + 1);
        EXPECT_EQ(zxzxzMultiplications(n), sum);
    }
}

TEST(ShRotationCounts, OursAreThePapersWithoutMultiplicationsByOneAndAccidentalZeros) {
    for (int n = 1; n <= detail::kUnrolledBands; ++n) {
        int fewer = 0;
        for (int l = 0; l < n; ++l) {
            int entries = 0, ones = 0;
            for (int r = -l; r <= l; ++r)
                for (int c = -l; c <= l; ++c) {
                    const double v = detail::kSwapTables[size_t(l)][size_t(r + l)][size_t(c + l)];
                    entries += v != 0;
                    ones += v == 1 || v == -1;
                }
            EXPECT_LE(entries, l * l + l + 1);
            fewer += 2 * (l * l + l + 1 - entries + ones);
        }
        EXPECT_EQ(countZxzxz(n), zxzxzMultiplications(n) - fewer) << n;
        EXPECT_LE(countZxzxz(n), zxzxzMultiplications(n));
    }
}

}  // namespace
}  // namespace prt
