// What techniques read, as pictures: coefficients of visibility and weights, Fig. 3.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "runtime/renderer.h"
#include "tools/measure/compression_sheet.h"
#include "tools/relight_techniques.h"

namespace prt::tools {

/// Pictures of `perPoint` numbers of every point, blue where negative, white at 0, red where positive: per
/// texel the atlas, at most `edgePx` wide; per vertex the mesh as the camera sees it, edgePx wide. Each has
/// its own scale (signedColours), which the note says; texels without surface are black.
/// @param values    [grid.count×perPoint]
/// @param validity  [grid.count] or empty: all have a surface
/// @param labels    [perPoint]
std::vector<SheetCell> fieldPictures(Renderer& renderer, const Camera& camera, const PointGrid& grid,
                                     std::span<const float> values, std::span<const Validity> validity,
                                     const std::vector<std::string>& labels, int edgePx);

/// Writes figure3-visibility.png, a row for each band, and figure3-weights.png, as far as the data is there.
/// @param folder  is there; files in it are replaced
/// @return what was written
/// @throws OutputError
/// @source [IwanickiSloan2012, Fig. 3]
std::vector<std::filesystem::path> drawFieldSheets(GlContext& context, const RelightData& data,
                                                   const Camera& camera, const std::filesystem::path& folder);

}  // namespace prt::tools
