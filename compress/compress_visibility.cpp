// Principal components [IwanickiSloan2012, Sec. 4] of visibility that was projected plainly or for
// irradiance.
#include "compress/compress_visibility.h"

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
// Irradiance at geometric and tilted normals gains 1 to 4 % from the second and third, nothing from more.
constexpr int kRefinements = 3;

std::vector<float> cutAtHorizons(std::span<const float> rows, std::span<const Vec3f> normals, int shOrder,
                                 const IrradianceWeight& weight) {
    const size_t dimension = size_t(shCount(shOrder));
    const IrradianceProjection projection(shOrder, weight);
    std::vector<float> cut(rows.begin(), rows.end());
    parallelFor(normals.size(), kBlockPoints, [&](size_t begin, size_t end) {
        throwIfInterrupted();
        for (size_t i = begin; i < end; ++i) {
            const std::span<float> row(&cut[i * dimension], dimension);
            const float square = normals[i].squaredNorm();
            if (square > 0.5f && square < 2) projection.cutAtHorizon(normals[i].normalized(), row, row);
        }
    });
    return cut;
}

}  // namespace

CompressedVisibility compressVisibility(std::span<const float> rows, std::span<const uint8_t> use,
                                        std::span<const Vec3f> normals, int shOrder,
                                        const Projection& projection, int components, WeightsFit fit) {
    const int dimension = shCount(shOrder);
    PRT_CHECK_EQ(rows.size(), normals.size() * size_t(dimension));
    std::vector<float> cut;
    std::span<const float> plainRows = rows;
    if (projection.kind == ProjectionKind::Irradiance) {
        cut = cutAtHorizons(rows, normals, shOrder, projection.weight);
        plainRows = cut;
    }
    CompressedVisibility result;
    result.pca = computePca(plainRows, use, dimension, components);
    if (fit == WeightsFit::Plain) {
        result.weights = projectPca(result.pca, plainRows, dimension);
        return result;
    }
    const IrradianceWeight& weight = projection.weight;
    result.weights = projectPcaForIrradiance(result.pca, rows, normals, shOrder, weight);
    if (projection.kind == ProjectionKind::Plain) return result;
    for (int round = 0; round < kRefinements; ++round) {
        throwIfInterrupted();
        result.pca =
            refineForIrradiance(result.pca, rows, plainRows, result.weights, normals, use, shOrder, weight);
        result.weights = projectPcaForIrradiance(result.pca, rows, normals, shOrder, weight);
    }
    return result;
}

}  // namespace prt
