// Light adds up, and so do lightmaps [IwanickiSloan2012, Sec. 5].
#include "tools/relight_lightmaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "compress/renewal_command.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"

namespace prt::tools {
namespace {

// Files have the angle as a float.
constexpr double kSameDegrees = 1e-3;

double degrees(double angleRad) { return angleRad * 180 / std::numbers::pi; }

}  // namespace

RelightLightmaps::RelightLightmaps(const Bundle& bundle, const RelightArguments& arguments,
                                   const std::vector<Environment>& environments)
    : bundle_(bundle), environmentOptions_(arguments.environmentOptions), bundlePath_(arguments.bundlePath) {
    for (const Environment& environment : environments)
        entries_.push_back({environment.name, environment.contentHash, environment.source, false, {}, {}});
}

void RelightLightmaps::read(Entry& entry) const {
    entry.read = true;
    const std::string file = lightmapFileName(entry.name);
    if (!bundle_.find(file)) {
        entry.problem = fmt::format("the bundle has no {}", file);
        return;
    }
    if (const std::string stale = bundle_.staleReason(file, false); !stale.empty()) {
        entry.problem = fmt::format("{} is stale ({})", file, stale);
        return;
    }
    Lightmap map = readLightmapFile(bundle_.pathOf(file).string());
    const auto hash = map.attributes.find("environmentHash");
    if (hash == map.attributes.end() || hash->second != entry.hash)
        entry.problem = fmt::format("{} is of another image of that name", file);
    else
        entry.map = std::move(map);
}

const Lightmap& RelightLightmaps::require(size_t environment, double rotationDeg) {
    Entry& entry = entries_[environment];
    if (!entry.read) read(entry);
    std::string problem = entry.problem;
    if (entry.map && std::abs(std::remainder(entry.map->rotationDeg - rotationDeg, 360.0)) > kSameDegrees)
        problem = fmt::format("{} is of light turned by {:g} degrees, not {:g}", lightmapFileName(entry.name),
                              entry.map->rotationDeg, rotationDeg);
    if (problem.empty()) return *entry.map;
    throw InputError(
        techniqueName(Technique::ShLightmap), problem,
        fmt::format("make it with: prt lightmap {} --env {} --rotate {:g}{}", shellWord(bundlePath_),
                    shellWord(entry.source), rotationDeg, environmentWords(environmentOptions_)));
}

void RelightLightmaps::check(const std::vector<double>& weights, double rotationRad) {
    PRT_CHECK_EQ(weights.size(), entries_.size());
    bool any = false;
    for (size_t e = 0; e < weights.size(); ++e) {
        if (weights[e] == 0) continue;
        require(e, degrees(rotationRad));
        any = true;
    }
    if (!any)
        throw InputError(techniqueName(Technique::ShLightmap), "all environments have a weight of 0",
                         "give one of them a larger weight");
}

Lightmap RelightLightmaps::blend(const std::vector<double>& weights, double rotationRad) {
    check(weights, rotationRad);
    Lightmap sum;
    for (size_t e = 0; e < weights.size(); ++e) {
        if (weights[e] == 0) continue;
        const Lightmap& map = require(e, degrees(rotationRad));
        if (sum.coefficients.empty()) {
            sum = map;
            for (float& value : sum.coefficients) value *= float(weights[e]);
            continue;
        }
        // All are current, so all are of the points of visibility.exr.
        PRT_CHECK_EQ(map.coefficients.size(), sum.coefficients.size());
        sum.bounces = std::min(sum.bounces, map.bounces);
        for (size_t i = 0; i < sum.coefficients.size(); ++i)
            sum.coefficients[i] += float(weights[e]) * map.coefficients[i];
    }
    return sum;
}

}  // namespace prt::tools
