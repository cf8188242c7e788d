// Matrices of turns of hemispherical harmonics about y, in two blocks by symmetry. Internal.
#pragma once

#include <vector>

namespace prt::detail {

/// Indices of the functions that are even (m >= 0) or odd (m < 0) in y, ascending. A turn about y keeps them
/// apart.
std::vector<int> hshParityIndices(int order, bool even);

/// M and M_R: block 0 of the even, block 1 of the odd functions, by columns.
struct HshTurnMatrices {
    std::vector<double> removal[2], rotation[2];
};

/// Nodes along each coordinate of the lune with which the quadrature has converged to 1e-12; to 3e-8 for β
/// between 0 and 0.01, where the edge of one function lies close to the edge of the other.
constexpr int hshNodeCount(int order) { return 4 * order + 28; }

/// @param order      1..kMaxShOrder
/// @param betaRad    0..π
/// @param nodeCount  >= 1
HshTurnMatrices hshTurnMatrices(int order, double betaRad, int nodeCount);

}  // namespace prt::detail
