// prt tabulate: tables over the normal for a bundle.
#pragma once

#include <string>
#include <vector>

#include "compress/tables/table_options.h"
#include "precompute/io/environment_file.h"

namespace prt {

struct TabulateSettings {
    std::string bundlePath;
    std::vector<std::string> environments;  ///< files or sky:NAME
    std::string kind = "triple-product";    ///< or "light-cosine"
    TableOptions table;
    EnvironmentOptions environmentOptions = {};
    bool force = false;  ///< also tables that the bundle has just so already
};
struct TabulateRow {
    std::string environment, file;
    std::string environmentHash;  ///< of its pixels
    size_t bytes = 0;
    double seconds = 0;
    bool upToDate = false;  ///< the bundle had just that already
    /// Where the sun was to be extracted; its shadows are made by bakeSunShadow (visibility/sun_shadow.h)
    ExtractedSun sun;
    double windowWidth = 0;  ///< bands; infinity: the light needed none, 0: none was asked for
    /// Of the variant "paper": √(Σ (paper − exact)² / Σ exact²) over the table; 0 for the exact one
    double relativeDifferenceFromExact = 0;
};
/// Writes a table for each environment; leaves those that are current and were made with the same settings.
std::vector<TabulateRow> runTabulate(const TabulateSettings& settings);

/// The command that makes one environment's table again.
/// @param source  the environment as it was named
std::string tabulateCommand(const TabulateSettings& settings, const std::string& source);

/// File name of a table within its bundle: tables/ENV.KIND.LAYOUT.exr (characters outside [A-Za-z0-9_-]
/// become '_').
std::string tableFileName(const std::string& environmentName, const std::string& kind,
                          const std::string& layout);

}  // namespace prt
