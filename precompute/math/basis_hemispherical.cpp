// Hemispherical harmonics: shifted associated Legendre [Gautron2004, Eqs. 5-9] and associated shifted Jacobi
// polynomials [Makhotkin1996]. Both are c·(z(1 − z))^{|m|/2} P_k^{(|m|, β)}(2z − 1)·{√2 cos mφ, 1, √2 sin
// |m|φ}, k = l − |m|, with β = |m| for the former (P_l^m shifted is that) and β = |m| + 1 for the latter,
// sign (−1)^m. Evaluated without angles: (z(1 − z))^{m/2} e^{imφ} = (x + iy)^m u^{m/2} with u = z/(1 + z).
//
// Makhotkin's own formula is in none of the papers at hand and could not be confirmed: ours follows from what
// they say of it, "shifted adjoint Jacobi polynomials" [Gautron2004, Sec. 2], 0 or constant on the rim
// [HabelWimmer2010, Sec. 2.2]. Adjoint reads as associated: d^m/dz^m P_l^{(0,1)}(2z − 1), orthogonal with the
// weight cosθ of radiative flux. Per m the span is that of hemispherical harmonics, and so are fits.
#include <algorithm>
#include <cmath>
#include <limits>

#include "precompute/math/basis_kernel.h"

namespace prt {
namespace {

using detail::AzimuthPowers;
using detail::Dual;

class HemisphericalHarmonics final : public detail::BasisOf<HemisphericalHarmonics> {
  public:
    /// @param cosineWeight  0 or 1: exponent of cosθ in the weight
    HemisphericalHarmonics(const std::string& name, int order, int cosineWeight)
        : BasisOf(name, order, shCount(order), BasisDomain::UpperHemisphere, true),
          cosineWeight_(cosineWeight) {
        for (int m = 0; m < order; ++m) {
            detail::RadialRecurrence& r = radial_[size_t(m)];
            r = detail::jacobiRadial(m, m, m + cosineWeight);
            if (m % 2) r.start = -r.start;
        }
    }

    double weight(const Vec3d& direction) const override {
        return cosineWeight_ == 0 ? 1 : std::max(0.0, direction.z());
    }

    template <typename T>
    void functions(const T& x, const T& y, const T& z, T* out) const {
        using std::sqrt;
        const T height = aboveRim(z);
        const T u = height / (T(1.0) + height);
        functionsOfRoot(x, y, height, u, sqrt(u), out);
    }

  protected:
    void gradientInto(const Vec3d& d, std::span<Vec3d> out) const override {
        BasisOf::gradientInto(d, out);
        if (d.z() > 0) return;
        // Where √u = 0 its slope is infinite and multiplies what it has as factor, |m| = 1.
        double factor[shCount(kMaxShOrder)];
        functionsOfRoot(d.x(), d.y(), 0.0, 0.0, 1.0, factor);
        for (int l = 1; l < order(); ++l)
            for (const int i : {shIndex(l, -1), shIndex(l, 1)}) {
                out[size_t(i)].setZero();
                if (factor[i] != 0)
                    out[size_t(i)].z() = std::copysign(std::numeric_limits<double>::infinity(), factor[i]);
            }
    }

  private:
    static double aboveRim(double z) { return std::max(0.0, z); }
    static Dual aboveRim(const Dual& z) { return {std::max(0.0, z.value), z.slope}; }

    template <typename T>
    void functionsOfRoot(const T& x, const T& y, const T& z, const T& u, const T& root, T* out) const {
        AzimuthPowers<T> powers(order(), x, y);
        T factor = root, other(1.0);  // u^{m/2}, and of the m before
        for (int m = 1; m < order(); ++m) {
            powers.cosPart[m] = powers.cosPart[m] * factor;
            powers.sinPart[m] = powers.sinPart[m] * factor;
            const T next = other * u;
            other = factor;
            factor = next;
        }
        detail::evalBands(radial_, order(), z, powers, out);
    }

    int cosineWeight_;
    detail::RadialTable radial_{};
};

}  // namespace

std::unique_ptr<Basis> detail::makeHemisphericalFamily(const std::string& name, int order) {
    return std::make_unique<HemisphericalHarmonics>(name, order, name == "makhotkin" ? 1 : 0);
}

}  // namespace prt
