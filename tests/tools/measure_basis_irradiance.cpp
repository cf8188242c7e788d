// The irradiance comparison against projecting and integrating one basis at a time.
#include "tools/measure/basis_irradiance.h"

#include <cmath>
#include <numbers>

#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "tools/measure/basis_cost.h"

namespace prt::tools {
namespace {

constexpr RadianceModel kModels[] = {RadianceModel::AboveSurface, RadianceModel::FullSphere};
constexpr int kDegree = 23;

/// Slow and obvious: every integral by itself, through the interface of the basis.
class SlowErrors {
  public:
    SlowErrors(const IrradianceComparison& comparison, RadianceModel model, const Radiance& radiance)
        : nodes_(comparison.nodes()), values_(nodes_.size()), sh9_(irradianceSh9(model, radiance)) {
        comparison.truth().eval(model, radiance, values_);
    }

    double direct(const IrradianceCandidate& candidate) const {
        const auto basis = makeBasis(candidate.basis, candidate.order);
        if (candidate.basis == "sh") return error(*basis, std::span(sh9_).first(size_t(basis->count())));
        // project() asks for the nodes in their order
        size_t next = 0;
        const auto c = basis->project([&](const Vec3d&) { return values_[next++]; }, kDegree);
        EXPECT_EQ(next, nodes_.size());
        return error(*basis, c);
    }
    double viaSh9(const IrradianceCandidate& candidate) const {
        const auto basis = makeBasis(candidate.basis, candidate.order);
        if (candidate.basis == "sh") return error(*basis, std::span(sh9_).first(size_t(basis->count())));
        const auto quadratic = makeBasis("sh", 3);
        return error(*basis, basis->project([&](const Vec3d& n) { return quadratic->evalExpansion(sh9_, n); },
                                            kDegree));
    }

  private:
    double error(const Basis& basis, std::span<const double> coefficients) const {
        double sum = 0;
        for (size_t k = 0; k < nodes_.size(); ++k) {
            const double difference = basis.evalExpansion(coefficients, nodes_[k].direction) - values_[k];
            sum += nodes_[k].weightSr * difference * difference;
        }
        return sum;
    }

