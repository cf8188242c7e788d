// Error analysis of the truncated Taylor rotation, after [Krivanek2006] "Fast Approximation to Spherical
// Harmonic Rotation", Sec. 3.1.
#include "tools/measure/rotation_errors.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/math/sh.h"

namespace prt::tools {
namespace {

/// Singular values of all blocks.
std::vector<double> singularValues(const ShBandMatrix& matrix) {
    std::vector<double> values;
    for (int l = 0; l < matrix.shOrder(); ++l) {
        const Eigen::Index size = 2 * l + 1;
        const Eigen::Map<const Eigen::MatrixXd> block(matrix.block(l).data(), size, size);  // its transpose
        const Eigen::VectorXd of = Eigen::JacobiSVD<Eigen::MatrixXd>(block).singularValues();
        values.insert(values.end(), of.begin(), of.end());
    }
    return values;
}

double length(std::span<const double> v) {
    double sum = 0;
    for (const double x : v) sum += x * x;
    return std::sqrt(sum);
}

TaylorError taylorError(int shOrder, ShTaylorOrder order, double betaDeg, std::span<const double> phong) {
    const double beta = betaDeg * std::numbers::pi / 180;
    ShBandMatrix d = ShRotationMatrix(rotationAboutUp(beta), shOrder);
    d.add(-1, shYTaylorMatrix(beta, order, shOrder));
    const std::vector<double> values = singularValues(d);
    TaylorError error{shOrder, order, betaDeg, 0, 0, 0, 0, 0};
    for (const double value : values) {
        error.max = std::max(error.max, value);
        error.mean += value / double(values.size());
    }
    error.rms = length(values) / shOrder;
    std::vector<double> off(phong.size());
    d.apply(phong, off);
    error.phong = length(off);
    error.phongRelative = error.phong / length(phong);
    return error;
}

}  // namespace

double taylorOrderNumber(ShTaylorOrder order) {
    return order == ShTaylorOrder::One ? 1 : order == ShTaylorOrder::OneAndHalf ? 1.5 : 2;
}

std::vector<TaylorError> taylorErrors(int shOrder, std::span<const double> betasDeg) {
    const std::vector<double> phong =
        projectSh(shOrder, [](const Vec3d& direction) { return std::pow(std::max(0.0, direction.z()), 7); });
    std::vector<TaylorError> errors;
    for (const ShTaylorOrder order : {ShTaylorOrder::One, ShTaylorOrder::OneAndHalf, ShTaylorOrder::Two})
        for (const double beta : betasDeg) errors.push_back(taylorError(shOrder, order, beta, phong));
    return errors;
}

}  // namespace prt::tools
