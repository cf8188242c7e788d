#include "tools/relight_suns.h"

#include "precompute/io/sun_shadow_file.h"
#include "precompute/io/visibility_file.h"
#include "precompute/math/sh_rotation.h"
#include "precompute/visibility/sun_shadow_job.h"

namespace prt::tools {

RelightSuns::RelightSuns(const Bundle& bundle, const Scene& scene,
                         const std::vector<Environment>& environments, double rotationRad)
    : bundle_(bundle), scene_(scene), environments_(environments), rotationRad_(rotationRad) {}

void RelightSuns::find() {
    const Mat3d turn = rotationAboutUp(rotationRad_);
    for (const Environment& environment : environments_) {
        suns_.push_back(extractSun(environment.view()).sun);
        suns_.back().direction = turn * suns_.back().direction;
    }
    shadows_.resize(suns_.size());
}

const std::vector<float>& RelightSuns::shadow(size_t environment) {
    std::vector<float>& shadow = shadows_[environment];
    if (!shadow.empty()) return shadow;
    const std::string file = sunShadowFileName(environments_[environment].name);
    if (rotationRad_ == 0 && bundle_.find(file) && bundle_.staleReason(file, false).empty()) {
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
    return shadow = traceSunShadow(*caster_, scene_, grid_, validity_, suns_[environment]).shadow;
}

std::vector<SunLight> RelightSuns::make(const std::vector<double>& weights) {
    if (suns_.empty()) find();
    std::vector<SunLight> lights;
    for (size_t e = 0; e < suns_.size(); ++e) {
        if (weights[e] == 0 || !suns_[e].found) continue;
        SunLight light;
        light.direction = suns_[e].direction.cast<float>();
        for (int c = 0; c < 3; ++c)
            light.irradiance[c] = float(weights[e] * suns_[e].irradiance()[size_t(c)]);
        light.shadow = shadow(e);
        lights.push_back(std::move(light));
    }
    return lights;
}

}  // namespace prt::tools
