// prt measure tables: size, layout and variant of tables over the normal against the error they cause.
#include <fmt/format.h>

#include <algorithm>

#include "precompute/base/log.h"
#include "precompute/math/sh.h"
#include "precompute/math/table_layout.h"
#include "tools/command_line.h"
#include "tools/environment_arguments.h"
#include "tools/measure/commands.h"
#include "tools/measure/output.h"
#include "tools/measure/tables.h"

namespace prt::tools {
namespace {

/// One table over all environments.
struct Summary {
    TableCostRow cost;
    double interpolation = 0, total = 0;  ///< means
    double highest = 0;                   ///< interpolation in the worst environment
    double worst = 0;                     ///< at the worst point of any
};

std::vector<Summary> summarise(const TableResult& result) {
    std::vector<Summary> all;
    const double environments = double(result.variants.size());
    for (const TableCostRow& cost : result.costs) {
        Summary summary{cost};
        for (const TableErrorRow& row : result.errors) {
            if (row.variant != cost.variant || row.layout != cost.layout || row.size != cost.size) continue;
            summary.interpolation += row.interpolation / environments;
            summary.total += row.total / environments;
            summary.highest = std::max(summary.highest, row.interpolation);
            summary.worst = std::max(summary.worst, row.worst);
        }
        all.push_back(std::move(summary));
    }
    return all;
}

Table rowTable(const std::vector<Summary>& all) {
    Table table({"variant", "layout", "size", "relative_rmse", "relative_rmse_highest", "relative_worst",
                 "relative_rmse_total", "texels", "bytes", "light_cosine_ms", "triple_product_ms"});
    for (const Summary& row : all)
        table.add({row.cost.variant, row.cost.layout, uint64_t(row.cost.size), row.interpolation, row.highest,
                   row.worst, row.total, row.cost.texels, row.cost.bytes, row.cost.lightCosineMs,
                   row.cost.tripleMs});
    return table;
}

Table environmentTable(const TableResult& result) {
    Table table({"environment", "variant", "layout", "size", "relative_rmse", "relative_rmse_total",
                 "relative_worst"});
    for (const TableErrorRow& row : result.errors)
        table.add({row.environment, row.variant, row.layout, uint64_t(row.size), row.interpolation, row.total,
                   row.worst});
    return table;
}

Table variantTable(const TableResult& result) {
    Table table({"environment", "paper", "exact"});
    TableVariantRow mean{"mean", 0, 0};
    for (const TableVariantRow& row : result.variants) {
        table.add({row.environment, row.paper, row.exact});
        mean.paper += row.paper / double(result.variants.size());
        mean.exact += row.exact / double(result.variants.size());
    }
    table.add({mean.environment, mean.paper, mean.exact});
    return table;
}

Figure errorFigure(const std::vector<Summary>& all) {
    Figure figure{.title = "Irradiance from tables over the normal", .columns = 2, .panels = {}};
    for (const bool total : {false, true}) {
        Panel panel{.title = total ? "against a cosine of all bands" : "interpolation alone",
                    .xLabel = total ? "kilobytes of a light-cosine table" : "texels along a face",
                    .yLabel = "relative RMSE",
                    .logX = true,
                    .logY = true};
        for (const Summary& row : all) {
            const std::string name = row.cost.layout + ", " + row.cost.variant;
            if (panel.series.empty() || panel.series.back().name != name)
                panel.series.push_back({name, {}, row.cost.variant == "paper"});
            const double x = total ? double(row.cost.bytes) / 1024 : double(row.cost.size);
            panel.series.back().points.push_back({x, total ? row.total : row.interpolation});
        }
        figure.panels.push_back(std::move(panel));
    }
    return figure;
}

}  // namespace

void runMeasureTables(int argc, char** argv) {
    TableStudy study;
    std::vector<std::string> sources;
    std::string sizes = "8,16,32,64", layouts = "all", variant = "both";
    int seed = int(study.seed);
    MeasureOptions options{.prefix = "measure-tables"};
    CommandLine line(
        "prt measure tables",
        "Error, size and time of tables over the normal: layouts and sizes, the paper's cosine of three "
        "bands "
        "and the exact one.",
        fmt::format(
            "Layouts: {}.\nErrors are of irradiance at random points whose half-space of visibility "
            "has round blockers, relative to its RMS,\naveraged over environments: relative_rmse of "
            "interpolation alone, relative_rmse_total against a cosine of all bands.\nExample:\n  prt "
            "measure tables --env assets/hdri/*.exr --sizes 8,16,32 --json -",
            fmt::join(TableLayout::names(), ", ")));
    line.textList("--env", sources, "ENV",
                  "environments: .exr, .hdr or sky:NAME; default: the built-in skies");
    line.text("--sizes", sizes, "LIST", "texels along a face");
    line.text("--layouts", layouts, "LIST", "layouts, or all");
    line.integer("--order", study.shOrder, 1, kMaxBundleShOrder, "number of SH bands of visibility");
    line.choice("--variant", variant, {"paper", "exact", "both"}, "bands of the cosine");
    line.integer("--points", study.points, 1, 1000000, "points where irradiance is judged");
    line.real("--cone", study.coneDeg, 0, 90, "half-angle of the cone of shading normals, degrees");
    line.integer("--components", study.components, 1, shCount(kMaxBundleShOrder),
                 "vectors of the triple-product tables that are timed");
    line.integer("--rounds", study.rounds, 0, 1000, "times are medians over so many rounds; 0: no times");
    line.integer("--seed", seed, 0, 1000000000, "of the points");
    addMeasureOptions(line, options);
    if (!line.parse(argc, argv)) return;
    checkMeasureOutput(options);
    study.seed = uint64_t(seed);
    study.layouts = parseNameList("--layouts", layouts, TableLayout::names());
    int smallest = 1;
    for (const std::string& name : study.layouts) smallest = std::max(smallest, TableLayout::minSize(name));
    study.sizes = parseIntegerList("--sizes", sizes, smallest, TableLayout::kMaxSize);
    study.variants = variant == "both" ? tableVariants() : std::vector<std::string>{variant};

    const Stopwatch watch;
    const std::vector<Environment> environments = loadEnvironmentsOrSkies(sources, true);
    const TableResult result = studyTables(environments, study);
    const std::vector<Summary> all = summarise(result);
    Measurement measurement{.name = "tables", .rows = rowTable(all)};
    measurement.more = {{"environments", environmentTable(result)}, {"variants", variantTable(result)}};
    measurement.figures = {{"", errorFigure(all)}};
    measurement.summary = fmt::format("{}\nWithout tables, against a cosine of all bands:\n{}",
                                      measurement.rows.text(), measurement.more[1].second.text());
    Report report;
    report.set("order", study.shOrder)
        .set("points", study.points)
        .set("cone_deg", study.coneDeg)
        .set("components", study.components)
        .set("environment_count", uint64_t(environments.size()))
        .set("rounds", study.rounds)
        .set("seconds", watch.seconds());
    writeMeasurement(measurement, options, line.common(), std::move(report));
}

}  // namespace prt::tools
