// Leading eigenvectors of a covariance matrix: the one place that sees an eigensolver.
#pragma once

#include <span>
#include <vector>

namespace prt {

struct LeadingVectors {
    std::vector<double> values;   ///< [M] falling, none negative
    std::vector<double> vectors;  ///< [M×d] orthonormal rows; the largest entry of each is positive
};

/// @param symmetric  [d×d] positive semidefinite up to rounding
/// @param count      M, 1..d
/// Vectors of eigenvalues that are zero or equal are some orthonormal choice, the same on every call.
LeadingVectors leadingVectors(std::span<const double> symmetric, int dimension, int count);

}  // namespace prt
