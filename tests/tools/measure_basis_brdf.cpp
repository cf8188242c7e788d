// Accuracies of lobes against the interface of the bases and closed forms; light by dot products.
#include "tools/measure/basis_brdf.h"

#include <cmath>
#include <numbers>

namespace prt::tools {
namespace {

using std::numbers::pi;

double accuracyOf(const std::vector<LobeAccuracy>& rows, size_t lobe, const std::string& basis, int order,
                  bool hemisphere = false) {
    for (const LobeAccuracy& row : rows)
        if (row.lobe == lobe && row.basis == basis && row.order == order)
            return hemisphere ? row.accuracyHemisphere : row.accuracy;
    ADD_FAILURE() << basis << order;
    return 0;
}

TEST(BasisBrdf, AccuracyOfAnUprightPhongLobe) {
    const std::vector<Lobe> lobes = {phongLobe(0)};
    const auto rows = lobeAccuracies(lobes, 6, 47);
    // (∫ cos⁵)² / (2π ∫ cos¹⁰) = (2π/6)² / (2π · 2π/11); over the sphere half of it
    EXPECT_NEAR(accuracyOf(rows, 0, "hsh", 1), 11.0 / 36, 1e-12);
    EXPECT_NEAR(accuracyOf(rows, 0, "zernike", 1), 11.0 / 36, 1e-12);
    EXPECT_NEAR(accuracyOf(rows, 0, "esh", 1), 11.0 / 36, 1e-12);
    EXPECT_NEAR(accuracyOf(rows, 0, "lsosh", 1), 11.0 / 36, 1e-12);
    EXPECT_NEAR(accuracyOf(rows, 0, "sh", 1), 11.0 / 72, 1e-12);
    // f̂ = 1/12 everywhere: over the hemisphere 1 − (2π/11 − 2·2π/72 + 2π/144) / (2π/11)
    EXPECT_NEAR(accuracyOf(rows, 0, "sh", 1, true), 11 * (2.0 / 72 - 1.0 / 144), 1e-12);
    // its own weight: f̂ = 2∫ z⁶ = 2/7
    EXPECT_NEAR(accuracyOf(rows, 0, "makhotkin", 1), 11 * (2 * 2.0 / 7 / 6 - 4.0 / 49), 1e-12);
    // a polynomial of degree 5 in z
    for (const char* basis : {"hsh", "makhotkin", "lsosh"})
        EXPECT_NEAR(accuracyOf(rows, 0, basis, 6), 1, 1e-12) << basis;
}

/// Through Basis::project and evalExpansion.
std::pair<double, double> slowAccuracy(const Lobe& lobe, const std::string& name, int order) {
    constexpr int kDegree = 63;
    const auto basis = makeBasis(name, order);
    const auto nodes = domainQuadrature(BasisDomain::UpperHemisphere, kDegree);
    std::vector<double> c(size_t(basis->count()), 0.0), values(c.size());
    if (name == "sh") {
        for (const DomainNode& node : nodes) {
            basis->eval(node.direction, values);
            for (size_t i = 0; i < c.size(); ++i)
                c[i] += node.weightSr * lobe.function(node.direction) * values[i];
        }
    } else {
        c = basis->project(lobe.function, kDegree);
    }
    double energy = 0, rest = 0, captured = 0;
    for (const DomainNode& node : nodes) {
        const double f = lobe.function(node.direction),
                     difference = f - basis->evalExpansion(c, node.direction);
        energy += node.weightSr * f * f;
        rest += node.weightSr * difference * difference;
    }
    for (const double value : c) captured += value * value;
    const bool squares = name != "lsosh" && name != "makhotkin";
    return {squares ? captured / energy : 1 - rest / energy, 1 - rest / energy};
}

TEST(BasisBrdf, AccuracyIsThatOfEveryBasisByItself) {
    const std::vector<Lobe> lobes = {phongLobe(45), wardLobe(30, 90, WardVariant::TimesCosine)};
    const auto rows = lobeAccuracies(lobes, 4, 63);
    for (size_t lobe = 0; lobe < lobes.size(); ++lobe)
        for (const char* basis : {"hsh", "sh", "esh", "lsosh", "zernike", "makhotkin"})
            for (const int order : {2, 4}) {
                const auto [accuracy, hemisphere] = slowAccuracy(lobes[lobe], basis, order);
                EXPECT_NEAR(accuracyOf(rows, lobe, basis, order), accuracy, 1e-11) << basis << order;
                EXPECT_NEAR(accuracyOf(rows, lobe, basis, order, true), hemisphere, 1e-11) << basis << order;
            }
    for (const LobeAccuracy& row : rows) {
        EXPECT_LE(row.coefficients, 16);
        EXPECT_EQ(row.stored, row.basis == "esh" ? row.order * row.order : row.coefficients);
        // spherical harmonics are judged below the horizon, too
        EXPECT_EQ(row.accuracyHemisphere > row.accuracy + 1e-9, row.basis == "sh") << row.basis;
    }
}

TEST(BasisBrdf, MoreFunctionsCaptureMore) {
    const std::vector<Lobe> lobes = {wardLobe(45, 0, WardVariant::RawCut89)};
    const auto rows = lobeAccuracies(lobes, 5, 63);
    for (size_t i = 1; i < rows.size(); ++i) {
        if (rows[i].basis != rows[i - 1].basis || rows[i].basis == "makhotkin") continue;
        EXPECT_GE(rows[i].accuracy, rows[i - 1].accuracy) << rows[i].basis << rows[i].order;
    }
    // two bases of one span: the fit is least squares where the basis is orthonormal
    for (int order = 1; order <= 5; ++order)
        EXPECT_GE(accuracyOf(rows, 0, "hsh", order), accuracyOf(rows, 0, "makhotkin", order) - 1e-12);
}

TEST(BasisBrdfDeathTest, LobesOfDifferentCutsDoNotMix) {
    const std::vector<Lobe> lobes = {wardLobe(0, 0, WardVariant::RawCut89), phongLobe(0)};
    EXPECT_DEATH(lobeAccuracies(lobes, 2, 15), "");
    EXPECT_DEATH(lobeAccuracies({}, 2, 15), "");
    EXPECT_DEATH(lobeAccuracies(std::span(lobes).last(1), 17, 15), "");
}

/// Under constant light every product is known: mirrored below the horizon a lobe reflects twice as much.
TEST(BasisBrdf, DotProductsUnderConstantLight) {
    const std::vector<Lobe> lobes = {phongLobe(0), phongLobe(40)};
    const std::vector<EnvironmentLights> lights = {environmentLights(loadEnvironment("sky:uniform"))};
    for (const int order : {1, 2, 4}) {
        const auto errors = lightErrors(lobes, lights, order, 2, 3);
        ASSERT_EQ(errors.size(), 4u);
        EXPECT_EQ(errors[0].basis, "sh");
        EXPECT_LT(errors[0].relativeMax, 2e-3);
        EXPECT_EQ(errors[1].basis, "hsh");
        // C of order 1 gives exactly the mean of the hemisphere
        EXPECT_LT(errors[1].relativeMax, 2e-3);
        EXPECT_EQ(errors[2].basis, "esh");
        EXPECT_NEAR(errors[2].relativeRms, 1, 2e-3);
        EXPECT_NEAR(errors[2].relativeMedian, 1, 2e-3);
        EXPECT_EQ(errors[3].basis, "lsosh");
        EXPECT_EQ(errors[3].order, order);
        if (order > 1) continue;
        EXPECT_NEAR(errors[3].relativeRms, 1, 2e-3);  // one constant: the same as mirroring
    }
}

}  // namespace
}  // namespace prt::tools
