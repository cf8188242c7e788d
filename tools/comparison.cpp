#include "tools/comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"

namespace prt::tools {
namespace {

/// v += weights_k Y_k over visible directions.
PRT_TARGET_CLONES
void projectVisible(const uint8_t* visible, const float* basis, const float* weights, size_t directions,
                    int n, float* v) {
    std::fill_n(v, n, 0.0f);
    for (size_t k = 0; k < directions; ++k) {
        if (!visible[k]) continue;
        const float* row = basis + k * size_t(n);
        const float weight = weights[k];
        for (int i = 0; i < n; ++i) v[i] += weight * row[i];
    }
}

/// light_out[j] = Σ_k (v·Y_k) max(0, n·ω_k) light[k][j]
PRT_TARGET_CLONES
void integrateExpansion(const float* v, const float* basis, const Vec3f* direction, const float* light,
                        size_t directions, int n, int channels, const float* normal, float* out) {
    std::fill_n(out, channels, 0.0f);
    for (size_t k = 0; k < directions; ++k) {
        const float* w = direction[k].data();
        const float cosine = normal[0] * w[0] + normal[1] * w[1] + normal[2] * w[2];
        if (cosine <= 0) continue;
        const float* row = basis + k * size_t(n);
        float value = 0;
        for (int i = 0; i < n; ++i) value += v[i] * row[i];
        value *= cosine;
        const float* lightRow = light + k * size_t(channels);
        for (int j = 0; j < channels; ++j) out[j] += value * lightRow[j];
    }
}

}  // namespace

IrradianceError compareIrradiance(std::span<const float> estimate, std::span<const float> truth,
                                  const SurfaceImage& surface) {
    double difference = 0, reference = 0, peak = 0;
    size_t count = 0;
    for (size_t p = 0; p < surface.pixels(); ++p) {
        if (surface.triangle[p] == kNoTriangle) continue;
        for (size_t c = 3 * p; c < 3 * p + 3; ++c) {
            const double d = double(estimate[c]) - double(truth[c]);
            difference += d * d;
            reference += double(truth[c]) * double(truth[c]);
            peak = std::max(peak, double(truth[c]));
            ++count;
        }
    }
    IrradianceError error;
    if (count == 0) return error;
    error.relativeRmse = reference > 0 ? std::sqrt(difference / reference) : (difference > 0 ? INFINITY : 0);
    const double rmse = std::sqrt(difference / double(count));
    error.psnrDb = rmse > 0 ? 20 * std::log10(peak / rmse) : std::numeric_limits<double>::infinity();
    return error;
}

TruncationFloor::TruncationFloor(const SurfaceImage& surface, const ReferenceDirections& directions,
                                 int shOrder, const Projection& projection)
    : surface_(surface), directions_(directions), coefficients_(shCount(shOrder)) {
    if (projection.kind == ProjectionKind::Irradiance)
        weighted_.emplace(Weighted{IrradianceProjection(shOrder, projection.weight),
                                   irradianceWeightTable(projection.weight)});
    const size_t count = directions.direction.size(), environments = directions.radiance.size();
    basis_.resize(count * size_t(coefficients_));
    evalShBatch(shOrder, directions.direction, basis_);
    light_.resize(count * 3 * environments);
    for (size_t k = 0; k < count; ++k)
        for (size_t e = 0; e < environments; ++e)
            for (size_t c = 0; c < 3; ++c)
                light_[(k * environments + e) * 3 + c] =
                    directions.radiance[e][3 * k + c] * directions.solidAngleSr[k];
    irradiance_.assign(environments, std::vector<float>(surface.pixels() * 3, 0.0f));
}

void TruncationFloor::projectWeighted(const Vec3f& normal, std::span<const uint8_t> visible,
                                      std::span<float> v) const {
    std::vector<float> weights(visible.size(), 0.0f);
    double seen = 0, open = 0;
    for (size_t k = 0; k < visible.size(); ++k) {
        const float cosine = std::clamp(normal.dot(directions_.direction[k]), -1.0f, 1.0f);
        const double solidAngle = double(directions_.solidAngleSr[k]);
        open += std::max(0.0, double(cosine)) * solidAngle;
        if (!visible[k]) continue;
        seen += std::max(0.0, double(cosine)) * solidAngle;
        weights[k] = float(double(weighted_->weight(cosine)) * solidAngle);
    }
    projectVisible(visible.data(), basis_.data(), weights.data(), visible.size(), coefficients_, v.data());
    weighted_->projection.solve(normal, v, open > 0 ? float(std::numbers::pi * seen / open) : 0.0f, v);
}

ReferenceVisitor TruncationFloor::visitor() {
    return [this](size_t pixel, std::span<const uint8_t> visible) {
        const size_t environments = irradiance_.size();
        std::vector<float> v(static_cast<size_t>(coefficients_)), out(environments * 3);
        if (weighted_)
            projectWeighted(surface_.geometricNormal[pixel], visible, v);
        else
            projectVisible(visible.data(), basis_.data(), directions_.solidAngleSr.data(), visible.size(),
                           coefficients_, v.data());
        integrateExpansion(v.data(), basis_.data(), directions_.direction.data(), light_.data(),
                           visible.size(), coefficients_, int(out.size()),
                           surface_.shadingNormal[pixel].data(), out.data());
        for (size_t e = 0; e < environments; ++e)
            std::copy_n(out.data() + 3 * e, 3, irradiance_[e].data() + 3 * pixel);
    };
}

}  // namespace prt::tools
