// Bytes that prt export ships, from the number of values alone.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace prt {

/// Formats of point textures: "float", "half", "unorm16", "unorm8".
const std::vector<std::string>& pointEncodings();
/// Formats of tables: "float", "half", "rgb9e5", "r11f".
const std::vector<std::string>& tableEncodings();

/// Bytes of a point as `prt export` writes it: four values to a texel, so 4·⌈values/4⌉ of them.
/// @param values    n² coefficients, or M weights; at least 1
/// @param encoding  one of pointEncodings()
size_t shippedBytes(int values, const std::string& encoding);

/// Bytes of one texel (a normal) of one environment's tables, three colours: four functions to an RGBA texel
/// and RGBA for the mean in float and half, one RGB texel for every function and the mean in the others.
/// @param values    n², or M; at least 1   @param hasMean  triple-product tables
/// @param encoding  one of tableEncodings()
size_t shippedTableBytes(int values, bool hasMean, const std::string& encoding);

}  // namespace prt
