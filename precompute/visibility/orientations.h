// Orientations of the sets of directions: neighbours on a surface take different ones.
//
// All points share directions, so that errors of neighbours are alike, and steps run over smooth surfaces
// like bands. Neighbours of different orientations err differently: what is left is grain, which a bilinear
// lookup averages. Orientations differ by few degrees only, so that rays of neighbours still run together.
#pragma once

#include <array>
#include <cstdint>

#include "precompute/math/vec.h"

namespace prt {

inline constexpr int kOrientations = 4;

/// Rotations of a set of directions; the first is the identity.
const std::array<Mat3d, kOrientations>& setOrientations();
/// A direction of the set as it is where the orientation of an item has it. Unit; exact for the first.
Vec3f turnedIntoWorld(int orientation, const Vec3f& direction);
/// A vector of the world as the set before its rotation has it. Unit; exact for the first.
Vec3f turnedBack(int orientation, const Vec3f& vector);

/// The orientation of an atlas texel: every 2×2 texels have all four.
constexpr uint8_t texelOrientation(uint32_t x, uint32_t y) { return uint8_t((x & 1) + 2 * (y & 1)); }
/// The orientation of a vertex, by its index.
uint8_t vertexOrientation(uint32_t vertex);

}  // namespace prt
