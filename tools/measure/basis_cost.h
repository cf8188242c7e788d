// What it costs to evaluate an expansion with few coefficients, as a shader would: straight-line code for
// every basis of the irradiance comparison.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "precompute/math/vec.h"

namespace prt::tools {

struct EvaluationCost {
    std::string basis;
    int order, coefficients;
    /// Of all functions and of their sum with coefficients, multiplications by constants included; counted
    /// while the code below runs, not by hand.
    int additions, multiplications, divisions, squareRoots;
    double ns;  ///< per evaluation: one direction after the other, float, one thread
};

/// Evaluates a basis by the straight-line code.
/// @param basis, order  one that evaluationCosts() lists
/// @param direction     unit, z >= 0
/// @param out           [coefficients]
void evalStraightLine(const std::string& basis, int order, const Vec3d& direction, std::span<double> out);

/// Costs of hl2 (3 functions), h (4, 6), sh (4, 9; lsosh has the same functions), esh (3, 6), hsh (4, 9),
/// makhotkin (4, 9) and zernike (3, 6, 10).
/// @param timed  false: ns stays 0
/// @throws Interrupted
std::vector<EvaluationCost> evaluationCosts(bool timed = true);

}  // namespace prt::tools
