// Irradiance in every basis: [HabelWimmer2010] "Efficient Irradiance Normal Mapping", Fig. 3 and Eq. 16. All
// integrals of a block of signals with all functions of all bases are one matrix product; with b = ∫ B E,
// G = ∫ B Bᵀ and coefficients c, ∫ (cᵀB − E)² = ∫ E² − 2 c·b + cᵀ G c.
#include "tools/measure/basis_irradiance.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/basis_conversion.h"
#include "precompute/math/sh.h"

namespace prt::tools {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using MatrixView = Eigen::Map<const Matrix>;

/// By number of coefficients, as the figure groups them.
const std::vector<IrradianceCandidate>& allCandidates() {
    static const std::vector<IrradianceCandidate> candidates = {{"hl2", "Half-Life 2", 2, 3},
                                                                {"zernike", "Zernike", 2, 3},
                                                                {"esh", "ESH", 2, 3},
                                                                {"h", "H4", 2, 4},
                                                                {"lsosh", "LSOSH", 2, 4},
                                                                {"sh", "SH", 2, 4},
                                                                {"hsh", "HSH", 2, 4},
                                                                {"makhotkin", "Makhotkin", 2, 4},
                                                                {"h", "H6", 3, 6},
                                                                {"zernike", "Zernike", 3, 6},
                                                                {"esh", "ESH", 3, 6},
                                                                {"lsosh", "LSOSH", 3, 9},
                                                                {"sh", "SH", 3, 9},
                                                                {"hsh", "HSH", 3, 9},
                                                                {"makhotkin", "Makhotkin", 3, 9},
                                                                {"zernike", "Zernike", 4, 10}};
    return candidates;
}

/// What one candidate needs beside its rows in the common matrix.
struct CandidateMatrices {
    Eigen::Index firstPlain, firstWeighted, count;  ///< rows of ∫ B E and of ∫ weight B E
    bool overSphere;                                ///< coefficients are those of irradiance over the sphere
    Matrix gram;                                    ///< ∫ B Bᵀ over the hemisphere
    Matrix solve;                                   ///< coefficients from ∫ weight B E; empty: the same
    Matrix fromSh9;                                 ///< [count×9]
};

Matrix evaluate(const Basis& basis, std::span<const DomainNode> nodes) {
    Matrix values(basis.count(), Eigen::Index(nodes.size()));
    std::vector<double> column(size_t(basis.count()));
    for (size_t k = 0; k < nodes.size(); ++k) {
        basis.eval(nodes[k].direction, column);
        values.col(Eigen::Index(k)) = Eigen::Map<const Eigen::VectorXd>(column.data(), basis.count());
    }
    return values;
}

/// Σ over the signals of a block of −2 c·b + cᵀGc.
/// @param coefficients, integrals  c and b, a row per signal
double expansionError(const Matrix& coefficients, const Matrix& integrals, const Matrix& gram) {
    return (coefficients * gram - 2 * integrals).cwiseProduct(coefficients).sum();
}

}  // namespace

struct IrradianceComparison::Matrices {
    Eigen::VectorXd quadrature;  ///< [nodes] solid angles
    Matrix functions;            ///< [all functions×nodes], times solid angle and weight
    std::vector<CandidateMatrices> candidates;
};

void IrradianceErrors::add(const IrradianceErrors& other) {
    signals += other.signals;
    energy += other.energy;
    direct.resize(other.direct.size(), 0.0);
    viaSh9.resize(other.viaSh9.size(), 0.0);
    for (size_t i = 0; i < direct.size(); ++i) {
        direct[i] += other.direct[i];
        viaSh9[i] += other.viaSh9[i];
    }
}

namespace {

/// Makes the common matrix row by row, and what each candidate needs beside.
class MatrixBuilder {
  public:
    MatrixBuilder(std::span<const DomainNode> nodes, IrradianceComparison::Matrices& out)
        : nodes_(nodes), out_(out), sh9_(evaluate(*makeBasis("sh", 3), nodes)) {
        out_.quadrature.resize(sh9_.cols());
        for (Eigen::Index k = 0; k < sh9_.cols(); ++k) out_.quadrature[k] = nodes[size_t(k)].weightSr;
    }

