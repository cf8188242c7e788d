// Stage 1 as a whole: mesh file in, bundle out.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "precompute/io/visibility_file.h"
#include "precompute/mesh/atlas.h"
#include "precompute/mesh/load_mesh.h"

namespace prt {

struct PrecomputeSettings {
    std::string meshPath, bundlePath;
    bool perVertex = false;
    int texels = 512;  ///< edge of the atlas
    int shOrder = 6;
    int rays = 1024;
    Projection projection;  ///< weighted for irradiance, or plain
    LoadMeshOptions load;
};

struct PrecomputeReport {
    size_t triangles = 0, vertices = 0;
    uint64_t points = 0;  ///< baked
    uint64_t rays = 0;
    double seconds = 0, traceSeconds = 0, raysPerSecond = 0;
    double meanAo = 0;  ///< over valid points
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
