// Rotation of expansions in hemispherical harmonics H_lm(ω) = √2·Y_lm(2x√(z/(1 + z)), 2y√(z/(1 + z)), 2z −
// 1), z >= 0, coefficients in the order of shIndex. What a rotation takes below the horizon is lost, and what
// it brings up from there is 0: the three methods of Gautron et al. compute the coefficients of that
// function.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "precompute/math/vec.h"

namespace prt {

/// M(β): what is left of a function when all is set to 0 that a turn about y by β will take below the
/// horizon.
///   M_ij = ∫ H_i H_j over the directions that stay above
/// Gauss-Legendre quadrature in coordinates in which the lune is a rectangle and the roots of z at both its
/// edges and at its poles are smooth; exact to 1e-12, and to 3e-8 for 0 < β < 0.01.
/// @param hshOrder  n, 1..kMaxShOrder
/// @param betaRad   0..π; +Z turns towards +X
/// @return [n²×n²] row-major, symmetric, dimensionless
/// @source [Gautron2004, Eq. 10]
std::vector<double> hshDigonRemoval(int hshOrder, double betaRad);

/// M_R(β): the turn about y by β itself, on the functions of the hemisphere.
///   M_R,ij = ∫ H_i(ω) H_j(R_y(β)ᵀω) over the directions above the horizon that came from above; accuracy as
///   above
/// @param hshOrder, betaRad  as above
/// @return [n²×n²] row-major, dimensionless
/// @source [Gautron2004, Eq. 14], which as printed is the inverse rotation
std::vector<double> hshYRotation(int hshOrder, double betaRad);

/// The angle by which the second method turns the coefficients as if they were spherical harmonics:
/// arccos(2cosβ − 1), and π from β = π/2 on, where nothing of a function on the pole stays above the horizon.
/// @param betaRad  0..π
/// @return 0..π
/// @source [Gautron2004, Eq. 13]
double hshShAngle(double betaRad);

/// First method: to spherical harmonics with Cᵀ (continued by zero below the horizon), rotated there, and
/// back with C. Exact but for the bands that the intermediate order cuts off: the error falls with it,
/// slowly, because the horizon is an edge.
class HshRotationThroughSh {
  public:
    /// @param hshOrder  n, 1..kMaxShOrder
    /// @param shOrder   order in between, 1..kMaxShOrder, sensibly larger
    HshRotationThroughSh(int hshOrder, int shOrder);
    int hshOrder() const { return hshOrder_; }
    int shOrder() const { return shOrder_; }
    /// (Rf)(ω) = f(Rᵀω) for ω and Rᵀω above the horizon, else 0. Allocates nothing.
    /// @param targetFromSource  rotation matrix; checked to 1e-3
    /// @param in, out           [n²]; the same memory, or apart
    /// @source [Gautron2004, Sec. 4 and Eq. 18]; their C⁻¹ is Cᵀ
    void rotate(const Mat3d& targetFromSource, std::span<const float> in, std::span<float> out) const;

  private:
    int hshOrder_, shOrder_;
    /// Functions of equal m, all of them ascending in l: column l' − |m| of row l − |m|.
    std::vector<float> conversion_;
    std::vector<size_t> start_;  ///< of the block of every m, at m + hshOrder − 1
};

/// Second and third method: M and M_R for a number of angles 0…180°, interpolated linearly in between.
class HshRotationTable {
  public:
    /// Takes milliseconds per angle for 10 bands, and 8·(n⁴ + n²)/2 bytes.
    /// @param hshOrder    n, 1..kMaxShOrder
    /// @param angleCount  >= 2, evenly from 0 to π, both included
    HshRotationTable(int hshOrder, int angleCount);
    int hshOrder() const { return hshOrder_; }
    int angleCount() const { return angleCount_; }
    size_t bytes() const { return (removal_.size() + rotation_.size()) * sizeof(float); }

    /// Second method: M(β), then the coefficients are turned as those of spherical harmonics by
    /// hshShAngle(β). It is not a rotation of the hemisphere, only near one: the coefficients of a cos⁵ lobe
    /// at 45° (n = 10) are 8 % off at β = 5°, 16 % at 10° and 32 % at 20°. Allocates nothing.
    /// @param targetFromSource  rotation matrix; checked to 1e-3
    /// @param in, out           [n²]; the same memory, or apart
    /// @source [Gautron2004, Sec. 4, Eqs. 10 to 13]
    void rotateByDigonRemoval(const Mat3d& targetFromSource, std::span<const float> in,
                              std::span<float> out) const;
    /// Third method: M_R(β), exact but for the interpolation, whose error falls with the square of the
    /// distance of angles (with its power 3/2 below the first angle, where M_R has no second derivative).
    /// Parameters as above.
    /// @source [Gautron2004, Sec. 4, Eq. 14]
    void rotateByTable(const Mat3d& targetFromSource, std::span<const float> in, std::span<float> out) const;

  private:
    void multiply(const std::vector<float>& tables, double betaRad, const float* in, float* out) const;

    int hshOrder_, angleCount_;
    /// Per angle the block of m >= 0, then that of m < 0, by columns: a turn about y keeps what is even in y.
    std::vector<float> removal_, rotation_;
};

}  // namespace prt
