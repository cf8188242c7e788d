// prt measure error: what each stage of a bundle's pipeline costs, and which knob to turn.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/projection_attributes.h"
#include "precompute/math/sh.h"
#include "tools/command_line.h"
#include "tools/environment_arguments.h"
#include "tools/measure/commands.h"
#include "tools/measure/error.h"
#include "tools/measure/error_advice.h"
#include "tools/measure/error_images.h"
#include "tools/measure/output.h"
#include "tools/table_arguments.h"

namespace prt::tools {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Order in which stages are listed: that of the sums up to each of them.
constexpr std::array kListed{ErrorStage::Truncation, ErrorStage::Projection,   ErrorStage::Sampling,
                             ErrorStage::Pca,        ErrorStage::Quantisation, ErrorStage::Tables};

std::vector<const ErrorBlock*> blocksOf(const ErrorResult& result) {
    std::vector<const ErrorBlock*> blocks;
    for (const ErrorBlock& block : result.environments) blocks.push_back(&block);
    if (blocks.size() > 1) blocks.push_back(&result.mean);
    return blocks;
}

double finite(double value) { return std::isfinite(value) ? value : kNone; }

Table rowTable(const ErrorResult& result) {
    Table table({"environment", "stage", "relative_rmse", "psnr_db", "relative_rmse_geometric",
                 "relative_rmse_tilted", "noise", "below_noise", "without_relative_rmse", "without_psnr_db",
                 "without_noise", "gain", "up_to_relative_rmse"});
    for (const ErrorBlock* block : blocksOf(result)) {
        if (block->isDark) continue;
        const ErrorFigure& total = block->total;
        table.add({block->environment, std::string("total"), total.relativeRmse, finite(total.psnrDb),
                   total.geometric, total.tilted, total.noise, uint64_t(total.isBelowNoise()), kNone, kNone,
                   kNone, kNone, total.relativeRmse});
        for (const ErrorStage stage : kListed) {
            const ErrorFigure &alone = block->alone[size_t(stage)], &without = block->without[size_t(stage)];
            table.add({block->environment, std::string(errorStageName(stage)), alone.relativeRmse,
                       finite(alone.psnrDb), alone.geometric, alone.tilted, alone.noise,
                       uint64_t(alone.isBelowNoise()), without.relativeRmse, finite(without.psnrDb),
                       without.noise, block->gain(stage), block->upTo[size_t(stage)].relativeRmse});
        }
    }
    return table;
}

std::vector<std::pair<const char*, const ErrorFigure*>> parts(const ErrorBlock& block) {
    return {{"quantisation_weights", &block.weights},
            {"quantisation_tables", &block.tableFormat},
            {"tables_lookup", &block.lookup},
            {"tables_bands", &block.bands},
            {"truncation_if_plain", &block.plain}};
}

Table partTable(const ErrorResult& result) {
    Table table({"environment", "part", "relative_rmse", "psnr_db", "noise", "below_noise"});
    for (const ErrorBlock* block : blocksOf(result)) {
        if (block->isDark) continue;
        for (const auto& [name, figure] : parts(*block))
            table.add({block->environment, std::string(name), figure->relativeRmse, finite(figure->psnrDb),
                       figure->noise, uint64_t(figure->isBelowNoise())});
    }
    return table;
}

std::string number(const ErrorFigure& figure) {
    if (figure.isBelowNoise()) return fmt::format("< {:.5f}", figure.noise);
    return fmt::format("{:.5f}", figure.relativeRmse);
}
std::string decibels(const ErrorFigure& figure) {
    if (figure.isBelowNoise() || !std::isfinite(figure.psnrDb)) return "";
    return fmt::format("{:.1f}", figure.psnrDb);
}

std::string blockText(const ErrorBlock& block) {
    if (block.isDark) return fmt::format("{}: no light reaches any point\n", block.environment);
    std::string text = fmt::format(
        "{}: total {} (geometric normals {:.5f}, tilted {:.5f}), {} dB; noise of the truth {:.5f}\n"
        "  {:<14}{:>11}{:>8}{:>11}{:>8}{:>10}{:>13}\n",
        block.environment, number(block.total), block.total.geometric, block.total.tilted,
        decibels(block.total), block.truthNoise, "stage", "alone", "dB", "without", "dB", "gain",
        "up to here");
    for (const ErrorStage stage : kListed) {
        const ErrorFigure &alone = block.alone[size_t(stage)], &without = block.without[size_t(stage)];
        text += fmt::format("  {:<14}{:>11}{:>8}{:>11}{:>8}{:>10.5f}{:>13}\n", errorStageName(stage),
                            number(alone), decibels(alone), number(without), decibels(without),
                            block.gain(stage), number(block.upTo[size_t(stage)]));
    }
    text += "  parts:";
    for (const auto& [name, figure] : parts(block)) text += fmt::format(" {} {};", name, number(*figure));
    text.back() = '\n';
    return text;
}

Figure errorFigure(const ErrorResult& result) {
    Figure figure{.title = "Relative RMSE of irradiance by stage", .columns = 2, .panels = {}};
    for (const ErrorBlock* block : blocksOf(result)) {
        Panel panel{.title = block->environment, .xLabel = {}, .yLabel = "relative RMSE"};
        panel.bars.push_back({"total", block->total.relativeRmse, 0});
        for (const ErrorStage stage : kListed) {
            panel.bars.push_back(
                {std::string(errorStageName(stage)) + " alone", block->alone[size_t(stage)].relativeRmse, 1});
            panel.bars.push_back({std::string("without ") + errorStageName(stage),
                                  block->without[size_t(stage)].relativeRmse, 2});
        }
        figure.panels.push_back(std::move(panel));
    }
    return figure;
}

std::vector<Report> imageReports(const std::vector<ErrorImage>& images) {
    std::vector<Report> reports;
    for (const ErrorImage& image : images) {
        Report report;
        report.set("file", image.file)
            .set("raw", image.raw)
            .set("environment", image.environment)
            .set("stage", image.stage)
            .set("scale", "logarithmic")
            .set("low", image.low)
            .set("high", image.high);
        reports.push_back(std::move(report));
    }
    return reports;
}

Report settingsReport(const JudgedBundle& bundle, const ErrorResult& result, const ErrorStudy& study,
                      const std::vector<ErrorKnob>& knobs) {
    const ErrorBlock& mean = result.mean;
    std::vector<Report> turns;
    for (const ErrorKnob& knob : knobs) {
        Report turn;
        turn.set("stage", errorStageName(knob.stage))
            .set("gain", knob.gain)
            .set("relative_rmse", knob.left)
            .set("command", knob.command);
        turns.push_back(std::move(turn));
    }
    Report report;
    report.set("domain", pointDomainName(bundle.visibility.grid.domain))
        .set("order", bundle.visibility.shOrder)
        .set("projection", projectionName(bundle.visibility.projection.kind))
        .set("compressed", result.isCompressed)
        .set("components", result.components)
        .set("points", uint64_t(result.points))
        .set("directions", uint64_t(result.directions))
        .set("tilt_deg", study.tiltDeg)
        .set("weights", study.weights)
        .set("tables", study.tables)
        .set("layout", study.table.layout)
        .set("size", study.table.size)
        .set("variant", study.table.variant)
        .set("cosine_bands", study.table.cosineBands())
        .set("window", study.table.window)
        .set("truth_noise", mean.truthNoise)
        .set("relative_rmse", mean.total.relativeRmse)
        .set("psnr_db", finite(mean.total.psnrDb))
        .set("environment_count", uint64_t(result.environments.size()))
        .set("knobs", turns);
    return report;
}

}  // namespace

