// prt measure compression: errors, bytes and work of compressed visibility, and the paper's claims about
// them.
#include <fmt/format.h>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/math/sh.h"
#include "tools/command_line.h"
#include "tools/environment_arguments.h"
#include "tools/measure/commands.h"
#include "tools/measure/compression.h"
#include "tools/measure/compression_images.h"
#include "tools/measure/compression_tables.h"
#include "tools/measure/output.h"
#include "tools/measure/view_arguments.h"
#include "tools/relight_arguments.h"

namespace prt::tools {
namespace {

constexpr int kTableSize = 32;  // of prt tabulate

struct Arguments {
    CompressionStudy study;
    MeasureOptions options{.prefix = "compression"};
    std::string bundle, projection = "bundle";
    std::string orders = "3,4,6", components = "4,8,12,16,24", lightOrders = "3-12";
    std::string images, sizeText = "640x400";
    std::vector<std::string> sources;
    int seed = 1, frames = 5;
    CompressionView view;
    RelightArguments camera;  // of these only the camera is used

    Arguments() { camera.distance = 0.7; }
    void addTo(CommandLine& line) {
        line.positional("BUNDLE", bundle, "bundle made by prt precompute");
        line.textList("--env", sources, "ENV",
                      "environments: .exr, .hdr or sky:NAME; default: the built-in skies");
        line.text("--orders", orders, "LIST", "numbers of SH bands of visibility");
        line.text("--components", components, "LIST", "numbers of vectors; n² is always measured");
        line.text("--light-orders", lightOrders, "LIST", "numbers of SH bands of the light");
        line.choice("--projection", projection, {"bundle", "plain"},
                    "of visibility and weights: as the bundle has it, or the paper's");
        line.choice("--weights", study.encoding, pointEncodings(), "format of weights as shipped");
        line.integer("--points", study.points, 1, 1000000, "where irradiance is judged");
        line.integer("--seed", seed, 0, 1000000000, "of the points");
        line.text("--images", images, "DIR",
                  "draws Figs. 5 and 6 under the first environment into this folder");
        line.text("--size", sizeText, "WIDTHxHEIGHT", "pixels of the pictures, and of frames that are timed");
        line.integer("--time-frames", frames, 0, 10000,
                     "times are medians of so many frames; 0: none are timed");
        line.integer("--reference-rays", view.referenceRays, 64, 1 << 20,
                     "directions of the pictures' reference, before refinement");
        addCameraOptions(line, camera);
        addMeasureOptions(line, options);
    }
    void finish() {
        parseSize("--size", sizeText, view.width, view.height);
        float unused[3];
        if (!camera.eyeText.empty()) parseVector("--eye", camera.eyeText, unused);
        if (!camera.targetText.empty()) parseVector("--target", camera.targetText, unused);
        study.seed = uint64_t(seed);
        study.orders = parseIntegerList("--orders", orders, 1, kMaxBundleShOrder);
        study.components = parseIntegerList("--components", components, 1, shCount(kMaxBundleShOrder));
        study.lightOrders = parseIntegerList("--light-orders", lightOrders, 1, kMostLightBands);
    }
};

std::vector<FrameTime> timeFrames(CompressionScene& scene, const Arguments& arguments,
                                  const Environment& environment) {
    if (arguments.frames == 0) return {};
    try {
        return timeCompressionFrames(scene, arguments.study.orders,
                                     componentsOf(arguments.study.components, arguments.study.orders.back()),
                                     environment, arguments.view, arguments.frames);
    } catch (const InputError& error) {  // no OSMesa, or a scene that its runtime cannot draw
        logNote(fmt::format("no frames are timed: {}", error.what()));
        return {};
    }
}

}  // namespace

void runMeasureCompression(int argc, char** argv) {
    Arguments arguments;
    CommandLine line(
        "prt measure compression",
        "Visibility of several orders compressed to several numbers of vectors: error of irradiance against "
        "uncompressed visibility and against ray-traced truth, bytes, work of a pixel.",
        "Every order but the bundle's own is baked anew, with the bundle's settings; the bundle stays as it "
        "is.\nExample:\n  prt measure compression house.prt --env assets/hdri/*.exr --json -");
    arguments.addTo(line);
    if (!line.parse(argc, argv)) return;
    arguments.finish();
    checkMeasureOutput(arguments.options);
    if (!arguments.images.empty()) checkCompressionFigures(arguments.images);

    const Stopwatch watch;
    const CompressionStudy& study = arguments.study;
    const std::vector<Environment> environments = loadEnvironmentsOrSkies(arguments.sources, true);
    CompressionScene scene(arguments.bundle, arguments.projection == "plain", study.orders.back());
    arguments.view.camera = arguments.camera.camera(sceneBounds(scene.scene()));
    arguments.view.tableSize = kTableSize;
    const CompressionResult result = studyCompression(scene, environments, study);
    const std::vector<FrameTime> times = timeFrames(scene, arguments, environments[0]);
    std::vector<PictureRow> pictures;
    if (!arguments.images.empty())
        pictures = drawCompressionFigures(scene, study.orders, study.encoding, environments[0],
                                          arguments.view, arguments.images);

    Measurement measurement{.name = "compression",
                            .rows = compressionTable(result, study.encoding, kTableSize)};
    measurement.more = {{"orders", orderTable(result)},
                        {"claims", claimTable(result)},
                        {"lights", lightTable(result)},
                        {"sensitivity", sensitivityTable(result)},
                        {"storage", storageTable(result, study.encoding)}};
    if (!times.empty()) measurement.more.emplace_back("frames", frameTable(times));
    if (!pictures.empty()) measurement.more.emplace_back("pictures", pictureTable(pictures));
    measurement.figures = {{"", compressionFigure(result)}};
    measurement.summary = fmt::format("{}\n{}\n{}", measurement.rows.text(),
                                      measurement.more[0].second.text(), verdictText(result));
    for (const auto& [name, table] : measurement.more)
        if (name == "frames" || name == "pictures") measurement.summary += fmt::format("\n{}", table.text());
    Report report;
    report.set("bundle", arguments.bundle)
        .set("domain", std::string(pointDomainName(result.domain)))
        .set("projection", arguments.projection)
        .set("weights", study.encoding)
        .set("points", result.points)
        .set("environment_count", uint64_t(environments.size()))
        .set("table_size", kTableSize)
        .set("seconds", watch.seconds());
    writeMeasurement(measurement, arguments.options, line.common(), std::move(report));
}

}  // namespace prt::tools
