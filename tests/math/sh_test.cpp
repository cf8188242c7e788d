// Evaluation and projection of spherical harmonics against closed forms and a slow reference of their
// definition.
#include "precompute/math/sh.h"

#include <cmath>
#include <numbers>

#include "precompute/base/error.h"
#include "precompute/math/directions.h"
#include "precompute/math/sh_legendre.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<double> evaluate(int shOrder, const Vec3d& d) {
    std::vector<double> y(size_t(shCount(shOrder)));
    evalSh(shOrder, d, std::span<double>(y));
    return y;
}

std::vector<float> evaluateFloat(int shOrder, const Vec3f& d) {
    std::vector<float> y(size_t(shCount(shOrder)));
    evalSh(shOrder, d, std::span<float>(y));
    return y;
}

/// Largest value of any function of the band: the scale of its errors.
double bandScale(int band) { return std::sqrt((2 * band + 1) / (4 * kPi)); }

/// The polynomials of [Sloan2008, A2] and [Gorller-Walrand1996], 4 bands and the fifth.
std::vector<double> closedForms(const Vec3d& d) {
    const double x = d.x(), y = d.y(), z = d.z();
    const auto root = [](double a) { return std::sqrt(a / kPi); };
    return {0.5 * root(1),
            -0.5 * root(3) * y,
            0.5 * root(3) * z,
            -0.5 * root(3) * x,
            0.5 * root(15) * x * y,
            -0.5 * root(15) * y * z,
            0.25 * root(5) * (3 * z * z - 1),
            -0.5 * root(15) * x * z,
            0.25 * root(15) * (x * x - y * y),
            -0.125 * root(70) * y * (3 * x * x - y * y),
            0.5 * root(105) * x * y * z,
            -0.125 * root(42) * y * (5 * z * z - 1),
            0.25 * root(7) * z * (5 * z * z - 3),
            -0.125 * root(42) * x * (5 * z * z - 1),
            0.25 * root(105) * z * (x * x - y * y),
            -0.125 * root(70) * x * (x * x - 3 * y * y),
            0.75 * root(35) * x * y * (x * x - y * y),
            -0.375 * root(70) * y * z * (3 * x * x - y * y),
            0.75 * root(5) * x * y * (7 * z * z - 1),
            -0.375 * root(10) * y * z * (7 * z * z - 3),
            3.0 / 16 * root(1) * (35 * z * z * z * z - 30 * z * z + 3),
            -0.375 * root(10) * x * z * (7 * z * z - 3),
            0.375 * root(5) * (x * x - y * y) * (7 * z * z - 1),
            -0.375 * root(70) * x * z * (x * x - 3 * y * y),
            3.0 / 16 * root(35) * (x * x * x * x - 6 * x * x * y * y + y * y * y * y)};
}

/// n (n − 1) … (n − count + 1)
long double falling(int n, int count) {
    long double product = 1;
    for (int k = 0; k < count; ++k) product *= n - k;
    return product;
}

/// Y_lm from the definition in long double: the m-th derivative of P_l, term by term from
/// P_l(z) = 2^-l Σ_k (−1)^k C(l, k) C(2l − 2k, l) z^(l − 2k).
long double slowSh(int l, int m, const Vec3d& d) {
    const int order = std::abs(m);
    long double derivative = 0;
    for (int k = 0; 2 * k <= l - order; ++k) {
        const int power = l - 2 * k;
        const long double binomials =
            falling(l, k) / falling(k, k) * (falling(2 * l - 2 * k, l) / falling(l, l));
        const long double term =
            binomials * falling(power, order) * std::pow((long double)d.z(), power - order);
        derivative += k % 2 ? -term : term;
    }
    derivative *= std::pow(2.0L, -l);
    long double ratio = 1;  // (l − m)! / (l + m)!
    for (int k = l - order + 1; k <= l + order; ++k) ratio /= k;
    const long double norm =
        std::sqrt((2 * l + 1) / (4 * std::numbers::pi_v<long double>)*ratio) * (order % 2 ? -1 : 1);
    const long double phi = std::atan2((long double)d.y(), (long double)d.x());
    const long double sinTheta = std::hypot((long double)d.x(), (long double)d.y());
    const long double legendre = norm * std::pow(sinTheta, order) * derivative;
    if (m == 0) return legendre;
    return std::numbers::sqrt2_v<long double> * legendre *
           (m > 0 ? std::cos(order * phi) : std::sin(order * phi));
}

