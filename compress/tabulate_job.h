// prt tabulate: tables over the normal for a bundle.
#pragma once

#include <string>
#include <vector>

#include "precompute/io/environment_file.h"

namespace prt {

struct TabulateSettings {
    std::string bundlePath;
    std::vector<std::string> environments;  ///< files or sky:NAME
    std::string kind = "triple-product";    ///< or "light-cosine"
    std::string layout = "cube";
    int size = 32;
    EnvironmentOptions environmentOptions = {};
    bool force = false;  ///< also tables that the bundle has just so already
};
struct TabulateRow {
    std::string environment, file;
    std::string environmentHash;  ///< of its pixels
    size_t bytes = 0;
    double seconds = 0;
    bool upToDate = false;  ///< the bundle had just that already
};
/// Writes a table for each environment; leaves those that are current and were made with the same settings.
std::vector<TabulateRow> runTabulate(const TabulateSettings& settings);

/// File name of a table within its bundle: tables/ENV.KIND.LAYOUT.exr (characters outside [A-Za-z0-9_-]
/// become '_').
std::string tableFileName(const std::string& environmentName, const std::string& kind,
                          const std::string& layout);

}  // namespace prt
