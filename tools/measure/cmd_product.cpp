// prt measure product: what a product of two expansions costs.
#include <fmt/format.h>

#include "precompute/base/log.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_product.h"
#include "tools/command_line.h"
#include "tools/measure/commands.h"
#include "tools/measure/output.h"
#include "tools/measure/product.h"

namespace prt::tools {
namespace {

Figure costFigure(const std::vector<ProductCost>& costs, const std::vector<std::string>& methods) {
    Panel times{
        .title = "time (batch: 64 pairs)", .xLabel = "order n", .yLabel = "ns per product", .logY = true};
    Panel counts{.title = "multiplications", .xLabel = "order n", .yLabel = "per product", .logY = true};
    for (const std::string& method : methods) {
        Series time{.name = method, .points = {}}, count = time;
        for (const ProductCost& row : costs) {
            if (row.method != method) continue;
            time.points.push_back({double(row.shOrder), row.ns});
            count.points.push_back({double(row.shOrder), double(row.multiplications)});
        }
        if (time.points.empty()) continue;
        times.series.push_back(std::move(time));
        if (!method.ends_with("-batch")) counts.series.push_back(std::move(count));
    }
    Series nonZeros{.name = "non-zero coefficients", .points = {}, .dashed = true};
    for (const ProductCost& row : costs)
        if (nonZeros.points.empty() || nonZeros.points.back()[0] != row.shOrder)
            nonZeros.points.push_back({double(row.shOrder), double(row.nonZeros)});
    counts.series.push_back(std::move(nonZeros));
    return {.title = "Products of spherical harmonics",
            .columns = 2,
            .panels = {std::move(times), std::move(counts)},
            .panelWidthPx = 640};
}

}  // namespace

void runMeasureProduct(int argc, char** argv) {
    ProductCostSettings settings;
    MeasureOptions options{.prefix = "measure-product"};
    std::string orders = "3-6", methods = "all";
    CommandLine line(
        "prt measure product",
        "Time, multiplications and non-zero coefficients of products of spherical harmonics.",
        fmt::format("Methods: {}.\nstraight-line ends at {} bands.\nExample:\n  prt measure product "
                    "--orders 3-6 --plot png --json -",
                    fmt::join(productMethods(), ", "), kMaxProductCodeOrder));
    line.text("--orders", orders, "LIST", "numbers of bands, 1..10");
    line.text("--methods", methods, "LIST", "methods to time, or all");
    line.integer("--rounds", settings.rounds, 1, 1000, "times are medians over so many rounds");
    addMeasureOptions(line, options);
    if (!line.parse(argc, argv)) return;
    checkMeasureOutput(options);
    settings.shOrders = parseIntegerList("--orders", orders, 1, kMaxBundleShOrder);
    settings.methods = parseNameList("--methods", methods, productMethods());

    const Stopwatch watch;
    const std::vector<ProductCost> costs = productCosts(settings);
    Measurement measurement{.name = "product",
                            .rows = Table({"order", "method", "ns", "ratio_to_single", "non_zeros",
                                           "multiplications", "additions"})};
    for (const ProductCost& row : costs)
        measurement.rows.add({uint64_t(row.shOrder), row.method, row.ns, row.ratioToSingle,
                              uint64_t(row.nonZeros), uint64_t(row.multiplications),
                              uint64_t(row.additions)});
    measurement.figures.emplace_back("", costFigure(costs, settings.methods));
    Report report;
    report.set("rounds", settings.rounds).set("seconds", watch.seconds());
    writeMeasurement(measurement, options, line.common(), std::move(report));
}

}  // namespace prt::tools
