// Zernike polynomials on the hemisphere [Koenderink1996]: the area-preserving map ρ = √2 sin(θ/2) takes it to
// the unit disc, K = √((n + 1)/(2π)) R_n^|m|(ρ)·{√2 cos mφ, 1, √2 sin|m|φ} with R_n^m(1) = 1. No angles are
// needed: ρ² = 1 − z and ρ e^{iφ} = (x + iy)/√(1 + z), and R_{m+2k}^m(ρ) = ρ^m P_k^{(0,m)}(2ρ² − 1).
#include <cmath>

#include "precompute/math/basis_kernel.h"

namespace prt {
namespace {

class ZernikeBasis final : public detail::BasisOf<ZernikeBasis> {
  public:
    explicit ZernikeBasis(int order)
        : BasisOf("zernike", order, order * (order + 1) / 2, BasisDomain::UpperHemisphere, true) {
        for (int m = 0; m < order; ++m) radial_[size_t(m)] = detail::jacobiRadial(m, 0, m);
    }
    template <typename T>
    void functions(const T& x, const T& y, const T& z, T* out) const {
        using std::sqrt;
        const T inverse = T(1.0) / sqrt(T(1.0) + z);
        const detail::AzimuthPowers<T> powers(order(), x * inverse, y * inverse);
        for (int m = 0; m < order(); ++m)
            detail::forEachPolynomial(radial_[size_t(m)], T(1.0) - z, (order() - 1 - m) / 2 + 1,
                                      [&](int k, const T& p) {
                                          const int degree = m + 2 * k;
                                          const int first = degree * (degree + 1) / 2;
                                          // for m = 0 overwritten by the next
                                          out[first + k] = p * powers.sinPart[m];
                                          out[first + k + m] = p * powers.cosPart[m];
                                      });
    }

  private:
    detail::RadialTable radial_{};
};

}  // namespace

std::unique_ptr<Basis> detail::makeZernikeBasis(int order) { return std::make_unique<ZernikeBasis>(order); }

}  // namespace prt
