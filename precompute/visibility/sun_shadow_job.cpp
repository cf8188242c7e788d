// Sources: sun_shadow.h for the shadows; the rest is bookkeeping.
#include "precompute/visibility/sun_shadow_job.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/bundle.h"
#include "precompute/io/glb.h"
#include "precompute/visibility/sun_shadow.h"

namespace prt {
namespace {

constexpr const char* kMesh = "mesh.glb";
constexpr const char* kVisibility = "visibility.exr";
constexpr const char* kSection = "suns";

nlohmann::json settingsJson(const BundleSun& sun) {
    const Vec3d& d = sun.sun.direction;
    return {{"environment", sun.environmentName}, {"environment_hash", sun.environmentHash},
            {"direction", {d.x(), d.y(), d.z()}}, {"angular_radius_rad", sun.sun.angularRadiusRad},
            {"irradiance", sun.sun.irradiance()}, {"rays", kSunRays}};
}

bool hasSame(const Bundle& bundle, const std::string& file, const nlohmann::json& settings) {
    if (!bundle.find(file) || !bundle.staleReason(file, true).empty()) return false;
    const nlohmann::json section = nlohmann::json::parse(bundle.section(kSection), nullptr, false);
    return section.is_object() && section.contains(file) && section[file] == settings;
}

// What all suns of a bundle are traced with, loaded when the first one is.
struct Traced {
    Scene scene;
    VisibilityMap visibility;
    RayCaster caster;

    explicit Traced(const Bundle& bundle)
        : scene(readGltf(bundle.pathOf(kMesh).string())),
          visibility(readVisibilityFile(bundle.pathOf(kVisibility).string())),
          caster(scene.positions, scene.indices) {}
};

}  // namespace

SunShadowMap traceSunShadow(const RayCaster& caster, const Scene& scene, const PointGrid& grid,
                            std::span<const Validity> validity, const ExtractedSun& sun) {
    SunShadowMap map;
    map.grid = grid;
    map.direction = sun.direction.cast<float>();
    map.angularRadiusRad = float(sun.angularRadiusRad);
    for (size_t c = 0; c < 3; ++c) map.irradiance[c] = float(sun.irradiance()[c]);
    map.shadow = sunShadow(caster, scene, grid, validity, {sun.direction, sun.angularRadiusRad});
    return map;
}

std::vector<SunShadowRow> runSunShadows(const std::string& bundlePath, const std::vector<BundleSun>& suns,
                                        bool force) {
    const Bundle bundle = Bundle::open(bundlePath);
    for (const char* file : {kMesh, kVisibility}) bundle.require(file, "prt precompute");
    BundleTransaction transaction(bundlePath, false);
    nlohmann::json section = nlohmann::json::parse(bundle.section(kSection), nullptr, false);
    if (!section.is_object()) section = nlohmann::json::object();
    std::optional<Traced> traced;
    std::vector<SunShadowRow> rows;
    for (const BundleSun& sun : suns) {
        const Stopwatch watch;
        throwIfInterrupted();
        SunShadowRow row;
        row.file = sunShadowFileName(sun.environmentName);
        const nlohmann::json settings = settingsJson(sun);
        if (!force && hasSame(bundle, row.file, settings)) {
            row.upToDate = true;
            row.bytes = bundle.find(row.file)->bytes;
            rows.push_back(row);
            continue;
        }
        if (!traced) traced.emplace(bundle);
        const VisibilityMap& visibility = traced->visibility;
        SunShadowMap map =
            traceSunShadow(traced->caster, traced->scene, visibility.grid, visibility.validity, sun.sun);
        map.attributes = {{"environmentName", sun.environmentName}, {"environmentHash", sun.environmentHash}};
        const std::filesystem::path staged = transaction.stage(
            row.file, {{kMesh, bundle.find(kMesh)->xxh3}, {kVisibility, bundle.find(kVisibility)->xxh3}},
            sun.command);
        writeSunShadowFile(staged.string(), map);
        row.bytes = size_t(std::filesystem::file_size(staged));
        row.seconds = watch.seconds();
        section[row.file] = settings;
        rows.push_back(row);
    }
    if (!traced) return rows;
    transaction.setSection(kSection, section.dump());
    transaction.commit();
    return rows;
}

}  // namespace prt
