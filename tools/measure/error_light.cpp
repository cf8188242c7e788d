// Irradiance by rays, the direct term of the rendering equation [Kajiya1986], and by tables over the normal
// [IwanickiSloan2012, Sec. 3.2].
#include "tools/measure/error_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compress/export_textures.h"
#include "compress/quantize.h"
#include "compress/tables/fast_tables.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "runtime/reference/reference.h"

namespace prt::tools {
namespace {

constexpr size_t kRowsPerSum = 512;  // terms summed in float before they are added in double

// sum[j·n + i] += Σ_k cosine_k light[k][j] basis[k][i]
PRT_TARGET_CLONES
void addTransfer(const float* basis, const float* light, const uint32_t* rows, const float* cosines,
                 size_t count, size_t n, size_t channels, float* sum) {
    for (size_t k = 0; k < count; ++k) {
        const float *y = basis + size_t(rows[k]) * n, *l = light + size_t(rows[k]) * channels;
        for (size_t j = 0; j < channels; ++j) {
            const float weight = cosines[k] * l[j];
            float* out = sum + j * n;
            for (size_t i = 0; i < n; ++i) out[i] += weight * y[i];
        }
    }
}

// Directions above a normal's horizon, and their cosines.
struct Facing {
    std::vector<uint32_t> rows;
    std::vector<float> cosines;

