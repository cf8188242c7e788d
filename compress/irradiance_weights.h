// Weights of principal vectors, fitted to the irradiance that a point receives.
//
// An error of V counts by what irradiance sees of it (precompute/math/irradiance_weight.h). Plain projection
// spends most of its accuracy on the half of the sphere below the horizon.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compress/pca.h"
#include "precompute/math/irradiance_weight.h"

namespace prt {

/// Weights that minimise eᵀ A(n) e with e = row − mean − Σ w_m basis_m, for all N rows. Each depends on its
/// own row and normal alone. Where the normal is zero or not finite they are those of projectPca, within
/// rounding.
/// @param rows     [N×n²]   @param normals  [N] geometric
/// @return [N×M]
std::vector<float> projectPcaForIrradiance(const PcaResult& pca, std::span<const float> rows,
                                           std::span<const Vec3f> normals, int shOrder,
                                           const IrradianceWeight& weight = {});

/// √(Σ eᵀ A(n) e / Σ vᵀ A(n) v) over the rows v in use, e = v − reconstruction.
/// @param weights  [N×M]   @param use  [N], or empty = all
double irradianceRelativeRmse(const PcaResult& pca, std::span<const float> rows,
                              std::span<const float> weights, std::span<const Vec3f> normals,
                              std::span<const uint8_t> use, int shOrder, const IrradianceWeight& weight = {});

}  // namespace prt
