// Small bundles whose errors are measured.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "compress/compress_job.h"
#include "precompute/visibility/precompute_job.h"
#include "tests/base/temporary_directory.h"
#include "tools/measure/error.h"

namespace prt::tools {

/// A square floor (y up) of 2 × 2.
inline std::string floorObj() { return "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4\n"; }
/// The same with a wall on two of its sides, facing inwards.
inline std::string cornerObj() {
    return floorObj() + "v -1 1.5 1\nv -1 1.5 -1\nv 1 1.5 -1\nf 4 6 5 1\nf 3 7 6 4\n";
}

/// What a bundle is made with.
struct BundleKind {
    std::string obj = cornerObj();
    int shOrder = 4;
    int rays = 512;
    ProjectionKind projection = ProjectionKind::Irradiance;
    int components = 0;  ///< 0: not compressed
    bool perVertex = false;
    std::string weights = "irradiance";
};

inline std::string makeBundle(const TemporaryDirectory& folder, const BundleKind& kind) {
    const std::string mesh = folder.file("mesh.obj"), bundle = folder.file("mesh.prt");
    rewriteFile(mesh, kind.obj);
    PrecomputeSettings settings;
    settings.meshPath = mesh;
    settings.bundlePath = bundle;
    settings.texels = 32;
    settings.perVertex = kind.perVertex;
    settings.shOrder = kind.shOrder;
    settings.rays = kind.rays;
    settings.projection.kind = kind.projection;
    runPrecompute(settings);
    if (kind.components > 0) {
        CompressSettings compress;
        compress.bundlePath = bundle;
        compress.components = kind.components;
        compress.weights = kind.weights;
        runCompress(compress);
    }
    return bundle;
}

/// Errors of such a bundle.
inline ErrorResult errorsOf(const BundleKind& kind, const std::vector<std::string>& skies,
                            const ErrorStudy& study) {
    const TemporaryDirectory folder;
    const JudgedBundle bundle = readJudgedBundle(makeBundle(folder, kind));
    const RayCaster caster(bundle.scene.positions, bundle.scene.indices);
    std::vector<Environment> environments;
    for (const std::string& sky : skies) environments.push_back(loadEnvironment(sky));
    return studyError(bundle, caster, judgedPoints(bundle, caster, study.points), environments, study);
}

/// Few points and directions, everything stored as floats.
inline ErrorStudy smallErrorStudy() {
    ErrorStudy study;
    study.points = 24;
    study.rays = 4096;
    study.weights = "float";
    study.tables = "float";
    return study;
}

}  // namespace prt::tools
