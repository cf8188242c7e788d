// Stage 2: coefficients of visibility to principal vectors and weights, in two passes over any number of
// points.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "compress/pca.h"
#include "compress/row_sample.h"
#include "compress/visibility_rows.h"
#include "precompute/io/visibility_file.h"
#include "precompute/math/irradiance_weight.h"

namespace prt {

enum class WeightsFit {
    Irradiance,  ///< least squares of the irradiance that shading normals receive
    Plain        ///< least squares of coefficients
};

/// What the vectors are the principal ones of.
enum class Covariance {
    Irradiance,  ///< errors as irradiance sees them, each in the metric of its own normal
    Plain        ///< coefficients
};

struct CompressionSettings {
    int components = 16;  ///< M, 1..n²
    WeightsFit fit = WeightsFit::Irradiance;
    Covariance covariance = Covariance::Irradiance;
};

/// What one pass over all points leaves: their mean and covariance, and a sample of them. Memory does not
/// depend on the number of points: n⁴ doubles and twice 8192 points.
///
/// Coefficients that were projected for irradiance are not compared with each other as they are: far below
/// their horizons, where irradiance does not look, they follow no common pattern, and a basis of them falls
/// apart. Mean and covariance are those of the expansions cut at their horizons.
class VisibilityStatistics {
  public:
    /// @param rows        gone through once, not kept
    /// @param projection  how the rows were made; where it is plain, the metric is that of its weight
    /// @throws InputError  a point that counts is not finite, or the file is damaged; Interrupted
    VisibilityStatistics(const VisibilityRows& rows, const Projection& projection);

    /// Mean and principal vectors. Where the covariance is that of irradiance and weights are fitted for it,
    /// plain vectors are refined by steps of alternating least squares on the sample (refine_basis.h); else
    /// they stay plain.
    /// @throws InputError  no point counts; Interrupted
    PcaResult basis(const CompressionSettings& settings) const;
    /// Points that count, 8192 at most.
    const SampledRows& sample() const { return sample_; }
    /// Number of points that count, of all.
    size_t pointsUsed() const { return moments_.rowsUsed(); }

  private:
    int shOrder_;
    Projection projection_;
    RowMoments moments_;
    SampledRows sample_;
};

/// Errors that compression leaves in the points that count.
struct CompressionErrors {
    double relativeRmse = 0;            ///< of coefficients
    double rmse = 0;                    ///< per coefficient
    double irradianceRelativeRmse = 0;  ///< of coefficients in the metric of irradiance
};

/// Weights of all points, handed to `take` tile by tile in order. Weights fitted for irradiance are those of
/// the rows, each in the metric of its own normal; plain ones are those of the rows cut at their horizons.
/// Where there is no surface they are zero.
/// @param take    [P×M] of the tile, P its number of points
/// @param errors  out, or null where nobody asks
/// @throws InputError  the file is damaged; Interrupted; what `take` throws
void compressRows(const VisibilityRows& rows, const Projection& projection, const PcaResult& pca,
                  WeightsFit fit, const std::function<void(std::span<const float> weights)>& take,
                  CompressionErrors* errors = nullptr);

struct CompressedVisibility {
    PcaResult pca;
    std::vector<float> weights;  ///< [N×M]
};

/// Both passes for rows in memory.
/// @param rows        [N×n²]   @param use  [N] non-zero for rows that count, empty = all
/// @param normals     [N] geometric, unit; zero where there is none
/// @param projection  how the rows were made; where it is plain, weights for irradiance use the default
/// weight
/// @param components  M, 1..n²
/// @param rowWeights  [N] what a row counts, empty = all the same
/// @throws InputError  as computePca
/// @source [IwanickiSloan2012, Sec. 4] for plain rows and weights
CompressedVisibility compressVisibility(std::span<const float> rows, std::span<const uint8_t> use,
                                        std::span<const Vec3f> normals, int shOrder,
                                        const Projection& projection, int components, WeightsFit fit,
                                        Covariance covariance = Covariance::Irradiance,
                                        std::span<const float> rowWeights = {});

/// Vectors of a bundle's visibility as a map without weights; grid, order and projection are those of the
/// visibility. Attributes are left to the caller.
PcaMap pcaMapOf(const VisibilityMap& visibility, const PcaResult& pca);

}  // namespace prt
