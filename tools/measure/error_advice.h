// Which knob an error report tells to turn.
#pragma once

#include <string>
#include <vector>

#include "tools/measure/error.h"

namespace prt::tools {

/// A stage that can be made better.
struct ErrorKnob {
    ErrorStage stage;
    double gain = 0;      ///< ErrorBlock::gain of the mean
    double left = 0;      ///< relative RMSE of the mean without the stage
    std::string command;  ///< turns it one notch; several are joined by &&
};

/// The same command with another value of an option, added where it has none.
/// @param command  e.g. "prt precompute a.obj -o a.prt --order 6"   @param option  e.g. "--order"
std::string withOption(const std::string& command, const std::string& option, const std::string& value);

/// Stages that can be turned further (not truncation at the largest order, not PCA with all vectors, …) and
/// gain more than the noise of the measurement, those that gain most first. More bands come with as many more
/// vectors: the same number of vectors would lose more of them.
/// @param path     of the bundle   @param sources  of the environments, as given
std::vector<ErrorKnob> knobsOf(const std::string& path, const JudgedBundle& bundle, const ErrorResult& result,
                               const ErrorStudy& study, const std::vector<std::string>& sources);

/// A line for each knob, the first knob last.
/// @param total  relative RMSE of the mean as shipped
std::string knobText(const std::vector<ErrorKnob>& knobs, double total);

}  // namespace prt::tools
