// The matrices of Gautron's second and third way to rotate hemispherical harmonics [Gautron2004] "A Novel
// Hemispherical Basis for Accurate and Efficient Rendering", Sec. 4, by quadrature over the lune that stays
// above the horizon.
#include "precompute/math/hsh_rotation_matrices.h"

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"

namespace prt::detail {
namespace {

constexpr double kPi = std::numbers::pi;

/// All functions in the direction (sinχ sin a, cosχ, sinχ cos a), scaled.
void evalHsh(int order, double a, double chi, double scale, std::span<double> out) {
    const double x = std::sin(chi) * std::sin(a), y = std::cos(chi);
    const double z = std::max(0.0, std::sin(chi) * std::cos(a));
    const double stretch = 2 * std::sqrt(z / (1 + z));
    evalSh(order, Vec3d(stretch * x, stretch * y, 2 * z - 1), out);
    for (double& value : out) value *= scale * std::numbers::sqrt2;
}

/// Gauss-Legendre in u after a = low + (high − low)(1 − cos u)/2: at both ends a root of the distance becomes
/// smooth.
struct EdgeNode {
    double at, weight;
};
std::vector<EdgeNode> edgeNodes(double low, double high, int count) {
    std::vector<EdgeNode> result;
    for (const LineNode& node : gaussLegendre(count)) {
        const double u = 0.5 * kPi * (node.z + 1);
        result.push_back({low + (high - low) * 0.5 * (1 - std::cos(u)),
                          0.25 * kPi * (high - low) * std::sin(u) * node.weight});
    }
    return result;
}

}  // namespace

std::vector<int> hshParityIndices(int order, bool even) {
    std::vector<int> result;
    for (int l = 0; l < order; ++l)
        for (int m = -l; m <= l; ++m)
            if ((m >= 0) == even) result.push_back(shIndex(l, m));
    return result;
}

HshTurnMatrices hshTurnMatrices(int order, double betaRad, int nodeCount) {
    PRT_CHECK_LE(1, order);
    PRT_CHECK_LE(order, kMaxShOrder);
    PRT_CHECK_LE(0.0, betaRad);
    PRT_CHECK_LE(betaRad, kPi);
    // About the axis y, what is and was above the horizon has angles a from +z towards +x of β − 90° … 90°,
    // and came from a − β.
    const std::vector<EdgeNode> around = edgeNodes(betaRad - 0.5 * kPi, 0.5 * kPi, nodeCount);
    std::vector<EdgeNode> along = edgeNodes(0, kPi, nodeCount + nodeCount % 2);
    along.resize(along.size() / 2);  // the other half is the mirror image
    HshTurnMatrices result;
    std::vector<double> here(size_t(shCount(order))), there(here.size());
    for (int p = 0; p < 2; ++p) {
        const std::vector<int> indices = hshParityIndices(order, p == 0);
        const Eigen::Index size = Eigen::Index(indices.size());
        Eigen::MatrixXd source(Eigen::Index(around.size() * along.size()), size), target(source.rows(), size);
        Eigen::Index row = 0;
        for (const EdgeNode& chi : along)
            for (const EdgeNode& a : around) {
                const double root = std::sqrt(2 * a.weight * chi.weight * std::sin(chi.at));
                evalHsh(order, a.at - betaRad, chi.at, root, here);
                evalHsh(order, a.at, chi.at, root, there);
                for (Eigen::Index i = 0; i < size; ++i) {
                    source(row, i) = here[size_t(indices[size_t(i)])];
                    target(row, i) = there[size_t(indices[size_t(i)])];
                }
                ++row;
            }
        const Eigen::MatrixXd removal = source.transpose() * source, rotation = target.transpose() * source;
        result.removal[p].assign(removal.data(), removal.data() + removal.size());
        result.rotation[p].assign(rotation.data(), rotation.data() + rotation.size());
    }
    return result;
}

}  // namespace prt::detail
