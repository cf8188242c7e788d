// prt measure projection: irradiance from plain and from weighted projection, against ray-traced truth.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/math/sh.h"
#include "precompute/mesh/load_mesh.h"
#include "precompute/visibility/bake.h"
#include "tools/command_line.h"
#include "tools/environment_arguments.h"
#include "tools/measure/commands.h"
#include "tools/measure/output.h"
#include "tools/measure/projection.h"

namespace prt::tools {
namespace {

// Above this mean ambient occlusion a mesh counts as open in the summary.
constexpr double kOpenAo = 0.7;

struct MeshResult {
    std::string name;
    ProjectionResult result;
};

Table rowTable(const std::vector<MeshResult>& meshes) {
    Table table({"mesh", "order", "tilt_deg", "plain", "weighted", "pca16_plain", "pca16_fitted",
                 "pca16_weighted", "weighted_to_plain", "pca16_weighted_to_plain"});
    for (const MeshResult& mesh : meshes)
        for (const ProjectionRow& row : mesh.result.rows)
            table.add({mesh.name, uint64_t(row.order), row.tiltDeg, row.plain, row.weighted, row.pcaPlain,
                       row.pcaFitted, row.pcaWeighted, row.weighted / row.plain,
                       row.pcaWeighted / row.plain});
    return table;
}

Table meshTable(const std::vector<MeshResult>& meshes) {
    Table table({"mesh", "mean_ao"});
    for (const MeshResult& mesh : meshes) table.add({mesh.name, mesh.result.meanAo});
    return table;
}

// Ratios of sums of errors over meshes: open ones, enclosed ones.
Table summaryTable(const std::vector<MeshResult>& meshes) {
    Table table({"meshes", "count", "order", "tilt_deg", "weighted_to_plain", "pca16_plain_to_plain",
                 "pca16_fitted_to_plain", "pca16_weighted_to_plain"});
    for (const bool open : {true, false}) {
        std::vector<const ProjectionResult*> results;
        for (const MeshResult& mesh : meshes)
            if ((mesh.result.meanAo > kOpenAo) == open) results.push_back(&mesh.result);
        if (results.empty()) continue;
        for (size_t r = 0; r < results[0]->rows.size(); ++r) {
            ProjectionRow sum{};
            for (const ProjectionResult* result : results) {
                const ProjectionRow& row = result->rows[r];
                sum.plain += row.plain;
                sum.weighted += row.weighted;
                sum.pcaPlain += row.pcaPlain;
                sum.pcaFitted += row.pcaFitted;
                sum.pcaWeighted += row.pcaWeighted;
            }
            const ProjectionRow& first = results[0]->rows[r];
            table.add({std::string(open ? "open" : "enclosed"), uint64_t(results.size()),
                       uint64_t(first.order), first.tiltDeg, sum.weighted / sum.plain,
                       sum.pcaPlain / sum.plain, sum.pcaFitted / sum.plain, sum.pcaWeighted / sum.plain});
        }
    }
    return table;
}

// A panel per mesh: bars of the errors at the first tilt.
Figure errorFigure(const std::vector<MeshResult>& meshes) {
    Figure figure;
    figure.title = "Relative RMSE of irradiance";
    figure.columns = int(std::min<size_t>(3, meshes.size()));
    for (const MeshResult& mesh : meshes) {
        Panel panel;
        panel.title = mesh.name;
        panel.xLabel = "tilt of the shading normal (degrees)";
        panel.yLabel = "relative RMSE";
        std::vector<Series> series;
        for (const ProjectionRow& row : mesh.result.rows) {
            const std::array<std::pair<const char*, double>, 3> values{
                {{"plain", row.plain}, {"weighted", row.weighted}, {"weighted, PCA", row.pcaWeighted}}};
            for (const auto& [kind, value] : values) {
                const std::string name = fmt::format("{} bands, {}", row.order, kind);
                auto found = std::find_if(series.begin(), series.end(),
                                          [&](const Series& s) { return s.name == name; });
                if (found == series.end()) {
                    series.push_back({name, {}, std::string(kind) == "plain"});
                    found = series.end() - 1;
                }
                found->points.push_back({row.tiltDeg, value});
            }
        }
        panel.series = std::move(series);
        figure.panels.push_back(std::move(panel));
    }
    return figure;
}

}  // namespace

void runMeasureProjection(int argc, char** argv) {
    std::vector<std::string> meshes, sources;
    std::string orders = "3,4,6", tilts = "0,20,35";
    ProjectionStudy study;
    int seed = int(study.seed);
    MeasureOptions options;
    options.prefix = "projection";
    CommandLine line(
        "prt measure projection",
        "Irradiance from visibility of few bands against ray-traced truth, at random points: plain "
        "projection, projection weighted by what irradiance sees, and both after PCA.",
        "Example:\n  prt measure projection bunny.obj room.ply --env assets/hdri/*.exr --json -");
    line.positionalList("MESH", meshes, "mesh files");
    line.textList("--env", sources, "ENV",
                  "environments: .exr, .hdr or sky:NAME; default: the built-in skies");
    line.text("--orders", orders, "LIST", "numbers of SH bands");
    line.text("--tilts", tilts, "LIST", "angles between geometric and shading normal, degrees");
    line.integer("--points", study.points, 1, 1000000, "points whose irradiance is judged");
    line.integer("--population", study.population, 2, 10000000,
                 "points that are baked, the judged among them; principal vectors are made from all");
    line.integer("--rays", study.rays, 1, kMaxBakeRays, "directions over the sphere of the bake");
    line.integer("--components", study.components, 1, shCount(kMaxBundleShOrder),
                 "principal vectors; fewer where an order has fewer coefficients");
    line.real("--cone", study.weight.coneDegrees, 1, 90,
              "half-angle of the cone of shading normals, degrees");
    line.real("--floor", study.weight.floor, 0, 1, "floor of the weight, as a share of its largest value");
    line.integer("--seed", seed, 0, 1000000000, "of the points and the directions of the tilts");
    addMeasureOptions(line, options);
    if (!line.parse(argc, argv)) return;
    study.seed = uint64_t(seed);
    study.orders = parseIntegerList("--orders", orders, 1, kMaxBundleShOrder);
    study.tiltsDeg.clear();
    for (const int tilt : parseIntegerList("--tilts", tilts, 0, 89)) study.tiltsDeg.push_back(tilt);

    const std::vector<Environment> environments = loadEnvironmentsOrSkies(sources, false);
    std::vector<MeshResult> results;
    for (const std::string& mesh : meshes) {
        const Scene scene = loadMesh(mesh, {});
        results.push_back(
            {std::filesystem::path(mesh).stem().string(), studyProjection(scene, environments, study)});
    }
    Report report;
    report.set("points", study.points)
        .set("population", study.population)
        .set("rays", study.rays)
        .set("components", study.components)
        .set("cone_deg", study.weight.coneDegrees)
        .set("floor", study.weight.floor)
        .set("environments", uint64_t(environments.size()));
    Measurement measurement{"projection", rowTable(results)};
    measurement.more = {{"summary", summaryTable(results)}, {"meshes", meshTable(results)}};
    measurement.figures = {{"", errorFigure(results)}};
    measurement.summary = measurement.rows.text() + "\n" + measurement.more[0].second.text();
    writeMeasurement(measurement, options, line.common(), std::move(report));
}

}  // namespace prt::tools
