// Tables over the surface normal: light × cosine, and light × cosine × PCA vector. Arrays in, arrays out.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "precompute/math/environment.h"
#include "precompute/math/table_layout.h"

namespace prt {

/// Bands of the clamped cosine that tables hold by default. What lies beyond is 2e-4 of the irradiance under
/// a sky, 4e-3 to 7e-3 under a sky with a sun of 3 degrees (visibility of 6 bands).
inline constexpr int kTableCosineBands = 12;
/// Order to which an environment must be projected to make tables for visibility of shOrder bands exact.
constexpr int tableEnvironmentShOrder(int shOrder, int cosineBands = kTableCosineBands) {
    return shOrder + cosineBands - 1;
}

/// R_i(n) = ∫ L(ω) max(0, n·ω) Y_i(ω) dω for any normals: what tables are filled with, and judged against.
/// @param environment   of tableEnvironmentShOrder(shOrder, cosineBands) bands or more
/// @param normals       [N] unit
/// @return [3 colours][n²][N]
/// @source [IwanickiSloan2012, Sec. 3.2-3.3]: product matrix of the environment (rows: bands of the cosine)
/// times the cosine's coefficients about each normal
std::vector<float> evalLightCosine(const EnvironmentSh& environment, int shOrder,
                                   std::span<const Vec3f> normals, int cosineBands = kTableCosineBands);

/// R_i(n) for every texel normal n of a cube of the given size (layout: math/sphere_map.h), made by a
/// LightTableBuilder: within 1e-5 of the largest value from evalLightCosine.
/// @param environment   of tableEnvironmentShOrder(shOrder, cosineBands) bands or more
/// @param size          1..1024
/// @return [3 colours][n²][6·size·size]
std::vector<float> buildLightCosineTable(const EnvironmentSh& environment, int shOrder, int size,
                                         int cosineBands = kTableCosineBands);

/// T_m(n) = ∫ L H_n V_m = Σ_i R_i(n) basis_mi; the mean comes last.
/// @param lightCosine  as returned by buildLightCosineTable
/// @param mean   [n²]   @param basis  [M×n²]
/// @return [3][M + 1][6·size·size]
/// @source [IwanickiSloan2012, Eq. 6]
std::vector<float> buildTripleProductTable(std::span<const float> lightCosine, int shOrder, int size,
                                           std::span<const float> mean, std::span<const float> basis);

/// Bilinear lookup of all layers at one normal, as the hardware does it.
/// @param table  [3][layers][layout.texelCount()]   @return [3][layers]
std::vector<float> lookUpTable(std::span<const float> table, int layers, const TableLayout& layout,
                               const Vec3d& normal);
/// The same in the cube layout, seamless.
std::vector<float> lookUpTable(std::span<const float> table, int layers, int size, const Vec3d& normal);

}  // namespace prt
