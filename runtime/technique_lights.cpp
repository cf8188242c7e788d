// Sources: [IwanickiSloan2012, Sec. 3.3] tables are linear in the light, so that those of single environments
// can be blended in place of the environments.
#include "runtime/technique_lights.h"

#include <utility>

#include "precompute/base/check.h"
#include "precompute/base/error.h"

namespace prt {
namespace {

NormalTable tableOf(Technique technique, const TechniqueData& data, const LiveLight& light,
                    const std::vector<double>& weights, double rotationRad) {
    if (technique.kind == TechniqueKind::PreconvolvedAo) return light.preconvolvedTable(weights, rotationRad);
    return readsVisibility(technique) ? light.lightCosineTable(weights, rotationRad, data.shOrder())
                                      : light.tripleProductTable(weights, rotationRad, data.basis());
}

}  // namespace

void TechniqueLights::set(Technique technique, TechniqueData& data, const LiveLight& light,
                          const std::vector<double>& weights, double rotationRad, BlendOn blendOn) {
    if (technique.kind == TechniqueKind::ShLightmap)
        throw InputError(techniqueName(technique), "its light is in its data",
                         "add the lightmap of another light");
    State& state = states_[technique];
    Given given{light.id(), weights, rotationRad, blendOn};
    if (state.given == given) return;
    state.given.reset();
    if (!usesTable(technique)) {
        data.setLight(light.blend(weights, rotationRad), light.cosineBands());
    } else if (blendOn == BlendOn::Cpu) {
        state.tables.clear();
        data.setTable(tableOf(technique, data, light, weights, rotationRad));
        ++tableUploads_;
    } else {
        blendOnGpu(technique, data, light, given, state);
    }
    state.given = std::move(given);
}

void TechniqueLights::blendOnGpu(Technique technique, TechniqueData& data, const LiveLight& light,
                                 const Given& given, State& state) {
    const size_t count = given.weights.size();
    PRT_CHECK_EQ(count, light.environmentCount());
    if (state.light != given.light || state.rotationRad != given.rotationRad ||
        state.tables.size() != count) {
        state.made.assign(count, false);
        state.tables.resize(count);
        state.light = given.light;
        state.rotationRad = given.rotationRad;
    }
    std::vector<const TableImage*> sources;
    std::vector<float> weights;
    for (size_t k = 0; k < count; ++k) {
        // A black light has a table, too.
        if (given.weights[k] == 0 && !(k + 1 == count && sources.empty())) continue;
        if (!state.made[k]) {
            std::vector<double> alone(count, 0.0);
            alone[k] = 1;
            uploadTable(context_, tableOf(technique, data, light, alone, given.rotationRad), state.tables[k]);
            state.made[k] = true;
            ++tableUploads_;
        }
        sources.push_back(&state.tables[k]);
        weights.push_back(float(given.weights[k]));
    }
    data.setTable([&](TableImage& table) { blender_.blend(sources, weights, table); });
}

}  // namespace prt
