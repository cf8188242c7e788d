// Labelled pictures side by side.
#pragma once

#include <string>
#include <vector>

#include "precompute/io/image.h"

namespace prt::tools {

struct SheetCell {
    std::string label;      ///< ASCII, one line
    ByteImage image;        ///< 3 channels; no pixels: the cell stays empty
    std::string note = {};  ///< one line below the picture
};

/// Rows of cells, each label above its picture and each note below, a title on top. Text that is wider than
/// its place is cut.
/// @param rows  at least one picture; cells are as large as the largest
/// @return 3 channels
ByteImage composeSheet(const std::string& title, const std::vector<std::vector<SheetCell>>& rows);

/// Rows of a sheet: `stacked[i][k]` above `stacked[i + 1][k]`, broken after so many columns.
/// @param stacked  lists of one length
std::vector<std::vector<SheetCell>> inColumns(const std::vector<std::vector<SheetCell>>& stacked,
                                              size_t columns);

}  // namespace prt::tools
