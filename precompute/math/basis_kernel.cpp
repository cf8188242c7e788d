// Three-term recurrences of orthonormal polynomials: Legendre functions as in [Sloan2008, A2], Jacobi
// polynomials by their recurrence [Szego1975, Eq. 4.5.1] in normalised form.
#include "precompute/math/basis_kernel.h"

#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/sh_legendre.h"

namespace prt::detail {

const RadialTable& shRadialTable() {
    static const RadialTable table = [] {
        const LegendreRecurrence<double>& legendre = kLegendreRecurrence<double>;
        RadialTable t{};
        for (int m = 0; m < kMaxShOrder; ++m) {
            RadialRecurrence& r = t[size_t(m)];
            r.start = legendre.diagonal[m];
            for (int l = m + 1; l < kMaxShOrder; ++l) {
                r.rise[size_t(l - 1 - m)] = legendre.rise[legendreIndex(l, m)];
                r.fall[size_t(l - 1 - m)] = legendre.fall[legendreIndex(l, m)];
            }
        }
        return t;
    }();
    return table;
}

RadialRecurrence jacobiRadial(int m, int alpha, int beta) {
    PRT_CHECK_LE(0, alpha);
    PRT_CHECK_LE(0, beta);
    PRT_CHECK_LE(alpha + beta, 2 * kMaxShOrder - 1);
    const double a = alpha, b = beta, sum = a + b;
    // Orthonormal over t = 2v − 1: offDiagonal(k + 1) p_{k+1} = (t − diagonal(k)) p_k − offDiagonal(k)
    // p_{k−1}.
    const auto diagonal = [&](double k) {
        return k == 0 ? (b - a) / (sum + 2) : (b * b - a * a) / ((2 * k + sum) * (2 * k + sum + 2));
    };
    const auto offDiagonal = [&](double k) {
        const double s = 2 * k + sum;
        return std::sqrt(4 * k * (k + a) * (k + b) * (k + sum) / (s * s * (s + 1) * (s - 1)));
    };
    // ∫ (1 − v)^α v^β dv = α! β! / (α + β + 1)!
    double integral = 1.0 / (beta + 1);
    for (int k = 1; k <= alpha; ++k) integral *= double(k) / (beta + 1 + k);
    RadialRecurrence r;
    r.start = 1 / std::sqrt(integral * (m == 0 ? 2 : 1) * std::numbers::pi);
    for (int k = 0; k + 1 < kMaxShOrder; ++k) {
        const size_t i = size_t(k);
        const double next = offDiagonal(k + 1);
        r.rise[i] = 2 / next;
        r.shift[i] = (-1 - diagonal(k)) / next;
        r.fall[i] = k == 0 ? 0 : offDiagonal(k) / next;
    }
    return r;
}

}  // namespace prt::detail