    void add(const IrradianceCandidate& candidate) {
        const auto basis = makeBasis(candidate.basis, candidate.order);
        PRT_CHECK_EQ(basis->count(), candidate.coefficients);
        const Matrix values = evaluate(*basis, nodes_);
        const Matrix plain = values * out_.quadrature.asDiagonal();
        CandidateMatrices m;
        m.count = basis->count();
        m.overSphere = basis->domain() == BasisDomain::Sphere;
        m.gram = plain * values.transpose();
        m.firstPlain = m.firstWeighted = addRows(plain);
        if (basis->weight(nodes_.front().direction) != 1) {
            Matrix weighted = plain;
            for (Eigen::Index k = 0; k < weighted.cols(); ++k)
                weighted.col(k) *= basis->weight(nodes_[size_t(k)].direction);
            m.firstWeighted = addRows(weighted);
        }
        if (!basis->orthonormal()) m.solve = m.gram.llt().solve(Matrix::Identity(m.count, m.count));
        m.fromSh9 = fromSh9(candidate, m);
        out_.candidates.push_back(std::move(m));
    }

    void finish() {
        out_.functions.resize(rowCount_, sh9_.cols());
        Eigen::Index at = 0;
        for (const Matrix& added : rows_) {
            out_.functions.middleRows(at, added.rows()) = added;
            at += added.rows();
        }
    }

  private:
    /// @return where they begin
    Eigen::Index addRows(const Matrix& added) {
        rows_.push_back(added);
        rowCount_ += added.rows();
        return rowCount_ - added.rows();
    }

    Matrix fromSh9(const IrradianceCandidate& candidate, const CandidateMatrices& m) const {
        if (m.overSphere) return Matrix::Identity(m.count, 9);
        if (candidate.basis == "h") return MatrixView(shToHMatrix(3).data(), 6, 9).topRows(m.count);
        if (candidate.basis == "hsh") return MatrixView(shToHshMatrix(candidate.order, 3).data(), m.count, 9);
        const Matrix integrals = rows_.back() * sh9_.transpose();  // of the weighted functions
        return m.solve.size() ? Matrix(m.solve * integrals) : integrals;
    }

    std::span<const DomainNode> nodes_;
    IrradianceComparison::Matrices& out_;
    Matrix sh9_;
    std::vector<Matrix> rows_;
    Eigen::Index rowCount_ = 0;
};

}  // namespace

IrradianceComparison::IrradianceComparison(int degree)
    : nodes_(domainQuadrature(BasisDomain::UpperHemisphere, degree)),
      truth_(nodes_),
      candidates_(allCandidates()),
      matrices_(std::make_unique<Matrices>()) {
    MatrixBuilder builder(nodes_, *matrices_);
    for (const IrradianceCandidate& candidate : candidates_) builder.add(candidate);
    builder.finish();
}

IrradianceComparison::~IrradianceComparison() = default;

size_t IrradianceComparison::find(const std::string& basis, int coefficients) const {
    const auto found = std::find_if(candidates_.begin(), candidates_.end(), [&](const auto& c) {
        return c.basis == basis && c.coefficients == coefficients;
    });
    PRT_CHECK(found != candidates_.end());
    return size_t(found - candidates_.begin());
}

IrradianceErrors IrradianceComparison::errors(std::span<const double> irradiance,
                                              std::span<const double> sh9) const {
    const auto nodeCount = Eigen::Index(nodes_.size());
    const auto signals = Eigen::Index(irradiance.size() / nodes_.size());
    PRT_CHECK_EQ(irradiance.size(), size_t(signals * nodeCount));
    PRT_CHECK_EQ(sh9.size(), size_t(signals * 9));
    const MatrixView values(irradiance.data(), signals, nodeCount), bands(sh9.data(), signals, 9);
    const Matrix integrals = values * matrices_->functions.transpose();

    IrradianceErrors errors;
    errors.signals = size_t(signals);
    errors.energy = (values.cwiseAbs2() * matrices_->quadrature).sum();
    for (const CandidateMatrices& m : matrices_->candidates) {
        const Matrix plain = integrals.middleCols(m.firstPlain, m.count);
        const Matrix viaSh9 = bands * m.fromSh9.transpose();
        Matrix direct = integrals.middleCols(m.firstWeighted, m.count);
        if (m.overSphere)
            direct = viaSh9;
        else if (m.solve.size())
            direct = direct * m.solve;
        errors.direct.push_back(errors.energy + expansionError(direct, plain, m.gram));
        errors.viaSh9.push_back(errors.energy + expansionError(viaSh9, plain, m.gram));
    }
    return errors;
}

