// Leading eigenvectors of a covariance matrix: the one place that sees an eigensolver.
#pragma once

#include <functional>
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

/// y = C x of a symmetric matrix that nobody forms, [d] each.
using SymmetricProduct = std::function<void(std::span<const double> x, std::span<double> y)>;

/// The same where only products with the matrix are known: about four for each vector asked for, d where most
/// are wanted.
/// @param trace  of the matrix, the scale of what counts as zero
LeadingVectors leadingVectors(const SymmetricProduct& product, double trace, int dimension, int count);

/// 1 or −1: what makes the largest entry positive. The first entry within rounding of the largest decides, so
/// that noise cannot choose among equal ones.
double canonicalSign(std::span<const double> vector);

}  // namespace prt
