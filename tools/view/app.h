// The interactive viewer: window, panel, scene and script together. In builds with PRT_WITH_VIEWER.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/relight_arguments.h"
#include "tools/report.h"
#include "tools/view/script.h"
#include "tools/view/state.h"

namespace prt::tools {

struct ViewOptions {
    RelightArguments relight;    ///< finished; of all techniques
    std::string technique;       ///< shown first; empty: pca where there is, else the first
    bool firstAlone = false;     ///< only the first environment shines at first
    bool measureFrames = false;  ///< draws all the time and counts frames a second
    std::vector<ScriptStep> script;
    std::string scriptName;
    std::filesystem::path screenshots = ".";  ///< folder of numbered screenshots
};

/// Opens a window and stays until it is closed.
/// @return what happened: frames, switches of light, screenshots
/// @throws InputError   no display; the bundle or an environment cannot be used; a step of the script cannot
///                      be done
/// @throws OutputError  a screenshot of the script cannot be written
/// @throws Interrupted  Ctrl-C
Report runViewer(const ViewOptions& options);

}  // namespace prt::tools
