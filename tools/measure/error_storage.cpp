// Principal vectors [IwanickiSloan2012, Sec. 4], weights fitted to irradiance
// (compress/irradiance_weights.h).
#include "tools/measure/error_storage.h"

#include <Eigen/Core>
#include <algorithm>

#include "compress/irradiance_weights.h"
#include "precompute/math/irradiance_projection.h"
#include "precompute/math/sh.h"

namespace prt::tools {
namespace {

using RowMatrixXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

BundleStorage::BundleStorage(const JudgedBundle& bundle, const std::string& weights)
    : bundle_(bundle),
      shOrder_(bundle.visibility.shOrder),
      dimension_(shCount(shOrder_)),
      format_(bundle.pca || weights == "float" ? weights : "half") {
    const size_t n2 = size_t(dimension_);
    if (!bundle.pca) {
        pca_.components = dimension_;
        pca_.mean.assign(n2, 0.0f);
        pca_.basis.assign(n2 * n2, 0.0f);
        for (size_t i = 0; i < n2; ++i) pca_.basis[i * n2 + i] = 1;
        return;
    }
    pca_.components = bundle.pca->components;
    pca_.mean = bundle.pca->mean;
    pca_.basis = bundle.pca->basis;
    if (!format_.starts_with("unorm")) return;
    bits_ = format_ == "unorm8" ? 8 : 16;
    std::vector<uint8_t> used;
    for (const Validity validity : bundle.visibility.validity) used.push_back(validity == Validity::Valid);
    ranges_ = fitUnormRanges(bundle.pca->weights, components(), bits_, used);
}

std::vector<float> BundleStorage::shipped(std::span<const uint32_t> places) const {
    const std::vector<float>& all = bundle_.pca ? bundle_.pca->weights : bundle_.visibility.coefficients;
    std::vector<float> result;
    result.reserve(places.size() * components());
    for (const uint32_t place : places) {
        const float* row = &all[place * components()];
        result.insert(result.end(), row, row + components());
    }
    return result;
}

std::vector<float> BundleStorage::fit(const std::vector<float>& rows, std::span<const Vec3f> normals) const {
    if (!bundle_.pca) return rows;
    const Projection& projection = bundle_.visibility.projection;
    const bool isWeighted = projection.kind == ProjectionKind::Irradiance;
    if (bundle_.compressedWith != "plain")
        return projectPcaForIrradiance(pca_, rows, normals, shOrder_,
                                       isWeighted ? projection.weight : IrradianceWeight{});
    if (!isWeighted) return projectPca(pca_, rows, dimension_);
    const IrradianceProjection cutter(shOrder_, projection.weight);
    std::vector<float> cut(rows.size());
    const size_t n2 = size_t(dimension_);
    for (size_t p = 0; p < normals.size(); ++p)
        cutter.cutAtHorizon(normals[p], std::span(rows).subspan(p * n2, n2),
                            std::span(cut).subspan(p * n2, n2));
    return projectPca(pca_, cut, dimension_);
}

std::vector<float> BundleStorage::store(std::vector<float> weights) const {
    if (bits_ != 0) return dequantizeUnorm(quantizeUnorm(weights, ranges_, bits_), ranges_, bits_);
    if (format_ == "half")
        for (float& value : weights)
            value = floatFromHalf(halfFromFloat(std::clamp(value, -kMaxHalf, kMaxHalf)));
    return weights;
}

std::vector<float> BundleStorage::expand(const std::vector<float>& weights) const {
    if (!bundle_.pca) return weights;
    const auto count = Eigen::Index(weights.size() / components());
    const Eigen::Map<const RowMatrixXf> w(weights.data(), count, pca_.components),
        basis(pca_.basis.data(), pca_.components, dimension_);
    RowMatrixXf rows = w * basis;
    rows.rowwise() += Eigen::Map<const Eigen::RowVectorXf>(pca_.mean.data(), dimension_);
    return {rows.data(), rows.data() + rows.size()};
}

}  // namespace prt::tools
