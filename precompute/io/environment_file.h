// Environments from files and from formulas.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "precompute/io/image.h"

namespace prt {

/// Distant light as a latitude-longitude image (orientation: math/environment.h).
struct Environment {
    std::string name;             ///< file name without extension, or the sky's name
    std::string source;           ///< the argument it was loaded from
    FloatImage image;             ///< 3 channels, linear radiance, all finite and >= 0
    std::string contentHash;      ///< xxh3-128 of the pixels, hexadecimal
    size_t clampedNegative = 0;   ///< negative values set to 0
    size_t clampedNotFinite = 0;  ///< NaN or infinite values set to 0
    LatLongView view() const { return {image.width, image.height, image.pixels}; }
};

/// Loads `.exr` or `.hdr` (latitude-longitude, or an EXR cube in ImfEnvmap layout, resampled), or makes a
/// sky: `sky:clear`, `sky:overcast`, `sky:sunset`, `sky:uniform` (radiance 1). Says once per file how many
/// values were clamped.
/// @throws InputError  missing, damaged, without R, G and B channels, not 2:1 and no envmap attribute, too
/// large
Environment loadEnvironment(const std::string& pathOrSky);

/// Names that loadEnvironment knows behind "sky:".
const std::vector<std::string>& proceduralSkyNames();

/// Share of the irradiance (averaged over all normals: of the flux) that comes from the brightest texels that
/// together cover at most `solidAngleFraction` of the sphere. An environment has a sun when it exceeds 0.2 at
/// 0.005.
double brightestFluxShare(const LatLongView& image, double solidAngleFraction);
bool hasSun(const LatLongView& image);

/// Writes RGB (3 channels, half) or RGBA float pixels as a scanline EXR with ZIP compression.
/// @throws OutputError
void writeExrImage(const std::string& path, const FloatImage& image);

}  // namespace prt
