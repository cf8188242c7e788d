// Principal vectors moved towards what irradiance sees.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "compress/pca.h"
#include "precompute/math/irradiance_weight.h"

namespace prt {

/// (M + 1)·n² above which vectors stay as they are: so many of them leave nothing to gain.
inline constexpr int kMostRefinedValues = 2048;

/// Rows that a step looks at, at most: no more make a better basis. Their metrics take up to 64 MB (n = 10;
/// 21 MB at 6, 1 MB at 3).
size_t mostRefinementRows(int shOrder);

/// One step of alternating least squares: the mean and basis that minimise Σ_p a_p e_pᵀ A(n_p) e_p,
/// e_p = row_p − mean − Σ_m w_pm basis_m, for the weights that `pca` has.
/// More than three steps lower this sum further, but no longer errors under real light.
/// @param pca         basis orthonormal
/// @param rows        [P×n²] a sample of the rows, mostRefinementRows() at most
/// @param weights     [P×M] of pca for rows, as projectPcaForIrradiance finds them
/// @param normals     [P] geometric
/// @param rowWeights  [P] a_p, finite, not negative; empty = all 1
/// @param covariance  [n²×n²] what variances are of
/// @return mean, and basis orthonormal along the principal axes of the covariance in its span; variances of
/// these. `pca` itself where there is nothing to gain, or rows do not determine the vectors
/// @source weighted low-rank approximation by alternating least squares [SrebroJaakkola2003]
PcaResult refineForIrradiance(const PcaResult& pca, std::span<const float> rows,
                              std::span<const float> weights, std::span<const Vec3f> normals,
                              std::span<const float> rowWeights, std::span<const double> covariance,
                              int shOrder, const IrradianceWeight& weight);

}  // namespace prt
