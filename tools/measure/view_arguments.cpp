// Techniques are those of [IwanickiSloan2012, Sec. 3 to 5].
#include "tools/measure/view_arguments.h"

#include <fmt/format.h>

#include <algorithm>

#include "precompute/base/error.h"
#include "tools/environment_arguments.h"

namespace prt::tools {

void addCameraOptions(CommandLine& line, RelightArguments& arguments, const std::string& distanceHelp) {
    line.text("--eye", arguments.eyeText, "X,Y,Z", "camera position; else it is placed by the next three");
    line.text("--target", arguments.targetText, "X,Y,Z", "point looked at; else the middle of the scene");
    line.real("--azimuth", arguments.azimuthDeg, -1e6, 1e6,
              "of the camera around the scene, degrees from +Z towards +X");
    line.real("--elevation", arguments.elevationDeg, -89, 89, "of the camera above the horizon, degrees");
    line.real("--distance", arguments.distance, 0.01, 100,
              "of the camera, 1 = the scene's bounding sphere fills the picture" + distanceHelp);
    line.real("--fov", arguments.fovDeg, 1, 160, "vertical field of view, degrees");
}

void addLightOptions(CommandLine& line, RelightArguments& arguments, const std::string& use) {
    line.textList("--env", arguments.environmentTexts, "ENV[:WEIGHT]",
                  "environment and its weight (1); repeat to " + use + "; none: sky:clear");
    addEnvironmentOptions(line, arguments.environmentOptions);
}

void addTechniqueOption(CommandLine& line, RelightArguments& arguments, const std::string& help) {
    line.textList("--technique", arguments.techniqueNames, "NAME",
                  fmt::format("{} [{} | all; default all]", help, listedTechniqueNames()));
}

void finishTechniques(RelightArguments& arguments) {
    if (arguments.techniqueNames.empty()) arguments.techniqueNames.push_back("all");
    if (std::ranges::find(arguments.techniqueNames, "reference") != arguments.techniqueNames.end())
        throw UsageError("--technique", "the reference is traced, not drawn",
                         fmt::format("use one of {}, all", listedTechniqueNames()));
}

std::vector<Technique> withoutTwins(const RelightData& data, const RelightTechniques& techniques) {
    std::vector<Technique> kept;
    for (const Technique technique : data.techniques) {
        std::erase_if(
            kept, [&](Technique other) { return techniques.drawn(other) == techniques.drawn(technique); });
        kept.push_back(technique);
    }
    return kept;
}

}  // namespace prt::tools
