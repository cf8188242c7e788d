// prt measure: finds the measurement.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "tools/commands.h"
#include "tools/measure/commands.h"

namespace prt::tools {
namespace {

struct MeasureCommand {
    const char* name;
    const char* summary;
    void (*run)(int, char**);
};

const std::vector<MeasureCommand> kMeasureCommands = {
    {"bake", "rays per second of the bake and of bare ray casting, time by stage", runMeasureBake},
    {"basis", "Habel Fig. 3, Gautron Figs. 4, 5 and 10: bases against signals and coefficients",
     runMeasureBasis},
    {"compression", "Iwanicki & Sloan Figs. 5 and 6: error, bytes and work of compressed visibility",
     runMeasureCompression},
    {"error", "error of a bundle by stage against ray-traced truth, and which knob to turn", runMeasureError},
    {"frame-time", "Iwanicki & Sloan Sec. 5: time of a frame by technique, base pass subtracted",
     runMeasureFrameTime},
    {"parameterization", "Iwanicki & Sloan Fig. 8: error of tables over the sphere by layout and size",
     runMeasureParameterization},
    {"product", "products of expansions: time, non-zeros, multiplications", runMeasureProduct},
    {"rotation", "Křivánek Fig. 3 and Table 1: errors and time of every rotation", runMeasureRotation},
    {"projection", "irradiance from plain and weighted visibility against ray-traced truth",
     runMeasureProjection},
    {"sampling", "error of visibility over rays: sets of directions, uniform and adaptive bakes",
     runMeasureSampling},
    {"tables", "Iwanicki & Sloan Secs. 3.2 and 3.3: error, size and time of tables over the normal",
     runMeasureTables},
    {"techniques", "Iwanicki & Sloan Figs. 3 to 7: every technique beside ray tracing, and its error",
     runMeasureTechniques},
};

std::string usage() {
    std::string text =
        "prt measure: figures of the papers, and of this machine, reproduced\n\n"
        "Usage: prt measure WHAT [OPTIONS]\n\nWhat:\n";
    for (const MeasureCommand& command : kMeasureCommands)
        text += fmt::format("  {:<18}{}\n", command.name, command.summary);
    return text +
           "\nEach writes CSV, a plot (where gnuplot is installed) and, with --json, JSON.\n"
           "prt measure WHAT --help lists every option with its default and range.\n";
}

}  // namespace

void runMeasureCommand(int argc, char** argv) {
    if (argc < 2) throw UsageError("", "what shall be measured?", "prt measure --help lists it");
    const std::string name = argv[1];
    if (name == "--help" || name == "-h" || name == "help") {
        fmt::print("{}", usage());
        return;
    }
    for (const MeasureCommand& command : kMeasureCommands) {
        if (name != command.name) continue;
        setProgramName("prt measure " + name);
        command.run(argc - 1, argv + 1);
        return;
    }
    throw UsageError("", fmt::format("'{}' is not a measurement", name), "prt measure --help lists them");
}

}  // namespace prt::tools
