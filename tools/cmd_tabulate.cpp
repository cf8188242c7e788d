// prt tabulate: tables for an engine to ship.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "compress/tabulate_job.h"
#include "precompute/visibility/sun_shadow_job.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/environment_arguments.h"
#include "tools/report.h"
#include "tools/table_arguments.h"

namespace prt::tools {

namespace {

template <class Row>
void printFile(const std::string& name, const Row& row) {
    fmt::print("{}: {} ({})\n", name, row.file,
               row.upToDate ? "current, nothing to do"
                            : fmt::format("{:.1f} kB, {:.3f} s", double(row.bytes) * 1e-3, row.seconds));
}

std::vector<SunShadowRow> makeShadows(const TabulateSettings& settings,
                                      const std::vector<TabulateRow>& rows) {
    std::vector<BundleSun> suns;
    for (size_t k = 0; k < rows.size(); ++k)
        if (rows[k].sun.found)
            suns.push_back({rows[k].environment, rows[k].environmentHash, rows[k].sun,
                            tabulateCommand(settings, settings.environments[k])});
    return suns.empty() ? std::vector<SunShadowRow>{}
                        : runSunShadows(settings.bundlePath, suns, settings.force);
}

void printRemarks(const TabulateSettings& settings, const TabulateRow& row) {
    if (row.relativeDifferenceFromExact > 0)
        fmt::print("  {:.2g} away from the exact tables (relative RMS)\n", row.relativeDifferenceFromExact);
    if (row.windowWidth > 0)
        fmt::print("  {}\n", std::isinf(row.windowWidth)
                                 ? "the light is nowhere negative as it is: no window"
                                 : fmt::format("window of {:.3g} bands", row.windowWidth));
    if (settings.table.extractSun && row.sun.found)
        fmt::print("  sun: {:.1f} % of the light, {:.2f} degrees across, from ({:.3f}, {:.3f}, {:.3f})\n",
                   100 * row.sun.share, 2 * row.sun.angularRadiusRad * 180 / std::numbers::pi,
                   row.sun.direction.x(), row.sun.direction.y(), row.sun.direction.z());
    else if (settings.table.extractSun)
        fmt::print("  no sun\n");
}

}  // namespace

void runTabulateCommand(int argc, char** argv) {
    TabulateSettings settings;
    CommandLine line(
        "prt tabulate", "Writes tables over the normal into a bundle, one per environment.",
        "Environments: .exr or .hdr in any layout of --env-layout, or sky:clear, sky:overcast, sky:sunset,\n"
        "sky:uniform, sky:preetham?turbidity=3&elevation=40&azimuth=120, sky:constant?r=1&g=1&b=1,\n"
        "sky:gradient?top=0.2,0.4,1&bottom=0.1,0.1,0.1.\n"
        "Example:\n  prt tabulate out/house.prt sunset.exr night.exr --kind triple-product --size 32");
    line.positional("BUNDLE", settings.bundlePath, "bundle made by prt precompute");
    line.positionalList("ENVIRONMENT", settings.environments, "environments");
    line.choice("--kind", settings.kind, {"triple-product", "light-cosine"},
                "light x cosine x component (needs prt compress), or light x cosine");
    addTableOptions(line, "--", settings.table);
    addSunOption(line, settings.table);
    addEnvironmentOptions(line, settings.environmentOptions);
    line.flag("--force", settings.force, "also tables that the bundle has just so already");
    if (!line.parse(argc, argv)) return;

    const std::vector<TabulateRow> rows = runTabulate(settings);
    const std::vector<SunShadowRow> shadows =
        settings.table.extractSun ? makeShadows(settings, rows) : std::vector<SunShadowRow>{};
    Report report;
    std::vector<Report> reportRows;
    for (const TabulateRow& row : rows) {
        if (line.common().json != "-") printFile(row.environment, row);
        if (line.common().json != "-") printRemarks(settings, row);
        Report one;
        one.set("environment", row.environment)
            .set("file", row.file)
            .set("bytes", uint64_t(row.bytes))
            .set("up_to_date", row.upToDate)
            .set("relative_difference_from_exact", row.relativeDifferenceFromExact)
            .set("seconds", row.seconds);
        reportRows.push_back(std::move(one));
    }
    std::vector<Report> sunRows;
    for (const SunShadowRow& shadow : shadows) {
        if (line.common().json != "-") printFile("sun", shadow);
        Report one;
        one.set("file", shadow.file)
            .set("bytes", uint64_t(shadow.bytes))
            .set("up_to_date", shadow.upToDate)
            .set("seconds", shadow.seconds);
        sunRows.push_back(std::move(one));
    }
    report.set("bundle", settings.bundlePath)
        .set("kind", settings.kind)
        .set("layout", settings.table.layout)
        .set("size", settings.table.size)
        .set("variant", settings.table.variant)
        .set("window", settings.table.window)
        .set("extract_sun", settings.table.extractSun)
        .set("rows", reportRows)
        .set("suns", sunRows);
    report.write(line.common().json);
}

}  // namespace prt::tools
