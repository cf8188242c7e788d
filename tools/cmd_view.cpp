// prt view: a window on a bundle, lit by any blend of environments.
#include <fmt/format.h>

#include <iostream>
#include <iterator>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/environment_arguments.h"
#include "tools/measure/view_arguments.h"
#include "tools/table_arguments.h"
#include "tools/view/app.h"
#include "tools/view/bindings.h"

namespace prt::tools {
namespace {

struct ViewArguments {
    ViewOptions options;
    std::string script, folder = ".";

    void addTo(CommandLine& line);
    void finish();
};

void ViewArguments::addTo(CommandLine& line) {
    RelightArguments& relight = options.relight;
    line.positional("BUNDLE", relight.bundlePath, "bundle made by prt precompute");
    line.textList("--env", relight.environmentTexts, "ENV[:WEIGHT]",
                  "environment and its weight (1); any number; none: all built-in skies, the first alone");
    addEnvironmentOptions(line, relight.environmentOptions);
    line.real("--rotate", relight.rotateDeg, -1e6, 1e6,
              "turn of the environments about the up axis, degrees");
    line.text("--technique", options.technique, "NAME",
              fmt::format("shown first [{}; none: pca, or unc without pca.exr]", listedTechniqueNames()));
    line.text("--size", relight.sizeText, "WIDTHxHEIGHT", "of the window");
    line.text("--exposure", relight.exposureText, "STOPS|auto", "brightness");
    line.choice("--tone", relight.toneText, {"none", "filmic", "neutral"}, "tone curve");
    line.integer("--samples", relight.samples, 1, 4, "of a pixel: 1, or 4 for smooth edges");
    line.choice(
        "--blend", relight.blendText, {"cpu", "gpu"},
        "where tables of several environments are blended: before they are made, or from one of each");
    addCameraOptions(line, relight);
    line.flag("--no-normal-map", relight.noNormalMap, "shade with the mesh's own normals");
    line.flag("--no-background", relight.noBackground, "black where nothing is seen");
    addTableOptions(line, "--table-", relight.tables);
    addSunOption(line, relight.tables);
    line.integer("--reference-rays", relight.referenceRays, 64, 1 << 20,
                 "directions of the reference, before refinement");
    line.text("--screenshots", folder, "FOLDER", "where key P writes prt-view-0001.png and so on");
    line.flag("--fps", options.measureFrames, "draw all the time and show frames a second");
    line.text("--script", script, "FILE|-", "play input from a file, or from standard input");
}

void ViewArguments::finish() {
    RelightArguments& relight = options.relight;
    if (relight.environmentTexts.empty()) {
        relight.environmentTexts = builtInEnvironments();
        options.firstAlone = true;
    }
    if (!options.technique.empty() && !techniqueFromName(options.technique))
        throw UsageError("--technique", fmt::format("there is no technique called '{}'", options.technique),
                         fmt::format("use one of {}", listedTechniqueNames()));
    relight.techniqueNames = {"all"};
    relight.timeFrames = 1;  // relight wants something to do
    relight.finish();
    options.screenshots = folder;
    if (script.empty()) return;
    options.scriptName = script == "-" ? "standard input" : script;
    options.script = parseViewScript(
        script == "-" ? std::string(std::istreambuf_iterator<char>(std::cin), {}) : readFile(script),
        options.scriptName);
}

std::string epilogue() {
    std::string text = "Mouse and keys:\n";
    for (const HelpLine& line : helpLines()) text += fmt::format("  {:<30} {}\n", line.keys, line.help);
    text += "Commands of a script, one a line:\n";
    for (const ScriptCommandHelp& command : scriptHelp())
        text += fmt::format("  {:<36} {}\n", command.usage, command.help);
    return text + "Example:\n  prt view out/house.prt --env sunset.exr --env night.exr:0.3 --technique pca16";
}

}  // namespace

void runViewCommand(int argc, char** argv) {
    ViewArguments arguments;
    CommandLine line("prt view", "Opens a window on a bundle: turn it, light it, compare it.", epilogue());
    arguments.addTo(line);
    if (!line.parse(argc, argv)) return;
    arguments.finish();
#ifdef PRT_WITH_VIEWER
    runViewer(arguments.options).write(line.common().json);
#else
    throw InputError("window", "this build has none",
                     "configure it with -DPRT_WITH_VIEWER=ON (packages: tools/install-dependencies viewer)");
#endif
}

}  // namespace prt::tools
