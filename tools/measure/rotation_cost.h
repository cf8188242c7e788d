// Time and multiplications of every rotation of spherical and hemispherical harmonics.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace prt::tools {

/// All methods by the command line's names; -batch ones take 64 vectors as a structure of arrays:
///   zxzxz[-batch]                      every vector by its own rotation
///   one-zxzxz-batch, one-matrix-batch  one rotation for all vectors, by zxzxz and by a given matrix
///   ivanic, ivanic-apply               the matrix made and applied; applied alone
///   taylor-1, -1.5, -2[-batch]         the turn about y by the truncated series
///   hsh-through-sh                     hemispherical harmonics by way of spherical ones of order min(2n, 24)
///   hsh-digon-removal, hsh-table       by interpolated matrices
const std::vector<std::string>& rotationMethods();

struct RotationCost {
    int shOrder;
    std::string method;
    double ns;               ///< per vector, angles from the matrix included; NaN where not timed
    double multiplications;  ///< of our code per vector, without those of angles and by ±1; NaN for ivanic,
                             ///< whose matrix is not counted
    double paperMultiplications;  ///< by the paper's count; NaN where it has none
    double ratioToZxzxz;          ///< of ns; NaN where zxzxz is not among the methods
    double paperUs;               ///< of publishedRotationTimes, flamingo; NaN where there is none
};

struct RotationCostSettings {
    std::vector<int> shOrders;         ///< 1..kMaxBundleShOrder
    std::vector<std::string> methods;  ///< of rotationMethods()
    int tabulatedAngles = 46;          ///< of the tables of hemispherical harmonics, >= 2
    int rounds = 15;                   ///< of timing; 0: nothing is timed
};

/// By order, then method.
/// @throws Interrupted
/// @source [Krivanek2006, Sec. 3.2] for its counts
std::vector<RotationCost> rotationCosts(const RotationCostSettings& settings);

struct PublishedTime {
    const char* scene;
    const char* method;  ///< as above, or "directx"
    int shOrder;
    double us;  ///< per rotation
};
/// @source [Krivanek2006, Table 1]: time per rotation ("TPR") on the authors' machine of 2006
std::span<const PublishedTime> publishedRotationTimes();

}  // namespace prt::tools