TEST(ShIndex, CountsThroughTheBands) {
    int index = 0;
    for (int l = 0; l < kMaxShOrder; ++l) {
        EXPECT_EQ(index, shCount(l));
        for (int m = -l; m <= l; ++m) EXPECT_EQ(shIndex(l, m), index++);
    }
    for (int n = 1; n <= kMaxShOrder; ++n) EXPECT_EQ(shOrderFromCount(size_t(shCount(n))), n);
    for (const size_t count : {0u, 2u, 3u, 5u, 35u, 37u, 575u, 577u, 625u})
        EXPECT_EQ(shOrderFromCount(count), 0);
}

TEST(Sh, CondonShortleySigns) {
    const double c = std::sqrt(3 / (4 * kPi));
    const Vec3d d(2.0 / 7, 3.0 / 7, 6.0 / 7);
    const std::vector<double> y = evaluate(2, d);
    EXPECT_NEAR(y[0], std::sqrt(1 / (4 * kPi)), 1e-15);
    EXPECT_NEAR(y[1], -c * d.y(), 1e-15);
    EXPECT_NEAR(y[2], c * d.z(), 1e-15);
    EXPECT_NEAR(y[3], -c * d.x(), 1e-15);
    // In the octant of positive coordinates near +X the sign of the highest function is (−1)^m.
    for (int m = 1; m < kMaxShOrder; ++m) {
        const std::vector<double> near = evaluate(kMaxShOrder, Vec3d(std::cos(0.01), std::sin(0.01), 0));
        EXPECT_EQ(near[size_t(shIndex(m, m))] < 0, m % 2 == 1) << m;
        EXPECT_EQ(near[size_t(shIndex(m, -m))] < 0, m % 2 == 1) << m;
    }
}

TEST(Sh, MatchesClosedFormsOfFiveBands) {
    test::RandomInput random(1);
    for (int k = 0; k < 500; ++k) {
        const Vec3d d = random.direction();
        const std::vector<double> y = evaluate(5, d), expected = closedForms(d);
        const Vec3f df = d.cast<float>();
        const std::vector<float> yf = evaluateFloat(5, df);
        const std::vector<double> expectedOfFloat = closedForms(df.cast<double>());
        for (size_t i = 0; i < 25; ++i) {
            EXPECT_NEAR(y[i], expected[i], 2e-15) << i;
            // closed forms use |d| = 1, which a direction in float is to 6e-8; up to l² of that shows
            EXPECT_NEAR(double(yf[i]), expectedOfFloat[i], 3e-6) << i;
        }
    }
}

TEST(Sh, MatchesSlowReferenceToTheLastBand) {
    test::RandomInput random(2);
    std::vector<Vec3d> directions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    directions.push_back(Vec3d(1e-9, -1e-9, 1).normalized());
    for (int k = 0; k < 40; ++k) directions.push_back(random.direction());
    for (const Vec3d& d : directions) {
        const std::vector<double> y = evaluate(kMaxShOrder, d);
        for (int l = 0; l < kMaxShOrder; ++l)
            for (int m = -l; m <= l; ++m)
                // cancellation in the reference: 64 bits against terms of (1 + √2)^l
                EXPECT_NEAR(y[size_t(shIndex(l, m))], double(slowSh(l, m, d)), 2e-10) << l << ' ' << m;
    }
}

TEST(Sh, AtThePolesOnlyZonalFunctionsRemain) {
    for (const double z : {1.0, -1.0}) {
        const std::vector<double> y = evaluate(kMaxShOrder, Vec3d(0, 0, z));
        for (int l = 0; l < kMaxShOrder; ++l)
            for (int m = -l; m <= l; ++m)
                EXPECT_NEAR(y[size_t(shIndex(l, m))], m ? 0 : bandScale(l) * (l % 2 ? z : 1), 1e-13);
    }
}

