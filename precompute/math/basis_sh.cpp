// Spherical harmonics as bases: over the sphere, over the hemisphere with even reflection, and as
// least-squares fit over the hemisphere (ESH and LSOSH of [Sloan2003], as [Gautron2004, Sec. 2] describes
// them).
//
// LSOSH projects through orthonormal polynomials of the hemisphere: for each m, q_k(z) Re/Im (x + iy)^m with
// q_k orthonormal for the weight (1 − z²)^m on [0, 1], by the discretised Stieltjes procedure. With
// Y = R q the coefficients are R⁻ᵀ ∫ f q: the condition of R, the square root of that of the Gram matrix, is
// what rounding is multiplied by. It grows 5.6-fold per band: 4 for n = 2, 2e3 for 6, 2e6 for 10, 5e7 for 12,
// 3e8 for 13.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "precompute/base/check.h"
#include "precompute/math/basis_kernel.h"
#include "precompute/math/sh_legendre.h"

namespace prt {
namespace {

using detail::AzimuthPowers;
using detail::RadialRecurrence;
using detail::RadialTable;
using std::numbers::pi;

/// Everything from the functions in n² places.
template <typename T>
void evalShFunctions(int order, const T& x, const T& y, const T& z, T* out) {
    if constexpr (std::is_same_v<T, double>)
        evalSh(order, Vec3d(x, y, z), std::span(out, size_t(shCount(order))));
    else
        detail::evalBands(detail::shRadialTable(), order, z, AzimuthPowers<T>(order, x, y), out);
}

class ShBasis final : public detail::BasisOf<ShBasis> {
  public:
    explicit ShBasis(int order) : BasisOf("sh", order, shCount(order), BasisDomain::Sphere, true) {}
    template <typename T>
    void functions(const T& x, const T& y, const T& z, T* out) const {
        evalShFunctions(order(), x, y, z, out);
    }
};

/// Calls visit(place in ESH, shIndex) for all functions even in z.
template <typename Visit>
void forEachEven(int order, const Visit& visit) {
    int place = 0;
    for (int l = 0; l < order; ++l)
        for (int m = -l; m <= l; m += 2) visit(place++, shIndex(l, m));
}

class EshBasis final : public detail::BasisOf<EshBasis> {
  public:
    explicit EshBasis(int order)
        : BasisOf("esh", order, order * (order + 1) / 2, BasisDomain::UpperHemisphere, true) {}
    template <typename T>
    void functions(const T& x, const T& y, const T& z, T* out) const {
        T all[shCount(kMaxShOrder)];
        evalShFunctions(order(), x, y, z, all);
        forEachEven(order(), [&](int place, int index) { out[place] = std::numbers::sqrt2 * all[index]; });
    }
};

/// Orthonormal polynomials of the hemisphere for one m.
RadialRecurrence hemisphereRadial(int m, const std::vector<LineNode>& nodes) {
    const double azimuth = (m == 0 ? 2 : 1) * pi;
    std::vector<double> mass(nodes.size()), before(nodes.size(), 0.0), here(nodes.size());
    double total = 0;
    for (size_t i = 0; i < nodes.size(); ++i) {
        const double z = nodes[i].z;
        mass[i] = nodes[i].weight * azimuth * std::pow((1 - z) * (1 + z), m);
        total += mass[i];
    }
    RadialRecurrence r;
    r.start = 1 / std::sqrt(total);
    std::fill(here.begin(), here.end(), r.start);
    double fall = 0;
    for (size_t k = 0; k + 1 < r.rise.size(); ++k) {
        double mean = 0, norm = 0;
        for (size_t i = 0; i < nodes.size(); ++i) mean += mass[i] * nodes[i].z * here[i] * here[i];
        for (size_t i = 0; i < nodes.size(); ++i) {
            const double next = (nodes[i].z - mean) * here[i] - fall * before[i];
            before[i] = here[i];
            here[i] = next;
            norm += mass[i] * next * next;
        }
        norm = std::sqrt(norm);
        for (double& value : here) value /= norm;
        r.rise[k] = 1 / norm;
        r.shift[k] = -mean / norm;
        r.fall[k] = fall / norm;
        fall = norm;
    }
    return r;
}

class LsoshBasis final : public detail::BasisOf<LsoshBasis> {
  public:
    explicit LsoshBasis(int order)
        : BasisOf("lsosh", order, shCount(order), BasisDomain::UpperHemisphere, false) {
        // exact for the squares of 24 polynomials times z and (1 − z²)^m
        std::vector<LineNode> nodes = gaussLegendre(2 * kMaxShOrder);
        for (LineNode& node : nodes) node = {(node.z + 1) / 2, node.weight / 2};
        for (int m = 0; m < order; ++m) {
            radial_[size_t(m)] = hemisphereRadial(m, nodes);
            solve_.push_back(solver(m, nodes));
        }
    }
    template <typename T>
    void functions(const T& x, const T& y, const T& z, T* out) const {
        evalShFunctions(order(), x, y, z, out);
    }

