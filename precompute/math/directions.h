// Sets of directions over the sphere.
#pragma once

#include <cstdint>
#include <vector>

#include "precompute/math/vec.h"

namespace prt {

/// N directions of nearly equal area by the golden-angle spiral; polar axis +Y; the same for every call.
/// @param count  >= 1
/// @source [Keinert2015, Eq. 1]
std::vector<Vec3f> sphericalFibonacci(int count);

/// N independent uniform directions (what PRT codes traditionally trace; kept for comparison).
std::vector<Vec3f> randomDirections(int count, uint64_t seed);

/// Two unit vectors that make a right-handed frame (tangent, bitangent, normal). Continuous except at
/// normal.z = −1, and orthonormal to float precision everywhere.
/// @source [Frisvad2012], made exact near that point
struct Frame {
    Vec3f tangent, bitangent, normal;
};
Frame frameAround(const Vec3f& normal);

}  // namespace prt
