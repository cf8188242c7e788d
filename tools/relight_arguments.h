// What prt relight was asked to do.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compress/tables/table_options.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/image.h"
#include "precompute/io/scene.h"
#include "precompute/io/surface_image.h"
#include "runtime/renderer.h"
#include "runtime/technique.h"
#include "tools/context_arguments.h"

namespace prt::tools {

class CommandLine;

struct EnvironmentArgument {
    std::string source;  ///< file or sky:NAME
    double weight = 1;
};
/// Splits "file.exr:0.7"; the part behind the last colon is a weight when it is a number.
/// @throws UsageError  empty name, weight not finite or negative
EnvironmentArgument parseEnvironmentArgument(const std::string& text);

/// What every technique is, a line each.
std::string techniqueHelp();

struct RelightArguments {
    std::string bundlePath;
    std::vector<std::string> environmentTexts;
    std::vector<std::string> techniqueNames;  ///< as given; ["unc"] where none was
    std::string sizeText = "1280x800";
    std::string output, referenceOutput, differenceOutput;
    std::string exposureText = "0";
    std::string eyeText, targetText, toneText = "none", blendText = "cpu", transitionText;
    int samples = 1;
    int turntableFrames = 0, rotateLightFrames = 0;  ///< 0: no such motion
    double framesPerSecond = 25;
    double rotateDeg = 0, fovDeg = 40, azimuthDeg = 35, elevationDeg = 18, distance = 1;
    int referenceRays = 4096, bounces = 0, referencePaths = 256, timeFrames = 0;
    bool noNormalMap = false, noBackground = false, compareReference = false, each = false;

    std::vector<Technique> techniques;  ///< asked for by their own names
    bool allTechniques = false;         ///< asked for all that the bundle can do
    bool reference = false;             ///< asked for the ray-traced picture
    std::vector<EnvironmentArgument> environments;
    EnvironmentOptions environmentOptions;
    TableOptions tables;
    ContextArguments context;
    int width = 0, height = 0;
    ToneCurve toneCurve = ToneCurve::None;
    BlendOn blendOn = BlendOn::Cpu;
    std::string transitionEnds;           ///< "A:B" of --transition
    int transitionFrames = 0;             ///< 0: none
    std::optional<double> exposureStops;  ///< empty: chosen from the picture

    void addTo(CommandLine& line);
    /// Turn of the environments, from --rotate.
    double rotationRad() const;
    /// Whether several frames are to be drawn, and how many.
    bool isSequence() const { return sequenceFrames() > 0; }
    int sequenceFrames() const;
    /// Whether a picture of the technique was asked for, not only its error.
    bool isAsked(Technique technique) const;
    /// Checks and parses the texts.
    /// @throws UsageError
    void finish();
    /// From --eye and --target, or around the scene by --azimuth, --elevation and --distance.
    Camera camera(const Bounds& bounds) const;

  private:
    void parseTechniques();
    void parseSequence();
    void checkOutputs() const;
};

}  // namespace prt::tools
