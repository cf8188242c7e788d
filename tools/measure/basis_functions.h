// Pictures of basis functions: [HabelWimmer2010, Fig. 2], [Gautron2004, Fig. 10].
#pragma once

#include <string>

#include "precompute/math/basis.h"
#include "tools/measure/figure.h"
#include "tools/measure/table.h"

namespace prt::tools {

/// Name, band and azimuthal order of one function.
struct FunctionLabel {
    std::string title;  ///< "l = 1, m = −1", "H5", …
    int band;
    int m;
};
/// Of all functions of a basis, in their order.
std::vector<FunctionLabel> functionLabels(const Basis& basis);

/// One panel per function, a row per band, m rising from left to right: the surface |f(ω)|·ω, coloured by
/// sign, over the domain of the basis, scaled to the largest |f| of each.
Figure basisFigure(const Basis& basis, const std::string& title);

/// Rows basis, order, coefficients, function, band, m, lowest, highest.
Table functionTable();
void addFunctionRows(const Basis& basis, Table& table);

}  // namespace prt::tools
