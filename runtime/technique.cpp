// Sources: [IwanickiSloan2012, Sec. 3] unc, [Sec. 4] pca, vertex-pca and pca-uniform, [Sec. 5] sh-lightmap,
// sh2 and preconvolved-ao.
#include "runtime/technique.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "precompute/base/check.h"
#include "precompute/io/lightmap_file.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

struct Entry {
    TechniqueKind kind;
    const char* name;
    int mostNumber;  ///< 0: takes none
    const char* summary;
};
constexpr Entry kEntries[] = {
    {TechniqueKind::Unc, "unc", kMaxBundleShOrder, "coefficients of visibility x light-cosine table"},
    {TechniqueKind::Pca, "pca", shCount(kMaxBundleShOrder),
     "weights of vectors x tables of their relit colours"},
    {TechniqueKind::VertexPca, "vertex-pca", shCount(kMaxBundleShOrder), "pca with weights at the vertices"},
    {TechniqueKind::PcaUniform, "pca-uniform", 0,
     "weights x products of vectors and light, convolved with the cosine at every pixel"},
    {TechniqueKind::ShLightmap, "sh-lightmap", 0,
     "lightmap of prt lightmap, with its bounces, for its light alone"},
    {TechniqueKind::Sh2, "sh2", 0, "two bands of visibility x two of light, multiplied at every pixel"},
    {TechniqueKind::PreconvolvedAo, "preconvolved-ao", 0, "unoccluded irradiance x ambient occlusion"},
};

const Entry& entryOf(TechniqueKind kind) {
    const auto found = std::ranges::find_if(kEntries, [&](const Entry& entry) { return entry.kind == kind; });
    PRT_CHECK(found != std::end(kEntries));
    return *found;
}

int layersOf(int values) { return (values + 3) / 4; }

// Coefficients of a point.
int valuesOf(Technique technique, const TechniqueSource& source) {
    switch (technique.kind) {
        case TechniqueKind::Unc:
            return shCount(technique.number > 0 ? technique.number : source.shOrder);
        case TechniqueKind::Pca:
        case TechniqueKind::VertexPca:
            return technique.number > 0 ? technique.number : source.components;
        case TechniqueKind::PcaUniform:
            return source.components;
        case TechniqueKind::ShLightmap:
            return 3 * kLightmapCoefficients;
        case TechniqueKind::Sh2:
            return 4;
        case TechniqueKind::PreconvolvedAo:
            break;
    }
    return 1;
}

}  // namespace

std::string techniqueName(Technique technique) {
    const std::string name = entryOf(technique.kind).name;
    return technique.number > 0 ? name + std::to_string(technique.number) : name;
}

std::optional<Technique> techniqueFromName(std::string_view name) {
    for (const Entry& entry : kEntries) {
        const std::string_view stem = entry.name;
        if (name == stem) return Technique{entry.kind, 0};
        if (entry.mostNumber == 0 || !name.starts_with(stem)) continue;
        const std::string_view digits = name.substr(stem.size());
        int number = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
        if (error == std::errc() && end == digits.data() + digits.size() && number >= 1 &&
            number <= entry.mostNumber && digits.front() != '0')
            return Technique{entry.kind, number};
    }
    return std::nullopt;
}

std::string techniqueSummary(Technique technique) {
    const std::string summary = entryOf(technique.kind).summary;
    if (technique.number == 0) return summary;
    return technique.kind == TechniqueKind::Unc
               ? fmt::format("{}, {} bands", summary, technique.number)
               : fmt::format("{}, the leading {}", summary, technique.number);
}

const std::vector<Technique>& listedTechniques() {
    static const std::vector<Technique> kListed = [] {
        std::vector<Technique> listed = {Technique::Unc};
        for (const int bands : {3, 4, 6}) listed.push_back({TechniqueKind::Unc, bands});
        listed.push_back(Technique::Pca);
        for (int vectors = 4; vectors <= 24; vectors += 4) listed.push_back({TechniqueKind::Pca, vectors});
        for (const Technique technique : {Technique::VertexPca, Technique::PcaUniform, Technique::ShLightmap,
                                          Technique::Sh2, Technique::PreconvolvedAo})
            listed.push_back(technique);
        return listed;
    }();
    return kListed;
}

std::string listedTechniqueNames() {
    std::string names;
    for (const Technique technique : listedTechniques())
        names += (names.empty() ? "" : ", ") + techniqueName(technique);
    return names;
}

bool readsVisibility(Technique technique) {
    return technique.kind == TechniqueKind::Unc || technique.kind == TechniqueKind::Sh2 ||
           technique.kind == TechniqueKind::PreconvolvedAo;
}

bool readsWeights(Technique technique) {
    return technique.kind == TechniqueKind::Pca || technique.kind == TechniqueKind::VertexPca ||
           technique.kind == TechniqueKind::PcaUniform;
}

InputError missingData(Technique technique) {
    const std::string name = techniqueName(technique);
    if (readsVisibility(technique)) return {name, "there is no visibility", "run prt precompute"};
    if (readsWeights(technique)) return {name, "there are no PCA weights", "run prt compress"};
    return {name, "there is no lightmap of this light", "run prt lightmap"};
}

void checkTechnique(Technique technique, const TechniqueSource& source) {
    const std::string name = techniqueName(technique);
    if (readsVisibility(technique) ? source.shOrder == 0
        : readsWeights(technique)  ? source.components == 0
                                   : !source.lightmaps)
        throw missingData(technique);
    if (technique.kind == TechniqueKind::Unc && technique.number > source.shOrder)
        throw InputError(name, fmt::format("visibility has {} bands only", source.shOrder),
                         fmt::format("bake with prt precompute --order {}", technique.number));
    if (readsWeights(technique) && technique.number > source.components)
        throw InputError(name, fmt::format("there are {} vectors only", source.components),
                         fmt::format("run prt compress --components {}", technique.number));
    if (technique.kind == TechniqueKind::Sh2 && source.shOrder < 2)
        throw InputError(name, "visibility has one band only", "bake with prt precompute --order 2 or more");
}

bool canDraw(Technique technique, const TechniqueSource& source) {
    try {
        checkTechnique(technique, source);
    } catch (const InputError&) {
        return false;
    }
    return true;
}

TechniqueCost techniqueCost(Technique technique, const TechniqueSource& source, PointDomain domain,
                            int cosineBands) {
    const int values = valuesOf(technique, source), layers = layersOf(values);
    TechniqueCost cost;
    switch (technique.kind) {
        case TechniqueKind::Unc:
            cost = {4 * layers, 12 * layers, 0};
            break;
        case TechniqueKind::Pca:
        case TechniqueKind::VertexPca:
            cost = {4 * layers + 1, 12 * layers, 0};
            break;
        case TechniqueKind::PcaUniform: {
            const int functions = cosineFunctionCount(cosineBands);
            cost = {layers, functions * (12 * layers + 6), functions * (values + 1)};
            break;
        }
        case TechniqueKind::ShLightmap:
            cost = {layers, 45, 0};
            break;
        case TechniqueKind::Sh2:
            cost = {1, 45, 4};
            break;
        case TechniqueKind::PreconvolvedAo:
            cost = {2, 3, 0};
            break;
    }
    if (domain == PointDomain::Vertex || technique.kind == TechniqueKind::VertexPca) {
        cost.fetches += 2 * layers;
        cost.multiplyAdds += 12 * layers;
    }
    return cost;
}

int cosineFunctionCount(int bands) {
    int count = 0;
    for (int l = 0; l < bands; ++l)
        if (l <= 1 || l % 2 == 0) count += 2 * l + 1;
    return count;
}

}  // namespace prt
