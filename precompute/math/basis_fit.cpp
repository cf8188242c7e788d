// Least squares through the normal equations, and Gram matrices: what needs an eigensolver.
#include <cmath>

#include <Eigen/Eigenvalues>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/math/basis.h"
#include "precompute/math/basis_kernel.h"

namespace prt {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Adds up Σ_k b_k b_kᵀ of vectors that come one by one, in blocks that keep it a matrix product.
class OuterProductSum {
  public:
    explicit OuterProductSum(int count) : rows_(kBlock, count), sum_(Matrix::Zero(count, count)) {}

    std::span<double> nextRow() {
        if (filled_ == kBlock) flush();
        return {rows_.row(filled_++).data(), size_t(rows_.cols())};
    }
    std::vector<double> take() {
        flush();
        return {sum_.data(), sum_.data() + sum_.size()};
    }

  private:
    void flush() {
        sum_.noalias() += rows_.topRows(filled_).transpose() * rows_.topRows(filled_);
        filled_ = 0;
    }

    static constexpr int kBlock = 256;
    Matrix rows_, sum_;
    int filled_ = 0;
};

}  // namespace

std::vector<double> detail::symmetricPseudoInverse(std::span<const double> matrix, int size, double cut) {
    PRT_CHECK_EQ(matrix.size(), size_t(size) * size_t(size));
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
        Eigen::Map<const Eigen::MatrixXd>(matrix.data(), size, size));
    PRT_CHECK(solver.info() == Eigen::Success);
    const double strongest = solver.eigenvalues().cwiseAbs().maxCoeff();
    const Eigen::VectorXd inverse =
        solver.eigenvalues().unaryExpr([&](double e) { return std::abs(e) < cut * strongest ? 0 : 1 / e; });
    const Eigen::MatrixXd result =
        solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
    return {result.data(), result.data() + result.size()};
}

std::vector<double> Basis::gram() const {
    OuterProductSum sum(count_);
    // a degree of 2(n − 1), and one for the weight
    for (const DomainNode& node : domainQuadrature(domain_, 2 * order_ - 1)) {
        const std::span<double> row = sum.nextRow();
        evalInto(node.direction, row);
        const double scale = std::sqrt(node.weightSr * weight(node.direction));
        for (double& value : row) value *= scale;
    }
    return sum.take();
}

std::vector<double> Basis::fitSamples(std::span<const Vec3d> directions,
                                      std::span<const double> values) const {
    PRT_CHECK_EQ(directions.size(), values.size());
    if (directions.size() < size_t(count_))
        throw InputError(
            "fit to basis " + name_,
            std::to_string(directions.size()) + " samples for " + std::to_string(count_) + " functions",
            "give at least as many samples as functions");
    OuterProductSum sum(count_);
    std::vector<double> right(size_t(count_), 0.0), result(size_t(count_), 0.0);
    for (size_t k = 0; k < directions.size(); ++k) {
        const std::span<double> row = sum.nextRow();
        eval(directions[k], row);
        for (size_t i = 0; i < row.size(); ++i) right[i] += values[k] * row[i];
    }
    constexpr double kWeakest = 1e-12;
    const std::vector<double> inverse = detail::symmetricPseudoInverse(sum.take(), count_, kWeakest);
    for (size_t i = 0; i < result.size(); ++i)
        for (size_t j = 0; j < result.size(); ++j) result[i] += inverse[i * result.size() + j] * right[j];
    return result;
}

}  // namespace prt
