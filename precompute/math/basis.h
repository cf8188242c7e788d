// Bases of functions on the sphere and the hemisphere, behind one interface.
//
// The hemisphere is the upper one, z >= 0, polar axis +Z (the surface normal). Families, by the name
// makeBasis takes; n is the number of bands:
//   sh         spherical harmonics, n² functions, orthonormal over the sphere
//   esh        even reflection: the function is mirrored below the horizon, f(x, y, −z) = f(x, y, z); only
//              √2·Y_lm with l + m even remain, n(n + 1)/2 of n², orthonormal over the hemisphere
//              [Gautron2004, Sec. 2]
//   lsosh      spherical harmonics as least-squares fit over the hemisphere: n², not orthonormal there. Their
//              Gram matrix has condition 14 for n = 2, 4e6 for 6, 3e12 for 10, 3e15 for 12 and 9e16 for 13:
//              projection is exact through n = 12, its coefficients to 1e-16 of the condition's square root;
//              beyond, combinations below 1e-8 of the strongest are left out. [Gautron2004, Sec. 2]
//   hsh        hemispherical harmonics √2·Y_lm(2cosθ − 1, φ), n², orthonormal over the hemisphere
//              [Gautron2004, Eqs. 5-9]
//   makhotkin  hemispherical harmonics from associated shifted Jacobi polynomials, n², orthonormal over the
//              hemisphere with the weight cosθ. The formula is ours, from the literature's description of
//              [Makhotkin1996]; unconfirmed:
//                c_lm (z(1 − z))^{|m|/2} P_{l−|m|}^{(|m|, |m|+1)}(2z − 1)·{√2 cos mφ, 1, √2 sin|m|φ}
//   zernike    Zernike polynomials on the disc of radius √2·sin(θ/2), n(n + 1)/2, orthonormal over the
//              hemisphere [Koenderink1996]
//   h          H-basis: orders 2 (4 functions) and 3 (6 functions), orthonormal over the hemisphere
//              [HabelWimmer2010, Eqs. 8-13]
//   hl2        Half-Life 2 basis, 3 functions (order 2), orthonormal over the hemisphere
//              [HabelWimmer2010, Eqs. 1-2]
// Functions of sh, esh, lsosh, hsh, makhotkin are in the order of shIndex (esh: without those of odd l + m);
// those of zernike by degree d and m = −d, −d + 2, …, d: index d(d + 1)/2 + (d + m)/2.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "precompute/math/vec.h"

namespace prt {

enum class BasisDomain { Sphere, UpperHemisphere };

/// A function of a unit direction.
using DirectionFunction = std::function<double(const Vec3d&)>;

/// What a family of bases offers.
struct BasisFamily {
    std::string name;   ///< "sh", "hsh", …
    std::string title;  ///< for legends: "SH", "HSH (Gautron)", …
    int minOrder, maxOrder;
};
/// All families in the order of the list above.
const std::vector<BasisFamily>& basisFamilies();

class Basis {
  public:
    virtual ~Basis() = default;
    Basis(const Basis&) = delete;
    Basis& operator=(const Basis&) = delete;

    /// Name of the family.
    const std::string& name() const { return name_; }
    /// Number of bands n.
    int order() const { return order_; }
    /// Number of functions.
    int count() const { return count_; }
    /// Where functions are represented, and samples are taken.
    BasisDomain domain() const { return domain_; }
    /// 4π or 2π sr.
    double domainSr() const;
    /// ∫_domain weight B_i B_j dω = δ_ij.
    bool orthonormal() const { return orthonormal_; }
    /// Weight of the inner product in which the basis is orthonormal and projects; 1 but for makhotkin
    /// (cosθ).
    virtual double weight(const Vec3d& direction) const;

    /// All functions in one direction. No heap allocation.
    /// @param direction  unit; for hemispherical bases z >= 0 (down to −1e-6 counts as the rim)
    /// @param out        [count]
    void eval(const Vec3d& direction, std::span<double> out) const;
    /// Derivatives along the sphere: out[i]·t is the derivative of function i in the unit tangent direction
    /// t, per radian, exact (forward differentiation). Functions of |m| = 1 of hsh and makhotkin grow as √z
    /// at the rim: there their derivative is (0, 0, ±∞), and 0 on the meridian where they vanish. No heap
    /// allocation.
    /// @param direction  as for eval
    /// @param out        [count], each perpendicular to the direction
    void evalGradient(const Vec3d& direction, std::span<Vec3d> out) const;

