// prt relight's moving pictures: the camera or the light changes from frame to frame.
#pragma once

#include <string>
#include <vector>

#include "tools/relight_arguments.h"
#include "tools/relight_scene.h"
#include "tools/report.h"

namespace prt::tools {

/// What one frame shows.
struct SequenceFrame {
    double cameraTurnRad = 0;  ///< of the eye around the target, about the up axis: +Z towards +X
    RelightLight light;
};

/// Frame i of N of each motion that is asked for; all motions run at the same time.
///   turntable     the camera has turned by 360° · i/N
///   rotate-light  the environments have turned by 360° · i/N, besides --rotate
///   transition    i/(N − 1) of the way from A alone to B alone, each with its own weight
/// @param names    [environments]
/// @param weights  [environments]
/// @throws UsageError  --transition names what is none of the environments, or one twice
std::vector<SequenceFrame> sequenceFrames(const RelightArguments& arguments,
                                          const std::vector<std::string>& names,
                                          const std::vector<double>& weights);

/// The camera, turned around its target.
Camera turnedCamera(const Camera& camera, double turnRad);

/// Draws and writes all frames; automatic exposure is that of the first. Frames appear as they are done,
/// videos at the end.
/// @param arguments  of which isSequence() is true
/// @throws InputError, OutputError, UsageError, Interrupted
Report runSequence(const RelightArguments& arguments);

}  // namespace prt::tools
