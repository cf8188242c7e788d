// The bases as their papers write them, slowly: angles, factorials, sums term by term. And directions at
// which bases are looked at.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "precompute/math/basis.h"
#include "tests/math/random_input.h"

namespace prt::test {

inline long double factorial(int n) {
    long double product = 1;
    for (int k = 2; k <= n; ++k) product *= k;
    return product;
}
inline long double binomial(int n, int k) {
    return k < 0 || k > n ? 0 : factorial(n) / (factorial(k) * factorial(n - k));
}

/// P_n^(α, β)(2v − 1) = Σ_s C(n + α, n − s) C(n + β, s) (v − 1)^s v^(n − s)
inline long double slowJacobi(int n, int alpha, int beta, long double v) {
    long double sum = 0;
    for (int s = 0; s <= n; ++s)
        sum += binomial(n + alpha, n - s) * binomial(n + beta, s) * std::pow(v - 1, s) * std::pow(v, n - s);
    return sum;
}

/// √2 cos mφ, 1 or √2 sin|m|φ
inline long double azimuthFactor(int m, const Vec3d& d) {
    const long double phi = std::atan2((long double)d.y(), (long double)d.x());
    if (m == 0) return 1;
    return std::numbers::sqrt2_v<long double> * (m > 0 ? std::cos(m * phi) : std::sin(-m * phi));
}

inline long double condonShortley(int m) { return m % 2 ? -1 : 1; }

/// K P_l^|m|(z) with the phase, norm 1 over a solid angle (4π: spherical, 2π: hemispherical harmonics).
inline long double slowHarmonic(int l, int m, long double z, long double solidAngle) {
    const int order = std::abs(m);
    const long double k = std::sqrt((2 * l + 1) / solidAngle * (factorial(l - order) / factorial(l + order)));
    return condonShortley(order) * k * std::assoc_legendre(unsigned(l), unsigned(order), z);
}

/// Our reading of [Makhotkin1996]: ∫ z (z(1 − z))^m P² dz = l! (l + 1)! / (2(l + 1) (l − m)! (l + m + 1)!).
inline long double slowMakhotkin(int l, int m, long double z) {
    const int order = std::abs(m);
    const long double norm = factorial(l) * factorial(l + 1) /
                             (2 * (l + 1) * factorial(l - order) * factorial(l + order + 1)) * 2 *
                             std::numbers::pi_v<long double>;
    return condonShortley(order) * std::pow(z * (1 - z), order / 2.0L) *
           slowJacobi(l - order, order, order + 1, z) / std::sqrt(norm);
}

/// K R_n^|m|(√2 sin(θ/2)) by the sum of factorials.
inline long double slowZernike(int degree, int m, long double z) {
    const int order = std::abs(m);
    const long double rho = std::numbers::sqrt2_v<long double> * std::sin(std::acos(z) / 2);
    long double sum = 0;
    for (int s = 0; 2 * s <= degree - order; ++s)
        sum += (s % 2 ? -1 : 1) * factorial(degree - s) /
               (factorial(s) * factorial((degree + order) / 2 - s) * factorial((degree - order) / 2 - s)) *
               std::pow(rho, degree - 2 * s);
    return std::sqrt((degree + 1) / (2 * std::numbers::pi_v<long double>)) * sum;
}

/// [HabelWimmer2010, Eqs. 8-13], Eq. 10 corrected.
inline std::vector<double> slowH(int order, const Vec3d& d) {
    const double pi = std::numbers::pi, theta = std::atan2(std::hypot(d.x(), d.y()), d.z());
    const double phi = std::atan2(d.y(), d.x()), a = std::sqrt(3 / (2 * pi)),
                 b = std::sqrt(15 / (2 * pi)) / 2;
    const double sin2 = std::sin(theta) * std::sin(theta);
    std::vector<double> h = {1 / std::sqrt(2 * pi), -a * std::sin(phi) * std::sin(theta),
                             a * (2 * std::cos(theta) - 1), -a * std::cos(phi) * std::sin(theta)};
    if (order == 3) h.insert(h.end(), {b * std::sin(2 * phi) * sin2, b * std::cos(2 * phi) * sin2});
    return h;
}

/// [HabelWimmer2010, Eqs. 1-2]
inline std::vector<double> slowHalfLife2(const Vec3d& d) {
    const double norm = std::sqrt(3 / (2 * std::numbers::pi));
    return {norm * (-d.x() / std::sqrt(6.0) - d.y() / std::sqrt(2.0) + d.z() / std::sqrt(3.0)),
            norm * (-d.x() / std::sqrt(6.0) + d.y() / std::sqrt(2.0) + d.z() / std::sqrt(3.0)),
            norm * (d.x() * std::sqrt(2.0 / 3) + d.z() / std::sqrt(3.0))};
}

/// All functions of a family.
inline std::vector<double> slowBasis(const std::string& family, int order, const Vec3d& d) {
    if (family == "h") return slowH(order, d);
    if (family == "hl2") return slowHalfLife2(d);
    const long double pi = std::numbers::pi_v<long double>;
    long double z = d.z();
    // near the pole the longer cosine knows more of the angle
    if (z > 0.5) z = std::cos(std::atan2(std::hypot((long double)d.x(), (long double)d.y()), z));
    std::vector<double> values;
    for (int l = 0; l < order; ++l)
        for (int m = -l; m <= l; ++m) {
            if (family == "zernike" || family == "esh")
                if ((l + m) % 2) continue;
            long double radial = 0;
            if (family == "zernike")
                radial = slowZernike(l, m, z);
            else if (family == "makhotkin")
                radial = slowMakhotkin(l, m, z);
            else if (family == "hsh")
                radial = slowHarmonic(l, m, 2 * z - 1, 2 * pi);
            else
                radial = slowHarmonic(l, m, z, family == "esh" ? 2 * pi : 4 * pi);
            values.push_back(double(radial * azimuthFactor(m, d)));
        }
    return values;
}

inline Vec3d directionOf(double z, double phi) {
    const double s = std::sqrt((1 - z) * (1 + z));
    return {s * std::cos(phi), s * std::sin(phi), z};
}

/// Pole and rim, places near them, and random ones; the sphere gets its lower half too.
inline std::vector<Vec3d> probeDirections(BasisDomain domain, int randomCount) {
    std::vector<Vec3d> directions = {{0, 0, 1},
                                     {1, 0, 0},
                                     {0, 1, 0},
                                     {-1, 0, 0},
                                     directionOf(0, 0.7),
                                     directionOf(0, -2.5),
                                     Vec3d(1e-7, -2e-7, 1).normalized(),
                                     Vec3d(3e-5, 1e-5, 1).normalized(),
                                     directionOf(1e-13, 2.0),
                                     directionOf(1e-6, 1.0),
                                     directionOf(0.5, std::numbers::pi / 2)};
    RandomInput random(31);
    for (int k = 0; k < randomCount; ++k) {
        Vec3d d = random.direction();
        if (domain == BasisDomain::UpperHemisphere) d.z() = std::abs(d.z());
        directions.push_back(d);
    }
    if (domain == BasisDomain::Sphere) {
        directions.push_back({0, 0, -1});
        directions.push_back(directionOf(-1e-9, 0.3));
    }
    return directions;
}

inline std::vector<double> evaluate(const Basis& basis, const Vec3d& d) {
    std::vector<double> values(size_t(basis.count()));
    basis.eval(d, values);
    return values;
}

/// Uniform samples of the domain that cover it evenly (golden-angle spiral about z).
inline std::vector<Vec3d> evenDirections(BasisDomain domain, int count) {
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    std::vector<Vec3d> directions;
    for (int k = 0; k < count; ++k) {
        const double fraction = (k + 0.5) / count;
        directions.push_back(
            directionOf(domain == BasisDomain::Sphere ? 1 - 2 * fraction : 1 - fraction, golden * k));
    }
    return directions;
}

}  // namespace prt::test
