// Matrices that turn spherical harmonics into hemispherical bases: c_H = T c_SH, exact projections of the
// part above the horizon.
#pragma once

#include <vector>

namespace prt {

/// T[i·n² + j] = ∫_{z≥0} H^{i+1} Y_j, the six functions of the H-basis (rows 0…3 are those of H₄), to 1e-14.
/// @param shOrder  n, 1..kMaxShOrder
/// @return [6×n²] row-major, dimensionless
/// @source [HabelWimmer2010, Sec. 4.1 and Eq. 17]
std::vector<double> shToHMatrix(int shOrder);

/// C[i·sh² + j] = ∫_{z≥0} H_i Y_j, to 1e-13. Its transpose turns hemispherical into spherical harmonics,
/// continued by zero below the horizon.
/// @param hshOrder, shOrder  1..kMaxShOrder
/// @return [hshOrder²×shOrder²] row-major, dimensionless
/// @source [Gautron2004, Eq. 18]
std::vector<double> shToHshMatrix(int hshOrder, int shOrder);

}  // namespace prt
