// Environments from files and from formulas.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "precompute/io/image.h"

namespace prt {

/// Distant light as a latitude-longitude image (orientation: math/environment.h).
struct Environment {
    std::string name;    ///< file name without extension, or the sky's with its parameters, fit for a file
    std::string source;  ///< the argument it was loaded from
    FloatImage image;    ///< 3 channels, linear radiance, all finite and >= 0
    std::string contentHash;      ///< xxh3-128 of the pixels, hexadecimal
    size_t clampedNegative = 0;   ///< negative values set to 0
    size_t clampedNotFinite = 0;  ///< NaN or infinite values set to 0
    LatLongView view() const { return {image.width, image.height, image.pixels}; }
};

/// How a file is to be read.
struct EnvironmentOptions {
    /// One of environmentLayoutNames() (math/environment_layout.h, which describes them), or "auto": what the
    /// EXR's envmap attribute says, else by its shape: 2:1 is latitude-longitude, 1:6 and 6:1 strips of
    /// OpenGL faces, 4:3 and 3:4 crosses, square an angular map. A dual paraboloid has the shape of a
    /// latitude-longitude image and must be named.
    std::string layout = "auto";
    /// The picture shows the other side of the sphere than its layout says: +X and −X are swapped.
    bool mirrored = false;
};

/// Loads `.exr` or `.hdr` (in any layout, resampled to latitude-longitude unless it is), or makes a sky (see
/// io/procedural_sky.h; the options do not matter then). Says once per file how many values were clamped,
/// which happens before they are mixed.
/// @throws InputError  missing, damaged, without R, G and B channels, of another shape than its layout, more
///                     than 16384 texels in a direction (12288 or 24576 along faces)
/// @throws UsageError  unknown layout, wrong parameters of a sky
Environment loadEnvironment(const std::string& pathOrSky, const EnvironmentOptions& options = {});

/// An environment's name as part of a file's: characters outside [A-Za-z0-9_-] become '_'.
std::string environmentFileStem(const std::string& environmentName);

/// Environments that measurements and targets of error take where none is named: "sky:clear",
/// "sky:overcast", "sky:sunset", "sky:uniform".
const std::vector<std::string>& builtInEnvironments();

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
