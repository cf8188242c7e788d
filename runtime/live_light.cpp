// Light of the moment: environments are blended and turned as spherical harmonics, where both are exact up to
// the order in use, and the tables are built again from the result [IwanickiSloan2012, Sec. 3.3].
#include "runtime/live_light.h"

#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/sh.h"

namespace prt {

LiveLight::LiveLight(const std::vector<Environment>& environments, int shOrder, const TableOptions& options)
    : shOrder_(shOrder), options_(options) {
    static std::atomic<uint64_t> last{0};
    id_ = ++last;
    PRT_CHECK(!environments.empty());
    for (const Environment& environment : environments) {
        TableLight light = projectTableLight(environment.view(), shOrder, options);
        environments_.push_back(std::move(light.rest));
        suns_.push_back(std::move(light.sun));
        names_.push_back(environment.name);
        hashes_.push_back(environment.contentHash);
    }
}

EnvironmentSh LiveLight::blend(const std::vector<double>& weights, double rotationRad) const {
    PRT_CHECK_EQ(weights.size(), environments_.size());
    EnvironmentSh light = blendEnvironments(environments_, weights);
    return rotationRad == 0 ? light : rotateEnvironmentAboutUp(light, rotationRad);
}

LightTableBuilder& LiveLight::builder(int shOrder, int cosineBands) const {
    const std::pair key(shOrder, cosineBands);
    auto found = builders_.find(key);
    if (found == builders_.end())
        found = builders_.try_emplace(key, TableLayout(options_.layout, options_.size), shOrder, cosineBands)
                    .first;
    return found->second;
}

NormalTable LiveLight::emptyTable(const LightTableBuilder& builder, TableKind kind, int layers,
                                  const std::vector<double>& weights, double rotationRad) const {
    PRT_CHECK_EQ(weights.size(), environments_.size());
    NormalTable table;
    table.kind = kind;
    table.layout = options_.layout;
    table.size = options_.size;
    table.shOrder = builder.shOrder();
    table.layers = layers;
    table.values.resize(size_t(3) * size_t(layers) * table.texels());
    std::string names, hashes;
    for (size_t k = 0; k < weights.size(); ++k) {
        if (weights[k] == 0) continue;
        names += fmt::format("{}{}:{:g}", names.empty() ? "" : " + ", names_[k], weights[k]);
        hashes += (hashes.empty() ? "" : " ") + hashes_[k];
    }
    table.attributes = {{"environmentName", names},
                        {"environmentHash", hashes},
                        {"rotationDeg", fmt::format("{:.9g}", rotationRad * 180 / std::numbers::pi)},
                        {"cosineBands", std::to_string(builder.cosineBands())}};
    return table;
}

NormalTable LiveLight::lightCosineTable(const std::vector<double>& weights, double rotationRad,
                                        int shOrder) const {
    PRT_CHECK_LE(shOrder, shOrder_);
    LightTableBuilder& maker = builder(shOrder == 0 ? shOrder_ : shOrder, cosineBands());
    NormalTable table =
        emptyTable(maker, TableKind::LightCosine, shCount(maker.shOrder()), weights, rotationRad);
    maker.buildLightCosine(blend(weights, rotationRad), table.values);
    return table;
}

NormalTable LiveLight::tripleProductTable(const std::vector<double>& weights, double rotationRad,
                                          const PcaMap& pca) const {
    PRT_CHECK_LE(pca.shOrder, shOrder_);
    LightTableBuilder& maker = builder(pca.shOrder, cosineBands());
    NormalTable table = emptyTable(maker, TableKind::TripleProduct, pca.components + 1, weights, rotationRad);
    maker.buildTripleProduct(blend(weights, rotationRad), pca.mean, pca.basis, table.values);
    return table;
}

NormalTable LiveLight::preconvolvedTable(const std::vector<double>& weights, double rotationRad) const {
    const bool exact = cosineBands() != kPaperCosineBands;
    LightTableBuilder& maker = builder(1, exact ? environments_.front().shOrder : kPaperCosineBands);
    NormalTable table = emptyTable(maker, TableKind::TripleProduct, 1, weights, rotationRad);
    maker.buildLightCosine(blend(weights, rotationRad), table.values);
    // What is open has the one coefficient √4π.
    for (float& value : table.values) value *= std::sqrt(4 * std::numbers::pi_v<float>);
    return table;
}

}  // namespace prt
