// Light of the moment: environments are blended and turned as spherical harmonics, where both are exact up to
// the order in use, and the tables are built again from the result [IwanickiSloan2012, Sec. 3.3].
#include "runtime/live_light.h"

#include <fmt/format.h>

#include <numbers>

#include "compress/tables/normal_tables.h"
#include "precompute/base/check.h"
#include "precompute/math/sh.h"

namespace prt {

LiveLight::LiveLight(const std::vector<Environment>& environments, int shOrder, int tableSize)
    : shOrder_(shOrder), tableSize_(tableSize), builder_(TableLayout("cube", tableSize), shOrder) {
    PRT_CHECK(!environments.empty());
    for (const Environment& environment : environments) {
        environments_.push_back(projectEnvironment(environment.view(), tableEnvironmentShOrder(shOrder)));
        names_.push_back(environment.name);
        hashes_.push_back(environment.contentHash);
    }
}

NormalTable LiveLight::lightCosineTable(const std::vector<double>& weights, double rotationRad) const {
    PRT_CHECK_EQ(weights.size(), environments_.size());
    EnvironmentSh light = blendEnvironments(environments_, weights);
    if (rotationRad != 0) light = rotateEnvironmentAboutUp(light, rotationRad);

    NormalTable table;
    table.kind = TableKind::LightCosine;
    table.size = tableSize_;
    table.shOrder = shOrder_;
    table.layers = shCount(shOrder_);
    table.values.resize(size_t(3) * size_t(table.layers) * table.texels());
    builder_.buildLightCosine(light, table.values);
    std::string names, hashes;
    for (size_t k = 0; k < weights.size(); ++k) {
        if (weights[k] == 0) continue;
        names += fmt::format("{}{}:{:g}", names.empty() ? "" : " + ", names_[k], weights[k]);
        hashes += (hashes.empty() ? "" : " ") + hashes_[k];
    }
    table.attributes = {{"environmentName", names},
                        {"environmentHash", hashes},
                        {"rotationDeg", fmt::format("{:.9g}", rotationRad * 180 / std::numbers::pi)},
                        {"cosineBands", std::to_string(kTableCosineBands)}};
    return table;
}

NormalTable LiveLight::tripleProductTable(const std::vector<double>& weights, double rotationRad,
                                          const PcaMap& pca) const {
    PRT_CHECK_EQ(pca.shOrder, shOrder_);
    NormalTable table = lightCosineTable(weights, rotationRad);
    table.kind = TableKind::TripleProduct;
    table.layers = pca.components + 1;
    table.values = buildTripleProductTable(table.values, shOrder_, tableSize_, pca.mean, pca.basis);
    return table;
}

}  // namespace prt
