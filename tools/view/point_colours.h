// What is stored at the points of a bundle, as colours to look at.
#pragma once

#include <string>
#include <vector>

#include "precompute/io/scene.h"
#include "precompute/io/visibility_file.h"
#include "tools/view/state.h"

namespace prt::tools {

struct LegendEntry {
    Vec3f colour;  ///< linear
    std::string text;
};

struct PointColours {
    PointGrid grid;
    std::vector<float> rgb;  ///< [grid.count×3] linear, in [0, 1]
    bool smooth = true;      ///< may be interpolated between points
    std::string title;
    std::vector<LegendEntry> legend;  ///< of a continuous scale: its ends and its middle, in order
    bool continuous = true;
};

/// Colours of one number per point: blue where it is negative, white at 0, red where it is positive.
/// @param values    [points], `stride` apart
/// @param validity  [points] or empty: points without surface do not count for the scale and are black
/// @return the ends of the scale are ± the magnitude that 99 % of the points stay within
PointColours signedColours(const PointGrid& grid, std::span<const float> values, size_t stride,
                           std::span<const Validity> validity, std::string title);

/// Colours of what is to be shown.
/// @param shown       of those that show points (showsPoints)
/// @param index       of the vector or coefficient
/// @param visibility  null where there is none; needed by all but Weight
/// @param pca         null where there is none; needed by Weight
/// @throws InputError  what is needed is not there
PointColours pointColours(Shown shown, int index, const Scene& scene, const VisibilityMap* visibility,
                          const PcaMap* pca);

/// Colour of a reason, linear.
Vec3f validityColour(Validity validity);

}  // namespace prt::tools
