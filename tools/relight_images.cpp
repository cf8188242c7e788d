#include "tools/relight_images.h"

#include "precompute/io/environment_file.h"
#include "tools/measure/picture.h"

namespace prt::tools {

std::string fileNamed(std::string pattern,
                      const std::vector<std::pair<std::string, std::string>>& valueOfWord) {
    for (const auto& [word, value] : valueOfWord)
        for (size_t at = pattern.find(word); at != std::string::npos;
             at = pattern.find(word, at + value.size()))
            pattern.replace(at, word.size(), value);
    return pattern;
}

void writeImage(const std::string& file, const FloatImage& image, double exposureStops,
                const RelightArguments& arguments) {
    if (file.empty()) return;
    if (file.ends_with(".exr"))
        writeExrImage(file, image);
    else
        writePng(file, toDisplay(image, exposureStops, arguments.toneCurve));
}

}  // namespace prt::tools
