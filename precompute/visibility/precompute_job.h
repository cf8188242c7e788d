// Stage 1 as a whole: mesh file in, bundle out.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "precompute/io/visibility_file.h"
#include "precompute/mesh/atlas.h"
#include "precompute/mesh/load_mesh.h"
#include "precompute/visibility/bake.h"

namespace prt {

struct PrecomputeSettings {
    std::string meshPath, bundlePath;
    bool perVertex = false;
    int texels = 512;  ///< edge of the atlas
    int shOrder = 6;
    /// Adaptive: points stop at this estimated error of their irradiance (BakeOptions::error), in (0, 1]
    double error = 0.01;
    int rays = 0;           ///< > 0: this many directions for every point instead
    Projection projection;  ///< weighted for irradiance, or plain
    LoadMeshOptions load;
};

struct PrecomputeReport {
    size_t triangles = 0, vertices = 0;
    uint64_t points = 0;  ///< baked
    uint64_t rays = 0;
    double seconds = 0, traceSeconds = 0, raysPerSecond = 0;
    double meanAo = 0;  ///< over valid points
    /// Estimated RMS sampling error of irradiance under natural light, over valid points: as a share of what
    /// an open point receives, and of the RMS that the points receive
    double errorRms = 0, relativeError = 0;
    BakeStages stages;
    bool atlasMade = false;
    AtlasReport atlas;
    std::map<std::string, size_t> repairs;
    std::array<size_t, kValidityCount> validity{};
    size_t peakResidentBytes = 0;
    std::string instructionSet;
};

/// Loads, unwraps, rasterises, bakes, fills gutters and writes mesh.glb, visibility.exr and the manifest.
/// @throws InputError, OutputError, Interrupted
PrecomputeReport runPrecompute(const PrecomputeSettings& settings);

}  // namespace prt