TEST(Sh, AdditionTheoremHoldsForEveryBand) {
    test::RandomInput random(3);
    for (int k = 0; k < 50; ++k) {
        const Vec3d a = random.direction(), b = random.direction();
        const std::vector<double> ya = evaluate(kMaxShOrder, a), yb = evaluate(kMaxShOrder, b);
        for (int l = 0; l < kMaxShOrder; ++l) {
            double sum = 0;
            for (int m = -l; m <= l; ++m) sum += ya[size_t(shIndex(l, m))] * yb[size_t(shIndex(l, m))];
            EXPECT_NEAR(sum,
                        (2 * l + 1) / (4 * kPi) * std::legendre(unsigned(l), std::clamp(a.dot(b), -1.0, 1.0)),
                        1e-13 * (2 * l + 1));
        }
    }
}

TEST(Sh, FloatIsAccurateAndLowerOrdersArePrefixes) {
    test::RandomInput random(4);
    std::vector<Vec3f> directions;
    for (int k = 0; k < 100; ++k) directions.push_back(random.direction().cast<float>());
    // near the poles, where the slope of a band in z is l (l + 1) / 2 times its height
    for (int k = 1; k < 60; ++k) {
        const Vec3d d(std::pow(10, -0.1 * k), std::pow(10, -0.15 * k), k % 2 ? 1 : -1);
        directions.push_back(d.normalized().cast<float>());
    }
    for (int n = 1; n <= kMaxShOrder; ++n)
        for (const Vec3f& d : directions) {
            const std::vector<float> y = evaluateFloat(n, d);
            const std::vector<double> exact = evaluate(kMaxShOrder, d.cast<double>());
            for (int l = 0; l < n; ++l)
                for (int m = -l; m <= l; ++m) {
                    const size_t i = size_t(shIndex(l, m));
                    ASSERT_NEAR(double(y[i]), exact[i], (l < 10 ? 2e-6 : 8e-6) * bandScale(l))
                        << n << ' ' << l << ' ' << m;
                }
        }
}

TEST(ShBatch, EqualsSingleEvaluationForEveryOrderAndLength) {
    test::RandomInput random(5);
    for (int n = 1; n <= kMaxShOrder; ++n)
        for (const size_t count : {0u, 1u, 3u, 31u, 32u, 33u, 70u}) {
            std::vector<Vec3f> directions;
            for (size_t k = 0; k < count; ++k) directions.push_back(random.direction().cast<float>());
            const size_t width = size_t(shCount(n));
            constexpr float kGuard = 12345;
            std::vector<float> rows(count * width + 1, kGuard);
            evalShBatch(n, directions, std::span(rows).first(count * width));
            EXPECT_EQ(rows.back(), kGuard);
            for (size_t k = 0; k < count; ++k) {
                const std::vector<double> exact = evaluate(n, directions[k].cast<double>());
                for (int l = 0; l < n; ++l)
                    for (size_t i = size_t(l * l); i < size_t((l + 1) * (l + 1)); ++i)
                        ASSERT_NEAR(double(rows[k * width + i]), exact[i], 1e-5 * bandScale(l))
                            << n << ' ' << count;
            }
        }
}

TEST(ShBatch, ADirectionsRowDoesNotDependOnItsNeighbours) {
    const std::vector<Vec3f> directions = sphericalFibonacci(77);
    std::vector<float> all(77 * 36), one(36);
    evalShBatch(6, directions, all);
    for (size_t k = 0; k < directions.size(); ++k) {
        evalShBatch(6, std::span(directions).subspan(k, 1), one);
        EXPECT_TRUE(std::equal(one.begin(), one.end(), all.begin() + ptrdiff_t(36 * k))) << k;
    }
}

