// Stage 2 in memory: coefficients of visibility to principal vectors and weights.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compress/pca.h"
#include "precompute/math/irradiance_weight.h"

namespace prt {

enum class WeightsFit {
    Irradiance,  ///< least squares of the irradiance that shading normals receive
    Plain        ///< least squares of coefficients
};

struct CompressedVisibility {
    PcaResult pca;
    std::vector<float> weights;  ///< [N×M]
};

/// Principal vectors of all rows in use, weights of all rows.
///
/// Coefficients that were projected for irradiance are not compared with each other as they are: far below
/// their horizons, where irradiance does not look, they follow no common pattern, and a basis of them falls
/// apart. The basis comes from the expansions cut at their horizons, refined by steps of alternating least
/// squares (refine_basis.h); weights fitted for irradiance are those
/// of the full ones, each in the metric of its own normal; plain weights are those of the cut ones.
/// @param rows        [N×n²]   @param use  [N] non-zero for rows that count, empty = all
/// @param normals     [N] geometric, unit; zero where there is none
/// @param projection  how the rows were made; where it is plain, weights for irradiance use the default
/// weight
/// @param components  M, 1..n²
/// @throws InputError  as computePca
/// @source [IwanickiSloan2012, Sec. 4] for plain rows and weights
CompressedVisibility compressVisibility(std::span<const float> rows, std::span<const uint8_t> use,
                                        std::span<const Vec3f> normals, int shOrder,
                                        const Projection& projection, int components, WeightsFit fit);

}  // namespace prt