  protected:
    void projectorInto(const Vec3d& d, std::span<double> out) const override {
        detail::evalBands(radial_, order(), d.z(), AzimuthPowers<double>(order(), d.x(), d.y()), out.data());
    }
    void finishProjection(std::span<double> coefficients) const override {
        double result[kMaxShOrder];
        for (int m = -(order() - 1); m < order(); ++m) {
            const int first = std::abs(m), count = order() - first;
            const std::vector<double>& solve = solve_[size_t(first)];
            for (int i = 0; i < count; ++i) {
                result[i] = 0;
                for (int k = 0; k < count; ++k)
                    result[i] += solve[size_t(i * count + k)] * coefficients[size_t(shIndex(first + k, m))];
            }
            for (int i = 0; i < count; ++i) coefficients[size_t(shIndex(first + i, m))] = result[i];
        }
    }

  private:
    /// Matrix that turns ∫ f q_k into coefficients of Y_{m+i, m}: the pseudo-inverse of A_ki = ∫ q_k Y_i, cut
    /// at 1e-8 of its largest singular value (1e-16 of the Gram matrix's eigenvalue), which nothing up to
    /// n = 12 falls under. Beyond, the combinations of functions that are that small over the hemisphere are
    /// left out. A's singular values are the eigenvalues of the symmetric (0 A; Aᵀ 0), to the same precision.
    std::vector<double> solver(int m, const std::vector<LineNode>& nodes) const {
        const int count = order() - m, size = 2 * count;
        const double azimuth = (m == 0 ? 2 : 1) * pi;
        std::vector<double> bordered(size_t(size) * size_t(size), 0.0);
        double q[kMaxShOrder], y[kMaxShOrder];
        for (const LineNode& node : nodes) {
            const double mass = node.weight * azimuth * std::pow((1 - node.z) * (1 + node.z), m);
            detail::forEachPolynomial(radial_[size_t(m)], node.z, count, [&](int k, double p) { q[k] = p; });
            detail::forEachPolynomial(detail::shRadialTable()[size_t(m)], node.z, count,
                                      [&](int i, double p) { y[i] = p; });
            for (int k = 0; k < count; ++k)
                for (int i = 0; i < count; ++i) {
                    bordered[size_t(k * size + count + i)] += mass * q[k] * y[i];
                    bordered[size_t((count + i) * size + k)] += mass * q[k] * y[i];
                }
        }
        const std::vector<double> inverse = detail::symmetricPseudoInverse(bordered, size, kWeakest);
        std::vector<double> result(size_t(count) * size_t(count));
        for (int i = 0; i < count; ++i)
            for (int k = 0; k < count; ++k)
                result[size_t(i * count + k)] = inverse[size_t((count + i) * size + k)];
        return result;
    }

    static constexpr double kWeakest = 1e-8;
    RadialTable radial_{};
    std::vector<std::vector<double>> solve_;  ///< by m, see solver
};

}  // namespace

std::unique_ptr<Basis> detail::makeSphericalFamily(const std::string& name, int order) {
    if (name == "sh") return std::make_unique<ShBasis>(order);
    if (name == "esh") return std::make_unique<EshBasis>(order);
    return std::make_unique<LsoshBasis>(order);
}

std::vector<double> eshToShCoefficients(int order, std::span<const double> esh) {
    PRT_CHECK_LE(1, order);
    PRT_CHECK_LE(order, kMaxShOrder);
    PRT_CHECK_EQ(esh.size(), size_t(order * (order + 1) / 2));
    std::vector<double> sh(size_t(shCount(order)), 0.0);
    forEachEven(order,
                [&](int place, int index) { sh[size_t(index)] = std::numbers::sqrt2 * esh[size_t(place)]; });
    return sh;
}

}  // namespace prt
