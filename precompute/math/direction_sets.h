// Sets of directions by name, for measurements that compare them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "precompute/math/vec.h"

namespace prt {

enum class DirectionSetKind {
    Random,      ///< independent, uniform
    Stratified,  ///< one uniform in each of N regions of equal area (equalAreaRegions)
    SobolOwen,   ///< sobolOwenPoints on the cylinder around +Y
    Fibonacci,   ///< sphericalFibonacci
};
/// Names as on the command line, in the order of DirectionSetKind: "random", "stratified", "sobol-owen",
/// "fibonacci".
const std::vector<std::string>& directionSetNames();

/// Directions over the sphere, each of weight 4π/N; the first ones of a larger Sobol-Owen or random set are
/// the smaller set of the same seed, the others share no direction.
/// @param count  N >= 1, exactly as many are returned
/// @param seed   of the random ones; Fibonacci directions are the same for every seed
/// @return [N] unit
std::vector<Vec3f> makeDirectionSet(DirectionSetKind kind, int count, uint64_t seed);

/// Sobol's first two dimensions, each scrambled by its own nested uniform scramble: whether a binary digit is
/// flipped is a hash of the digits before it. Any 2^m points of the sequence that start at a multiple of 2^m
/// lie one in each of the 2^m boxes of 2^-a × 2^(a − m), for every a.
/// @param count  >= 0
/// @return points in (0, 1)²
/// @source [Sobol1967], [Owen1995, Sec. 3], [Burley2020, Sec. 3]
std::vector<std::array<double, 2>> sobolOwenPoints(int count, uint64_t seed);

/// Rows of regions of equal area over the sphere: a cap on each pole and collars between them, cut into equal
/// sectors, all of about the same diameter.
struct RegionRow {
    double low, high;  ///< sines of latitude, −1..1: rows come from the top down, high > low
    int count;         ///< sectors; all rows sum to N, and (high − low) / 2 = count / N
};
/// @param count  N >= 1
/// @source [Leopardi2006, Sec. 3]
std::vector<RegionRow> equalAreaRegions(int count);

}  // namespace prt
