// How far the three rotations of hemispherical harmonics are from rotating and clipping the function itself.
#pragma once

#include <string>
#include <vector>

namespace prt::tools {

/// Names of the three methods of [Gautron2004, Sec. 4], as in rotationMethods().
inline constexpr const char* kHshThroughSh = "hsh-through-sh";
inline constexpr const char* kHshDigonRemoval = "hsh-digon-removal";
inline constexpr const char* kHshTable = "hsh-table";

/// The function: max(0, ω·d)^5 with d tilted by this much from the pole towards +X, turned about y further
/// that way.
inline constexpr double kHshLobeTiltDeg = 45;
/// Largest turn, which brings d to the horizon.
inline constexpr int kMaxHshBetaDeg = 45;

/// |c' − c| / |c|: c' the lobe's projected coefficients rotated, c those of the function that is rotated and
/// set to 0 below the horizon. It holds what the rotation does wrong and what the projection before it left
/// out.
struct HshError {
    int hshOrder;
    std::string method;
    int shOrder;          ///< of the spherical harmonics in between; 0: none
    int tabulatedAngles;  ///< over 0…180°, linear in between; 0: the matrix of β itself
    double betaDeg;
    double relativeError;
};

/// Orders in between that are compared: n, 3n/2, 2n and the largest there is.
std::vector<int> hshIntermediateOrders(int hshOrder);

/// Every method at β = 0, stepDeg, … kMaxHshBetaDeg: the first for all orders in between, the second and
/// third without tables, the third with tables of 10, 19 and 37 angles too.
/// @param hshOrder  1..kMaxShOrder
/// @throws Interrupted
/// @source [Gautron2004, Sec. 4]
std::vector<HshError> hshErrors(int hshOrder, double stepDeg = 2.5);

/// What interpolation costs, over kHshTableBetas angles evenly in 0…kMaxHshBetaDeg that no table holds.
struct HshTableError {
    int hshOrder;
    std::string method;
    int tabulatedAngles;
    size_t bytes;               ///< of the tables of that method, in float
    double relativeError;       ///< root mean square of HshError::relativeError
    double interpolationError;  ///< the same against the matrix of β itself instead of the function
};
inline constexpr int kHshTableBetas = 32;

/// Tables of 4 … 181 angles, by number of angles, second and third method each.
/// @throws Interrupted
std::vector<HshTableError> hshTableErrors(int hshOrder);

}  // namespace prt::tools
