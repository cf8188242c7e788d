// One battery over every basis: orthonormality, what it spans, projection and least squares, evaluation
// against the papers' formulas, derivatives.
#include "precompute/math/basis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "precompute/base/error.h"
#include "tests/math/basis_reference.h"

namespace prt {
namespace {

using test::evaluate;

struct Case {
    std::string family;
    int order;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.family << ' ' << c.order; }

template <typename Keep>
std::vector<Case> casesWhere(const Keep& keep) {
    std::vector<Case> cases;
    for (const BasisFamily& family : basisFamilies())
        for (const int order : {1, 2, 3, 4, 6, 9, 12, 17, 24})
            if (order >= family.minOrder && order <= family.maxOrder && keep(Case{family.name, order}))
                cases.push_back({family.name, order});
    return cases;
}

class BasisBattery : public ::testing::TestWithParam<Case> {
  protected:
    BasisBattery() : basis_(makeBasis(GetParam().family, GetParam().order)) {}

    bool is(const char* family) const { return basis_->name() == family; }
    bool hemisphericalHarmonics() const { return is("hsh") || is("makhotkin"); }
    int order() const { return basis_->order(); }

    /// Unit directions of the domain, a few of them for high orders.
    std::vector<Vec3d> probes() const {
        return test::probeDirections(basis_->domain(), order() > 9 ? 6 : 40);
    }

    /// Lengths in which the basis spans the polynomials up to a degree.
    std::array<double, 3> coordinates(const Vec3d& d) const {
        if (is("zernike")) {
            const double s = 1 / std::sqrt(1 + d.z());
            return {d.x() * s, d.y() * s, 0};
        }
        if (hemisphericalHarmonics()) {
            const double s = 2 * std::sqrt(d.z() / (1 + d.z()));
            return {d.x() * s, d.y() * s, 2 * d.z() - 1};
        }
        return {d.x(), d.y(), is("esh") ? 0 : d.z()};
    }
    /// A random polynomial of the span: all x^a y^b z^c in coordinates() with a + b + c < n.
    DirectionFunction randomMember(uint64_t seed) const {
        test::RandomInput random(seed);
        if (is("h") || is("hl2")) {
            const std::vector<double> c = random.coefficients<double>(6);
            const bool constant = is("h"), quadratic = order() == 3;
            return [=](const Vec3d& d) {
                return constant * c[0] + c[1] * d.x() + c[2] * d.y() + c[3] * d.z() +
                       quadratic * (c[4] * d.x() * d.y() + c[5] * (d.x() * d.x() - d.y() * d.y()));
            };
        }
        struct Term {
            int a, b, c;
            double factor;
        };
        std::vector<Term> terms;
        for (int a = 0; a < order(); ++a)
            for (int b = 0; a + b < order(); ++b)
                for (int c = 0; a + b + c < order(); ++c) terms.push_back({a, b, c, random.uniform(-1, 1)});
        return [terms, this](const Vec3d& d) {
            const std::array<double, 3> x = coordinates(d);
            double power[3][kMaxOrder], sum = 0;
            for (int axis = 0; axis < 3; ++axis) {
                power[axis][0] = 1;
                for (int k = 1; k < order(); ++k) power[axis][k] = power[axis][k - 1] * x[size_t(axis)];
            }
            for (const Term& t : terms) sum += t.factor * power[0][t.a] * power[1][t.b] * power[2][t.c];
            return sum;
        };
    }
    /// By how much coefficients of the dual functions magnify rounding: 4·5.65^(n − 2) for LSOSH.
    double amplification() const { return is("lsosh") ? std::max(1.0, 4 * std::pow(5.65, order() - 2)) : 1; }

