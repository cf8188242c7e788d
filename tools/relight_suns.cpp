#include "tools/relight_suns.h"

#include "precompute/base/check.h"
#include "precompute/io/sun_shadow_file.h"
#include "precompute/io/visibility_file.h"
#include "precompute/math/sh_rotation.h"
#include "precompute/visibility/sun_shadow_job.h"

namespace prt::tools {

RelightSuns::RelightSuns(const Bundle& bundle, const Scene& scene,
                         const std::vector<Environment>& environments)
    : bundle_(bundle), scene_(scene), environments_(environments) {}

void RelightSuns::find() {
    for (const Environment& environment : environments_) suns_.push_back(extractSun(environment.view()).sun);
    unturned_.shadows.resize(suns_.size());
}

const std::vector<float>& RelightSuns::shadow(size_t environment, const ExtractedSun& turned, Turn& turn) {
    std::vector<float>& shadow = turn.shadows[environment];
    if (!shadow.empty()) return shadow;
    const std::string file = sunShadowFileName(environments_[environment].name);
    if (turn.rotationRad == 0 && bundle_.find(file) && bundle_.staleReason(file, false).empty()) {
        SunShadowMap stored = readSunShadowFile(bundle_.pathOf(file).string());
        const auto hash = stored.attributes.find("environmentHash");
        if (hash != stored.attributes.end() && hash->second == environments_[environment].contentHash) {
            grid_ = stored.grid;
            return shadow = std::move(stored.shadow);
        }
    }
    if (!caster_) {
        bundle_.require("visibility.exr", "prt precompute");
        VisibilityMap visibility = readVisibilityFile(bundle_.pathOf("visibility.exr").string());
        grid_ = visibility.grid;
        validity_ = std::move(visibility.validity);
        caster_.emplace(scene_.positions, scene_.indices);
    }
    return shadow = traceSunShadow(*caster_, scene_, grid_, validity_, turned).shadow;
}

std::vector<SunLight> RelightSuns::make(const std::vector<double>& weights, double rotationRad) {
    PRT_CHECK_EQ(weights.size(), environments_.size());
    if (suns_.empty()) find();
    if (rotationRad != 0 && (turned_.rotationRad != rotationRad || turned_.shadows.empty()))
        turned_ = {rotationRad, std::vector<std::vector<float>>(suns_.size())};
    Turn& turn = rotationRad == 0 ? unturned_ : turned_;
    const Mat3d worldFromEnvironment = rotationAboutUp(rotationRad);
    std::vector<SunLight> lights;
    for (size_t e = 0; e < suns_.size(); ++e) {
        if (weights[e] == 0 || !suns_[e].found) continue;
        SunLight light;
        ExtractedSun sun = suns_[e];
        sun.direction = worldFromEnvironment * sun.direction;
        light.direction = sun.direction.cast<float>();
        for (int c = 0; c < 3; ++c) light.irradiance[c] = float(weights[e] * sun.irradiance()[size_t(c)]);
        light.shadow = shadow(e, sun, turn);
        lights.push_back(std::move(light));
    }
    return lights;
}

size_t RelightSuns::setTo(Renderer& renderer, const std::vector<double>& weights, double rotationRad) {
    const auto found = given_.find(&renderer);
    if (found != given_.end() && found->second.weights == weights && found->second.rotationRad == rotationRad)
        return found->second.suns;
    const std::vector<SunLight> suns = make(weights, rotationRad);
    renderer.setSuns(suns, grid_);
    given_[&renderer] = {weights, rotationRad, suns.size()};
    return suns.size();
}

}  // namespace prt::tools
