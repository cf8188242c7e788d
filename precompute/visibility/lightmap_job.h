// prt lightmap: SH lightmaps as files of a bundle.
#pragma once

#include <string>

#include "precompute/io/environment_file.h"
#include "precompute/visibility/lightmap.h"

namespace prt {

struct LightmapSettings {
    std::string bundlePath;
    double rotationDeg = 0;  ///< of the environment about the up axis
    LightmapOptions options;
    bool force = false;   ///< also where the bundle has just that already
    std::string command;  ///< that renews the file
};

struct LightmapReport {
    std::string file;  ///< lightmaps/ENV.exr
    size_t bytes = 0;
    bool upToDate = false;  ///< the bundle had just that already
    uint64_t rays = 0;      ///< 0 where it was up to date
    double seconds = 0;
    double relativeError = 0;  ///< estimated, see LightmapBake
};

/// Bakes the lightmap of one environment for the points of visibility.exr and writes it into the bundle; one
/// of the same environment that was made otherwise (another rotation, other options) is replaced.
/// @throws InputError  files of the bundle missing or stale   @throws UsageError  an option out of range
/// @throws OutputError, Interrupted
LightmapReport runLightmap(const LightmapSettings& settings, const Environment& environment);

}  // namespace prt
