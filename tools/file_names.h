// Names of the pictures that prt relight writes.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace prt::tools {

/// Puts values in place of words such as {env}, {technique} and {frame}; each as often as it occurs.
std::string fileNamed(std::string pattern,
                      const std::vector<std::pair<std::string, std::string>>& valueOfWord);

}  // namespace prt::tools
