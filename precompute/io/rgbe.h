// Radiance .hdr images.
#pragma once

#include <string>
#include <string_view>

#include "precompute/io/image.h"

namespace prt {

/// Decodes a Radiance RGBE image (flat, old and new run lengths; rows from the top, columns from the left).
/// @param where  names the image in errors
/// @return       3 channels
/// @throws InputError  damaged, truncated, XYZE, another orientation, wider or higher than 16384
FloatImage decodeRgbe(std::string_view bytes, const std::string& where);

}  // namespace prt
