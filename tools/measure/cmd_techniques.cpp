// prt measure techniques: Figs. 3 to 7 of [IwanickiSloan2012] for a bundle, and the error of every technique.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "tools/command_line.h"
#include "tools/measure/commands.h"
#include "tools/measure/output.h"
#include "tools/measure/technique_fields.h"
#include "tools/measure/technique_pictures.h"
#include "tools/measure/view_arguments.h"

namespace prt::tools {
namespace {

struct Arguments {
    RelightArguments relight;  // of these, what says what is drawn
    std::string folder = "techniques", plot = "svg";

    Arguments() {
        relight.sizeText = "640x400";
        relight.distance = 0.7;
        relight.referenceRays = 1024;
    }
    void addTo(CommandLine& line) {
        line.positional("BUNDLE", relight.bundlePath, "bundle made by prt precompute and prt compress");
        addLightOptions(line, relight, "draw each by itself");
        line.real("--rotate", relight.rotateDeg, -1e6, 1e6,
                  "turn of the environments about the up axis, degrees");
        addTechniqueOption(line, relight, "repeat to draw several; unc and pca are always drawn");
        line.text("--size", relight.sizeText, "WIDTHxHEIGHT", "pixels of a picture");
        addCameraOptions(line, relight);
        line.integer("--reference-rays", relight.referenceRays, 64, 1 << 20,
                     "directions of the reference, before refinement");
        relight.context.addTo(line);
        line.text("-o,--output", folder, "DIR", "folder of the pictures, techniques.csv and the plot");
        line.choice("--plot", plot, {"svg", "png", "none"}, "format of the plot; needs gnuplot");
    }
    void finish() {
        finishTechniques(relight);
        relight.compareReference = true;
        relight.finish();
    }
};

void makeFolder(const std::string& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw OutputError(folder, "cannot be made: " + error.message());
}

Table errorTable(const std::vector<TechniqueError>& errors) {
    Table rows(
        {"environment", "technique", "normal_map", "relative_rmse", "psnr_db", "floor", "rmse_to_unc"});
    for (const TechniqueError& row : errors)
        rows.add({row.environment, techniqueName(row.technique), std::string(row.normalMap ? "yes" : "no"),
                  row.error.relativeRmse, row.error.psnrDb, row.floorRmse, row.differenceRmse});
    return rows;
}

Figure errorFigure(const std::vector<TechniqueError>& errors) {
    Figure figure{.title = "Error of techniques against ray tracing", .columns = 1, .panels = {}};
    for (const TechniqueError& row : errors) {
        if (!row.normalMap) continue;
        if (figure.panels.empty() || figure.panels.back().title != row.environment)
            figure.panels.push_back({.title = row.environment, .yLabel = "relative RMSE of irradiance"});
        figure.panels.back().bars.push_back(
            {techniqueName(row.technique), row.error.relativeRmse, int(row.technique.kind)});
    }
    figure.panelWidthPx = 900;
    return figure;
}

}  // namespace

void runMeasureTechniques(int argc, char** argv) {
    Arguments arguments;
    CommandLine line(
        "prt measure techniques",
        "Draws every technique beside ray tracing: pictures with errors, four times the "
        "differences, numbers of vectors and bands, without and with normal maps, and the "
        "coefficients and weights themselves.",
        techniqueHelp() +
            "Example:\n  prt measure techniques house.prt --env sky:sunset --env assets/hdri/city.exr "
            "-o figures --json figures/techniques.json");
    arguments.addTo(line);
    if (!line.parse(argc, argv)) return;
    arguments.finish();
    const MeasureOptions output{(std::filesystem::path(arguments.folder) / "techniques").string(),
                                arguments.plot};
    makeFolder(arguments.folder);
    checkMeasureOutput(output);

    const Stopwatch watch;
    const RelightData data = loadRelightData(arguments.relight);
    const auto context = std::make_unique<GlContext>(arguments.relight.context.kind());
    TechniqueFigures figures = drawTechniqueFigures(*context, arguments.relight, data, arguments.folder);
    for (const auto& file :
         drawFieldSheets(*context, data, arguments.relight.camera(sceneBounds(data.scene)), arguments.folder))
        figures.files.push_back(file);
    for (const auto& file : figures.files) logNote("wrote " + file.string());

    Measurement measurement{.name = "techniques", .rows = errorTable(figures.errors)};
    measurement.figures = {{"", errorFigure(figures.errors)}};
    Report report;
    report.set("bundle", arguments.relight.bundlePath)
        .set("context", glContextKindName(context->kind()))
        .set("gpu", context->rendererName())
        .set("width", arguments.relight.width)
        .set("height", arguments.relight.height)
        .set("rotate_deg", arguments.relight.rotateDeg)
        .set("order", data.shOrder)
        .set("domain", std::string(pointDomainName(data.domain())))
        .set("seconds", watch.seconds());
    writeMeasurement(measurement, output, line.common(), std::move(report));
}

}  // namespace prt::tools
