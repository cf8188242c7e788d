// Which knob an error report tells to turn.
#pragma once

#include <string>
#include <vector>

#include "tools/measure/error.h"

namespace prt::tools {

struct ErrorAdvice {
    std::string stage;    ///< errorStageName, or "none": nothing that can be turned gains more than the noise
    double gain = 0;      ///< of relative RMSE, in the mean, if the stage were exact
    std::string command;  ///< turns the knob; empty for "none"
    std::string text;     ///< one line for the terminal
};

/// The same command with another value of an option, added where it has none.
/// @param command  e.g. "prt precompute a.obj -o a.prt --order 6"   @param option  e.g. "--order"
std::string withOption(const std::string& command, const std::string& option, const std::string& value);

/// Looks at the stages that can be turned further (not truncation at the largest order, not PCA with all
/// vectors, …) and takes the one with the largest ErrorBlock::gain of the mean.
/// @param path     of the bundle   @param sources  of the environments, as given
ErrorAdvice adviseOnErrors(const std::string& path, const JudgedBundle& bundle, const ErrorResult& result,
                           const ErrorStudy& study, const std::vector<std::string>& sources);

}  // namespace prt::tools
