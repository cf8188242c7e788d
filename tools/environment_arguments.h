// How commands are told what their environment files look like.
#pragma once

#include <string>
#include <vector>

#include "precompute/io/environment_file.h"
#include "tools/command_line.h"

namespace prt::tools {

/// Adds --env-layout and --env-mirrored.
void addEnvironmentOptions(CommandLine& line, EnvironmentOptions& options);

/// Loads all, or the built-in skies where none is named.
/// @param withUniform  whether the uniform sky is one of those
std::vector<Environment> loadEnvironmentsOrSkies(std::vector<std::string> sources, bool withUniform);

}  // namespace prt::tools
