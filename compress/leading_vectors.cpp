// Leading eigenvectors of a symmetric matrix: implicitly restarted Lanczos [Sorensen1992], by Spectra, for
// the first few, a full decomposition (Eigen) when most are wanted or when Lanczos' answer does not stand its
// checks.
#include "compress/leading_vectors.h"

#include <Spectra/SymEigsSolver.h>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "precompute/base/check.h"
#include "precompute/base/error.h"

namespace prt {
namespace {

struct Pairs {
    Eigen::VectorXd values;   // falling
    Eigen::MatrixXd vectors;  // columns
};

// A symmetric matrix as Spectra sees it: products with vectors. The largest eigenvectors found so far can be
// taken out of it.
class Operator {
  public:
    using Scalar = double;
    Operator(const SymmetricProduct& product, Eigen::Index dimension)
        : product_(product), dimension_(dimension) {}

    Eigen::Index rows() const { return dimension_; }
    Eigen::Index cols() const { return dimension_; }
    void perform_op(const double* in, double* out) const {
        const size_t size = size_t(dimension_);
        product_({in, size}, {out, size});
        if (!without_) return;
        const Eigen::Map<const Eigen::VectorXd> x(in, dimension_);
        Eigen::Map<Eigen::VectorXd> y(out, dimension_);
        y -= without_->vectors * (without_->values.asDiagonal() * (without_->vectors.transpose() * x));
    }
    Eigen::MatrixXd times(const Eigen::MatrixXd& columns) const {
        Eigen::MatrixXd result(columns.rows(), columns.cols());
        for (Eigen::Index c = 0; c < columns.cols(); ++c)
            perform_op(columns.col(c).data(), result.col(c).data());
        return result;
    }
    Operator without(const Pairs& pairs) const {
        Operator result = *this;
        result.without_ = &pairs;
        return result;
    }

  private:
    const SymmetricProduct& product_;
    Eigen::Index dimension_;
    const Pairs* without_ = nullptr;
};

Pairs allPairs(const Operator& matrix, int count) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
        matrix.times(Eigen::MatrixXd::Identity(matrix.rows(), matrix.rows())));
    PRT_CHECK(solver.info() == Eigen::Success);
    return {solver.eigenvalues().reverse().head(count),
            solver.eigenvectors().rowwise().reverse().leftCols(count)};
}

std::optional<Pairs> lanczosPairs(Operator matrix, int count) {
    const int dimension = int(matrix.rows());
    Spectra::SymEigsSolver<Operator> solver(matrix, count, std::min(dimension, std::max(2 * count + 1, 20)));
    try {
        solver.init();
        solver.compute(Spectra::SortRule::LargestAlge, 1000, 1e-12, Spectra::SortRule::LargestAlge);
    } catch (const Interrupted&) {
        throw;
    } catch (const Error&) {
        throw;  // of the product
    } catch (const std::exception&) {
        return std::nullopt;  // no usable start, or the small problem inside did not converge
    }
    if (solver.info() != Spectra::CompInfo::Successful) return std::nullopt;
    return Pairs{solver.eigenvalues(), solver.eigenvectors()};
}

// Lanczos sees one vector per distinct eigenvalue, and symmetric shapes have equal ones (without this check
// one of ten such matrices loses a copy): what is left of the matrix without the vectors found must have no
// larger eigenvalue than the last of them.
bool areLeading(const Operator& matrix, const Pairs& pairs, double scale) {
    const double tolerance = 1e-9 * scale;
    const auto& v = pairs.vectors;
    if (!v.allFinite() || !pairs.values.allFinite()) return false;
    if ((v.transpose() * v - Eigen::MatrixXd::Identity(v.cols(), v.cols())).cwiseAbs().maxCoeff() > 1e-10)
        return false;
    if ((matrix.times(v) - v * pairs.values.asDiagonal()).cwiseAbs().maxCoeff() > tolerance) return false;
    // Nothing is left: no start for Lanczos.
    if (scale - pairs.values.sum() <= tolerance) return true;
    const std::optional<Pairs> next = lanczosPairs(matrix.without(pairs), 1);
    return next && next->values[0] <= pairs.values.minCoeff() + tolerance;
}

}  // namespace

double canonicalSign(std::span<const double> vector) {
    double largest = 0;
    for (const double value : vector) largest = std::max(largest, std::abs(value));
    for (const double value : vector)
        if (std::abs(value) >= largest * (1 - 1e-6)) return value < 0 ? -1 : 1;
    return 1;
}

LeadingVectors leadingVectors(const SymmetricProduct& product, double trace, int dimension, int count) {
    PRT_CHECK_LE(1, count);
    PRT_CHECK_LE(count, dimension);
    const Operator matrix(product, dimension);
    std::optional<Pairs> pairs;
    if (2 * count < dimension && trace > 0) {
        pairs = lanczosPairs(matrix, count);
        if (pairs && !areLeading(matrix, *pairs, trace)) pairs.reset();
    }
    if (!pairs) pairs = allPairs(matrix, count);

    LeadingVectors result;
    const size_t size = size_t(dimension);
    for (int m = 0; m < count; ++m) {
        result.values.push_back(std::max(0.0, pairs->values[m]));
        const double* column = pairs->vectors.col(m).data();
        const double sign = canonicalSign({column, size});
        for (size_t k = 0; k < size; ++k) result.vectors.push_back(sign * column[k]);
    }
    return result;
}

LeadingVectors leadingVectors(std::span<const double> symmetric, int dimension, int count) {
    PRT_CHECK_EQ(symmetric.size(), size_t(dimension) * size_t(dimension));
    const Eigen::Map<const Eigen::MatrixXd> matrix(symmetric.data(), dimension, dimension);
    return leadingVectors(
        [&](std::span<const double> x, std::span<double> y) {
            Eigen::Map<Eigen::VectorXd>(y.data(), dimension).noalias() =
                matrix.selfadjointView<Eigen::Lower>() *
                Eigen::Map<const Eigen::VectorXd>(x.data(), dimension);
        },
        matrix.trace(), dimension, count);
}

}  // namespace prt
