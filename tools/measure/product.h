// Time, non-zeros and multiplications of products of spherical-harmonic expansions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace prt::tools {

/// All methods by the command line's names; -batch ones take 64 pairs as a structure of arrays:
///   table                       sum over all non-zero tripling coefficients, into a new array
///   straight-line[-batch]       generated code, to kMaxProductCodeOrder
///   matrix[-batch]              a prebuilt matrix of one factor, applied
///   matrix-build                that matrix built
const std::vector<std::string>& productMethods();

struct ProductCost {
    int shOrder;
    std::string method;
    double ns;                           ///< per product, NaN where not timed
    int64_t nonZeros;                    ///< of the tripling coefficients
    int64_t multiplications, additions;  ///< per product
    double ratioToSingle;                ///< of ns: over that of straight-line; NaN where that is not timed
};

struct ProductCostSettings {
    std::vector<int> shOrders;         ///< 1..kMaxBundleShOrder
    std::vector<std::string> methods;  ///< of productMethods()
    int rounds = 31;                   ///< of timing; 0: nothing is timed
};

/// By order, then method; above kMaxProductCodeOrder without straight-line.
/// @throws Interrupted
std::vector<ProductCost> productCosts(const ProductCostSettings& settings);

}  // namespace prt::tools
