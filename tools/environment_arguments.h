// How commands are told what their environment files look like.
#pragma once

#include "precompute/io/environment_file.h"
#include "tools/command_line.h"

namespace prt::tools {

/// Adds --env-layout and --env-mirrored.
void addEnvironmentOptions(CommandLine& line, EnvironmentOptions& options);

}  // namespace prt::tools
