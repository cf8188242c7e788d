// Sources: none.
#include "tools/view/screenshots.h"

#include <fmt/format.h>

#include "precompute/base/error.h"

namespace prt::tools {

std::filesystem::path nextScreenshot(const std::filesystem::path& folder) {
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error))
        throw OutputError(folder.string(), "is no folder", "make it first");
    constexpr int kMost = 9999;
    for (int number = 1; number <= kMost; ++number) {
        std::filesystem::path path = folder / fmt::format("prt-view-{:04}.png", number);
        if (std::filesystem::symlink_status(path, error).type() == std::filesystem::file_type::not_found)
            return path;
    }
    throw OutputError(folder.string(), fmt::format("already holds {} screenshots", kMost), "move some away");
}

}  // namespace prt::tools