    std::span<const DomainNode> nodes_;
    std::vector<double> values_;
    std::array<double, 9> sh9_;
};

TEST(BasisIrradiance, ErrorsAreThoseOfEveryBasisByItself) {
    const IrradianceComparison comparison(kDegree);
    const size_t nodes = comparison.nodes().size();
    SignalRandom random(2);
    for (const RadianceModel model : kModels) {
        std::vector<double> irradiance(2 * nodes), sh9;
        std::vector<SlowErrors> slow;
        for (size_t s = 0; s < 2; ++s) {
            const Radiance radiance = drawRadiance(model, 3, 0.5, random);
            comparison.truth().eval(model, radiance, {irradiance.data() + s * nodes, nodes});
            const auto bands = irradianceSh9(model, radiance);
            sh9.insert(sh9.end(), bands.begin(), bands.end());
            slow.emplace_back(comparison, model, radiance);
        }
        const IrradianceErrors errors = comparison.errors(irradiance, sh9);
        EXPECT_EQ(errors.signals, 2u);
        for (size_t i = 0; i < comparison.candidates().size(); ++i) {
            const IrradianceCandidate& candidate = comparison.candidates()[i];
            EXPECT_NEAR(errors.direct[i], slow[0].direct(candidate) + slow[1].direct(candidate), 1e-11)
                << candidate.title << candidate.coefficients;
            EXPECT_NEAR(errors.viaSh9[i], slow[0].viaSh9(candidate) + slow[1].viaSh9(candidate), 1e-11)
                << candidate.title << candidate.coefficients;
            EXPECT_NEAR(errors.imseDirect(i), errors.direct[i] / 2, 1e-15);
        }
    }
}

TEST(BasisIrradiance, SameForAnyNumberOfThreads) {
    const IrradianceComparison comparison(15);
    std::vector<IrradianceErrors> found;
    for (const int threads : {1, 2}) {
        setThreadCount(threads);
        found.push_back(randomIrradianceErrors(comparison, RadianceModel::FullSphere, 2, 1, 200, 5));
    }
    setThreadCount(0);
    EXPECT_EQ(found[0].signals, 200u);
    EXPECT_EQ(found[0].energy, found[1].energy);
    EXPECT_EQ(found[0].direct, found[1].direct);
    EXPECT_EQ(found[0].viaSh9, found[1].viaSh9);
    const IrradianceErrors other =
        randomIrradianceErrors(comparison, RadianceModel::FullSphere, 2, 1, 200, 6);
    EXPECT_NE(found[0].energy, other.energy);
}

TEST(BasisIrradiance, SpansAndOptimaShowInTheErrors) {
    const IrradianceComparison comparison(31);
    const IrradianceErrors errors =
        randomIrradianceErrors(comparison, RadianceModel::AboveSurface, 2, 1, 100, 1);
    const auto direct = [&](const char* basis, int count) {
        return errors.direct[comparison.find(basis, count)];
    };
    EXPECT_NEAR(direct("h", 4), direct("lsosh", 4), 1e-10 * errors.energy);
    // least squares is the best of its span: analytic SH, and Makhotkin of the span of HSH, cannot be better
    EXPECT_LT(direct("lsosh", 4), direct("sh", 4));
    EXPECT_LT(direct("lsosh", 9), direct("sh", 9));
    EXPECT_LT(direct("hsh", 4), direct("makhotkin", 4));
    EXPECT_LT(direct("hsh", 9), direct("makhotkin", 9));
    // and every orthogonal projection is at least as good as what comes by way of SH-9
    for (const auto& [basis, count] :
         {std::pair("h", 6), {"zernike", 10}, {"hsh", 9}, {"esh", 6}, {"lsosh", 9}}) {
        const size_t i = comparison.find(basis, count);
        EXPECT_LE(errors.direct[i], errors.viaSh9[i]) << basis;
    }
    const size_t sh9 = comparison.find("sh", 9);
    EXPECT_EQ(errors.direct[sh9], errors.viaSh9[sh9]);
}

TEST(BasisIrradiance, ConstantEnvironment) {
    const IrradianceComparison comparison(15);
    const auto lights = environmentLights(loadEnvironment("sky:uniform"));
    const auto errors = environmentIrradianceErrors(comparison, lights, 3, 1);
    EXPECT_EQ(errors[0].signals, 9u);
    EXPECT_EQ(errors[1].signals, 9u);
    EXPECT_NEAR(errors[1].energy, 9 * 2 * std::numbers::pi / 16, 1e-3);  // E = 1/4 everywhere
    for (size_t i = 0; i < comparison.candidates().size(); ++i) {
        // of a constant, directional occlusion captures 3/4; texels make the rest a little uneven
        const bool hl2 = comparison.candidates()[i].basis == "hl2";
        EXPECT_NEAR(errors[1].direct[i] / errors[1].energy, hl2 ? 0.25 : 0, 1e-4)
            << comparison.candidates()[i].title;
    }
    // above the surface only: E ~ 1 + z, which has no error in bases that hold 1 and z
    EXPECT_LT(errors[0].direct[comparison.find("h", 4)] / errors[0].energy, 1e-4);
    EXPECT_GT(errors[0].direct[comparison.find("esh", 3)] / errors[0].energy, 1e-2);
}

TEST(BasisCost, StraightLineCodeIsTheBasis) {
    SignalRandom random(4);
    for (const EvaluationCost& cost : evaluationCosts(false)) {
        const auto basis = makeBasis(cost.basis, cost.order);
        ASSERT_EQ(basis->count(), cost.coefficients);
        std::vector<double> expected(size_t(cost.coefficients)), values(expected.size());
        for (int k = 0; k < 100; ++k) {
            Vec3d direction = random.direction();
            direction.z() = std::abs(direction.z());
            basis->eval(direction, expected);
            evalStraightLine(cost.basis, cost.order, direction, values);
            for (size_t i = 0; i < values.size(); ++i)
                EXPECT_NEAR(values[i], expected[i], 1e-13) << cost.basis << cost.order << ' ' << i;
        }
    }
}

TEST(BasisCost, OperationsAreCounted) {
    for (const EvaluationCost& cost : evaluationCosts(false)) {
        // the sum with coefficients alone
        EXPECT_GE(cost.multiplications, cost.coefficients) << cost.basis;
        EXPECT_GE(cost.additions, cost.coefficients - 1) << cost.basis;
        const bool roots = cost.basis == "zernike" || cost.basis == "hsh" || cost.basis == "makhotkin";
        EXPECT_EQ(cost.squareRoots, roots ? 1 : 0) << cost.basis;
        EXPECT_EQ(cost.divisions, roots ? 1 : 0) << cost.basis;
        EXPECT_EQ(cost.ns, 0);
        if (cost.basis == "h" && cost.order == 3) {
            // −y, 2z − 1, −x, xy, x² − y²: 3 + 2 + 3 products and 2 differences, then 6 products and 5 sums
            EXPECT_EQ(cost.multiplications, 3 + 2 + 3 + 6);
            EXPECT_EQ(cost.additions, 2 + 5);
        }
    }
}

}  // namespace
}  // namespace prt::tools
