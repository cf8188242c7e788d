// Every technique beside ray-traced truth: the sheets of Figs. 4 to 7.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/renderer.h"
#include "tools/comparison.h"
#include "tools/relight_arguments.h"
#include "tools/relight_techniques.h"

namespace prt::tools {

/// Error of one technique under one environment.
struct TechniqueError {
    std::string environment;
    Technique technique;
    bool normalMap = true;
    IrradianceError error;      ///< against ray tracing
    double floorRmse = 0;       ///< what the bundle's projection and order lose by themselves
    double differenceRmse = 0;  ///< relative, to unc of all bands; NaN where it was not drawn
};

struct TechniqueFigures {
    std::vector<TechniqueError> errors;        ///< by environment, normal map first, then as listed
    std::vector<std::filesystem::path> files;  ///< what was written
};

/// Writes, for every environment ENV by itself, as sRGB PNGs of one exposure:
///   figure4-ENV.png      every technique and ray tracing, the error below each
///   difference-ENV.png   the same, and four times the difference to ray tracing
///   figure5-ENV.png      numbers of vectors, and four times the difference to uncompressed visibility
///   figure6-ENV.png      numbers of bands, and four times the difference to the highest
///   figure7-ENV.png      every technique and ray tracing, without and with normal maps
/// Figs. 5 and 6 are left out where there is nothing to compare.
/// @param arguments  finished; camera, size, reference rays and rotation are taken from it
/// @param data       of those arguments
/// @param folder     is there; files in it are replaced
/// @throws InputError; OutputError; Interrupted
/// @source [IwanickiSloan2012, Figs. 4 to 7]
TechniqueFigures drawTechniqueFigures(GlContext& context, const RelightArguments& arguments,
                                      const RelightData& data, const std::filesystem::path& folder);

}  // namespace prt::tools
