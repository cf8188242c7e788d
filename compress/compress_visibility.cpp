// Principal components [IwanickiSloan2012, Sec. 4] of visibility that was projected plainly or for
// irradiance.
#include "compress/compress_visibility.h"

#include <algorithm>

#include "compress/irradiance_weights.h"
#include "compress/refine_basis.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/irradiance_projection.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

constexpr size_t kBlockPoints = 2048;
constexpr size_t kSampledPoints = 8192;
// Irradiance at geometric and tilted normals gains 1 to 4 % from the second and third, nothing from more.
constexpr int kRefinements = 3;

// Rows as plain components are found of: cut at their horizons where they were projected for irradiance.
class PlainRows {
  public:
    PlainRows(int shOrder, const Projection& projection)
        : dimension_(size_t(shCount(shOrder))),
          isCut_(projection.kind == ProjectionKind::Irradiance),
          projection_(shOrder, projection.weight) {}

    /// @return [P×n²] of the tile; lives until the next call
    std::span<const float> of(const VisibilityTile& tile) {
        if (!isCut_) return tile.rows;
        cut_.resize(tile.rows.size());
        parallelFor(tile.normals.size(), kBlockPoints, [&](size_t begin, size_t end) {
            throwIfInterrupted();
            for (size_t i = begin; i < end; ++i) {
                const std::span<const float> row = tile.rows.subspan(i * dimension_, dimension_);
                const std::span<float> out(&cut_[i * dimension_], dimension_);
                const float square = tile.normals[i].squaredNorm();
                if (square > 0.5f && square < 2)
                    projection_.cutAtHorizon(tile.normals[i].normalized(), row, out);
                else
                    std::copy(row.begin(), row.end(), out.begin());
            }
        });
        return cut_;
    }

  private:
    size_t dimension_;
    bool isCut_;
    IrradianceProjection projection_;
    std::vector<float> cut_;
};

}  // namespace

VisibilityStatistics::VisibilityStatistics(const VisibilityRows& rows, const Projection& projection)
    : shOrder_(rows.shOrder()), projection_(projection), moments_(shCount(rows.shOrder())) {
    const size_t dimension = size_t(shCount(shOrder_));
    PlainRows plainRows(shOrder_, projection);
    RowSampler sampler(kSampledPoints, dimension);
    rows.forEachTile([&](const VisibilityTile& tile) {
        PRT_CHECK_EQ(tile.rows.size(), tile.normals.size() * dimension);
        moments_.add(plainRows.of(tile), tile.use, tile.rowWeights);
        sampler.add(tile.rows, tile.normals, tile.use, tile.rowWeights);
    });
    sample_ = sampler.sample();
}

PcaResult VisibilityStatistics::basis(const CompressionSettings& settings) const {
    PcaResult pca = principalComponents(moments_, settings.components);
    if (settings.covariance == Covariance::Plain || settings.fit == WeightsFit::Plain) return pca;
    const SampledRows sample = thinned(sample_, size_t(shCount(shOrder_)), mostRefinementRows(shOrder_));
    const std::vector<double> covariance = moments_.covariance();
    for (int round = 0; round < kRefinements; ++round) {
        throwIfInterrupted();
        const std::vector<float> weights =
            projectPcaForIrradiance(pca, sample.rows, sample.normals, shOrder_, projection_.weight);
        pca = refineForIrradiance(pca, sample.rows, weights, sample.normals, sample.rowWeights, covariance,
                                  shOrder_, projection_.weight);
    }
    return pca;
}

void compressRows(const VisibilityRows& rows, const Projection& projection, const PcaResult& pca,
                  WeightsFit fit, const std::function<void(std::span<const float> weights)>& take,
                  CompressionErrors* errors) {
    const int dimension = shCount(rows.shOrder());
    const size_t components = size_t(pca.components);
    const IrradianceFit forIrradiance(pca, rows.shOrder(), projection.weight);
    PlainRows plainRows(rows.shOrder(), projection);
    std::vector<float> weights;
    PcaErrorSums plain;
    IrradianceErrorSums seen;
    rows.forEachTile([&](const VisibilityTile& tile) {
        throwIfInterrupted();
        weights.resize(tile.normals.size() * components);
        if (fit == WeightsFit::Plain)
            projectPca(pca, plainRows.of(tile), dimension, weights);
        else if (!errors)
            forIrradiance.fit(tile.rows, tile.normals, weights);
        else
            seen += forIrradiance.fitAndSum(tile.rows, tile.normals, tile.use, tile.rowWeights, weights);
        if (errors) {
            plain += pcaErrorSums(pca, tile.rows, weights, tile.use, dimension, tile.rowWeights);
            if (fit == WeightsFit::Plain)
                seen += forIrradiance.sum(tile.rows, tile.normals, tile.use, tile.rowWeights, weights);
        }
        for (size_t i = 0; i < tile.surface.size(); ++i)
            if (!tile.surface[i]) std::fill_n(&weights[i * components], components, 0.0f);
        take(weights);
    });
    if (!errors) return;
    const PcaError error = plain.result(dimension);
    *errors = {error.relativeRmse, error.rmse, seen.relativeRmse()};
}

CompressedVisibility compressVisibility(std::span<const float> rows, std::span<const uint8_t> use,
                                        std::span<const Vec3f> normals, int shOrder,
                                        const Projection& projection, int components, WeightsFit fit,
                                        Covariance covariance, std::span<const float> rowWeights) {
    const VisibilityInMemory source(shOrder, {0, rows, normals, use, {}, rowWeights});
    CompressedVisibility result;
    result.pca = VisibilityStatistics(source, projection).basis({components, fit, covariance});
    compressRows(source, projection, result.pca, fit, [&](std::span<const float> weights) {
        result.weights.assign(weights.begin(), weights.end());
    });
    return result;
}

PcaMap pcaMapOf(const VisibilityMap& visibility, const PcaResult& pca) {
    PcaMap map;
    map.grid = visibility.grid;
    map.shOrder = visibility.shOrder;
    map.components = pca.components;
    map.mean = pca.mean;
    map.basis = pca.basis;
    map.variance = pca.variance;
    map.projection = visibility.projection;
    return map;
}

}  // namespace prt
