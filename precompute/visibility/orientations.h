// Orientations of the sets of directions: neighbours on a surface take different ones.
//
// All points share directions, so that errors of neighbours are alike, and steps run over smooth surfaces
// like bands. Neighbours of different orientations err differently: what is left is grain, which a bilinear
// lookup averages.
#pragma once

#include <array>
#include <cstdint>

#include "precompute/math/vec.h"

namespace prt {

inline constexpr int kOrientations = 4;

/// Rotations of a set of directions; the first is the identity.
const std::array<Mat3d, kOrientations>& setOrientations();

/// The orientation of an atlas texel: every 2×2 texels have all four.
constexpr uint8_t texelOrientation(uint32_t x, uint32_t y) { return uint8_t((x & 1) + 2 * (y & 1)); }
/// The orientation of a vertex, by its index.
uint8_t vertexOrientation(uint32_t vertex);

}  // namespace prt
