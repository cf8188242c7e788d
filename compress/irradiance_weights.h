// Weights of principal vectors, fitted to the irradiance that a point receives.
//
// What is displayed is ∫ V L max(0, n_s·ω) dω, so an error of V counts by w(ω·n), the mean of max(0, n_s·ω)²
// over the shading normals n_s in a cone about the geometric normal n, plus a floor that keeps V bounded
// where no shading normal sees it. Plain projection spends most of its accuracy on the half of the sphere
// below the horizon.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compress/pca.h"
#include "precompute/math/vec.h"

namespace prt {

/// Half-angle of the cone of shading normals.
inline constexpr double kIrradianceConeDegrees = 35;
/// Floor of w, as a share of its largest value before the floor is added. A trade: a smaller floor lowers
/// errors of irradiance a little further and lets coefficients depart more from those of V.
inline constexpr double kIrradianceFloor = 0.002;

/// w as a function of the angle to the normal: w(ω) = Σ_l zonal_l Y_l0(ω) for a normal along +Z. Exact.
/// @param bands  1..kMaxShOrder
/// @return [bands]
std::vector<double> irradianceWeightZonal(int bands);

/// A_ij = ∫ w(ω·n) Y_i Y_j dω, so that eᵀ A e = ∫ w e² for every e of shOrder bands. Positive definite; its
/// eigenvalues lie between the floor and the largest value of w.
/// @param normal   of any length; one that is zero or not finite gives a multiple of the identity
/// @param shOrder  1..kMaxBundleShOrder
/// @return [n²×n²]
std::vector<float> irradianceMetric(const Vec3f& normal, int shOrder);

/// Weights that minimise eᵀ A(n) e with e = row − mean − Σ w_m basis_m, for all N rows. Each depends on its
/// own row and normal alone. Where the normal is zero or not finite they are those of projectPca, within
/// rounding.
/// @param rows     [N×n²]   @param normals  [N] geometric
/// @return [N×M]
std::vector<float> projectPcaForIrradiance(const PcaResult& pca, std::span<const float> rows,
                                           std::span<const Vec3f> normals, int shOrder);

/// √(Σ eᵀ A(n) e / Σ vᵀ A(n) v) over the rows v in use, e = v − reconstruction.
/// @param weights  [N×M]   @param use  [N], or empty = all
double irradianceRelativeRmse(const PcaResult& pca, std::span<const float> rows,
                              std::span<const float> weights, std::span<const Vec3f> normals,
                              std::span<const uint8_t> use, int shOrder);

}  // namespace prt
