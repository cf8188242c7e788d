// Pictures that prt relight writes.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "precompute/io/image.h"
#include "tools/relight_arguments.h"

namespace prt::tools {

/// Puts values in place of words such as {env}, {technique} and {frame}; each as often as it occurs.
std::string fileNamed(std::string pattern,
                      const std::vector<std::pair<std::string, std::string>>& valueOfWord);

/// .exr: linear; else sRGB as the arguments' tone curve shows it, with this exposure. Does nothing where the
/// name is empty.
/// @throws OutputError
void writeImage(const std::string& file, const FloatImage& image, double exposureStops,
                const RelightArguments& arguments);

}  // namespace prt::tools