    static constexpr int kMaxOrder = 24;
    std::unique_ptr<Basis> basis_;
};

/// Those whose duals are all kept.
class CompleteBasisBattery : public BasisBattery {};
/// For properties of which high orders say nothing new, slowly.
class LowOrderBasisBattery : public BasisBattery {};
class HemisphericalHarmonicsBattery : public BasisBattery {};

/// Smooth over the sphere, in no span, with a kink for the hemisphere's bases at most on the rim.
double smoothSignal(const Vec3d& d) {
    return std::exp(0.8 * d.x() - 0.5 * d.y() + d.z()) / (1.5 + d.x() * d.z());
}

TEST_P(BasisBattery, CountsItsFunctions) {
    const int n = order();
    const int expected = is("h")                      ? 2 * n
                         : is("hl2")                  ? 3
                         : is("esh") || is("zernike") ? n * (n + 1) / 2
                                                      : n * n;
    EXPECT_EQ(basis_->count(), expected);
    EXPECT_EQ(basis_->name(), GetParam().family);
    EXPECT_EQ(n, GetParam().order);
    EXPECT_EQ(basis_->domain(), is("sh") ? BasisDomain::Sphere : BasisDomain::UpperHemisphere);
    EXPECT_NEAR(basis_->domainSr(), (is("sh") ? 4 : 2) * std::numbers::pi, 1e-15);
    EXPECT_EQ(basis_->orthonormal(), !is("lsosh"));
}

TEST_P(BasisBattery, IsOrthonormalWhereItClaims) {
    const std::vector<double> gram = basis_->gram();
    const size_t count = size_t(basis_->count());
    ASSERT_EQ(gram.size(), count * count);
    double worst = 0;
    for (size_t i = 0; i < count; ++i)
        for (size_t j = 0; j < count; ++j)
            worst = std::max(worst, std::abs(gram[i * count + j] - (i == j ? 1 : 0)));
    EXPECT_EQ(worst < 1e-12, basis_->orthonormal()) << worst;
}

TEST_P(BasisBattery, EvaluatesAsThePapersWriteIt) {
    // the sum of factorials of Zernike's polynomials cancels to 1e-10 of long double's 1e-19 at order 24
    const double tolerance = is("zernike") && order() > 12 ? 1e-9 : 1e-12;
    for (const Vec3d& d : probes()) {
        const std::vector<double> expected = test::slowBasis(GetParam().family, order(), d);
        const std::vector<double> values = evaluate(*basis_, d);
        ASSERT_EQ(values.size(), expected.size());
        for (size_t i = 0; i < values.size(); ++i)
            ASSERT_NEAR(values[i], expected[i], tolerance * order()) << i << " at " << d.transpose();
    }
}

TEST_P(BasisBattery, ReproducesWhatItSpans) {
    const DirectionFunction f = randomMember(5);
    const std::vector<double> c = basis_->project(f, 2 * order() + 40);
    // the truncated solution of LSOSH beyond order 12 is good to 1e-8 of its coefficients
    const double tolerance = is("lsosh") && order() > 12 ? 1e-5 : 1e-10;
    double scale = 1;
    for (const Vec3d& d : probes()) scale = std::max(scale, std::abs(f(d)));
    for (const Vec3d& d : probes())
        ASSERT_NEAR(basis_->evalExpansion(c, d), f(d), tolerance * scale) << d.transpose();
}

TEST_P(CompleteBasisBattery, MembersProjectToUnitVectors) {
    const size_t count = size_t(basis_->count());
    const size_t step = count > 60 ? count / 7 : 1;
    for (size_t k = 0; k < count; k += step) {
        std::vector<double> values(count);
        const std::vector<double> c = basis_->project(
            [&](const Vec3d& d) {
                basis_->eval(d, values);
                return values[k];
            },
            2 * order());
        for (size_t i = 0; i < count; ++i)
            ASSERT_NEAR(c[i], i == k ? 1 : 0, 1e-14 * order() * amplification()) << i << ' ' << k;
    }
}

TEST_P(BasisBattery, ProjectionIsTheLeastSquaresFit) {
    // nothing of the remainder is left in the space: ∫ weight (f − Σ c B) B_i = 0
    const std::vector<double> c = basis_->project(smoothSignal);
    std::vector<double> remainder(c.size(), 0.0);
    for (const DomainNode& node : domainQuadrature(basis_->domain(), 127)) {
        const std::vector<double> values = evaluate(*basis_, node.direction);
        double left = smoothSignal(node.direction);
        for (size_t i = 0; i < c.size(); ++i) left -= c[i] * values[i];
        for (size_t i = 0; i < c.size(); ++i)
            remainder[i] += node.weightSr * basis_->weight(node.direction) * left * values[i];
    }
    const double tolerance = is("lsosh") ? 1e-8 : 1e-12;
    for (const double r : remainder) ASSERT_NEAR(r, 0, tolerance);
}

TEST_P(LowOrderBasisBattery, SamplesConvergeToTheProjection) {
    const std::vector<double> exact = basis_->project(smoothSignal);
    double before = std::numeric_limits<double>::infinity();
    for (const int samples : {1000, 30000}) {
        const std::vector<Vec3d> directions = test::evenDirections(basis_->domain(), samples);
        std::vector<double> values;
        for (const Vec3d& d : directions) values.push_back(smoothSignal(d));
        const std::vector<double> c = basis_->projectSamples(directions, values);
        // compared as functions: the coefficients of LSOSH say little alone
        double worst = 0;
        for (const Vec3d& d : probes())
            worst = std::max(worst, std::abs(basis_->evalExpansion(c, d) - basis_->evalExpansion(exact, d)));
        EXPECT_LT(worst, before / 5);
        before = worst;
    }
    EXPECT_LT(before, 0.01);
}

TEST_P(BasisBattery, FitsItsMembersExactly) {
    const DirectionFunction f = randomMember(6);
    const int samples = 3 * basis_->count() + 20;
    const std::vector<Vec3d> directions = test::evenDirections(basis_->domain(), samples);
    std::vector<double> values;
    double scale = 1;
    for (const Vec3d& d : directions) {
        values.push_back(f(d));
        scale = std::max(scale, std::abs(values.back()));
    }
    const std::vector<double> c = basis_->fitSamples(directions, values);
    // the normal equations leave out what is below 1e-6 of the strongest function over the samples
    const double tolerance = is("lsosh") && order() > 6 ? 1e-4 : 1e-9;
    for (size_t k = 0; k < directions.size(); k += 1 + directions.size() / 50)
        ASSERT_NEAR(basis_->evalExpansion(c, directions[k]), values[k], tolerance * scale);
}

TEST_P(LowOrderBasisBattery, FitOfManySamplesIsTheProjection) {
    const std::vector<Vec3d> directions = test::evenDirections(basis_->domain(), 20000);
    std::vector<double> values;
    for (const Vec3d& d : directions) values.push_back(smoothSignal(d));
    const std::vector<double> fitted = basis_->fitSamples(directions, values);
    // Makhotkin's projection is the fit with another weight; hemispherical harmonics span the same functions
    const std::unique_ptr<Basis> peer = makeBasis(is("makhotkin") ? "hsh" : GetParam().family, order());
    const std::vector<double> projected = peer->project(smoothSignal);
    for (const Vec3d& d : probes())
        EXPECT_NEAR(basis_->evalExpansion(fitted, d), peer->evalExpansion(projected, d), 5e-3)
            << d.transpose();
}

TEST_P(BasisBattery, InterpolatedCoefficientsGiveInterpolatedValues) {
    test::RandomInput random(7);
    const std::vector<double> a = random.coefficients<double>(basis_->count());
    const std::vector<double> b = random.coefficients<double>(basis_->count());
    for (const Vec3d& d : probes())
        for (const double t : {0.0, 0.25, 0.9}) {
            std::vector<double> mixed;
            for (size_t i = 0; i < a.size(); ++i) mixed.push_back((1 - t) * a[i] + t * b[i]);
            ASSERT_NEAR(basis_->evalExpansion(mixed, d),
                        (1 - t) * basis_->evalExpansion(a, d) + t * basis_->evalExpansion(b, d),
                        1e-13 * basis_->count());
        }
}

/// Two unit tangents; on the rim the first runs along it and the second upwards.
std::array<Vec3d, 2> tangentsOf(const Vec3d& d) {
    const Vec3d side = std::abs(d.z()) > 0.9 ? Vec3d(1, 0, 0) : Vec3d(0, 0, 1);
    const Vec3d along = side.cross(d).normalized();
    return {along, d.cross(along)};
}

/// Values along the great circle from d.
std::vector<double> valuesAt(const Basis& basis, const Vec3d& d, const Vec3d& tangent, double angle) {
    return evaluate(basis, std::cos(angle) * d + std::sin(angle) * tangent);
}

TEST_P(BasisBattery, GradientsAreDifferenceQuotients) {
    constexpr double kStep = 2e-5;
    const double tolerance = 1e-8 * order() * order();
    std::vector<Vec3d> gradient(size_t(basis_->count()));
    for (const Vec3d& d : probes()) {
        // near the rim see the tests of it below
        if (hemisphericalHarmonics() && d.z() < 0.1) continue;
        basis_->evalGradient(d, gradient);
        const bool oneSided = basis_->domain() == BasisDomain::UpperHemisphere && d.z() < 1e-3;
        for (const Vec3d& t : tangentsOf(d)) {
            std::vector<std::vector<double>> f;
            for (int k = 0; k < 5; ++k) f.push_back(valuesAt(*basis_, d, t, kStep * (oneSided ? k : k - 2)));
            for (size_t i = 0; i < gradient.size(); ++i) {
                const double slope =
                    oneSided ? (-25 * f[0][i] + 48 * f[1][i] - 36 * f[2][i] + 16 * f[3][i] - 3 * f[4][i])
                             : f[0][i] - 8 * f[1][i] + 8 * f[3][i] - f[4][i];
                ASSERT_NEAR(gradient[i].dot(t), slope / (12 * kStep), tolerance)
                    << i << " at " << d.transpose() << " along " << t.transpose();
                ASSERT_NEAR(gradient[i].dot(d), 0, 1e-12 * order() * order());
            }
        }
    }
}

TEST_P(HemisphericalHarmonicsBattery, GradientsOnTheRim) {
    std::vector<Vec3d> gradient(size_t(basis_->count()));
    for (const double phi : {0.7, -2.0, 3.0}) {
        const Vec3d d = test::directionOf(0, phi), up(0, 0, 1), along(-d.y(), d.x(), 0);
        basis_->evalGradient(d, gradient);
        const std::vector<double> here = evaluate(*basis_, d);
        const std::vector<double> far = valuesAt(*basis_, d, up, 1e-8),
                                  near = valuesAt(*basis_, d, up, 1e-10);
        for (int l = 0; l < order(); ++l)
            for (int m = -l; m <= l; ++m) {
                const size_t i = size_t(l * (l + 1) + m);
                const double farSlope = (far[i] - here[i]) / 1e-8, nearSlope = (near[i] - here[i]) / 1e-10;
                if (std::abs(m) == 1) {
                    // as √z: the slope grows tenfold where z falls a hundredfold
                    EXPECT_NEAR(nearSlope / farSlope, 10, 1e-3) << l << ' ' << m;
                    EXPECT_EQ(gradient[i].z(),
                              std::copysign(std::numeric_limits<double>::infinity(), farSlope));
                    EXPECT_EQ(gradient[i].x(), 0);
                    EXPECT_EQ(gradient[i].y(), 0);
                    continue;
                }
                // what is missing falls as √z at least
                const double slope = gradient[i].dot(up);
                EXPECT_LE(std::abs(nearSlope - slope), 0.11 * std::abs(farSlope - slope) + 5e-4 * order())
                    << l << ' ' << m;
                EXPECT_NEAR(gradient[i].dot(along), 0, 1e-12);  // 0 or constant all along the rim
            }
    }
}

TEST_P(HemisphericalHarmonicsBattery, GradientsNearTheRimGrow) {
    std::vector<Vec3d> gradient(size_t(basis_->count()));
    for (const double z : {1e-6, 1e-3, 0.05}) {
        const Vec3d d = test::directionOf(z, 0.9);
        const double step = 0.01 * z;  // √z is smooth over a hundredth of z: 1e-8 of the slope is lost
        basis_->evalGradient(d, gradient);
        for (const Vec3d& t : tangentsOf(d)) {
            const std::vector<double> a = valuesAt(*basis_, d, t, -2 * step),
                                      b = valuesAt(*basis_, d, t, -step), e = valuesAt(*basis_, d, t, step),
                                      f = valuesAt(*basis_, d, t, 2 * step);
            for (size_t i = 0; i < gradient.size(); ++i)
                ASSERT_NEAR(gradient[i].dot(t), (a[i] - 8 * b[i] + 8 * e[i] - f[i]) / (12 * step),
                            1e-7 * order() * order() / std::sqrt(z))
                    << i << " at z = " << z;
        }
    }
}

TEST_P(HemisphericalHarmonicsBattery, AreConstantOnTheRim) {
    const std::vector<double> first = evaluate(*basis_, {1, 0, 0});
    for (const double phi : {0.4, 1.0, 2.2, 3.9, 5.5}) {
        const std::vector<double> values = evaluate(*basis_, test::directionOf(0, phi));
        for (int l = 0; l < order(); ++l)
            for (int m = -l; m <= l; ++m) {
                const size_t i = size_t(l * (l + 1) + m);
                EXPECT_EQ(values[i], m == 0 ? first[i] : 0) << l << ' ' << m;
                EXPECT_EQ(std::abs(values[i]) > 0.3, m == 0) << l;
            }
    }
}

TEST_P(BasisBattery, RejectsTooFewSamples) {
    const std::vector<Vec3d> directions = test::evenDirections(basis_->domain(), basis_->count() - 1);
    const std::vector<double> values(directions.size(), 1.0);
    EXPECT_THROW(basis_->fitSamples(directions, values), InputError);
    EXPECT_THROW(basis_->projectSamples({}, {}), InputError);
}

std::string nameOf(const ::testing::TestParamInfo<Case>& c) {
    return c.param.family + std::to_string(c.param.order);
}
INSTANTIATE_TEST_SUITE_P(Families, BasisBattery,
                         ::testing::ValuesIn(casesWhere([](const Case&) { return true; })), nameOf);
INSTANTIATE_TEST_SUITE_P(Families, CompleteBasisBattery, ::testing::ValuesIn(casesWhere([](const Case& c) {
                             return c.family != "lsosh" || c.order <= 12;
                         })),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Families, LowOrderBasisBattery,
                         ::testing::ValuesIn(casesWhere([](const Case& c) { return c.order <= 6; })), nameOf);
INSTANTIATE_TEST_SUITE_P(Families, HemisphericalHarmonicsBattery,
                         ::testing::ValuesIn(casesWhere([](const Case& c) {
                             return c.family == "hsh" || c.family == "makhotkin";
                         })),
                         nameOf);

}  // namespace
}  // namespace prt
