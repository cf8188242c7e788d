// Errors of the rotations of hemispherical harmonics [Gautron2004] "A Novel Hemispherical Basis for Accurate
// and Efficient Rendering", Sec. 4.
#include "tools/measure/rotation_hsh.h"

#include <cmath>
#include <numbers>
#include <set>

#include "precompute/base/error.h"
#include "precompute/math/basis.h"
#include "precompute/math/hsh_rotation.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation.h"
#include "tools/measure/basis_signals.h"

namespace prt::tools {
namespace {

using Coefficients = std::vector<float>;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

double relativeDistance(const Coefficients& a, const Coefficients& b) {
    double difference = 0, length = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        difference += (double(a[i]) - double(b[i])) * (double(a[i]) - double(b[i]));
        length += double(b[i]) * double(b[i]);
    }
    return std::sqrt(difference / length);
}

/// The lobe and everything it is turned to. The lobe is 0 where the horizon from before the turn ends up, so
/// that turning it is only to tilt it further, and to clip it.
class LobeTurns {
  public:
    explicit LobeTurns(int hshOrder) : basis_(makeBasis("hsh", hshOrder)), lobe_(turned(0)) {}
    int order() const { return basis_->order(); }
    const Coefficients& lobe() const { return lobe_; }
    Coefficients turned(double betaDeg) const {
        const std::vector<double> c = basis_->project(phongLobe(kHshLobeTiltDeg + betaDeg).function);
        return {c.begin(), c.end()};
    }

  private:
    std::unique_ptr<Basis> basis_;
    Coefficients lobe_;
};

Coefficients product(const std::vector<double>& matrix, const Coefficients& v) {
    Coefficients out(v.size());
    for (size_t r = 0; r < v.size(); ++r) {
        double sum = 0;
        for (size_t c = 0; c < v.size(); ++c) sum += matrix[r * v.size() + c] * double(v[c]);
        out[r] = float(sum);
    }
    return out;
}

Coefficients rotateThroughSh(const HshRotationThroughSh& rotation, const Coefficients& v, double betaDeg) {
    Coefficients out(v.size());
    rotation.rotate(rotationAboutUp(radians(betaDeg)), v, out);
    return out;
}

/// Second or third method with the matrix of β itself.
Coefficients rotateByMatrix(const std::string& method, int order, const Coefficients& v, double betaDeg) {
    const double beta = radians(betaDeg);
    if (method == kHshTable) return product(hshYRotation(order, beta), v);
    Coefficients out = product(hshDigonRemoval(order, beta), v);
    rotateSh(rotationAboutUp(hshShAngle(beta)), order, std::span<const float>(out), std::span<float>(out));
    return out;
}

Coefficients rotateByTable(const std::string& method, const HshRotationTable& table, const Coefficients& v,
                           double betaDeg) {
    const Mat3d rotation = rotationAboutUp(radians(betaDeg));
    Coefficients out(v.size());
    if (method == kHshTable)
        table.rotateByTable(rotation, v, out);
    else
        table.rotateByDigonRemoval(rotation, v, out);
    return out;
}

}  // namespace

std::vector<int> hshIntermediateOrders(int hshOrder) {
    std::set<int> orders;
    for (const int order : {hshOrder, 3 * hshOrder / 2, 2 * hshOrder, kMaxShOrder})
        orders.insert(std::min(order, kMaxShOrder));
    return {orders.begin(), orders.end()};
}

std::vector<HshError> hshErrors(int hshOrder, double stepDeg) {
    const LobeTurns lobe(hshOrder);
    std::vector<double> betas;
    std::vector<Coefficients> turned;
    for (double beta = 0; beta <= kMaxHshBetaDeg; beta += stepDeg) {
        betas.push_back(beta);
        turned.push_back(lobe.turned(beta));
    }
    std::vector<HshError> errors;
    const auto add = [&](const std::string& method, int shOrder, int angles, const auto& rotate) {
        for (size_t i = 0; i < betas.size(); ++i) {
            throwIfInterrupted();
            errors.push_back({hshOrder, method, shOrder, angles, betas[i],
                              relativeDistance(rotate(lobe.lobe(), betas[i]), turned[i])});
        }
    };
    for (const int shOrder : hshIntermediateOrders(hshOrder)) {
        const HshRotationThroughSh rotation(hshOrder, shOrder);
        add(kHshThroughSh, shOrder, 0,
            [&](const Coefficients& v, double beta) { return rotateThroughSh(rotation, v, beta); });
    }
    for (const char* method : {kHshDigonRemoval, kHshTable})
        add(method, 0, 0,
            [&](const Coefficients& v, double beta) { return rotateByMatrix(method, hshOrder, v, beta); });
    for (const int angles : {10, 19, 37}) {
        const HshRotationTable table(hshOrder, angles);
        add(kHshTable, 0, angles,
            [&](const Coefficients& v, double beta) { return rotateByTable(kHshTable, table, v, beta); });
    }
    return errors;
}

std::vector<HshTableError> hshTableErrors(int hshOrder) {
    constexpr const char* kMethods[] = {kHshDigonRemoval, kHshTable};
    const LobeTurns lobe(hshOrder);
    std::vector<double> betas;
    std::vector<Coefficients> turned, byMatrix[2];
    for (int k = 0; k < kHshTableBetas; ++k) {
        throwIfInterrupted();
        betas.push_back(kMaxHshBetaDeg * (k + 0.5) / kHshTableBetas);
        turned.push_back(lobe.turned(betas.back()));
        for (size_t m = 0; m < 2; ++m)
            byMatrix[m].push_back(rotateByMatrix(kMethods[m], hshOrder, lobe.lobe(), betas.back()));
    }
    std::vector<HshTableError> errors;
    for (const int angles : {4, 7, 10, 13, 19, 37, 73, 91, 181}) {
        throwIfInterrupted();
        const HshRotationTable table(hshOrder, angles);
        for (size_t m = 0; m < 2; ++m) {
            double toFunction = 0, toMatrix = 0;
            for (size_t k = 0; k < betas.size(); ++k) {
                const Coefficients out = rotateByTable(kMethods[m], table, lobe.lobe(), betas[k]);
                toFunction += std::pow(relativeDistance(out, turned[k]), 2) / kHshTableBetas;
                toMatrix += std::pow(relativeDistance(out, byMatrix[m][k]), 2) / kHshTableBetas;
            }
            errors.push_back({hshOrder, kMethods[m], angles, table.bytes() / 2, std::sqrt(toFunction),
                              std::sqrt(toMatrix)});
        }
    }
    return errors;
}

}  // namespace prt::tools
