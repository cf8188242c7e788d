// prt measure bake: rays per second of the bake, and of the bare ray-casting loop.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <vector>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/io/projection_attributes.h"
#include "precompute/math/sh.h"
#include "precompute/mesh/load_mesh.h"
#include "tools/command_line.h"
#include "tools/measure/bake.h"
#include "tools/measure/commands.h"
#include "tools/measure/output.h"

namespace prt::tools {
namespace {

Table rateTable(const BakeRates& rates) {
    Table table({"threads", "arrangement", "rays_per_s", "ratio", "ratio_low", "ratio_high", "seconds",
                 "rays", "points"});
    for (const BakeRate& row : rates.rates)
        table.add({uint64_t(row.threads), row.arrangement, row.raysPerSecond, row.ratio, row.lowest,
                   row.highest, row.seconds, row.rays, row.points});
    return table;
}

Table stageTable(const BakeRates& rates) {
    Table table({"threads", "stage", "seconds", "share"});
    for (const BakeStageTime& row : rates.stages)
        table.add({uint64_t(row.threads), row.stage, row.seconds, row.share});
    return table;
}

// Names that fit below a bar.
std::string barName(std::string name) {
    const std::vector<std::pair<std::string, std::string>> shorter = {
        {"-not-robust", ", fast"}, {"-direction-major", ""}, {"packet-point-major", "packet, point"}};
    for (const auto& [from, to] : shorter)
        if (const size_t at = name.find(from); at != std::string::npos) name.replace(at, from.size(), to);
    return name;
}

Figure rateFigure(const BakeRates& rates, const std::vector<int>& threadCounts) {
    Figure figure;
    figure.title = "Occlusion rays: bare loops, bakes, loops on a scene that is not watertight";
    figure.columns = int(std::min<size_t>(2, threadCounts.size()));
    figure.panelWidthPx = 640;
    for (const int threads : threadCounts) {
        Panel panel{.title = threads == 1 ? "1 thread" : fmt::format("{} threads", threads),
                    .xLabel = "",
                    .yLabel = "million rays per second"};
        for (const BakeRate& row : rates.rates) {
            if (row.threads != threads) continue;
            const bool bake = row.arrangement.starts_with("pipeline") || row.arrangement == "adaptive";
            const bool notRobust = row.arrangement.ends_with("-not-robust");
            panel.bars.push_back({barName(row.arrangement), row.raysPerSecond * 1e-6,
                                  bake        ? 1
                                  : notRobust ? 2
                                              : 0});
        }
        figure.panels.push_back(std::move(panel));
    }
    return figure;
}

// The figures of the largest number of threads, and what more threads gain.
void setSummary(const BakeRates& rates, const std::vector<int>& threadCounts, Report& report) {
    const int threads = threadCounts.back();
    const BakeRate& ceiling = rates.ceiling(threads);
    const BakeRate& pipeline = *rates.find(threads, "pipeline");
    double notRobust = 0;
    for (const BakeRate& row : rates.rates)
        if (row.threads == threads && row.arrangement.ends_with("-not-robust"))
            notRobust = std::max(notRobust, row.raysPerSecond);
    report.set("threads", threads)
        .set("ceiling_rays_per_s", ceiling.raysPerSecond)
        .set("ceiling_arrangement", ceiling.arrangement)
        .set("pipeline_rays_per_s", pipeline.raysPerSecond)
        .set("ratio", pipeline.ratio)
        .set("ratio_low", pipeline.lowest)
        .set("ratio_high", pipeline.highest)
        .set("fast_scene_rays_per_s", notRobust);
    const int fewest = threadCounts.front();
    if (fewest < threads) {
        Report speedup;
        speedup.set("from_threads", fewest)
            .set("to_threads", threads)
            .set("ceiling", ceiling.raysPerSecond / rates.ceiling(fewest).raysPerSecond)
            .set("pipeline", pipeline.raysPerSecond / rates.find(fewest, "pipeline")->raysPerSecond);
        report.set("speedup", speedup);
    }
    if (const BakeRate* adaptive = rates.find(threads, "adaptive"))
        report.set("adaptive_rays_per_s", adaptive->raysPerSecond)
            .set("adaptive_rays_per_point", double(adaptive->rays) / double(adaptive->points));
    report.set("largest_difference", rates.largestDifference).set("blocked_rays", rates.blockedRays);
}

std::string summaryText(const BakeRates& rates, const Measurement& measurement,
                        const std::vector<int>& threadCounts) {
    std::string text = measurement.rows.text() + "\n" + measurement.more[0].second.text() + "\n";
    for (const int threads : threadCounts) {
        const BakeRate& ceiling = rates.ceiling(threads);
        const BakeRate& pipeline = *rates.find(threads, "pipeline");
        text += fmt::format(
            "{} thread{}: pipeline {:.2f} of {:.2f} million rays per second ({}), ratio {:.3f} ({:.3f} to "
            "{:.3f})\n",
            threads, threads == 1 ? "" : "s", pipeline.raysPerSecond * 1e-6, ceiling.raysPerSecond * 1e-6,
            ceiling.arrangement, pipeline.ratio, pipeline.lowest, pipeline.highest);
    }
    return text;
}

}  // namespace

void runMeasureBake(int argc, char** argv) {
    std::string mesh, projection = projectionName(ProjectionKind::Irradiance), threadCounts;
    BakeStudy study;
    MeasureOptions options{.prefix = "measure-bake"};
    CommandLine line(
        "prt measure bake",
        "Rays per second of the bake, end to end, and of bare ray-casting loops over the same points and "
        "directions; the ceiling is the fastest loop.",
        "Only rays above the horizon of their point are cast and counted. A bake is timed from surface "
        "points "
        "to coefficients, the search for points inside geometry included.\n"
        "Example:\n  prt measure bake bunny.obj --threads 2 --json -");
    line.text("MESH", mesh, "", "mesh file; default: a sphere with bumps of 69,692 triangles");
    line.integer("--texels", study.texels, 16, 8192, "edge of the atlas");
    line.integer("--rays", study.rays, 1, 65535, "directions over the sphere");
    line.integer("--order", study.shOrder, 1, kMaxBundleShOrder, "number of SH bands");
    line.choice("--projection", projection, {"irradiance", "plain"}, "as prt precompute");
    line.real("--error", study.error, 0, 1, "of the adaptive bake that is measured too; 0: none");
    line.text("--thread-counts", threadCounts, "LIST", "numbers of threads; default: 1 and --threads");
    line.integer("--rounds", study.rounds, 1, 1000, "everything runs so often, in turn; rates are medians");
    line.integer("--loop-points", study.loopPoints, 0, 1000000000,
                 "points of the bare loops, in runs of 256 spread over the surface; 0: all");
    addMeasureOptions(line, options);
    if (!line.parse(argc, argv)) return;
    if (projection == projectionName(ProjectionKind::Plain)) study.projection = kPlainProjection;
    if (threadCounts.empty()) {
        const std::set<int> counts{1, threadCount()};
        study.threadCounts.assign(counts.begin(), counts.end());
    } else {
        study.threadCounts = parseIntegerList("--thread-counts", threadCounts, 1, 1024);
    }
    checkMeasureOutput(options);

    const Stopwatch watch;
    Scene scene = mesh.empty() ? bumpySphere() : loadMesh(mesh, {});
    const BakeRates rates = measureBake(std::move(scene), study);
    Measurement measurement{.name = "bake", .rows = rateTable(rates)};
    measurement.more = {{"stages", stageTable(rates)}};
    measurement.figures = {{"", rateFigure(rates, study.threadCounts)}};
    measurement.summary = summaryText(rates, measurement, study.threadCounts);
    Report report;
    setSummary(rates, study.threadCounts, report);
    report.set("mesh", mesh.empty() ? "bumpy-sphere" : std::filesystem::path(mesh).stem().string())
        .set("triangles", uint64_t(rates.triangles))
        .set("points", uint64_t(rates.points))
        .set("texels", study.texels)
        .set("rays", study.rays)
        .set("order", study.shOrder)
        .set("projection", projection)
        .set("error", study.error)
        .set("rounds", study.rounds)
        .set("embree_isa", rates.instructionSet)
        .set("seconds", watch.seconds());
    writeMeasurement(measurement, options, line.common(), std::move(report));
}

}  // namespace prt::tools
