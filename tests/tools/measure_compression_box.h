// A small bundle: an open box, whose walls shade its floor.
#pragma once

#include <fstream>
#include <string>

#include "compress/compress_job.h"
#include "precompute/visibility/precompute_job.h"
#include "tests/base/temporary_directory.h"

namespace prt::tools::test {

/// Bakes the box into the folder: 4 bands, 48 texels along the edge of the atlas.
/// @return path of the bundle
inline std::string boxBundle(const TemporaryDirectory& folder, bool perVertex, ProjectionKind projection) {
    const std::string mesh = folder.file("box.obj");
    std::ofstream(mesh) << "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 1 -1\nv 1 1 -1\nv 1 1 1\nv -1 1 1\n"
                           "f 1 4 3 2\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    PrecomputeSettings settings;
    settings.meshPath = mesh;
    settings.bundlePath = folder.file("box.prt");
    settings.perVertex = perVertex;
    settings.texels = 48;
    settings.shOrder = 4;
    settings.rays = 512;
    settings.projection.kind = projection;
    runPrecompute(settings);
    return settings.bundlePath;
}

/// The same, compressed to 8 vectors.
inline std::string compressedBoxBundle(const TemporaryDirectory& folder, bool perVertex) {
    CompressSettings settings;
    settings.bundlePath = boxBundle(folder, perVertex, ProjectionKind::Irradiance);
    settings.components = 8;
    runCompress(settings);
    return settings.bundlePath;
}

}  // namespace prt::tools::test
