#include "tools/file_names.h"

namespace prt::tools {

std::string fileNamed(std::string pattern,
                      const std::vector<std::pair<std::string, std::string>>& valueOfWord) {
    for (const auto& [word, value] : valueOfWord)
        for (size_t at = pattern.find(word); at != std::string::npos;
             at = pattern.find(word, at + value.size()))
            pattern.replace(at, word.size(), value);
    return pattern;
}

}  // namespace prt::tools
