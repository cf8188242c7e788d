// Sources: lightmap.h for the light; the rest is bookkeeping.
#include "precompute/visibility/lightmap_job.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "precompute/base/log.h"
#include "precompute/io/bundle.h"
#include "precompute/io/glb.h"
#include "precompute/io/lightmap_file.h"
#include "precompute/io/projection_attributes.h"

namespace prt {
namespace {

constexpr const char* kMesh = "mesh.glb";
constexpr const char* kVisibility = "visibility.exr";
constexpr const char* kSection = "lightmaps";

nlohmann::json settingsJson(const LightmapSettings& settings, const Environment& environment) {
    return {{"environment", environment.name},
            {"environment_hash", environment.contentHash},
            {"rotation_deg", settings.rotationDeg},
            {"bounces", settings.options.bounces},
            {"rays", settings.options.rays},
            {"projection", projectionName(settings.options.projection.kind)}};
}

// The file's part of the section where it is current and was made with these settings; else null.
nlohmann::json sameBefore(const Bundle& bundle, const nlohmann::json& section, const std::string& file,
                          const nlohmann::json& wanted) {
    if (!bundle.find(file) || !bundle.staleReason(file, true).empty()) return nullptr;
    if (!section.contains(file) || !section[file].is_object()) return nullptr;
    for (const auto& [key, value] : wanted.items())
        if (!section[file].contains(key) || section[file][key] != value) return nullptr;
    return section[file];
}

Lightmap makeLightmap(const Bundle& bundle, const LightmapSettings& settings, const Environment& environment,
                      LightmapReport& report) {
    const Scene scene = readGltf(bundle.pathOf(kMesh).string());
    const VisibilityMap visibility = readVisibilityFile(bundle.pathOf(kVisibility).string());
    const RayCaster caster(scene.positions, scene.indices);
    const EnvironmentSampler light(environment.view(), settings.rotationDeg * std::numbers::pi / 180);
    LightmapBake bake = bakeLightmap(caster, scene, SurfaceAlbedo(scene), visibility.grid,
                                     visibility.validity, light, settings.options);
    report.rays = bake.rays;
    report.relativeError = bake.relativeError;
    Lightmap map;
    map.grid = visibility.grid;
    map.coefficients = std::move(bake.coefficients);
    map.bounces = settings.options.bounces;
    map.rotationDeg = settings.rotationDeg;
    map.relativeError = bake.relativeError;
    map.projection = settings.options.projection;
    map.attributes = {{"environmentName", environment.name}, {"environmentHash", environment.contentHash}};
    return map;
}

}  // namespace

LightmapReport runLightmap(const LightmapSettings& settings, const Environment& environment) {
    const Stopwatch watch;
    const Bundle bundle = Bundle::open(settings.bundlePath);
    for (const char* file : {kMesh, kVisibility}) bundle.require(file, "prt precompute");
    BundleTransaction transaction(settings.bundlePath, false);
    nlohmann::json section = nlohmann::json::parse(bundle.section(kSection), nullptr, false);
    if (!section.is_object()) section = nlohmann::json::object();
    LightmapReport report;
    report.file = lightmapFileName(environment.name);
    const nlohmann::json wanted = settingsJson(settings, environment);
    if (!settings.force)
        if (const nlohmann::json before = sameBefore(bundle, section, report.file, wanted);
            before.is_object()) {
            report.upToDate = true;
            report.bytes = bundle.find(report.file)->bytes;
            report.relativeError = before.value("relative_error", 0.0);
            return report;
        }

    const Lightmap map = makeLightmap(bundle, settings, environment, report);
    const std::filesystem::path staged = transaction.stage(
        report.file, {{kMesh, bundle.find(kMesh)->xxh3}, {kVisibility, bundle.find(kVisibility)->xxh3}},
        settings.command);
    writeLightmapFile(staged.string(), map);
    report.bytes = size_t(std::filesystem::file_size(staged));
    report.seconds = watch.seconds();
    section[report.file] = wanted;
    section[report.file]["relative_error"] = report.relativeError;
    section[report.file]["seconds"] = report.seconds;
    section[report.file]["cast_rays"] = report.rays;
    transaction.setSection(kSection, section.dump());
    transaction.commit();
    return report;
}

}  // namespace prt