TEST(ShSoa, EqualsSingleEvaluationForEveryOrderLengthAndStride) {
    test::RandomInput random(6);
    constexpr float kGuard = 12345;
    for (int n = 1; n <= kMaxShOrder; ++n)
        for (const size_t count : {0u, 1u, 15u, 16u, 17u, 53u})
            for (const size_t gap : {0u, 3u}) {
                std::vector<float> axes[3];
                std::vector<std::vector<double>> exact;
                for (size_t k = 0; k < count; ++k) {
                    const Vec3f d = random.direction().cast<float>();
                    for (int a = 0; a < 3; ++a) axes[a].push_back(d[a]);
                    exact.push_back(evaluate(n, d.cast<double>()));
                }
                const size_t functions = size_t(shCount(n)), stride = count + gap;
                // the gap behind the last row is not asked for
                std::vector<float> out(functions * stride - (count > 0 ? gap : 0), kGuard);
                evalShSoa(n, axes[0], axes[1], axes[2], out, stride);
                for (size_t j = 0; j < out.size(); ++j) {
                    const size_t i = j / stride, k = j % stride;
                    if (k >= count) {
                        ASSERT_EQ(out[j], kGuard) << n << ' ' << count;
                        continue;
                    }
                    const int l = int(std::sqrt(double(i)));
                    ASSERT_NEAR(double(out[j]), exact[k][i], (l < 10 ? 2e-6 : 8e-6) * bandScale(l))
                        << n << ' ' << count;
                }
            }
}

TEST(ShSoa, ADirectionsValuesDoNotDependOnItsPlace) {
    std::vector<float> x, y, z;
    for (const Vec3f& d : sphericalFibonacci(37)) {
        x.push_back(d.x());
        y.push_back(d.y());
        z.push_back(d.z());
    }
    for (const int n : {6, 12}) {
        const size_t functions = size_t(shCount(n));
        std::vector<float> all(functions * 37), one(functions);
        evalShSoa(n, x, y, z, all, 37);
        for (size_t k = 0; k < 37; ++k) {
            evalShSoa(n, std::span(&x[k], 1), std::span(&y[k], 1), std::span(&z[k], 1), one, 1);
            for (size_t i = 0; i < functions; ++i) EXPECT_EQ(one[i], all[i * 37 + k]) << i << ' ' << k;
        }
    }
}

TEST(ShSoaDeathTest, RefusesLengthsThatDoNotFit) {
    const std::vector<float> two(2), three(3);
    std::vector<float> out(12);
    EXPECT_DEATH(evalShSoa(2, three, two, three, out, 3), "2 against 3");
    EXPECT_DEATH(evalShSoa(2, three, three, two, out, 3), "2 against 3");
    EXPECT_DEATH(evalShSoa(2, three, three, three, out, 2), "3 against 2");
    EXPECT_DEATH(evalShSoa(2, three, three, three, std::span(out).first(11), 3), "12 against 11");
    EXPECT_DEATH(evalShSoa(0, three, three, three, out, 3), "1 against 0");
    EXPECT_DEATH(evalShSoa(25, three, three, three, out, 3), "25 against 24");
}

TEST(ShDeathTest, RefusesOrdersOutsideTheRange) {
    std::vector<double> out(1);
    EXPECT_DEATH(evalSh(0, Vec3d(0, 0, 1), std::span<double>(out)), "1 against 0");
    EXPECT_DEATH(evalSh(kMaxShOrder + 1, Vec3d(0, 0, 1), std::span<double>(out)), "25 against 24");
    EXPECT_DEATH(evalSh(2, Vec3d(0, 0, 1), std::span<double>(out)), "1 against 4");
}

TEST(GaussLegendre, IntegratesMonomialsExactly) {
    for (int count = 1; count <= 64; ++count) {
        const std::vector<LineNode> nodes = gaussLegendre(count);
        for (int power = 0; power <= 2 * count - 1; ++power) {
            double sum = 0;
            for (const LineNode& node : nodes) sum += node.weight * std::pow(node.z, power);
            EXPECT_NEAR(sum, power % 2 ? 0 : 2.0 / (power + 1), 1e-13) << count << ' ' << power;
        }
        for (size_t k = 1; k < nodes.size(); ++k) EXPECT_LT(nodes[k - 1].z, nodes[k].z);
    }
}

/// ∫ x^a y^b z^c over the sphere: 4π (a−1)!! (b−1)!! (c−1)!! / (a+b+c+1)!! for even powers.
double monomialIntegral(int a, int b, int c) {
    if (a % 2 || b % 2 || c % 2) return 0;
    const auto oddFactorial = [](int k) {
        double product = 1;
        for (; k > 1; k -= 2) product *= k;
        return product;
    };
    return 4 * kPi * oddFactorial(a - 1) * oddFactorial(b - 1) * oddFactorial(c - 1) /
           oddFactorial(a + b + c + 1);
}

