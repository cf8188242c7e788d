// Shadows of the suns that were taken out of environments, as files of a bundle.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "precompute/io/scene.h"
#include "precompute/io/sun_shadow_file.h"
#include "precompute/math/extract_sun.h"
#include "precompute/rays/ray_caster.h"

namespace prt {

/// One environment's sun.
struct BundleSun {
    std::string environmentName, environmentHash;
    ExtractedSun sun;     ///< found
    std::string command;  ///< that renews the file
};

struct SunShadowRow {
    std::string file;
    size_t bytes = 0;
    double seconds = 0;
    bool upToDate = false;  ///< the bundle had just that already
};

/// Traces the shadow of every sun over the points of visibility.exr and writes tables/ENV.sun.exr; leaves
/// those that are current and of the same sun.
/// @param force  also those
/// @throws InputError  files of the bundle missing or stale   @throws OutputError, Interrupted
std::vector<SunShadowRow> runSunShadows(const std::string& bundlePath, const std::vector<BundleSun>& suns,
                                        bool force);

/// The shadow of a disc for a bundle's points.
/// @param scene  of mesh.glb
SunShadowMap traceSunShadow(const RayCaster& caster, const Scene& scene, const PointGrid& grid,
                            std::span<const Validity> validity, const ExtractedSun& sun);

}  // namespace prt
