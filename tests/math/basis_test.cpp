// Bases by name, what the papers say of them and of each other, and how misuse ends.
#include "precompute/math/basis.h"

#include <cmath>
#include <numbers>

#include "precompute/base/error.h"
#include "precompute/math/sh.h"
#include "tests/math/basis_reference.h"

namespace prt {
namespace {

using std::numbers::pi;
using test::evaluate;

double signal(const Vec3d& d) { return std::exp(d.x() - 0.6 * d.y() + 0.3 * d.z()) / (1.4 + d.x() * d.z()); }

double leastSquaresError(const Basis& basis) {
    const std::vector<double> c = basis.project(signal);
    double error = 0;
    for (const DomainNode& node : domainQuadrature(basis.domain(), 60))
        error += node.weightSr * std::pow(signal(node.direction) - basis.evalExpansion(c, node.direction), 2);
    return error;
}

TEST(MakeBasis, KnowsAllFamilies) {
    ASSERT_EQ(basisFamilies().size(), 8u);
    for (const BasisFamily& family : basisFamilies()) {
        EXPECT_FALSE(family.title.empty());
        EXPECT_EQ(makeBasis(family.name, family.minOrder)->name(), family.name);
        EXPECT_EQ(makeBasis(family.name, family.maxOrder)->order(), family.maxOrder);
        EXPECT_THROW(makeBasis(family.name, family.minOrder - 1), InputError);
        EXPECT_THROW(makeBasis(family.name, family.maxOrder + 1), InputError);
    }
    for (const int order : {0, 2}) EXPECT_EQ(makeBasis("h4", order)->count(), 4);
    for (const int order : {0, 3}) EXPECT_EQ(makeBasis("h6", order)->count(), 6);
    EXPECT_THROW(makeBasis("h4", 3), InputError);
    EXPECT_THROW(makeBasis("h6", 2), InputError);
    try {
        makeBasis("hhh", 3);
        FAIL();
    } catch (const InputError& e) {
        EXPECT_THAT(e.what(), ::testing::HasSubstr("hhh"));
        EXPECT_THAT(e.what(), ::testing::HasSubstr("makhotkin"));
    }
}

TEST(Basis, AgreesWithThePapersInLowOrders) {
    for (const BasisFamily& family : basisFamilies())
        for (int order = family.minOrder; order <= std::min(family.maxOrder, 4); ++order) {
            const std::unique_ptr<Basis> basis = makeBasis(family.name, order);
            for (const Vec3d& d : test::probeDirections(basis->domain(), 5)) {
                const std::vector<double> values = evaluate(*basis, d);
                const std::vector<double> expected = test::slowBasis(family.name, order, d);
                ASSERT_EQ(values.size(), expected.size());
                for (size_t i = 0; i < values.size(); ++i)
                    EXPECT_NEAR(values[i], expected[i], 1e-12) << family.name << order << ' ' << i;
            }
        }
}

TEST(Basis, GradientsOfLinearFunctionsAreTheirCoefficients) {
    const double a = std::sqrt(3 / (2 * pi));
    const std::unique_ptr<Basis> h = makeBasis("h", 2);
    for (const Vec3d& d : test::probeDirections(h->domain(), 10)) {
        std::vector<Vec3d> gradient(4);
        h->evalGradient(d, gradient);
        const auto tangent = [&](const Vec3d& v) -> Vec3d { return v - v.dot(d) * d; };
        EXPECT_LT(gradient[0].norm(), 1e-15);
        EXPECT_LT((gradient[1] - tangent({0, -a, 0})).norm(), 1e-15);
        EXPECT_LT((gradient[2] - tangent({0, 0, 2 * a})).norm(), 1e-15);
        EXPECT_LT((gradient[3] - tangent({-a, 0, 0})).norm(), 1e-15);
    }
}

TEST(HBasis, SharesFunctionsWithOthers) {
    const std::unique_ptr<Basis> h = makeBasis("h6", 3), sh = makeBasis("sh", 3), hsh = makeBasis("hsh", 2),
                                 zernike = makeBasis("zernike", 3);
    for (const Vec3d& d : test::probeDirections(h->domain(), 10)) {
        const std::vector<double> values = evaluate(*h, d), y = evaluate(*sh, d);
        EXPECT_NEAR(values[1], std::numbers::sqrt2 * y[1], 1e-15);
        EXPECT_NEAR(values[2], evaluate(*hsh, d)[2], 1e-14);
        EXPECT_NEAR(values[2], -evaluate(*zernike, d)[4], 1e-14);  // "the negative", Sec. 4
        EXPECT_NEAR(values[3], std::numbers::sqrt2 * y[3], 1e-15);
        EXPECT_NEAR(values[4], std::numbers::sqrt2 * y[4], 1e-15);
        EXPECT_NEAR(values[5], std::numbers::sqrt2 * y[8], 1e-15);
    }
}

TEST(HBasis, FourFunctionsFitAsLinearHarmonicsDo) {
    // [HabelWimmer2010, Sec. 4]: least-squares linear SH have the error of H4
    const double h4 = leastSquaresError(*makeBasis("h", 2));
    EXPECT_NEAR(h4, leastSquaresError(*makeBasis("lsosh", 2)), 1e-12);
    EXPECT_GT(h4, 0.01);
    EXPECT_LT(leastSquaresError(*makeBasis("h", 3)), 0.9 * h4);
}

TEST(HalfLife2, IsDirectionalOcclusion) {
    const std::unique_ptr<Basis> hl2 = makeBasis("hl2", 2);
    test::RandomInput random(41);
    for (int k = 0; k < 10; ++k) {
        const std::vector<double> c = random.coefficients<double>(3);
        const Vec3d o = directionalOcclusionVector(c);
        for (const Vec3d& d : test::probeDirections(hl2->domain(), 10))
            EXPECT_NEAR(hl2->evalExpansion(c, d), o.dot(d), 1e-15);
        // and every vector is one: the coefficients of E = v·ω give v back
        const Vec3d v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        const std::vector<double> back = hl2->project([&](const Vec3d& d) { return v.dot(d); }, 4);
        EXPECT_LT((directionalOcclusionVector(back) - v).norm(), 1e-14);
    }
}

TEST(Esh, IsTheMirroredFunctionInSphericalHarmonics) {
    constexpr int kOrder = 5;
    const std::unique_ptr<Basis> esh = makeBasis("esh", kOrder), sh = makeBasis("sh", kOrder);
    const std::vector<double> c = esh->project(signal);
    const std::vector<double> stored = eshToShCoefficients(kOrder, c);
    ASSERT_EQ(stored.size(), 25u);
    // the mirrored function has a kink at the horizon, which the hemisphere's quadrature does not see
    std::vector<double> expected(25, 0.0);
    for (const DomainNode& node : domainQuadrature(BasisDomain::UpperHemisphere, 80)) {
        Vec3d below = node.direction;
        below.z() = -below.z();
        const std::vector<double> up = evaluate(*sh, node.direction), down = evaluate(*sh, below);
        for (size_t i = 0; i < 25; ++i)
            expected[i] += node.weightSr * signal(node.direction) * (up[i] + down[i]);
    }
    for (size_t i = 0; i < 25; ++i) EXPECT_NEAR(stored[i], expected[i], 1e-13) << i;
    for (int l = 0; l < kOrder; ++l)
        for (int m = -l; m <= l; ++m) EXPECT_EQ(stored[size_t(shIndex(l, m))] == 0, (l + m) % 2 != 0);
    for (const Vec3d& d : test::probeDirections(esh->domain(), 10)) {
        Vec3d below = d;
        below.z() = -below.z();
        EXPECT_NEAR(sh->evalExpansion(stored, d), esh->evalExpansion(c, d), 1e-13);
        EXPECT_NEAR(sh->evalExpansion(stored, below), esh->evalExpansion(c, d), 1e-13);
    }
}

TEST(EshAndLsosh, DottedWithAnEnvironmentSeeLightFromBelow) {
    // A reflectance of 1 above the horizon under the light L = z: ∫_{z≥0} 1·z dω = π, but the representations
    // say 1 below too, where as much is taken away [Gautron2004, Sec. 2, 6.1].
    const auto one = [](const Vec3d&) { return 1.0; };
    const std::unique_ptr<Basis> sh = makeBasis("sh", 2);
    const std::vector<double> light = sh->project([](const Vec3d& d) { return d.z(); });
    const auto lit = [&](const std::vector<double>& c) {
        double sum = 0;
        for (size_t i = 0; i < c.size(); ++i) sum += c[i] * light[i];
        return sum;
    };
    std::vector<double> truth(4, 0.0);
    for (const DomainNode& node : domainQuadrature(BasisDomain::UpperHemisphere, 4))
        for (size_t i = 0; i < 4; ++i) truth[i] += node.weightSr * evaluate(*sh, node.direction)[i];
    EXPECT_NEAR(lit(truth), pi, 1e-13);
    EXPECT_NEAR(lit(eshToShCoefficients(2, makeBasis("esh", 2)->project(one))), 0, 1e-13);
    EXPECT_NEAR(lit(makeBasis("lsosh", 2)->project(one)), 0, 1e-12);
}

TEST(Lsosh, GramIsHalfOfUnityAmongFunctionsOfOneParity) {
    const std::unique_ptr<Basis> basis = makeBasis("lsosh", 6);
    const std::vector<double> gram = basis->gram();
    double same = 0, mixed = 0;
    for (int l = 0; l < 6; ++l)
        for (int m = -l; m <= l; ++m)
            for (int k = 0; k < 6; ++k)
                for (int q = -k; q <= k; ++q) {
                    const double g = gram[size_t(shIndex(l, m) * 36 + shIndex(k, q))];
                    const bool sameParity = (l + m + k + q) % 2 == 0;
                    double& worst = sameParity ? same : mixed;
                    worst = std::max(worst, std::abs(g - (l == k && m == q ? 0.5 : 0)));
                }
    EXPECT_LT(same, 1e-14);
    EXPECT_GT(mixed, 0.4);
}

TEST(Lsosh, FitsBetterThanProjectionContinuedByZero) {
    const std::unique_ptr<Basis> lsosh = makeBasis("lsosh", 3), sh = makeBasis("sh", 3);
    std::vector<double> plain(9, 0.0);
    for (const DomainNode& node : domainQuadrature(BasisDomain::UpperHemisphere, 80))
        for (size_t i = 0; i < 9; ++i)
            plain[i] += node.weightSr * signal(node.direction) * evaluate(*sh, node.direction)[i];
    double plainError = 0;
    for (const DomainNode& node : domainQuadrature(BasisDomain::UpperHemisphere, 60))
        plainError +=
            node.weightSr * std::pow(signal(node.direction) - sh->evalExpansion(plain, node.direction), 2);
    EXPECT_LT(leastSquaresError(*lsosh), 0.05 * plainError);
}

TEST(Lsosh, HighOrdersKeepCoefficientsBounded) {
    // a kink has parts in every combination of functions, however small that is over the hemisphere
    const auto kink = [](const Vec3d& d) { return std::abs(d.x() - 0.3); };
    for (const int order : {12, 13, 17, 24}) {
        const std::unique_ptr<Basis> basis = makeBasis("lsosh", order);
        const std::vector<double> c = basis->project(kink);
        double largest = 0;
        for (const double value : c) largest = std::max(largest, std::abs(value));
        EXPECT_LT(largest, 1e6) << order;
        for (const double phi : {0.3, 1.2, 4.0}) {
            const Vec3d d = test::directionOf(0.6, phi);
            EXPECT_NEAR(basis->evalExpansion(c, d), kink(d), 0.1) << order;
        }
    }
}

/// d^m/dz^m P_l^(0, 1)(2z − 1), from (−1)^l (l + 1) Σ_k (−l)_k (l + 2)_k / ((2)_k k!) z^k.
long double derivativeOfJacobi(int l, int m, long double z) {
    long double sum = 0, factor = (l % 2 ? -1 : 1) * (l + 1);
    for (int k = 0; k <= l; ++k) {
        if (k >= m) sum += factor * test::factorial(k) / test::factorial(k - m) * std::pow(z, k - m);
        factor *= (long double)(k - l) * (l + 2 + k) / ((2.0L + k) * (k + 1));
    }
    return sum;
}

TEST(Makhotkin, FunctionsAreAssociatedToShiftedJacobiPolynomials) {
    constexpr int kOrder = 9;
    const std::unique_ptr<Basis> basis = makeBasis("makhotkin", kOrder);
    const std::vector<double> values = evaluate(*basis, test::directionOf(0.3, 0));
    const std::vector<double> others = evaluate(*basis, test::directionOf(0.8, 0));
    for (int l = 0; l < kOrder; ++l)
        for (int m = 0; m <= l; ++m) {
            const auto shape = [&](long double z) {
                return std::pow(z * (1 - z), m / 2.0L) * derivativeOfJacobi(l, m, z);
            };
            const size_t i = size_t(shIndex(l, m));
            EXPECT_NEAR(double(values[i] * shape(0.8L)), double(others[i] * shape(0.3L)),
                        1e-13 * double(std::abs(shape(0.8L)) + std::abs(shape(0.3L))))
                << l << ' ' << m;
        }
}

TEST(Makhotkin, FirstCoefficientIsIrradiance) {
    const std::unique_ptr<Basis> basis = makeBasis("makhotkin", 3);
    double irradiance = 0;
    for (const DomainNode& node : domainQuadrature(BasisDomain::UpperHemisphere, 80))
        irradiance += node.weightSr * node.direction.z() * signal(node.direction);
    EXPECT_NEAR(basis->project(signal)[0] * std::sqrt(pi), irradiance, 1e-13);
}

TEST(DomainQuadrature, IntegratesMonomials) {
    // ∫_{z≥0} x^2a y^2b z^(c/2) dω = 2 B(a + ½, b + ½) ∫ (1 − z²)^(a+b) z^(c/2) dz
    for (const int degree : {0, 3, 8, 21}) {
        const std::vector<DomainNode> nodes = domainQuadrature(BasisDomain::UpperHemisphere, degree);
        for (int a = 0; 2 * a <= degree; ++a)
            for (int b = 0; 2 * (a + b) <= degree; ++b)
                for (int c = 0; 2 * (a + b) + c <= degree; ++c) {
                    double sum = 0;
                    for (const DomainNode& node : nodes)
                        sum += node.weightSr * std::pow(node.direction.x(), 2 * a) *
                               std::pow(node.direction.y(), 2 * b) * std::pow(node.direction.z(), c / 2.0);
                    const double expected =
                        std::beta(a + 0.5, b + 0.5) * std::beta(a + b + 1.0, (c / 2.0 + 1) / 2);
                    EXPECT_NEAR(sum, expected, 1e-13) << degree << ": " << a << ' ' << b << ' ' << c;
                }
    }
    double sum = 0;
    for (const DomainNode& node : domainQuadrature(BasisDomain::Sphere, 9)) sum += node.weightSr;
    EXPECT_NEAR(sum, 4 * pi, 1e-13);
}

TEST(Basis, DirectionsJustBelowTheRimCountAsOnIt) {
    for (const BasisFamily& family : basisFamilies()) {
        const std::unique_ptr<Basis> basis = makeBasis(family.name, family.maxOrder);
        const std::vector<double> on = evaluate(*basis, {0.6, 0.8, 0});
        const std::vector<double> below = evaluate(*basis, {0.6, 0.8, -1e-7});
        for (size_t i = 0; i < on.size(); ++i) EXPECT_NEAR(below[i], on[i], 1e-3) << family.name;
    }
}

TEST(BasisDeath, WrongSizesAndDirectionsAbort) {
    const std::unique_ptr<Basis> basis = makeBasis("hsh", 3);
    std::vector<double> nine(9), eight(8);
    std::vector<Vec3d> eightVectors(8);
    const std::vector<Vec3d> directions(10, Vec3d(0, 0, 1));
    const Vec3d up(0, 0, 1), down(0, 0, -1);
    EXPECT_DEATH(basis->eval(up, eight), "");
    EXPECT_DEATH(basis->eval(down, nine), "");
    EXPECT_DEATH(basis->evalGradient(up, eightVectors), "");
    EXPECT_DEATH(basis->evalExpansion(eight, up), "");
    EXPECT_DEATH(basis->projectSamples(directions, nine), "");
    EXPECT_DEATH(basis->fitSamples(directions, nine), "");
    EXPECT_DEATH(basis->project(signal, -1), "");
    EXPECT_DEATH(eshToShCoefficients(3, eight), "");
    EXPECT_DEATH(directionalOcclusionVector(eight), "");
}

}  // namespace
}  // namespace prt
