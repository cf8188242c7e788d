// How far the truncated Taylor rotation of spherical harmonics is from the rotation.
#pragma once

#include <span>
#include <vector>

#include "precompute/math/sh_rotation_taylor.h"

namespace prt::tools {

/// Errors of the turn about y by the truncated series: D(β) = R_y(β) − R'_y(β), on vectors of n²
/// coefficients, the constant band (which errs by 0) among them.
struct TaylorError {
    int shOrder;
    ShTaylorOrder taylorOrder;
    double betaDeg;
    double max;    ///< greatest singular value of D: the largest error of a unit vector
    double mean;   ///< average singular value of D; what the paper calls the average error of unit vectors
    double rms;    ///< root of the mean squared error of unit vectors: |D|_F / n
    double phong;  ///< |D c|, c the coefficients of max(0, cosθ)^7, neither the function nor c normalised
    double phongRelative;  ///< the same over |c|
};

/// 1, 1.5 or 2, as the paper calls them.
double taylorOrderNumber(ShTaylorOrder order);

/// All three orders of expansion at every angle, by order of expansion, then angle.
/// @param shOrder   1..kMaxShOrder
/// @param betasDeg  degrees
/// @source [Krivanek2006, Sec. 3.1, Fig. 3]
std::vector<TaylorError> taylorErrors(int shOrder, std::span<const double> betasDeg);

}  // namespace prt::tools
