// Rotation of many spherical-harmonic expansions at once, stored as a structure of arrays: coefficient i of
// vector k lies at data[i·stride + k]. Several times faster per vector than rotateSh. Nothing here allocates
// memory.
#pragma once

#include <cstddef>
#include <span>

#include "precompute/math/vec.h"

namespace prt {

/// Rotates every vector by its own rotation, in float: (Rf)(ω) = f(Rᵀω). The error is 1e-6 of the band's
/// length for shOrder <= 10 where matrices are rotations to float rounding, and grows with the band.
/// @param rotations  [9×stride] entry (row, column) of rotation k at rotations[(3·row + column)·stride + k];
/// checked
///                   to 1e-3
/// @param shOrder    n, 1..kMaxShOrder; 1..10 are fast
/// @param count      vectors; the rest of every row is left alone
/// @param stride     >= count
/// @param in, out    at least (n² − 1)·stride + count floats; the same memory, or apart; apart from rotations
/// @source [Kautz2002], [Krivanek2006, Sec. 2.2] in our own orientation
void rotateShSoa(std::span<const float> rotations, int shOrder, size_t count, size_t stride,
                 std::span<const float> in, std::span<float> out);

/// Rotates all vectors by one rotation; faster than ShRotationMatrix::applySoa from n = 4.
/// @param targetFromSource  rotation matrix; checked to 1e-3
/// @param shOrder, count, stride, in, out  as above
void rotateShSoa(const Mat3d& targetFromSource, int shOrder, size_t count, size_t stride,
                 std::span<const float> in, std::span<float> out);

}  // namespace prt
