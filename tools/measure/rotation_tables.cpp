#include "tools/measure/rotation_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace prt::tools {
namespace {

/// A count, or nothing where it is 0.
Cell countOrNothing(int count) {
    if (count == 0) return std::numeric_limits<double>::quiet_NaN();
    return uint64_t(count);
}

template <typename Row>
std::set<int> ordersOf(std::span<const Row> rows, int Row::*order) {
    std::set<int> orders;
    for (const Row& row : rows) orders.insert(row.*order);
    return orders;
}

std::vector<std::string> methodsOf(std::span<const RotationCost> costs) {
    std::vector<std::string> methods;
    for (const RotationCost& cost : costs)
        if (std::find(methods.begin(), methods.end(), cost.method) == methods.end())
            methods.push_back(cost.method);
    return methods;
}

Table costTable(std::span<const RotationCost> costs) {
    Table table(
        {"order", "method", "ns", "ratio_to_zxzxz", "multiplications", "paper_multiplications", "paper_us"});
    for (const RotationCost& row : costs)
        table.add({uint64_t(row.shOrder), row.method, row.ns, row.ratioToZxzxz, row.multiplications,
                   row.paperMultiplications, row.paperUs});
    return table;
}

Table errorTable(std::span<const TaylorError> errors) {
    Table table({"order", "taylor_order", "beta_deg", "max", "mean", "rms", "phong", "phong_relative"});
    for (const TaylorError& row : errors)
        table.add({uint64_t(row.shOrder), taylorOrderNumber(row.taylorOrder), row.betaDeg, row.max, row.mean,
                   row.rms, row.phong, row.phongRelative});
    return table;
}

Table hshErrorTable(std::span<const HshError> errors) {
    Table table({"order", "method", "intermediate_order", "tabulated_angles", "beta_deg", "relative_error"});
    for (const HshError& row : errors)
        table.add({uint64_t(row.hshOrder), row.method, countOrNothing(row.shOrder),
                   countOrNothing(row.tabulatedAngles), row.betaDeg, row.relativeError});
    return table;
}

Table hshTableTable(std::span<const HshTableError> errors) {
    Table table({"order", "method", "tabulated_angles", "bytes", "relative_error", "interpolation_error"});
    for (const HshTableError& row : errors)
        table.add({uint64_t(row.hshOrder), row.method, uint64_t(row.tabulatedAngles), uint64_t(row.bytes),
                   row.relativeError, row.interpolationError});
    return table;
}

Table paperTable() {
    Table table({"scene", "order", "method", "us"});
    for (const PublishedTime& row : publishedRotationTimes())
        table.add({std::string(row.scene), uint64_t(row.shOrder), std::string(row.method), row.us});
    return table;
}

bool isBatch(const std::string& method) { return method.ends_with("-batch"); }

Series costSeries(std::span<const RotationCost> costs, const std::string& method,
                  double RotationCost::*value) {
    Series series{.name = method, .points = {}};
    for (const RotationCost& row : costs)
        if (row.method == method) series.points.push_back({double(row.shOrder), row.*value});
    return series;
}

/// Ours and the paper's times as multiples of zxzxz.
Panel ratioPanel(std::span<const RotationCost> costs) {
    Panel panel{.title = "time over that of zxzxz: ours and the paper's",
                .xLabel = "order n",
                .yLabel = "times zxzxz",
                .logY = true};
    for (const char* method : {"ivanic", "ivanic-apply", "taylor-1.5", "taylor-1.5-batch", "zxzxz-batch"})
        if (Series series = costSeries(costs, method, &RotationCost::ratioToZxzxz); !series.points.empty())
            panel.series.push_back(std::move(series));
    const auto published = [](const std::string& method, int n) {
        for (const PublishedTime& time : publishedRotationTimes())
            if (time.method == method && time.shOrder == n && std::string(time.scene) == "flamingo")
                return time.us;
        return std::numeric_limits<double>::quiet_NaN();
    };
    for (const char* method : {"directx", "ivanic", "taylor-1.5"}) {
        Series series{.name = fmt::format("{} (2006)", method), .points = {}, .dashed = true};
        for (const int n : {6, 10})
            series.points.push_back({double(n), published(method, n) / published("zxzxz", n)});
        panel.series.push_back(std::move(series));
    }
    return panel;
}

Figure timeFigure(std::span<const RotationCost> costs) {
    Figure figure{.title = "Rotation: time per vector", .columns = 2, .panels = {}};
    figure.panelWidthPx = 640;
    Panel single{.title = "one vector at a time", .xLabel = "order n", .yLabel = "ns", .logY = true};
    Panel batch{.title = "64 vectors as a structure of arrays",
                .xLabel = "order n",
                .yLabel = "ns per vector",
                .logY = true};
    Panel counts{.title = "multiplications of our code",
                 .xLabel = "order n",
                 .yLabel = "multiplications per vector",
                 .logY = true};
    std::vector<std::string> methods = methodsOf(costs);
    // Last, because it has no count: a method has one colour in all panels.
    std::stable_partition(methods.begin(), methods.end(), [](const std::string& m) { return m != "ivanic"; });
    for (const std::string& method : methods) {
        (isBatch(method) ? batch : single).series.push_back(costSeries(costs, method, &RotationCost::ns));
        if (!isBatch(method) && method != "ivanic")
            counts.series.push_back(costSeries(costs, method, &RotationCost::multiplications));
    }
    for (Panel* panel : {&single, &batch})
        if (!panel->series.empty()) figure.panels.push_back(std::move(*panel));
    figure.panels.push_back(ratioPanel(costs));
    if (!counts.series.empty()) figure.panels.push_back(std::move(counts));
    return figure;
}

Figure errorFigure(std::span<const TaylorError> errors) {
    struct Row {
        const char* title;
        double TaylorError::*value;
    };
    constexpr Row kRows[] = {{"maximum over unit vectors", &TaylorError::max},
                             {"average over unit vectors (singular values)", &TaylorError::mean},
                             {"Phong lobe cos⁷θ", &TaylorError::phong}};
    const std::set<int> orders = ordersOf(errors, &TaylorError::shOrder);
    Figure figure{.title = "Error of the truncated Taylor rotation by angle",
                  .columns = int(orders.size()),
                  .panels = {},
                  .panelWidthPx = 560,
                  .panelHeightPx = 380};
    for (const Row& row : kRows)
        for (const int n : orders) {
            Panel panel{
                .title = fmt::format("n = {}: {}", n, row.title), .xLabel = "β, degrees", .yLabel = "error"};
            for (const ShTaylorOrder order :
                 {ShTaylorOrder::One, ShTaylorOrder::OneAndHalf, ShTaylorOrder::Two}) {
                Series series{.name = fmt::format("order {:g}", taylorOrderNumber(order)), .points = {}};
                for (const TaylorError& error : errors)
                    if (error.shOrder == n && error.taylorOrder == order)
                        series.points.push_back({error.betaDeg, error.*row.value});
                panel.series.push_back(std::move(series));
            }
            figure.panels.push_back(std::move(panel));
        }
    return figure;
}

std::string titleOf(const HshError& row) {
    if (row.method == kHshThroughSh) return fmt::format("1: through SH of order {}", row.shOrder);
    if (row.method == kHshDigonRemoval) return "2: digon removal";
    if (row.tabulatedAngles == 0) return "3: matrix of the angle";
    return fmt::format("3: table of {} angles", row.tabulatedAngles);
}

Panel hshAnglePanel(std::span<const HshError> errors, int n) {
    Panel panel{.title = fmt::format("n = {}: cos⁵ lobe tilted by {:g}°, turned further", n, kHshLobeTiltDeg),
                .xLabel = "β, degrees",
                .yLabel = "relative error of coefficients",
                .logY = true};
    for (const HshError& row : errors) {
        if (row.hshOrder != n) continue;
        const std::string title = titleOf(row);
        if (panel.series.empty() || panel.series.back().name != title)
            panel.series.push_back({.name = title, .points = {}, .dashed = row.tabulatedAngles != 0});
        // Without a turn the methods are exact, and their rounding would stretch the axis.
        const double shown =
            row.relativeError < 1e-6 ? std::numeric_limits<double>::quiet_NaN() : row.relativeError;
        panel.series.back().points.push_back({row.betaDeg, shown});
    }
    return panel;
}

Panel hshTablePanel(std::span<const HshTableError> errors, int n) {
    Panel panel{.title = fmt::format("n = {}: number of tabulated angles", n),
                .xLabel = "angles in 0…180°",
                .yLabel = fmt::format("relative error, RMS over 0…{}°", kMaxHshBetaDeg),
                .logX = true,
                .logY = true};
    for (const auto& [method, title] :
         {std::pair(kHshDigonRemoval, "2: digon removal"), std::pair(kHshTable, "3: table")})
        for (const bool toMatrix : {false, true}) {
            Series series{
                .name = fmt::format("{}, against {}", title, toMatrix ? "its own limit" : "the function"),
                .points = {},
                .dashed = toMatrix};
            for (const HshTableError& row : errors)
                if (row.hshOrder == n && row.method == method)
                    series.points.push_back(
                        {double(row.tabulatedAngles), toMatrix ? row.interpolationError : row.relativeError});
            panel.series.push_back(std::move(series));
        }
    return panel;
}

Figure hshFigure(const RotationResults& results) {
    Figure figure{.title = "Rotation of hemispherical harmonics against rotating and clipping the function",
                  .columns = 2,
                  .panels = {},
                  .panelWidthPx = 680,
                  .panelHeightPx = 520};
    for (const int n : ordersOf(std::span<const HshError>(results.hshErrors), &HshError::hshOrder)) {
        figure.panels.push_back(hshAnglePanel(results.hshErrors, n));
        figure.panels.push_back(hshTablePanel(results.hshTables, n));
    }
    return figure;
}

/// One row per method, one column per order.
std::string timeSummary(std::span<const RotationCost> costs) {
    std::vector<std::string> columns = {"method"};
    const std::set<int> orders = ordersOf(costs, &RotationCost::shOrder);
    for (const int n : orders) columns.push_back(fmt::format("n={}", n));
    columns.insert(columns.end(), {"ratio_to_zxzxz", "paper_us"});
    Table table(columns);
    for (const std::string& method : methodsOf(costs)) {
        std::vector<Cell> cells = {method};
        double ratio = 0;
        std::string paper;
        for (const RotationCost& row : costs) {
            if (row.method != method) continue;
            cells.emplace_back(row.ns);
            ratio = row.ratioToZxzxz;
            if (std::isfinite(row.paperUs))
                paper += fmt::format("{}{:g} (n={})", paper.empty() ? "" : ", ", row.paperUs, row.shOrder);
        }
        cells.insert(cells.end(), {ratio, paper});
        table.add(std::move(cells));
    }
    return fmt::format(
        "Nanoseconds per vector by order; ratio at n={}; the paper's times in microseconds\n{}",
        *orders.rbegin(), table.text());
}

std::string errorSummary(std::span<const TaylorError> errors) {
    Table table({"order", "beta_deg", "taylor_order", "max", "mean", "rms", "phong"});
    for (const TaylorError& row : errors)
        if (row.betaDeg == 5 || row.betaDeg == 10 || row.betaDeg == 25 ||
            row.betaDeg == errors.back().betaDeg)
            table.add({uint64_t(row.shOrder), row.betaDeg, taylorOrderNumber(row.taylorOrder), row.max,
                       row.mean, row.rms, row.phong});
    return "Errors of the truncated Taylor rotation\n" + table.text();
}

std::string hshSummary(std::span<const HshError> errors) {
    Table table({"order", "method", "5_deg", "10_deg", "20_deg", "40_deg"});
    for (size_t i = 0; i < errors.size(); ++i) {
        if (errors[i].betaDeg != 0) continue;
        std::vector<Cell> cells = {uint64_t(errors[i].hshOrder), titleOf(errors[i])};
        for (const double beta : {5, 10, 20, 40}) {
            double error = std::numeric_limits<double>::quiet_NaN();
            for (size_t k = i; k < errors.size() && (k == i || errors[k].betaDeg != 0); ++k)
                if (errors[k].betaDeg == beta) error = errors[k].relativeError;
            cells.emplace_back(error);
        }
        table.add(std::move(cells));
    }
    return "Relative error of rotated hemispherical harmonics\n" + table.text();
}

}  // namespace

Measurement rotationMeasurement(const RotationResults& results) {
    Measurement measurement{.name = "rotation", .rows = costTable(results.costs)};
    measurement.more.emplace_back("errors", errorTable(results.errors));
    measurement.more.emplace_back("hsh_errors", hshErrorTable(results.hshErrors));
    measurement.more.emplace_back("hsh_tables", hshTableTable(results.hshTables));
    measurement.more.emplace_back("paper_times", paperTable());
    measurement.figures.emplace_back("", timeFigure(results.costs));
    measurement.figures.emplace_back("errors", errorFigure(results.errors));
    measurement.figures.emplace_back("hsh", hshFigure(results));
    measurement.summary = timeSummary(results.costs) + '\n' + errorSummary(results.errors) + '\n' +
                          hshSummary(results.hshErrors);
    return measurement;
}

}  // namespace prt::tools