namespace {

/// Blocks of signals in parallel, added up in their order.
IrradianceErrors sumBlocks(size_t signals, size_t block,
                           const std::function<IrradianceErrors(size_t, size_t)>& errorsOf,
                           const std::function<void(size_t)>& report) {
    std::vector<IrradianceErrors> blocks((signals + block - 1) / block);
    parallelFor(signals, block, [&](size_t begin, size_t end) {
        blocks[begin / block] = errorsOf(begin, end);
        if (report) report(end - begin);
    });
    IrradianceErrors sum;
    for (const IrradianceErrors& errors : blocks) sum.add(errors);
    return sum;
}

/// A seed of its own for each signal of each measurement.
uint64_t signalSeed(uint64_t seed, uint64_t measurement, uint64_t signal) {
    return (seed * 0x9e3779b97f4a7c15u + measurement) * 0x94d049bb133111ebu + signal;
}

}  // namespace

IrradianceErrors randomIrradianceErrors(const IrradianceComparison& comparison, RadianceModel model,
                                        int lights, double smoothFlux, size_t signals, uint64_t seed,
                                        const std::function<void(size_t)>& report) {
    const size_t nodes = comparison.nodes().size();
    const uint64_t measurement = 2 * uint64_t(lights) + (model == RadianceModel::FullSphere ? 1 : 0);
    return sumBlocks(
        signals, 64,
        [&](size_t begin, size_t end) {
            std::vector<double> irradiance((end - begin) * nodes), sh9((end - begin) * 9);
            for (size_t s = begin; s < end; ++s) {
                SignalRandom random(signalSeed(seed, measurement, s));
                const Radiance radiance = drawRadiance(model, lights, smoothFlux, random);
                comparison.truth().eval(model, radiance, {irradiance.data() + (s - begin) * nodes, nodes});
                const auto bands = irradianceSh9(model, radiance);
                std::copy(bands.begin(), bands.end(), sh9.data() + (s - begin) * 9);
            }
            return comparison.errors(irradiance, sh9);
        },
        report);
}

std::array<IrradianceErrors, 2> environmentIrradianceErrors(const IrradianceComparison& comparison,
                                                            const EnvironmentLights& lights, int orientations,
                                                            uint64_t seed,
                                                            const std::function<void(size_t)>& report) {
    const size_t nodes = comparison.nodes().size();
    std::array<IrradianceErrors, 2> sums;
    for (const RadianceModel model : {RadianceModel::AboveSurface, RadianceModel::FullSphere}) {
        const bool above = model == RadianceModel::AboveSurface;
        sums[above ? 0 : 1] = sumBlocks(
            size_t(orientations), 2,
            [&](size_t begin, size_t end) {
                std::vector<double> irradiance((end - begin) * 3 * nodes, 0.0), sh9((end - begin) * 3 * 9);
                for (size_t o = begin; o < end; ++o) {
                    SignalRandom random(signalSeed(seed, 0, o));
                    const std::vector<Vec3d> directions = turnedDirections(lights, random.rotation());
                    std::array<std::span<const double>, 3> fluxes;
                    std::array<std::span<double>, 3> out;
                    for (size_t c = 0; c < 3; ++c) {
                        const size_t row = (o - begin) * 3 + c;
                        fluxes[c] = lights.fluxes[c];
                        out[c] = {irradiance.data() + row * nodes, nodes};
                        const auto bands = irradianceSh9(model, directions, fluxes[c]);
                        std::copy(bands.begin(), bands.end(), sh9.data() + row * 9);
                    }
                    comparison.truth().addLights(directions, above, fluxes, out);
                }
                return comparison.errors(irradiance, sh9);
            },
            report);
    }
    return sums;
}

}  // namespace prt::tools
