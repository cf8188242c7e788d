// prt measure sampling: error of visibility over rays, for sets of directions, uniform and adaptive.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>
#include <span>
#include <vector>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/math/sh.h"
#include "precompute/mesh/load_mesh.h"
#include "tools/command_line.h"
#include "tools/measure/commands.h"
#include "tools/measure/output.h"
#include "tools/measure/sampling.h"
#include "tools/measure/sampling_banding.h"

namespace prt::tools {
namespace {

struct MeshResult {
    std::string name;
    SamplingResult result;
};

Cell integerOrNone(double value) {
    return std::isnan(value) ? Cell(value) : Cell(uint64_t(std::llround(value)));
}

Table rowTable(const std::vector<MeshResult>& meshes) {
    Table table({"mesh", "set", "directions", "rays", "rms", "rms_open", "error", "estimated", "below_error",
                 "below_twice_estimate"});
    for (const MeshResult& mesh : meshes)
        for (const SamplingRow& row : mesh.result.rows)
            table.add({mesh.name, row.set, integerOrNone(row.directions), row.rays, row.rms, row.rmsOpen,
                       row.error, row.estimated, row.belowError, row.belowTwiceEstimate});
    return table;
}

Table meshTable(const std::vector<MeshResult>& meshes) {
    Table table({"mesh", "points", "mean_ao"});
    for (const MeshResult& mesh : meshes)
        table.add({mesh.name, uint64_t(mesh.result.points), mesh.result.meanAo});
    return table;
}

// What every other set takes for the error of so many random directions shared by all points.
Table equalErrorTable(const std::vector<MeshResult>& meshes, int randomDirections) {
    Table table({"mesh", "set", "rms", "directions", "rays", "directions_to_random"});
    for (const MeshResult& mesh : meshes) {
        const std::vector<SamplingRow>& rows = mesh.result.rows;
        const double rms = rmsAt(rows, "random", randomDirections);
        std::set<std::string> seen;
        for (const SamplingRow& row : rows) {
            if (std::isnan(row.directions) || !seen.insert(row.set).second) continue;
            const SamplingEffort effort = effortAt(rows, row.set, rms);
            table.add({mesh.name, row.set, rms, effort.directions, effort.rays,
                       effort.directions / randomDirections});
        }
    }
    return table;
}

// Adaptive bakes beside the rays that uniform bakes take for the same RMS.
Table adaptiveTable(const std::vector<MeshResult>& meshes) {
    Table table({"mesh", "error", "rays", "rms", "uniform_rays", "rays_to_uniform", "rms_open", "estimated",
                 "below_error", "below_twice_estimate"});
    for (const MeshResult& mesh : meshes)
        for (const SamplingRow& row : mesh.result.rows) {
            if (std::isnan(row.error)) continue;
            const double uniform = effortAt(mesh.result.rows, "fibonacci", row.rms).rays;
            table.add({mesh.name, row.error, row.rays, row.rms, uniform, row.rays / uniform, row.rmsOpen,
                       row.estimated, row.belowError, row.belowTwiceEstimate});
        }
    return table;
}

Figure errorFigure(const std::vector<MeshResult>& meshes) {
    Figure figure;
    figure.title = "Sampling error of irradiance";
    figure.columns = int(std::min<size_t>(3, meshes.size()));
    for (const MeshResult& mesh : meshes) {
        Panel panel{.title = mesh.name,
                    .xLabel = "rays traced per point",
                    .yLabel = "relative RMS",
                    .logX = true,
                    .logY = true};
        for (const SamplingRow& row : mesh.result.rows) {
            if (panel.series.empty() || panel.series.back().name != row.set)
                panel.series.push_back({row.set, {}, row.set.ends_with("-rotated")});
            panel.series.back().points.push_back({row.rays, row.rms});
        }
        figure.panels.push_back(std::move(panel));
    }
    return figure;
}

Table bandingTable(const BandingResult& banding) {
    Table table({"surface", "light", "set", "directions", "rays", "rms", "shading_rms", "bands_rms",
                 "grain_rms", "bands_to_white", "step"});
    for (const BandingRow& row : banding.rows)
        table.add({row.surface, row.light, row.set, integerOrNone(row.directions), row.rays, row.rms,
                   row.shadingRms, row.bandsRms, row.grainRms, row.bandsToWhite, row.step});
    return table;
}

Table pictureTable(const BandingResult& banding) {
    Table table({"picture", "rms", "rms_display_steps"});
    for (const BandingPicture& picture : banding.pictures)
        table.add({picture.name, picture.rms, picture.steps});
    return table;
}

// A panel per surface and light: RMS by octave of the wavelength.
Figure bandingFigure(const BandingResult& banding, int linePoints) {
    Figure figure;
    figure.title = "Error along a line of " + std::to_string(linePoints) + " points";
    figure.columns = 2;
    for (const BandingRow& row : banding.rows) {
        const std::string title = row.surface + ", " + row.light;
        if (figure.panels.empty() || figure.panels.back().title != title)
            figure.panels.push_back({.title = title,
                                     .xLabel = "length of the wave (points)",
                                     .yLabel = "RMS in an octave (share of an open point)",
                                     .logX = true,
                                     .logY = true});
        Series series{row.set, {}, row.set.find("rotated") != std::string::npos};
        if (!std::isnan(row.directions)) series.name += fmt::format(" {}", row.directions);
        for (size_t k = 0; k < row.octaves.size(); ++k)
            series.points.push_back({linePoints / std::exp2(k), row.octaves[k]});
        figure.panels.back().series.push_back(std::move(series));
    }
    figure.panelHeightPx = 560;
    return figure;
}

// "0.04,0.01" into falling numbers; "none" is none.
std::vector<double> parseErrors(const std::string& text) {
    std::set<double, std::greater<>> values;
    const char *at = text.data(), *end = at + text.size();
    while (text != "none") {
        double value = 0;
        const auto [next, problem] = std::from_chars(at, end, value);
        if (problem != std::errc() || (next != end && *next != ','))
            throw UsageError("--errors", fmt::format("'{}' is not a list of numbers", text),
                             "for example 0.02,0.01, or none");
        if (!(value >= kLeastError && value <= 1))
            throw UsageError("--errors", fmt::format("{} is outside {}..1", value, kLeastError));
        values.insert(value);
        if (next == end) break;
        at = next + 1;
    }
    return {values.begin(), values.end()};
}

std::vector<DirectionSetKind> parseSets(const std::string& text) {
    const std::vector<std::string>& names = directionSetNames();
    std::vector<DirectionSetKind> kinds;
    for (const std::string& name : parseNameList("--sets", text, names))
        kinds.push_back(DirectionSetKind(std::find(names.begin(), names.end(), name) - names.begin()));
    return kinds;
}

struct Arguments {
    std::vector<std::string> meshes;
    std::string counts = "25,50,100,200,400,800,1600,3200", errors = "0.04,0.02,0.01,0.005,0.0025,0.00125";
    std::string sets = "all", projection = "irradiance", placement = "both";
    int compare = 1600, seed = 1;
    bool banding = false;
    BandingStudy bandingStudy;
    SamplingStudy study;
    MeasureOptions options;
};

void declare(CommandLine& line, Arguments& arguments) {
    SamplingStudy& study = arguments.study;
    line.positionalList("MESH", arguments.meshes, "mesh files");
    line.text("--counts", arguments.counts, "LIST", "sizes of the sets: directions over the sphere");
    line.text("--sets", arguments.sets, "LIST",
              "any of " + fmt::format("{}", fmt::join(directionSetNames(), ", ")) + "; all");
    line.choice("--placement", arguments.placement, {"both", "shared"},
                "sets shared by all points, or also turned at random for each");
    line.text("--errors", arguments.errors, "LIST",
              "adaptive bakes: errors to stop at, shares of an open point's irradiance; none");
    line.integer("--compare", arguments.compare, 1, kMaxBakeRays,
                 "random directions whose error the other sets shall reach");
    line.integer("--points", study.points, 1, 1000000, "random points of each mesh");
    line.integer("--seeds", study.seeds, 1, 1000, "of each random set");
    line.integer("--truth", study.truth, 64, 1 << 24, "directions over the sphere of the truth");
    line.integer("--order", study.shOrder, 1, kMaxBundleShOrder, "number of SH bands");
    line.choice("--projection", arguments.projection, {"irradiance", "plain"}, "as of prt precompute");
    line.flag(
        "--banding", arguments.banding,
        "also errors along lines on a made scene, by the length of their waves, and pictures of a floor "
        "under the sun: PREFIX-banding-NAME.png (irradiance, and its error 16 times as large)");
    line.integer("--picture-size", arguments.bandingStudy.picturePx, 0, 1024,
                 "of --banding: side of the pictures, 0 for none");
    line.integer("--seed", arguments.seed, 0, 1000000000, "of points and sets");
    addMeasureOptions(line, arguments.options);
}

void finish(Arguments& arguments) {
    SamplingStudy& study = arguments.study;
    study.counts = parseIntegerList("--counts", arguments.counts, 1, kMaxBakeRays);
    study.errors = parseErrors(arguments.errors);
    study.sets = parseSets(arguments.sets);
    study.rotated = arguments.placement == "both";
    study.seed = uint64_t(arguments.seed);
    if (arguments.projection == "plain") study.projection = kPlainProjection;
    if (study.truth < 4 * study.counts.back())
        throw UsageError("--truth",
                         fmt::format("{} is no truth for sets of {}", study.truth, study.counts.back()),
                         "give at least four times as many, or smaller --counts");
    checkMeasureOutput(arguments.options);
}

// Pictures are written here, the rest with everything else.
void addBanding(Measurement& measurement, const Arguments& arguments) {
    BandingStudy study = arguments.bandingStudy;
    study.shOrder = arguments.study.shOrder;
    study.projection = arguments.study.projection;
    study.seed = arguments.study.seed;
    study.truth = std::max(1, arguments.study.truth / 2);  // many more points
    const BandingResult banding = studyBanding(study);
    for (const BandingPicture& picture : banding.pictures) {
        const std::vector<uint8_t> png = encodePng(picture.image);
        writeFileAtomically(arguments.options.prefix + "-banding-" + picture.name + ".png",
                            std::as_bytes(std::span(png)));
    }
    measurement.more.emplace_back("banding", bandingTable(banding));
    measurement.figures.emplace_back("banding", bandingFigure(banding, study.linePoints));
    measurement.summary += fmt::format(
        "\nErrors along lines of {} points, shares of an open point (bands: waves of {} to {} "
        "points):\n{}",
        study.linePoints, kShortestWave, kLongestWave, measurement.more.back().second.text());
    if (banding.pictures.empty()) return;
    measurement.more.emplace_back("banding_pictures", pictureTable(banding));
    measurement.summary += "\n" + measurement.more.back().second.text();
}

}  // namespace

void runMeasureSampling(int argc, char** argv) {
    Arguments arguments;
    arguments.options.prefix = "sampling";
    CommandLine line(
        "prt measure sampling",
        "Error of visibility from finitely many rays at random points, as irradiance under "
        "natural light shows it: random, stratified, Sobol-Owen and Fibonacci directions, shared "
        "or turned for each point, uniform and adaptive bakes.",
        "Example:\n  prt measure sampling bunny.obj room.ply --json -");
    declare(line, arguments);
    if (!line.parse(argc, argv)) return;
    finish(arguments);

    std::vector<MeshResult> results;
    for (const std::string& mesh : arguments.meshes)
        results.push_back({std::filesystem::path(mesh).stem().string(),
                           studySampling(loadMesh(mesh, {}), arguments.study)});
    const SamplingStudy& study = arguments.study;
    Report report;
    report.set("points", study.points)
        .set("truth_directions", study.truth)
        .set("order", study.shOrder)
        .set("projection", arguments.projection)
        .set("seeds", study.seeds)
        .set("compare_directions", arguments.compare);
    Measurement measurement{"sampling", rowTable(results)};
    measurement.more = {{"equal_error", equalErrorTable(results, arguments.compare)},
                        {"adaptive", adaptiveTable(results)},
                        {"meshes", meshTable(results)}};
    measurement.figures = {{"", errorFigure(results)}};
    measurement.summary = fmt::format(
        "What reaches the error of {} random directions over the sphere (rays: those traced, above the "
        "horizon):\n{}\nAdaptive bakes, and the rays of uniform ones for the same RMS:\n{}",
        arguments.compare, measurement.more[0].second.text(), measurement.more[1].second.text());
    if (arguments.banding) addBanding(measurement, arguments);
    writeMeasurement(measurement, arguments.options, line.common(), std::move(report));
}

}  // namespace prt::tools
