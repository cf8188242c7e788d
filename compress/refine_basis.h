// Principal vectors moved towards what irradiance sees.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compress/pca.h"
#include "precompute/math/irradiance_weight.h"

namespace prt {

/// (M + 1)·n² above which vectors stay as they are: so many of them leave nothing to gain.
inline constexpr int kMostRefinedValues = 2048;

/// One step of alternating least squares: the mean and basis that minimise Σ_p e_pᵀ A(n_p) e_p,
/// e_p = row_p − mean − Σ_m w_pm basis_m, for the weights that `pca` has; from a sample of the rows in use.
/// More than three steps lower this sum further, but no longer errors under real light.
/// @param pca        basis orthonormal
/// @param rows       [N×n²]   @param plainRows  [N×n²] what variances are of
/// @param weights    [N×M] of pca for rows, as projectPcaForIrradiance finds them
/// @return mean, and basis orthonormal along the principal axes of plainRows in its span; variances of these
/// @source weighted low-rank approximation by alternating least squares [SrebroJaakkola2003]
PcaResult refineForIrradiance(const PcaResult& pca, std::span<const float> rows,
                              std::span<const float> plainRows, std::span<const float> weights,
                              std::span<const Vec3f> normals, std::span<const uint8_t> use, int shOrder,
                              const IrradianceWeight& weight);

}  // namespace prt
