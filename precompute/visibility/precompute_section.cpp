// Settings and statistics of stage 1 as JSON (the only file of this folder that knows the JSON library).
#include "precompute/visibility/precompute_section.h"

#include <nlohmann/json.hpp>

#include "precompute/io/projection_attributes.h"

namespace prt {

std::string precomputeSection(const PrecomputeSettings& settings, const PrecomputeReport& report) {
    nlohmann::ordered_json section;
    auto& given = section["settings"];
    given["mesh"] = settings.meshPath;
    given["domain"] = pointDomainName(settings.perVertex ? PointDomain::Vertex : PointDomain::Texel);
    if (!settings.perVertex) given["texels"] = settings.texels;
    given["order"] = settings.shOrder;
    if (settings.rays > 0)
        given["rays"] = settings.rays;
    else
        given["error"] = settings.error;
    given["uv_scale"] = settings.load.uvScale;
    if (!settings.load.normalMap.empty()) given["normal_map"] = settings.load.normalMap;
    given["projection"] = projectionName(settings.projection.kind);
    if (settings.projection.kind == ProjectionKind::Irradiance) {
        given["projection_cone_deg"] = settings.projection.weight.coneDegrees;
        given["projection_floor"] = settings.projection.weight.floor;
    }
    given["direction_set"] = "spherical-fibonacci";

    auto& found = section["statistics"];
    found["triangles"] = report.triangles;
    found["vertices"] = report.vertices;
    found["points"] = report.points;
    found["rays"] = report.rays;
    found["rays_per_s"] = report.raysPerSecond;
    found["seconds"] = report.seconds;
    found["trace_seconds"] = report.traceSeconds;
    found["peak_rss_bytes"] = report.peakResidentBytes;
    found["mean_ao"] = report.meanAo;
    found["sampling_error"] = report.errorRms;
    found["sampling_error_relative"] = report.relativeError;
    auto& stages = found["stage_seconds"];
    stages["set_up"] = report.stages.setUp;
    stages["trace"] = report.stages.trace;
    stages["project"] = report.stages.project;
    stages["inside"] = report.stages.inside;
    found["embree_isa"] = report.instructionSet;
    found["repairs"] = report.repairs;
    auto& validity = found["validity"];
    for (int i = 0; i < kValidityCount; ++i) validity[validityName(Validity(i))] = report.validity[size_t(i)];
    if (!settings.perVertex) {
        auto& atlas = found["atlas"];
        atlas["made"] = report.atlasMade;
        if (report.atlasMade) {
            atlas["charts"] = report.atlas.charts;
            atlas["split_charts"] = report.atlas.splitCharts;
            atlas["utilisation"] = report.atlas.utilisation;
            atlas["texels_per_unit"] = report.atlas.texelsPerUnit;
            atlas["smallest_stretch"] = report.atlas.smallestStretch;
            atlas["largest_stretch"] = report.atlas.largestStretch;
        }
    }
    return section.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace prt
