// prt precompute: mesh file -> bundle.
#include <fmt/format.h>

#include "precompute/base/error.h"
#include "precompute/io/projection_attributes.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/bake.h"
#include "precompute/visibility/precompute_job.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/report.h"

namespace prt::tools {
namespace {

Report toReport(const PrecomputeSettings& settings, const PrecomputeReport& result) {
    Report validity, repairs, stages, report;
    stages.set("set_up", result.stages.setUp)
        .set("trace", result.stages.trace)
        .set("project", result.stages.project)
        .set("inside", result.stages.inside);
    for (int i = 0; i < kValidityCount; ++i)
        validity.set(validityName(Validity(i)), uint64_t(result.validity[size_t(i)]));
    for (const auto& [kind, count] : result.repairs) repairs.set(kind, uint64_t(count));
    report.set("bundle", settings.bundlePath)
        .set("mesh", settings.meshPath)
        .set("domain", pointDomainName(settings.perVertex ? PointDomain::Vertex : PointDomain::Texel))
        .set("order", settings.shOrder)
        .set("projection", projectionName(settings.projection.kind))
        .set("triangles", uint64_t(result.triangles))
        .set("vertices", uint64_t(result.vertices))
        .set("points", result.points)
        .set("rays", result.rays)
        .set("rays_per_s", result.raysPerSecond)
        .set("trace_seconds", result.traceSeconds)
        .set("seconds", result.seconds)
        .set("mean_ao", result.meanAo)
        .set("sampling_error", result.errorRms)
        .set("sampling_error_relative", result.relativeError)
        .set("stage_seconds", stages)
        .set("peak_rss_bytes", uint64_t(result.peakResidentBytes))
        .set("embree_isa", result.instructionSet)
        .set("validity", validity)
        .set("repairs", repairs);
    if (!settings.perVertex && result.atlasMade) {
        Report atlas;
        atlas.set("charts", result.atlas.charts)
            .set("utilisation", result.atlas.utilisation)
            .set("texels_per_unit", result.atlas.texelsPerUnit);
        report.set("atlas", atlas);
    }
    return report;
}

}  // namespace

void runPrecomputeCommand(int argc, char** argv) {
    PrecomputeSettings settings;
    std::string projection = projectionName(settings.projection.kind);
    CommandLine line(
        "prt precompute", "Bakes spherical-harmonic visibility of a static mesh into a bundle.",
        "Meshes: .obj (+ .mtl), .ply, .off, .stl, .gltf, .glb; polygons, no normals or no UVs are fine.\n"
        "Examples:\n"
        "  prt precompute house.obj -o house.prt --texels 512 --order 6 --rays 1024\n"
        "  prt precompute bunny.ply -o bunny.prt --per-vertex --order 4");
    line.positional("MESH", settings.meshPath, "mesh file");
    line.text("-o,--output", settings.bundlePath, "BUNDLE", "bundle directory to write, e.g. out/house.prt",
              true);
    line.flag("--per-vertex", settings.perVertex, "bake at vertices instead of atlas texels");
    line.integer("--texels", settings.texels, 16, 8192, "edge of the square atlas, texels");
    line.integer("--order", settings.shOrder, 1, kMaxBundleShOrder,
                 "number of SH bands n (n*n coefficients)");
    line.real("--error", settings.error, 1e-4, 1,
              "RMS error of irradiance that a point may have, as a share of what an open point receives: "
              "directions are refined along silhouettes until nine of ten are below it");
    int rays = 1024;
    line.integer("--rays", rays, 1, kMaxBakeRays,
                 "instead of --error: so many directions over the sphere for every point; those above its "
                 "horizon are traced");
    line.choice("--projection", projection, {"irradiance", "plain"},
                "least squares of the irradiance that shading normals receive, or of visibility itself");
    line.real("--uv-scale", settings.load.uvScale, 1e-6, 1e9,
              "scene units per tile of box-projected texture coordinates, where the mesh has none");
    line.text("--normal-map", settings.load.normalMap, "IMAGE",
              "tangent-space normal map (+Y up; PNG, JPEG, WebP) for materials that have none");
    if (!line.parse(argc, argv)) return;
    if (projection == projectionName(ProjectionKind::Plain)) settings.projection = kPlainProjection;
    if (line.isGiven("--rays")) {
        if (line.isGiven("--error"))
            throw UsageError("--rays", "cannot go with --error",
                             "give the number of directions or the error, not both");
        settings.rays = rays;
    }

    const PrecomputeReport result = runPrecompute(settings);
    if (line.common().json != "-") {
        fmt::print(
            "{}: {} {} baked, {:.3g} M rays in {:.2f} s ({:.3g} Mrays/s), {:.2f} s in all; mean AO {:.3f}\n",
            settings.bundlePath, result.points, settings.perVertex ? "vertices" : "texels",
            double(result.rays) * 1e-6, result.traceSeconds, result.raysPerSecond * 1e-6, result.seconds,
            result.meanAo);
        fmt::print(
            "sampling error of irradiance: {:.2g} of an open point's, {:.2g} of what points receive (RMS)\n",
            result.errorRms, result.relativeError);
        if (!settings.perVertex && result.atlasMade)
            fmt::print("atlas: {} charts, {:.0f} % used, {:.3g} texels per unit\n", result.atlas.charts,
                       100 * result.atlas.utilisation, result.atlas.texelsPerUnit);
    }
    toReport(settings, result).write(line.common().json);
}

}  // namespace prt::tools
