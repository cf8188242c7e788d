// The subcommands of prt. Each takes the arguments from its own name on, and throws what
// precompute/base/error.h lists.
#pragma once

namespace prt::tools {

void runPrecomputeCommand(int argc, char** argv);
void runCompressCommand(int argc, char** argv);
void runTabulateCommand(int argc, char** argv);
void runLightmapCommand(int argc, char** argv);
void runExportCommand(int argc, char** argv);
void runRelightCommand(int argc, char** argv);
void runViewCommand(int argc, char** argv);
void runInfoCommand(int argc, char** argv);
void runMeasureCommand(int argc, char** argv);

}  // namespace prt::tools