TEST(SphereQuadrature, IntegratesMonomialsUpToItsDegree) {
    for (const int degree : {0, 1, 2, 3, 4, 7, 10, 15, 22}) {
        const std::vector<SphereNode> nodes = sphereQuadrature(degree);
        for (const SphereNode& node : nodes) EXPECT_NEAR(node.direction.norm(), 1, 1e-15);
        for (int a = 0; a <= degree; ++a)
            for (int b = 0; a + b <= degree; ++b)
                for (int c = 0; a + b + c <= degree; ++c) {
                    double sum = 0;
                    for (const SphereNode& node : nodes)
                        sum += node.weightSr * std::pow(node.direction.x(), a) *
                               std::pow(node.direction.y(), b) * std::pow(node.direction.z(), c);
                    EXPECT_NEAR(sum, monomialIntegral(a, b, c), 1e-13) << degree << ": " << a << b << c;
                }
    }
}

TEST(ProjectSh, RecoversExpansionsOfEveryOrder) {
    test::RandomInput random(6);
    for (const int n : {1, 2, 3, 6, 10, 17, 24}) {
        const std::vector<float> c = random.coefficients<float>(shCount(n));
        const std::vector<double> projected = projectSh(
            n, [&](const Vec3d& d) { return evalShExpansion(n, c, d); }, 2 * (n - 1));
        for (size_t i = 0; i < c.size(); ++i) EXPECT_NEAR(projected[i], double(c[i]), 1e-12) << n << ' ' << i;
    }
}

TEST(ProjectSh, OfAZonalLobeFollowsFunkHecke) {
    // exp(k (n·ω − 1)) has bands 2π ∫ e^{k(z−1)} P_l(z) dz about n.
    const Vec3d axis = Vec3d(1, -2, 0.5).normalized();
    const double k = 6;
    const std::vector<double> c =
        projectSh(10, [&](const Vec3d& d) { return std::exp(k * (axis.dot(d) - 1)); });
    const std::vector<double> y = evaluate(10, axis);
    const std::vector<LineNode> line = gaussLegendre(60);
    for (int l = 0; l < 10; ++l) {
        double band = 0;
        for (const LineNode& node : line)
            band += 2 * kPi * node.weight * std::exp(k * (node.z - 1)) * std::legendre(unsigned(l), node.z);
        for (int m = -l; m <= l; ++m)
            EXPECT_NEAR(c[size_t(shIndex(l, m))], band * y[size_t(shIndex(l, m))], 1e-13) << l << ' ' << m;
    }
}

TEST(ProjectShSamples, IsThePlainSum) {
    test::RandomInput random(7);
    for (const int n : {1, 4, 10, 12}) {
        const std::vector<Vec3f> directions = randomDirections(1000, 9);
        const std::vector<float> values = random.coefficients<float>(1000);
        const std::vector<float> c = projectShSamples(n, directions, values);
        std::vector<double> expected(size_t(shCount(n)), 0.0);
        for (size_t k = 0; k < directions.size(); ++k) {
            const std::vector<double> y = evaluate(n, directions[k].cast<double>());
            for (size_t i = 0; i < y.size(); ++i) expected[i] += 4 * kPi / 1000 * double(values[k]) * y[i];
        }
        ASSERT_EQ(c.size(), expected.size());
        for (size_t i = 0; i < c.size(); ++i) EXPECT_NEAR(double(c[i]), expected[i], 2e-5) << n;
    }
}

TEST(ProjectShSamples, ConvergesToTheProjection) {
    const std::vector<Vec3f> directions = sphericalFibonacci(20000);
    test::RandomInput random(8);
    const std::vector<float> c = random.coefficients<float>(36);
    std::vector<float> values;
    for (const Vec3f& d : directions) values.push_back(float(evalShExpansion(6, c, d.cast<double>())));
    const std::vector<float> projected = projectShSamples(6, directions, values);
    for (size_t i = 0; i < c.size(); ++i) EXPECT_NEAR(projected[i], c[i], 1e-4f);
}

TEST(ProjectShSamples, RefusesNoDirections) { EXPECT_THROW(projectShSamples(3, {}, {}), InputError); }

}  // namespace
}  // namespace prt