    Facing(std::span<const Vec3f> directions, const Vec3f& normal) {
        for (size_t k = 0; k < directions.size(); ++k) {
            const float cosine = normal.dot(directions[k]);
            if (!(cosine > 0)) continue;
            rows.push_back(uint32_t(k));
            cosines.push_back(cosine);
        }
    }
};

// Puts planes [colour][layer][texel] of one environment where lookups want them: [texel][channel][layer].
void scatter(std::span<const float> planes, size_t layers, size_t texels, size_t environment, size_t channels,
             std::vector<float>& out) {
    out.resize(texels * channels * layers);
    for (size_t c = 0; c < 3; ++c)
        for (size_t m = 0; m < layers; ++m)
            for (size_t t = 0; t < texels; ++t)
                out[(t * channels + environment * 3 + c) * layers + m] =
                    planes[(c * layers + m) * texels + t];
}

std::vector<float> storedValues(std::vector<float> values, int shOrder, const TableOptions& options,
                                const std::string& format, size_t vectors) {
    if (format == "float") return values;
    if (options.layout == "cube") {
        NormalTable table;
        table.kind = TableKind::TripleProduct;
        table.size = options.size;
        table.shOrder = shOrder;
        table.layers = int(vectors + 1);
        table.values = std::move(values);
        return encodeTable(table, format).decoded;
    }
    for (float& value : values) value = floatFromHalf(halfFromFloat(std::clamp(value, -kMaxHalf, kMaxHalf)));
    return values;
}

const TableOptions& checked(const TableOptions& options, const std::string& format) {
    checkTableOptions(options);
    if (options.extractSun)
        throw UsageError("--extract-sun", "a sun's own shadow is no stage of this report",
                         "leave it out; prt relight --compare-reference shows what it gains");
    if (options.size > kLargestJudgedTable)
        throw UsageError("--size", fmt::format("{} is too large to be judged", options.size),
                         fmt::format("use at most {}", kLargestJudgedTable));
    if (options.layout != "cube" && format != "float" && format != "half")
        throw UsageError("--tables", format + " is for cubes alone", "use half or float");
    return options;
}

void lookUp(const SphereTaps& taps, const std::vector<float>& table, size_t values, std::span<float> out) {
    PRT_CHECK_EQ(out.size(), values);
    std::fill(out.begin(), out.end(), 0.0f);
    for (const SphereTap& tap : taps) {
        const float* row = &table[size_t(tap.texel) * values];
        const float weight = float(tap.weight);
        for (size_t i = 0; i < values; ++i) out[i] += weight * row[i];
    }
}

}  // namespace

RayLight::RayLight(std::span<const Environment> environments, int shOrder, int baseCount)
    : channels_(3 * environments.size()), coefficients_(size_t(shCount(shOrder))) {
    const std::vector<double> rotations(environments.size(), 0.0);
    ReferenceDirections reference = makeReferenceDirections(environments, rotations, baseCount);
    directions_ = std::move(reference.direction);
    basis_.resize(directions_.size() * coefficients_);
    evalShBatch(shOrder, directions_, basis_);
    light_.resize(directions_.size() * channels_);
    for (size_t k = 0; k < directions_.size(); ++k)
        for (size_t j = 0; j < channels_; ++j)
            light_[k * channels_ + j] = reference.radiance[j / 3][k * 3 + j % 3] * reference.solidAngleSr[k];
}

void RayLight::irradiance(std::span<const float> visible, const Vec3f& normal, std::span<float> out) const {
    PRT_CHECK_EQ(visible.size(), directions_.size());
    PRT_CHECK_EQ(out.size(), channels_);
    std::vector<double> sum(channels_, 0.0);
    for (size_t k = 0; k < directions_.size(); ++k) {
        const float weight = visible[k] * std::max(0.0f, normal.dot(directions_[k]));
        if (weight == 0) continue;
        for (size_t j = 0; j < channels_; ++j) sum[j] += double(weight * light_[k * channels_ + j]);
    }
    std::transform(sum.begin(), sum.end(), out.begin(), [](double value) { return float(value); });
}

void RayLight::transfer(const Vec3f& normal, std::span<float> out) const {
    const size_t values = channels_ * coefficients_;
    PRT_CHECK_EQ(out.size(), values);
    const Facing facing(directions_, normal);
    std::vector<double> sum(values, 0.0);
    std::vector<float> partial(values);
    for (size_t begin = 0; begin < facing.rows.size(); begin += kRowsPerSum) {
        std::fill(partial.begin(), partial.end(), 0.0f);
        addTransfer(basis_.data(), light_.data(), &facing.rows[begin], &facing.cosines[begin],
                    std::min(kRowsPerSum, facing.rows.size() - begin), coefficients_, channels_,
                    partial.data());
        for (size_t i = 0; i < values; ++i) sum[i] += double(partial[i]);
    }
    std::transform(sum.begin(), sum.end(), out.begin(), [](double value) { return float(value); });
}

TabulatedLight::TabulatedLight(std::span<const Environment> environments, int shOrder,
                               std::span<const float> mean, std::span<const float> basis,
                               const TableOptions& options, const std::string& format)
    : layout_(checked(options, format).layout, options.size),
      cosineBands_(options.cosineBands()),
      shOrder_(shOrder),
      coefficients_(size_t(shCount(shOrder))),
      vectors_(basis.size() / coefficients_),
      texels_(size_t(layout_.texelCount())) {
    PRT_CHECK_EQ(mean.size(), coefficients_);
    LightTableBuilder builder(layout_, shOrder, cosineBands_);
    const size_t channels = 3 * environments.size();
    for (size_t e = 0; e < environments.size(); ++e) {
        environments_.push_back(projectTableLight(environments[e].view(), shOrder, options).rest);
        std::vector<float> planes(3 * coefficients_ * texels_);
        builder.buildLightCosine(environments_.back(), planes);
        scatter(planes, coefficients_, texels_, e, channels, exact_);
        planes.resize(3 * (vectors_ + 1) * texels_);
        builder.buildTripleProduct(environments_.back(), mean, basis, planes);
        scatter(storedValues(std::move(planes), shOrder, options, format, vectors_), vectors_ + 1, texels_, e,
                channels, stored_);
    }
}

void TabulatedLight::transfer(const Vec3f& normal, std::span<float> out) const {
    lookUp(layout_.taps(normal.cast<double>()), exact_, 3 * environments_.size() * coefficients_, out);
}

void TabulatedLight::stored(const Vec3f& normal, std::span<float> out) const {
    lookUp(layout_.taps(normal.cast<double>()), stored_, 3 * environments_.size() * (vectors_ + 1), out);
}

std::vector<float> TabulatedLight::transferWithoutTable(std::span<const Vec3f> normals) const {
    const size_t channels = 3 * environments_.size();
    std::vector<float> result(normals.size() * channels * coefficients_);
    for (size_t e = 0; e < environments_.size(); ++e)
        scatter(evalLightCosine(environments_[e], shOrder_, normals, cosineBands_), coefficients_,
                normals.size(), e, channels, result);
    return result;
}

}  // namespace prt::tools
