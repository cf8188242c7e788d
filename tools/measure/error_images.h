// Heat maps of errors over the atlas.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "precompute/io/image.h"
#include "tools/measure/error.h"

namespace prt::tools {

/// Colour of a value in [0, 1] (clamped) on a ramp of even lightness steps, sRGB: dark violet, blue, green,
/// yellow.
/// @source [SmithWalt2015], "viridis", between nine of its colours
std::array<uint8_t, 3> rampColour(double value);

/// One picture. Colours are logarithmic: log(value / low) / log(high / low) on the ramp.
struct ErrorImage {
    std::string file;          ///< PNG, full path
    std::string raw;           ///< EXR of the environment, full path; its channel is the stage
    std::string environment;   ///< name
    std::string stage;         ///< "total", or errorStageName
    double low = 0, high = 0;  ///< values of the two ends of the ramp, shares of the RMS of irradiance
};

/// Decades that the ramp covers.
inline constexpr double kErrorImageDecades = 2;

/// Writes DIR/ENV.STAGE.png of each environment and stage (not of stages without any error), and
/// DIR/ENV.error.exr: float channels of the same names, and `measured` (uint): 1 where a texel was judged.
/// Texels of charts that were not judged show the nearest judged one of their chart; those with none near are
/// grey, 0 in the EXR. All pictures of an environment share one range, up to the 99th percentile of the
/// total.
/// @param result  with maps   @param grid  of the bundle, per texel
/// @throws OutputError
std::vector<ErrorImage> writeErrorImages(const std::filesystem::path& directory, const ErrorResult& result,
                                         const JudgedPoints& points, const PointGrid& grid);

}  // namespace prt::tools
