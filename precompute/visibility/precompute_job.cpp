// Stage 1 from file to bundle [IwanickiSloan2012, Sec. 3].
#include "precompute/visibility/precompute_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/io/bundle.h"
#include "precompute/io/glb.h"
#include "precompute/io/projection_attributes.h"
#include "precompute/math/irradiance_norm.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/bake.h"
#include "precompute/visibility/fill.h"
#include "precompute/visibility/precompute_section.h"

namespace prt {
namespace {

constexpr int kSmallestAtlas = 16, kLargestAtlas = 8192;

void checkRange(const char* option, int value, int low, int high) {
    if (value < low || value > high)
        throw UsageError(option, fmt::format("{} is out of range", value),
                         fmt::format("choose {} to {}", low, high));
}

void checkSettings(const PrecomputeSettings& settings) {
    checkRange("--order", settings.shOrder, 1, kMaxBundleShOrder);
    if (settings.rays != 0) checkRange("--rays", settings.rays, 1, kMaxBakeRays);
    if (!(settings.error > 0 && settings.error <= 1))
        throw UsageError("--error", fmt::format("{} is out of range", settings.error),
                         "choose more than 0, at most 1");
    if (!settings.perVertex) checkRange("--texels", settings.texels, kSmallestAtlas, kLargestAtlas);
}

// Shells take it back as one word.
std::string quoted(const std::string& word) {
    const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
        return std::isalnum(c) || c >= 0x80 ||
               std::string_view("/._-+=:,@%").find(char(c)) != std::string_view::npos;
    });
    if (plain) return word;
    std::string result = "'";
    for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

std::string commandLine(const PrecomputeSettings& settings) {
    std::string line =
        fmt::format("prt precompute {} -o {}", quoted(settings.meshPath), quoted(settings.bundlePath));
    line += settings.perVertex ? std::string(" --per-vertex") : fmt::format(" --texels {}", settings.texels);
    line += fmt::format(" --order {} --projection {}", settings.shOrder,
                        projectionName(settings.projection.kind));
    line += settings.rays > 0 ? fmt::format(" --rays {}", settings.rays)
                              : fmt::format(" --error {}", settings.error);
    const LoadMeshOptions defaults;
    if (settings.load.uvScale != defaults.uvScale)
        line += fmt::format(" --uv-scale {}", settings.load.uvScale);
    if (!settings.load.normalMap.empty()) line += " --normal-map " + quoted(settings.load.normalMap);
    return line;
}

void noteRepairs(const PrecomputeReport& report) {
    std::string list;
    for (const auto& [kind, count] : report.repairs) {
        std::string words = kind;
        std::replace(words.begin(), words.end(), '_', ' ');
        list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, words);
    }
    logNote(fmt::format("{} triangles, {} vertices{}{}", report.triangles, report.vertices,
                        list.empty() ? "" : "; ", list));
}

void prepareAtlas(const PrecomputeSettings& settings, bool fileHasAtlas, Scene& scene,
                  PrecomputeReport& report) {
    if (fileHasAtlas && isValidAtlas(scene, settings.texels)) {
        logNote("the file's second UV set is a valid atlas and is kept");
        return;
    }
    AtlasOptions options;
    options.texels = settings.texels;
    report.atlas = buildAtlas(scene, options);
    report.atlasMade = true;
    logNote(fmt::format("atlas: {} charts, {:.0f} % of the texels used, {:.3g} texels per unit",
                        report.atlas.charts, 100 * report.atlas.utilisation, report.atlas.texelsPerUnit));
}

struct Baked {
    VisibilityMap map;
    BakeResult result;
    size_t points = 0;
};

