// Files of screenshots.
#pragma once

#include <filesystem>

namespace prt::tools {

/// The first of prt-view-0001.png, prt-view-0002.png … that is not there yet.
/// @throws OutputError  the folder is missing, or all 9999 are taken
std::filesystem::path nextScreenshot(const std::filesystem::path& folder);

}  // namespace prt::tools
