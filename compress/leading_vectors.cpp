// Leading eigenvectors of a symmetric matrix: implicitly restarted Lanczos [Sorensen1992], by Spectra, for
// the first few, a full decomposition (Eigen) when most are wanted or when Lanczos' answer does not stand its
// checks.
#include "compress/leading_vectors.h"

#include <Spectra/MatOp/DenseSymMatProd.h>
#include <Spectra/SymEigsSolver.h>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "precompute/base/check.h"

namespace prt {
namespace {

struct Pairs {
    Eigen::VectorXd values;   // falling
    Eigen::MatrixXd vectors;  // columns
};

Pairs allPairs(const Eigen::MatrixXd& matrix, int count) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
    PRT_CHECK(solver.info() == Eigen::Success);
    return {solver.eigenvalues().reverse().head(count),
            solver.eigenvectors().rowwise().reverse().leftCols(count)};
}

std::optional<Pairs> lanczosPairs(const Eigen::MatrixXd& matrix, int count) {
    const int dimension = int(matrix.rows());
    Spectra::DenseSymMatProd<double> product(matrix);
    Spectra::SymEigsSolver<Spectra::DenseSymMatProd<double>> solver(
        product, count, std::min(dimension, std::max(2 * count + 1, 20)));
    try {
        solver.init();
        solver.compute(Spectra::SortRule::LargestAlge, 1000, 1e-12, Spectra::SortRule::LargestAlge);
    } catch (const std::exception&) {
        return std::nullopt;  // no usable start, or the small problem inside did not converge
    }
    if (solver.info() != Spectra::CompInfo::Successful) return std::nullopt;
    return Pairs{solver.eigenvalues(), solver.eigenvectors()};
}

// Lanczos sees one vector per distinct eigenvalue, and symmetric shapes have equal ones (without this check
// one of ten such matrices loses a copy): what is left of the matrix without the vectors found must have no
// larger eigenvalue than the last of them.
bool areLeading(const Eigen::MatrixXd& matrix, const Pairs& pairs, double scale) {
    const double tolerance = 1e-9 * scale;
    const auto& v = pairs.vectors;
    if (!v.allFinite() || !pairs.values.allFinite()) return false;
    if ((v.transpose() * v - Eigen::MatrixXd::Identity(v.cols(), v.cols())).cwiseAbs().maxCoeff() > 1e-10)
        return false;
    if ((matrix * v - v * pairs.values.asDiagonal()).cwiseAbs().maxCoeff() > tolerance) return false;
    const Eigen::MatrixXd rest = matrix - v * pairs.values.asDiagonal() * v.transpose();
    if (rest.cwiseAbs().maxCoeff() <= tolerance) return true;
    const std::optional<Pairs> next = lanczosPairs(rest, 1);
    return next && next->values[0] <= pairs.values.minCoeff() + tolerance;
}

// The first entry within rounding of the largest decides, so that noise cannot choose among equal ones.
double signOf(const Eigen::Ref<const Eigen::VectorXd>& vector) {
    const double limit = vector.cwiseAbs().maxCoeff() * (1 - 1e-6);
    for (Eigen::Index i = 0; i < vector.size(); ++i)
        if (std::abs(vector[i]) >= limit) return vector[i] < 0 ? -1 : 1;
    return 1;
}

}  // namespace

LeadingVectors leadingVectors(std::span<const double> symmetric, int dimension, int count) {
    PRT_CHECK_EQ(symmetric.size(), size_t(dimension) * size_t(dimension));
    PRT_CHECK_LE(1, count);
    PRT_CHECK_LE(count, dimension);
    const Eigen::MatrixXd matrix = Eigen::Map<const Eigen::MatrixXd>(symmetric.data(), dimension, dimension);
    const double scale = matrix.trace();

    std::optional<Pairs> pairs;
    if (2 * count < dimension && scale > 0) {
        pairs = lanczosPairs(matrix, count);
        if (pairs && !areLeading(matrix, *pairs, scale)) pairs.reset();
    }
    if (!pairs) pairs = allPairs(matrix, count);

    LeadingVectors result;
    result.values.resize(size_t(count));
    result.vectors.resize(size_t(count) * size_t(dimension));
    for (int m = 0; m < count; ++m) {
        result.values[size_t(m)] = std::max(0.0, pairs->values[m]);
        Eigen::Map<Eigen::VectorXd>(result.vectors.data() + size_t(m) * size_t(dimension), dimension) =
            signOf(pairs->vectors.col(m)) * pairs->vectors.col(m);
    }
    return result;
}

}  // namespace prt
