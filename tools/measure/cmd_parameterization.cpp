// prt measure parameterization: Figure 8 of Iwanicki & Sloan 2012.
#include <fmt/format.h>

#include "precompute/base/log.h"
#include "precompute/math/sh.h"
#include "precompute/math/sphere_map.h"
#include "tools/command_line.h"
#include "tools/measure/commands.h"
#include "tools/measure/output.h"
#include "tools/measure/parameterization.h"
#include "tools/report.h"

namespace prt::tools {
namespace {

std::string titleOf(const std::string& layout) {
    for (const SphereMapFamily& family : sphereMapFamilies())
        if (family.name == layout) return family.title;
    return layout;
}

/// One panel per order and kind of table, one line per layout.
Figure drawPanels(const ParameterizationSettings& settings, const std::vector<ParameterizationRow>& rows) {
    Figure figure;
    figure.title = "Error of spherical harmonics in textures over the sphere";
    figure.columns = int(settings.shOrders.size());
    figure.panelHeightPx = 560;
    for (const std::string table : {"float", "half"}) {
        if (table == "half" && !settings.half) continue;
        for (const int n : settings.shOrders) {
            Panel panel{.title = fmt::format("order {}, {} tables", n, table),
                        .xLabel = "samples (texels)",
                        .yLabel = "mean squared error",
                        .logX = true,
                        .logY = true};
            for (const std::string& layout : settings.layouts) {
                Series series{.name = titleOf(layout), .points = {}};
                for (const ParameterizationRow& row : rows)
                    if (row.shOrder == n && row.table == table && row.layout == layout)
                        series.points.push_back({double(row.samples), row.mse});
                panel.series.push_back(std::move(series));
            }
            figure.panels.push_back(std::move(panel));
        }
    }
    return figure;
}

}  // namespace

void runMeasureParameterization(int argc, char** argv) {
    ParameterizationSettings settings;
    MeasureOptions options{.prefix = "measure-parameterization"};
    std::string orders = "3,6", layouts = "all";
    std::vector<std::string> names;
    for (const SphereMapFamily& family : sphereMapFamilies()) names.push_back(family.name);

    CommandLine line(
        "prt measure parameterization",
        "Mean squared error of spherical harmonics tabulated in textures over the sphere and looked "
        "up as\nhardware filters them, against the number of samples (Iwanicki & Sloan 2012, Figure 8).",
        fmt::format("Layouts: {}.\nExample:\n  prt measure parameterization --layouts "
                    "cube-seamless,octahedral --half --plot png",
                    fmt::join(names, ", ")));
    line.text("--orders", orders, "LIST", "numbers of bands, 1..10");
    line.text("--layouts", layouts, "LIST", "layouts to compare, or all");
    line.integer("--points", settings.points, 1000, 10'000'000, "random directions to look up");
    line.integer("--max-samples", settings.maxSamples, 100, 1'000'000, "texels of the largest tables");
    line.flag("--half", settings.half, "tables rounded to half floats too");
    addMeasureOptions(line, options);
    if (!line.parse(argc, argv)) return;
    checkMeasureOutput(options);
    settings.shOrders = parseIntegerList("--orders", orders, 1, kMaxBundleShOrder);
    settings.layouts = parseNameList("--layouts", layouts, names);

    const Stopwatch watch;
    const std::vector<ParameterizationRow> rows = measureParameterization(settings);
    Measurement measurement{.name = "parameterization",
                            .rows = Table({"order", "layout", "table", "size", "samples", "mse"})};
    for (const ParameterizationRow& row : rows)
        measurement.rows.add({uint64_t(row.shOrder), row.layout, row.table, uint64_t(row.size),
                              uint64_t(row.samples), row.mse});
    measurement.figures.emplace_back("", drawPanels(settings, rows));
    Report report;
    report.set("points", settings.points).set("seed", settings.seed).set("seconds", watch.seconds());
    writeMeasurement(measurement, options, line.common(), std::move(report));
}

}  // namespace prt::tools