Baked bake(const RayCaster& caster, const Scene& scene, const PrecomputeSettings& settings) {
    const std::vector<uint8_t> doubleSided = doubleSidedTriangles(scene);
    BakeOptions options;
    options.shOrder = settings.shOrder;
    if (settings.rays > 0)
        options.rays = settings.rays;
    else
        options.error = settings.error;
    options.projection = settings.projection;
    options.doubleSided = doubleSided;
    Baked baked;
    if (settings.perVertex) {
        const VertexPoints vertices = makeVertexPoints(scene);
        baked.points = vertices.sameAs.size();
        baked.result = bakeVertexVisibility(caster, vertices, options);
        baked.map = fillVertices(scene, vertices, baked.result, settings.shOrder);
    } else {
        const TexelSurface surface = rasterizeTexels(scene, settings.texels, settings.texels);
        if (surface.points.empty())
            throw InputError(settings.meshPath, "no texel of the atlas lies on the mesh", "raise --texels");
        baked.points = surface.points.size();
        baked.result = bakeTexelVisibility(caster, surface, options);
        baked.map = fillTexels(surface, baked.result, settings.shOrder);
    }
    baked.map.projection = settings.projection;
    baked.map.attributes = {{"directionSet", "spherical-fibonacci"},
                            {"rays", settings.rays > 0 ? std::to_string(settings.rays) : "adaptive"},
                            {"embreeIsa", caster.instructionSet()}};
    if (settings.rays == 0) baked.map.attributes["errorBound"] = fmt::format("{}", settings.error);
    return baked;
}

// Counts of every kind of point, and means over the valid ones.
void summarize(const VisibilityMap& map, PrecomputeReport& report) {
    const IrradianceNorm norm(map.shOrder);
    const size_t columns = size_t(shCount(map.shOrder));
    double ao = 0, errors = 0, received = 0;
    size_t valid = 0;
    for (size_t i = 0; i < map.validity.size(); ++i) {
        ++report.validity[size_t(map.validity[i])];
        if (map.validity[i] != Validity::Valid || map.normals[i] == Vec3f::Zero()) continue;
        ao += double(map.ao[i]);
        errors += double(map.error[i]) * double(map.error[i]);
        const double irradiance =
            norm.evaluate(map.normals[i], std::span(&map.coefficients[i * columns], columns));
        received += irradiance * irradiance;
        ++valid;
    }
    if (valid == 0) return;
    report.meanAo = ao / double(valid);
    report.errorRms = std::sqrt(errors / double(valid));
    report.relativeError = received > 0 ? std::sqrt(errors / received) : 0;
}

}  // namespace

PrecomputeReport runPrecompute(const PrecomputeSettings& settings) {
    checkSettings(settings);
    const Stopwatch watch;
    PrecomputeReport report;
    LoadMeshReport loadReport;
    Scene scene = loadMesh(settings.meshPath, settings.load, &loadReport);
    const std::string sourceHash = xxh3HexOfFile(settings.meshPath);
    report.repairs = loadReport.counts;
    report.triangles = scene.triangleCount();
    // Opened before the long work, so that a place that cannot be written is found out at once.
    BundleTransaction bundle(settings.bundlePath, true);
    report.vertices = scene.vertexCount();
    noteRepairs(report);
    if (!settings.perVertex) prepareAtlas(settings, loadReport.hasAtlas, scene, report);
    report.vertices = scene.vertexCount();
    throwIfInterrupted();

    const RayCaster caster(scene.positions, scene.indices);
    const Baked baked = bake(caster, scene, settings);
    report.points = baked.points;
    report.rays = baked.result.rays;
    report.traceSeconds = baked.result.traceSeconds;
    report.raysPerSecond = report.traceSeconds > 0 ? double(report.rays) / report.traceSeconds : 0;
    report.instructionSet = caster.instructionSet();
    report.stages = baked.result.stages;
    summarize(baked.map, report);
    throwIfInterrupted();

    const std::string command = commandLine(settings);
    writeGlb(scene, bundle.stage("mesh.glb", {{settings.meshPath, sourceHash}}, command).string());
    writeVisibilityFile(bundle.stage("visibility.exr", {}, command).string(), baked.map);
    bundle.setMadeFrom("visibility.exr", {{"mesh.glb", bundle.hashOfStaged("mesh.glb")}});
    report.seconds = watch.seconds();
    report.peakResidentBytes = peakResidentBytes();
    bundle.setSection("precompute", precomputeSection(settings, report));
    throwIfInterrupted();
    bundle.commit();
    return report;
}

}  // namespace prt
