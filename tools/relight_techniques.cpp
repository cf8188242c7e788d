// Wires stage 2's reductions to the runtime's techniques [IwanickiSloan2012, Sec. 3 to 5].
#include "tools/relight_techniques.h"

#include <fmt/format.h>

#include <algorithm>

#include "compress/reduce_visibility.h"
#include "compress/tabulate_job.h"
#include "precompute/base/log.h"
#include "precompute/io/glb.h"
#include "precompute/mesh/vertex_values.h"

namespace prt::tools {
namespace {

// Fewer vectors are fitted about the normals, vertices to the texels that are valid: both are with the
// visibility.
bool needsPoints(Technique technique) {
    return readsVisibility(technique) || technique.kind == TechniqueKind::VertexPca ||
           (technique.kind == TechniqueKind::Pca && technique.number > 0);
}

PcaMap atVertices(const Scene& scene, const VisibilityMap& visibility, PcaMap pca) {
    if (pca.grid.domain == PointDomain::Vertex) return pca;
    std::vector<uint8_t> counts(visibility.validity.size());
    std::ranges::transform(visibility.validity, counts.begin(), [](Validity v) { return !isInside(v); });
    pca.weights =
        fitVertexValues(scene, pca.grid.width, pca.grid.height, counts, pca.weights, size_t(pca.components));
    pca.grid = vertexGrid(scene.vertexCount());
    return pca;
}

// Those that were named and those that a comparison always has.
std::vector<Technique> wantedTechniques(const RelightArguments& arguments, bool pcaIsCurrent) {
    std::vector<Technique> wanted = arguments.techniques;
    if (arguments.compareReference || arguments.allTechniques) wanted.push_back(Technique::Unc);
    if ((arguments.compareReference || arguments.allTechniques) && pcaIsCurrent)
        wanted.push_back(Technique::Pca);
    return wanted;
}

// In the order of the list; what is not listed comes last.
std::vector<Technique> inListedOrder(const std::vector<Technique>& wanted) {
    std::vector<Technique> ordered;
    const auto take = [&](Technique technique) {
        if (std::ranges::find(ordered, technique) == ordered.end()) ordered.push_back(technique);
    };
    for (const Technique technique : listedTechniques())
        if (std::ranges::find(wanted, technique) != wanted.end()) take(technique);
    for (const Technique technique : wanted) take(technique);
    return ordered;
}

// Whoever names the technique is told what is missing; "all" has it where it is there.
void findLightmaps(const RelightArguments& arguments, bool named, RelightData& data) {
    data.lightmaps = std::make_shared<RelightLightmaps>(data.bundle, arguments, data.environments);
    if (!named && (!arguments.allTechniques || arguments.rotateLightFrames > 0)) return;
    try {
        data.lightmaps->check(data.weights, arguments.rotationRad());
        data.hasLightmaps = true;
    } catch (const InputError&) {
        if (named) throw;
    }
}

}  // namespace

TechniqueSource RelightData::source() const {
    return {visibility ? visibility->shOrder : 0, pca ? pca->shOrder : 0, pca ? pca->components : 0,
            hasLightmaps};
}

PointDomain RelightData::domain() const {
    return visibility ? visibility->grid.domain : pca ? pca->grid.domain : PointDomain::Texel;
}

RelightData loadRelightData(const RelightArguments& arguments) {
    RelightData data{Bundle::open(arguments.bundlePath), {}, {}, {}, {}, false, {}, {}, 0, {}};
    const std::string precompute = fmt::format("prt precompute MESH -o {}", arguments.bundlePath);
    data.bundle.require("mesh.glb", precompute);
    data.scene = readGltf(data.bundle.pathOf("mesh.glb").string());

    for (const EnvironmentArgument& argument : arguments.environments) {
        data.environments.push_back(loadEnvironment(argument.source, arguments.environmentOptions));
        data.weights.push_back(argument.weight);
    }
    const bool hasPca = data.bundle.find("pca.exr") != nullptr;
    const bool pcaIsCurrent = hasPca && data.bundle.staleReason("pca.exr", false).empty();
    std::vector<Technique> wanted = wantedTechniques(arguments, pcaIsCurrent);
    const bool all = arguments.allTechniques;
    if (all || std::ranges::any_of(wanted, needsPoints)) {
        data.bundle.require("visibility.exr", precompute);
        data.visibility = readVisibilityFile(data.bundle.pathOf("visibility.exr").string());
        data.shOrder = data.visibility->shOrder;
    }
    // A comparison measures what is there; asking for pca itself insists on it.
    if (std::ranges::any_of(wanted, readsWeights)) {
        data.bundle.require("pca.exr", fmt::format("prt compress {}", arguments.bundlePath));
        data.pca = readPcaFile(data.bundle.pathOf("pca.exr").string());
        data.shOrder = data.pca->shOrder;
    } else if ((arguments.compareReference || all) && hasPca) {
        logWarning("pca.exr is stale and is not compared; renew it with: prt compress " +
                   arguments.bundlePath);
    }
    findLightmaps(arguments, std::ranges::find(wanted, Technique::ShLightmap) != wanted.end(), data);
    if (all)
        for (const Technique technique : listedTechniques())
            if (canDraw(technique, data.source())) wanted.push_back(technique);
    for (const Technique technique : wanted) checkTechnique(technique, data.source());
    data.techniques = inListedOrder(wanted);
    return data;
}

RelightTechniques::RelightTechniques(const RelightArguments& arguments, const RelightData& data)
    : arguments_(arguments), data_(data) {}

Technique RelightTechniques::drawn(Technique technique) const {
    const TechniqueSource source = data_.source();
    const int all = technique.kind == TechniqueKind::Unc ? source.shOrder : source.components;
    if (technique.number == all) technique.number = 0;
    return technique;
}

void RelightTechniques::addTo(Renderer& renderer) {
    std::erase_if(given_, [&](const auto& entry) { return entry.first.first == &renderer; });
    for (const Technique named : data_.techniques) {
        const Technique technique = drawn(named);
        // A lightmap comes with its light.
        if (technique.kind == TechniqueKind::ShLightmap) continue;
        if (readsVisibility(technique)) {
            const int bands = technique.kind == TechniqueKind::Sh2 ? 2 : technique.number;
            if (bands > 0)
                renderer.add(technique, reduceOrder(*data_.visibility, bands));
            else
                renderer.add(technique, *data_.visibility);
            continue;
        }
        const PcaMap reduced = technique.number > 0
                                   ? reduceComponents(*data_.pca, data_.visibility->normals, technique.number)
                                   : PcaMap();
        const PcaMap& pca = technique.number > 0 ? reduced : *data_.pca;
        if (technique.kind == TechniqueKind::VertexPca)
            renderer.add(technique, atVertices(data_.scene, *data_.visibility, pca));
        else
            renderer.add(technique, pca);
    }
}

const char* RelightTechniques::setLight(Renderer& renderer, Technique technique,
                                        const std::vector<double>& weights, double rotationRad) {
    const Technique used = drawn(technique);
    Given& given = given_[{&renderer, used}];
    if (given.origin && given.weights == weights && given.rotationRad == rotationRad) return given.origin;
    given.origin = nullptr;
    const char* origin = makeLight(renderer, used, weights, rotationRad);
    given = {weights, rotationRad, origin};
    return origin;
}

const char* RelightTechniques::makeLight(Renderer& renderer, Technique used,
                                         const std::vector<double>& weights, double rotationRad) {
    const bool all = used == Technique::Unc || used == Technique::Pca || used == Technique::VertexPca;
    if (rotationRad == 0 && all && arguments_.blendOn == BlendOn::Cpu) {
        const TableKind kind = used == Technique::Unc ? TableKind::LightCosine : TableKind::TripleProduct;
        if (const auto table = blendStored(kind, weights)) {
            renderer.setTable(used, *table);
            return "bundle";
        }
    }
    if (used.kind == TechniqueKind::ShLightmap) {
        const Lightmap lightmap = data_.lightmaps->blend(weights, rotationRad);
        bounces_ = lightmap.bounces;
        renderer.add(used, lightmap);
        return "bundle";
    }
    if (!live_) live_.emplace(data_.environments, data_.shOrder, arguments_.tables);
    renderer.setLight(used, *live_, weights, rotationRad, arguments_.blendOn);
    return "built";
}

std::optional<NormalTable> RelightTechniques::blendStored(TableKind kind,
                                                          const std::vector<double>& weights) {
    std::optional<NormalTable> blend;
    for (size_t e = 0; e < weights.size(); ++e) {
        if (weights[e] == 0) continue;
        const std::optional<NormalTable>& table = stored(kind, e);
        if (!table) return std::nullopt;
        if (!blend) {
            blend = table;
            for (float& value : blend->values) value *= float(weights[e]);
            continue;
        }
        if (blend->layers != table->layers) return std::nullopt;
        for (size_t i = 0; i < blend->values.size(); ++i)
            blend->values[i] += float(weights[e]) * table->values[i];
    }
    return blend;
}

// Read once: light may change every frame.
const std::optional<NormalTable>& RelightTechniques::stored(TableKind kind, size_t environment) {
    const std::pair key(kind, environment);
    const auto found = stored_.find(key);
    if (found != stored_.end()) return found->second;
    return stored_[key] = readStored(kind, data_.environments[environment]);
}

std::optional<NormalTable> RelightTechniques::readStored(TableKind kind,
                                                         const Environment& environment) const {
    const std::string name = tableFileName(environment.name, tableKindName(kind), arguments_.tables.layout);
    if (!data_.bundle.find(name) || !data_.bundle.staleReason(name, false).empty()) return std::nullopt;
    NormalTable table = readTableFile(data_.bundle.pathOf(name).string());
    const TableOptions& wanted = arguments_.tables;
    const auto is = [&](const char* attribute, const std::string& value) {
        const auto found = table.attributes.find(attribute);
        return found != table.attributes.end() && found->second == value;
    };
    const bool fits = table.size == wanted.size && table.shOrder == data_.shOrder &&
                      is("environmentHash", environment.contentHash) &&
                      is("cosineBands", std::to_string(wanted.cosineBands())) &&
                      is("window", wanted.window) && is("extractSun", wanted.extractSun ? "yes" : "no");
    return fits ? std::optional(std::move(table)) : std::nullopt;
}

}  // namespace prt::tools
