// Sets of directions. Sobol's sequence: [Sobol1967]; its second dimension by the matrix of binomial
// coefficients modulo 2 as in [KolligKeller2002]. Nested uniform scrambling: [Owen1995], by a hash of the
// leading digits as in [Burley2020] (digit by digit, not by the permutation of [LaineKarras2011] that makes
// it fast and less random). Regions of equal area: [Leopardi2006]. Hash: [Steele2014].
#include "precompute/math/direction_sets.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/directions.h"
#include "precompute/math/split_mix.h"

namespace prt {
namespace {

// The cylinder around +Y onto the sphere, areas kept.
Vec3f onSphere(double height, double turns) {
    const double azimuth = 2 * std::numbers::pi * turns;
    const double radius = std::sqrt((1 - height) * (1 + height));
    return Vec3d(radius * std::sin(azimuth), height, radius * std::cos(azimuth)).cast<float>();
}

uint32_t reverseBits(uint32_t x) {
    uint32_t reversed = 0;
    for (int bit = 0; bit < 32; ++bit, x >>= 1) reversed = reversed << 1 | (x & 1);
    return reversed;
}

uint32_t sobolSecond(uint32_t index) {
    uint32_t value = 0;
    for (uint32_t column = 0x80000000u; index != 0; index >>= 1, column ^= column >> 1)
        if (index & 1) value ^= column;
    return value;
}

uint32_t nestedScramble(uint32_t x, uint64_t key) {
    uint32_t flips = 0;
    for (int bit = 31; bit >= 0; --bit) {
        // The digits before this one, behind a leading one that tells how many they are.
        const uint64_t node = (uint64_t(1) << 32 | x) >> (bit + 1);
        flips = flips << 1 | uint32_t(SplitMix64{key ^ node}.next() >> 63);
    }
    return x ^ flips;
}

double toUnit(uint32_t x) { return (double(x) + 0.5) * 0x1p-32; }

std::vector<Vec3f> stratified(int count, uint64_t seed) {
    SplitMix64 random{seed};
    std::vector<Vec3f> directions;
    for (const RegionRow& row : equalAreaRegions(count))
        for (int k = 0; k < row.count; ++k) {
            const double height = row.low + (row.high - row.low) * random.uniform();
            directions.push_back(onSphere(height, (k + random.uniform()) / row.count));
        }
    return directions;
}

}  // namespace

const std::vector<std::string>& directionSetNames() {
    static const std::vector<std::string> names = {"random", "stratified", "sobol-owen", "fibonacci"};
    return names;
}

std::vector<std::array<double, 2>> sobolOwenPoints(int count, uint64_t seed) {
    PRT_CHECK_LE(0, count);
    SplitMix64 keys{seed};
    const uint64_t firstKey = keys.next(), secondKey = keys.next();
    std::vector<std::array<double, 2>> points;
    for (uint32_t k = 0; k < uint32_t(count); ++k)
        points.push_back({toUnit(nestedScramble(reverseBits(k), firstKey)),
                          toUnit(nestedScramble(sobolSecond(k), secondKey))});
    return points;
}

std::vector<RegionRow> equalAreaRegions(int count) {
    PRT_CHECK_LE(1, count);
    if (count == 1) return {{-1, 1, 1}};
    // Heights of the ideal collars: as high as a region of a square's shape is wide.
    const double cap = std::acos(1 - 2.0 / count), side = std::sqrt(4 * std::numbers::pi / count);
    const int collars = count == 2 ? 0 : std::max(1, int(std::lround((std::numbers::pi - 2 * cap) / side)));
    std::vector<int> counts = {1};
    double ideal = 1;  // regions above the lower end of the ideal collar
    int placed = 1;
    for (int c = 1; c <= collars; ++c) {
        const double end = cap + (std::numbers::pi - 2 * cap) * c / collars;
        ideal = count * (1 - std::cos(end)) / 2;
        const int regions = c == collars ? count - 1 - placed : int(std::lround(ideal)) - placed;
        counts.push_back(regions);
        placed += regions;
    }
    counts.push_back(1);
    std::vector<RegionRow> rows;
    int above = 0;
    for (const int regions : counts) {
        rows.push_back({1 - 2.0 * (above + regions) / count, 1 - 2.0 * above / count, regions});
        above += regions;
    }
    return rows;
}

std::vector<Vec3f> makeDirectionSet(DirectionSetKind kind, int count, uint64_t seed) {
    PRT_CHECK_LE(1, count);
    switch (kind) {
        case DirectionSetKind::Random:
            return randomDirections(count, seed);
        case DirectionSetKind::Stratified:
            return stratified(count, seed);
        case DirectionSetKind::SobolOwen: {
            std::vector<Vec3f> directions;
            for (const auto& [u, v] : sobolOwenPoints(count, seed))
                directions.push_back(onSphere(1 - 2 * u, v));
            return directions;
        }
        case DirectionSetKind::Fibonacci:
            break;
    }
    return sphericalFibonacci(count);
}

}  // namespace prt
