// prt export: textures, a description and shader source for an engine.
#include <fmt/format.h>

#include "compress/export_bundle.h"
#include "compress/shipped_bytes.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/report.h"

namespace prt::tools {
namespace {

void print(const ExportReport& report, const ExportSettings& settings) {
    fmt::print("{:<12}{:<42}{:<24}{:>7}{:>12}{:>13}\n", "part", "file", "format", "layers", "bytes",
               "bytes/texel");
    for (const ExportRow& row : report.rows)
        fmt::print("{:<12}{:<42}{:<24}{:>7}{:>12}{:>13.2f}\n", row.part, row.file, row.format, row.layers,
                   row.bytes, row.bytesPerTexel);
    fmt::print("{:<85}{:>12}{:>13.2f}  ({:.2f} without tables)\n", "sum", report.bytes, report.bytesPerTexel,
               report.bytesPerPointTexel);
    fmt::print("relative RMSE of visibility by weights as {}: {:.3g}\n", settings.weights,
               report.weightsRelativeRmse);
    for (const ExportError& error : report.errors)
        fmt::print("relative RMSE of irradiance by all formats, {}: {:.3g}\n", error.table,
                   error.irradianceRelativeRmse);
}

Report jsonReport(const ExportReport& report, const ExportSettings& settings) {
    std::vector<Report> rows, errors;
    for (const ExportRow& row : report.rows) {
        Report one;
        one.set("part", row.part)
            .set("file", row.file)
            .set("format", row.format)
            .set("layers", row.layers)
            .set("bytes", uint64_t(row.bytes))
            .set("bytes_per_texel", row.bytesPerTexel);
        rows.push_back(std::move(one));
    }
    for (const ExportError& error : report.errors) {
        Report one;
        one.set("table", error.table).set("irradiance_relative_rmse", error.irradianceRelativeRmse);
        errors.push_back(std::move(one));
    }
    Report result;
    result.set("bundle", settings.bundlePath)
        .set("folder", settings.folder)
        .set("container", settings.container)
        .set("points", uint64_t(report.points))
        .set("bytes", uint64_t(report.bytes))
        .set("bytes_per_texel", report.bytesPerTexel)
        .set("bytes_per_texel_without_tables", report.bytesPerPointTexel)
        .set("weights_relative_rmse", report.weightsRelativeRmse)
        .set("not_exported", uint64_t(report.notExported.size()))
        .set("seconds", report.seconds)
        .set("rows", rows)
        .set("errors", errors);
    return result;
}

}  // namespace

void runExportCommand(int argc, char** argv) {
    ExportSettings settings;
    CommandLine line(
        "prt export",
        "Writes a bundle as textures for an engine: weights, validity, visibility and tables, with a\n"
        "description (JSON) and GLSL and HLSL source that evaluates them.",
        "Example:\n  prt export out/house.prt -o out/house-ktx2 --weights unorm8 --tables half");
    line.positional("BUNDLE", settings.bundlePath, "bundle made by prt precompute");
    line.text("-o,--output", settings.folder, "FOLDER", "where to write; made when it is not there", true);
    line.choice("--container", settings.container, {"ktx2", "dds"}, "kind of the texture files");
    line.choice("--weights", settings.weights, pointEncodings(),
                "format of the weights; unorm has a scale and bias per component");
    line.choice("--tables", settings.tables, tableEncodings(), "format of the tables");
    line.choice(
        "--visibility", settings.visibility, {"auto", "half", "float", "none"},
        "SH coefficients of visibility; auto: half where a light-cosine table needs them or the bundle is "
        "not compressed");
    if (!line.parse(argc, argv)) return;

    const ExportReport report = runExport(settings);
    if (line.common().json != "-") print(report, settings);
    jsonReport(report, settings).write(line.common().json);
}

}  // namespace prt::tools
