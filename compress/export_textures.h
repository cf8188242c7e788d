// Weights, coefficients and tables as textures. Arrays in, textures out. Internal to prt export.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "compress/quantize.h"
#include "precompute/io/table_file.h"
#include "precompute/io/texture_image.h"
#include "precompute/io/visibility_file.h"

namespace prt {

/// Values of every point of a grid: a 2D array, layer i holds values 4i … 4i + 3 of a point (0 behind the
/// last and where the grid has no point).
struct PointTexture {
    TextureImage image;
    /// [4·layers] of UNORM formats, behind the last value {0, 0}; else empty: texels are the values.
    std::vector<UnormRange> ranges;
    std::vector<float> decoded;  ///< [count×perPoint] what a reader gets
};

/// @param values    [grid.count×perPoint]
/// @param perPoint  at least 1
/// @param encoding  "float", "half" (clamped to ±kMaxHalf), "unorm16" or "unorm8" (ranges by fitUnormRanges)
/// @param used      [grid.count] as for fitUnormRanges
/// @throws InputError  a value in use that is not finite
PointTexture encodePoints(std::span<const float> values, size_t perPoint, const PointGrid& grid,
                          const std::string& encoding, std::span<const uint8_t> used);

/// A table over normals as a cube array.
struct TableTexture {
    TextureImage image;
    /// "four-per-texel": layer colour·L + i holds functions 4i … 4i + 3 of a colour, L = ⌈functions / 4⌉,
    /// then for triple products one RGB layer for the mean; "rgb-per-layer": layer m holds function m in RGB,
    /// the mean is the last.
    std::string packing;
    /// [cube layers] {r, g, b, s}: value = (r, g, b) + s · texel (where there is a fourth channel, s ·
    /// texel); empty: texels are the values.
    std::vector<std::array<float, 4>> ranges;
    std::vector<float> decoded;  ///< as NormalTable::values
};

/// @param encoding  "float"; "half" (scaled by a power of two where it would overflow); "rgb9e5" or "r11f",
///                  scaled to [0, 1] per function with a bias per colour, because they hold no sign
TableTexture encodeTable(const NormalTable& table, const std::string& encoding);

}  // namespace prt