    /// Direct projection c_i = ∫_domain weight f B*_i, with B* = B for orthonormal bases and the dual
    /// functions (hence the least-squares fit) otherwise; by domainQuadrature(domain, degree).
    /// @param degree  >= 0
    /// @return [count]
    std::vector<double> project(const DirectionFunction& function, int degree = 127) const;
    /// The same from samples of equal weight, uniform over the domain: c_i = (|domain|/N) Σ_k weight f_k
    /// B*_i(ω_k).
    /// @param directions  [N] unit  @param values  [N]
    /// @throws InputError  no directions
    std::vector<double> projectSamples(std::span<const Vec3d> directions,
                                       std::span<const double> values) const;
    /// Least squares over the samples: c minimises Σ_k (Σ_i c_i B_i(ω_k) − f_k)². Directions of the normal
    /// equations weaker than 1e-12 of the strongest are left out (minimum-norm solution).
    /// @param directions  [N] unit  @param values  [N]
    /// @throws InputError  fewer samples than functions
    std::vector<double> fitSamples(std::span<const Vec3d> directions, std::span<const double> values) const;
    /// Gram matrix ∫_domain weight B_i B_j, exact.
    /// @return [count×count]
    std::vector<double> gram() const;
    /// Σ_i c_i B_i(ω).
    /// @param coefficients  [count]
    double evalExpansion(std::span<const double> coefficients, const Vec3d& direction) const;

  protected:
    Basis(std::string name, int order, int count, BasisDomain domain, bool orthonormal);
    virtual void evalInto(const Vec3d& direction, std::span<double> out) const = 0;
    virtual void gradientInto(const Vec3d& direction, std::span<Vec3d> out) const = 0;
    /// The functions that project integrates against: the basis itself where it is orthonormal.
    virtual void projectorInto(const Vec3d& direction, std::span<double> out) const;
    /// What turns these integrals into coefficients, in place.
    virtual void finishProjection(std::span<double> coefficients) const;

  private:
    void checkDirection(const Vec3d& direction) const;

    std::string name_;
    int order_, count_;
    BasisDomain domain_;
    bool orthonormal_;
};

/// @param name   of a family, or "h4" and "h6" for the orders 2 and 3 of "h"
/// @param order  n, within the family's range; with "h4" and "h6" 0 or the order they imply
/// @throws InputError  unknown name or order
std::unique_ptr<Basis> makeBasis(const std::string& name, int order);

/// A node of a quadrature over a domain.
struct DomainNode {
    Vec3d direction;  ///< unit
    double weightSr;  ///< all weights sum to 4π or 2π
};
/// Gauss–Legendre in t = √z (hemisphere) or z (sphere) times the trapezoid rule in azimuth, no node on the
/// rim: exact for polynomials up to `degree` in (√z, x, y), where x and y count 1 as √z and z do; over the
/// sphere in (x, y, z).
/// @param degree  >= 0
std::vector<DomainNode> domainQuadrature(BasisDomain domain, int degree);

/// Coefficients of even reflection as the paper stores and multiplies them: those of the mirrored function in
/// all n² spherical harmonics, c_lm = 2∫_{z≥0} f Y_lm for even l + m and 0 for odd.
/// @param esh  [n(n + 1)/2] as basis "esh" of order n projects them
/// @return     [n²], index shIndex(band, m)
/// @source [Gautron2004, Sec. 2], who take it from Sloan et al. 2003
std::vector<double> eshToShCoefficients(int order, std::span<const double> esh);

/// The vector o with E(ω) = o·ω of an expansion in basis "hl2": directional occlusion, which is the same
/// function space.
/// @param coefficients  [3] of basis "hl2"
/// @source [HabelWimmer2010, Eq. 3]
Vec3d directionalOcclusionVector(std::span<const double> coefficients);

}  // namespace prt