void runMeasureError(int argc, char** argv) {
    std::string path, images;
    std::vector<std::string> sources;
    ErrorStudy study;
    int points = int(study.points);
    EnvironmentOptions environmentOptions;
    MeasureOptions options{.prefix = "measure-error"};
    CommandLine line(
        "prt measure error",
        "Error of a bundle's irradiance against ray-traced truth, split into the stages that make it: with "
        "each stage alone exact, and with each stage alone. Says which knob to turn.",
        "Stages: truncation (bands of visibility), projection (plain instead of weighted), sampling "
        "(directions of the bake),\npca, quantisation (formats that ship), tables (texels over the normal, "
        "bands of the cosine).\nWhat each means exactly: tools/docs/error_report.md.\nExample:\n  prt "
        "measure error out/house.prt --env studio.exr --env sky:clear --images out/errors --json -");
    line.positional("BUNDLE", path, "bundle made by prt precompute, compressed or not");
    line.textList("--env", sources, "ENV",
                  "environments: .exr, .hdr or sky:NAME; default: the built-in skies");
    addEnvironmentOptions(line, environmentOptions);
    line.integer("--points", points, 0, 100000000, "points judged, spread evenly over the surface; 0: all");
    line.integer("--rays", study.rays, kFewestErrorRays, kMaxBakeRays,
                 "directions over the sphere of the truth and of dense bakes; more where the light is");
    line.real("--tilt", study.tiltDeg, 0, 60, "of four shading normals about the geometric one, degrees");
    line.choice(
        "--weights", study.weights, {"float", "half", "unorm16", "unorm8"},
        "format of the weights; coefficients of a bundle that is not compressed are halves, or floats");
    line.choice("--tables", study.tables, {"float", "half", "rgb9e5", "r11f"},
                "format of the tables; the last two of cubes alone");
    addTableOptions(line, "--", study.table);
    line.text("--images", images, "DIR", "writes heat maps over the atlas: PNG, and EXR with the values");
    addMeasureOptions(line, options);
    if (!line.parse(argc, argv)) return;
    study.points = size_t(points);
    checkTableOptions(study.table);
    checkMeasureOutput(options);

    const Stopwatch watch;
    const JudgedBundle bundle = readJudgedBundle(path);
    const bool isAtlas = bundle.visibility.grid.domain == PointDomain::Texel;
    if (!images.empty() && !isAtlas)
        logWarning("--images: the bundle is per vertex and has no atlas; no heat maps are drawn");
    study.maps = !images.empty() && isAtlas;
    std::vector<Environment> environments;
    if (sources.empty()) environments = loadEnvironmentsOrSkies({}, false);
    for (const std::string& source : sources)
        environments.push_back(loadEnvironment(source, environmentOptions));
    const RayCaster caster(bundle.scene.positions, bundle.scene.indices);
    const JudgedPoints judged = judgedPoints(bundle, caster, study.points);
    const ErrorResult result = studyError(bundle, caster, judged, environments, study);

    std::vector<ErrorImage> written;
    if (study.maps) written = writeErrorImages(images, result, judged, bundle.visibility.grid);
    const std::vector<ErrorKnob> knobs = knobsOf(path, bundle, result, study, sources);
    Report report = settingsReport(bundle, result, study, knobs);
    report.set("bundle", path).set("images", imageReports(written)).set("seconds", watch.seconds());
    Measurement measurement{.name = "error", .rows = rowTable(result)};
    measurement.more = {{"parts", partTable(result)}};
    measurement.figures = {{"", errorFigure(result)}};
    for (const ErrorBlock* block : blocksOf(result)) measurement.summary += blockText(*block) + "\n";
    for (const ErrorImage& image : written)
        measurement.summary += fmt::format("{}: {:.2g} to {:.2g}\n", image.file, image.low, image.high);
    writeMeasurement(measurement, options, line.common(), std::move(report));
    if (line.common().json != "-") fmt::print("{}", knobText(knobs, result.mean.total.relativeRmse));
}

}  // namespace prt::tools
