// What the families of bases are made of (internal): numbers that carry their derivatives, and functions of
// the form p_k(v)·Re/Im w^m with orthonormal polynomials p_k by three-term recurrences.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "precompute/math/basis.h"
#include "precompute/math/sh.h"

namespace prt::detail {

/// A number and its derivatives by x, y and z; uninitialised where nothing is given, as numbers are.
struct Dual {
    double value;
    Vec3d slope;

    Dual() = default;
    Dual(double v) : value(v), slope(Vec3d::Zero()) {}  // NOLINT: constants mix freely
    Dual(double v, const Vec3d& s) : value(v), slope(s) {}
};
inline Dual operator+(const Dual& a, const Dual& b) { return {a.value + b.value, a.slope + b.slope}; }
inline Dual operator-(const Dual& a, const Dual& b) { return {a.value - b.value, a.slope - b.slope}; }
inline Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.slope * b.value + b.slope * a.value};
}
inline Dual operator*(double a, const Dual& b) { return {a * b.value, a * b.slope}; }
inline Dual operator/(const Dual& a, const Dual& b) {
    const double ratio = a.value / b.value;
    return {ratio, (a.slope - ratio * b.slope) / b.value};
}
/// At 0 the derivative is left 0: right wherever the root is multiplied by something that vanishes there, and
/// replaced by the caller where not.
inline Dual sqrt(const Dual& a) {
    const double root = std::sqrt(a.value);
    if (root == 0) return {0.0};
    return {root, a.slope * (0.5 / root)};
}

/// Polynomials of one azimuthal order m: p_0 = start, p_{k+1} = (rise[k] v + shift[k]) p_k − fall[k] p_{k−1}.
struct RadialRecurrence {
    double start = 0;
    std::array<double, kMaxShOrder> rise{}, shift{}, fall{};
};
using RadialTable = std::array<RadialRecurrence, kMaxShOrder>;

/// Those of spherical harmonics, in v = z: Y_{m+k, ±m} = p_k(z) Re/Im (x + iy)^m.
const RadialTable& shRadialTable();
/// Jacobi polynomials P_k^(α, β)(2v − 1), leading coefficient positive, such that p_k cos mφ (and p_0 for
/// m = 0) have norm 1 over v in [0, 1] and φ in [0, 2π] with the weight (1 − v)^α v^β.
/// @param alpha, beta  >= 0, sum <= 2·kMaxShOrder − 1
RadialRecurrence jacobiRadial(int m, int alpha, int beta);

/// Re w^m and Im w^m for m < order.
template <typename T>
struct AzimuthPowers {
    T cosPart[kMaxShOrder], sinPart[kMaxShOrder];

    /// w = x + iy
    AzimuthPowers(int order, const T& x, const T& y) {
        cosPart[0] = T(1.0);
        sinPart[0] = T(0.0);
        for (int m = 1; m < order; ++m) {
            cosPart[m] = x * cosPart[m - 1] - y * sinPart[m - 1];
            sinPart[m] = x * sinPart[m - 1] + y * cosPart[m - 1];
        }
    }
};

/// Calls visit(k, p_k(v)) for k < count.
template <typename T, typename Visit>
void forEachPolynomial(const RadialRecurrence& r, const T& v, int count, const Visit& visit) {
    T before(0.0), here(r.start);
    for (int k = 0;;) {
        visit(k, here);
        const size_t i = size_t(k);
        if (++k >= count) break;
        const T next = (r.rise[i] * v + T(r.shift[i])) * here - r.fall[i] * before;
        before = here;
        here = next;
    }
}

/// Functions p_k(v) Re w^m and p_k(v) Im w^m in bands l = m + k, in the order of shIndex.
/// @param out  [order²]
template <typename T>
void evalBands(const RadialTable& table, int order, const T& v, const AzimuthPowers<T>& powers, T* out) {
    for (int m = 0; m < order; ++m)
        forEachPolynomial(table[size_t(m)], v, order - m, [&](int k, const T& p) {
            out[shIndex(m + k, -m)] = p * powers.sinPart[m];  // for m = 0 overwritten by the next
            out[shIndex(m + k, m)] = p * powers.cosPart[m];
        });
}

/// A basis from one function template: Family has
///   template <typename T> void functions(const T& x, const T& y, const T& z, T* out) const;
template <typename Family>
class BasisOf : public Basis {
  protected:
    using Basis::Basis;

    void evalInto(const Vec3d& d, std::span<double> out) const override {
        family().template functions<double>(d.x(), d.y(), d.z(), out.data());
    }
    void gradientInto(const Vec3d& d, std::span<Vec3d> out) const override {
        Dual value[shCount(kMaxShOrder)];
        family().template functions<Dual>({d.x(), Vec3d::UnitX()}, {d.y(), Vec3d::UnitY()},
                                          {d.z(), Vec3d::UnitZ()}, value);
        for (size_t i = 0; i < out.size(); ++i) out[i] = value[i].slope - value[i].slope.dot(d) * d;
    }

  private:
    const Family& family() const { return static_cast<const Family&>(*this); }
};

// One maker per file of families; the order is in range.
std::unique_ptr<Basis> makeSphericalFamily(const std::string& name, int order);      // sh, esh, lsosh
std::unique_ptr<Basis> makeHemisphericalFamily(const std::string& name, int order);  // hsh, makhotkin
std::unique_ptr<Basis> makeZernikeBasis(int order);
std::unique_ptr<Basis> makeIrradianceFamily(const std::string& name, int order);  // h, hl2

/// Pseudo-inverse of a symmetric matrix, without eigenvalues smaller than `cut` times the largest in
/// magnitude.
/// @param matrix  [size×size]
/// @return        [size×size]
std::vector<double> symmetricPseudoInverse(std::span<const double> matrix, int size, double cut);

}  // namespace prt::detail
