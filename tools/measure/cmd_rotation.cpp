// prt measure rotation: Figure 3 and Table 1 of Křivánek et al. 2006, and the rotations of Gautron et al.
// 2004.
#include <fmt/format.h>

#include "precompute/base/log.h"
#include "precompute/math/sh.h"
#include "tools/command_line.h"
#include "tools/measure/commands.h"
#include "tools/measure/rotation_tables.h"

namespace prt::tools {
namespace {

struct Arguments {
    std::string orders = "3-10", methods = "all", errorOrders = "5,8", hshOrders = "5,10";
    int maxAngle = 25, tableAngles = 46, rounds = 15;
    MeasureOptions output{.prefix = "measure-rotation"};
};

RotationResults measureRotation(const Arguments& arguments) {
    RotationCostSettings settings;
    settings.shOrders = parseIntegerList("--orders", arguments.orders, 1, kMaxBundleShOrder);
    settings.methods = parseNameList("--methods", arguments.methods, rotationMethods());
    settings.tabulatedAngles = arguments.tableAngles;
    settings.rounds = arguments.rounds;
    const std::vector<int> errorOrders =
        parseIntegerList("--error-orders", arguments.errorOrders, 1, kMaxShOrder);
    const std::vector<int> hshOrders =
        parseIntegerList("--hsh-orders", arguments.hshOrders, 1, kMaxBundleShOrder);

    RotationResults results;
    Progress progress("rotation", settings.shOrders.size() + errorOrders.size() + hshOrders.size(), "orders");
    for (const int n : settings.shOrders) {
        RotationCostSettings one = settings;
        one.shOrders = {n};
        const std::vector<RotationCost> costs = rotationCosts(one);
        results.costs.insert(results.costs.end(), costs.begin(), costs.end());
        progress.advance(1);
    }
    std::vector<double> betas;
    for (int beta = 0; beta <= arguments.maxAngle; ++beta) betas.push_back(beta);
    for (const int n : errorOrders) {
        const std::vector<TaylorError> errors = taylorErrors(n, betas);
        results.errors.insert(results.errors.end(), errors.begin(), errors.end());
        progress.advance(1);
    }
    for (const int n : hshOrders) {
        const std::vector<HshError> errors = hshErrors(n);
        results.hshErrors.insert(results.hshErrors.end(), errors.begin(), errors.end());
        const std::vector<HshTableError> tables = hshTableErrors(n);
        results.hshTables.insert(results.hshTables.end(), tables.begin(), tables.end());
        progress.advance(1);
    }
    return results;
}

}  // namespace

void runMeasureRotation(int argc, char** argv) {
    Arguments arguments;
    CommandLine line(
        "prt measure rotation",
        "Time, multiplications and errors of every rotation of spherical and hemispherical harmonics\n"
        "(Křivánek et al. 2006, Figure 3 and Table 1; Gautron et al. 2004, Section 4).",
        fmt::format("Methods: {}.\nThe Phong lobe of the errors is max(0, cosθ)^7 projected, not "
                    "normalised.\nExample:\n  prt measure rotation --orders 6,10 --plot png --json -",
                    fmt::join(rotationMethods(), ", ")));
    line.text("--orders", arguments.orders, "LIST", "numbers of bands to time, 1..10");
    line.text("--methods", arguments.methods, "LIST", "methods to time, or all");
    line.integer("--rounds", arguments.rounds, 1, 1000, "times are medians over so many rounds");
    line.text("--error-orders", arguments.errorOrders, "LIST",
              "numbers of bands of the Taylor errors, 1..24");
    line.integer("--max-angle", arguments.maxAngle, 1, 90, "largest angle of the Taylor errors, degrees");
    line.text("--hsh-orders", arguments.hshOrders, "LIST",
              "numbers of bands of the errors of hemispherical harmonics, 1..10");
    line.integer("--table-angles", arguments.tableAngles, 2, 361,
                 "angles in the tables of hemispherical harmonics that are timed");
    addMeasureOptions(line, arguments.output);
    if (!line.parse(argc, argv)) return;
    checkMeasureOutput(arguments.output);

    const Stopwatch watch;
    const Measurement measurement = rotationMeasurement(measureRotation(arguments));
    Report report;
    report.set("rounds", arguments.rounds)
        .set("table_angles", arguments.tableAngles)
        .set("hsh_lobe_tilt_deg", kHshLobeTiltDeg)
        .set("paper_source", "Krivanek et al. 2006, Table 1: time per rotation")
        .set("seconds", watch.seconds());
    writeMeasurement(measurement, arguments.output, line.common(), std::move(report));
}

}  // namespace prt::tools
