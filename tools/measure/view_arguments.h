// Options of measurements that draw a scene, and what several of them make of these.
#pragma once

#include <vector>

#include "tools/command_line.h"
#include "tools/relight_arguments.h"
#include "tools/relight_techniques.h"

namespace prt::tools {

/// Declares --eye, --target, --azimuth, --elevation, --distance and --fov, as of prt relight.
/// @param distanceHelp  what else there is to say of --distance
void addCameraOptions(CommandLine& line, RelightArguments& arguments, const std::string& distanceHelp = "");

/// Declares --env, --env-layout and --env-mirrored.
/// @param use  what several environments are for
void addLightOptions(CommandLine& line, RelightArguments& arguments, const std::string& use);

/// Declares --technique; none named is all. After parsing call finishTechniques, before
/// RelightArguments::finish.
void addTechniqueOption(CommandLine& line, RelightArguments& arguments, const std::string& help);
/// @throws UsageError  "reference" was named
void finishTechniques(RelightArguments& arguments);

/// The techniques to be drawn, each once: of two names for the same (unc and unc6 of a bundle of six bands)
/// the one with a number.
std::vector<Technique> withoutTwins(const RelightData& data, const RelightTechniques& techniques);

}  // namespace prt::tools
