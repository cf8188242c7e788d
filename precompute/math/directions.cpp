// Sets of directions. Spherical Fibonacci: [Keinert2015] "Spherical Fibonacci Mapping", Eq. 1. Frames:
// [Frisvad2012] "Building an Orthonormal Basis from a 3D Unit Vector Without Normalization", with the
// cancellation near normal.z = −1 that [Duff2017] analyse avoided by 1 + z = (x² + y²) / (1 − z).
// Random numbers: [Steele2014] SplitMix64.
#include "precompute/math/directions.h"

#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/split_mix.h"

namespace prt {
std::vector<Vec3f> sphericalFibonacci(int count) {
    PRT_CHECK_LE(1, count);
    std::vector<Vec3f> directions(static_cast<size_t>(count));
    for (int k = 0; k < count; ++k) {
        const double turns = k * (std::numbers::phi - 1);
        const double azimuth = 2 * std::numbers::pi * (turns - std::floor(turns));
        const double height = 1 - (2.0 * k + 1) / count;
        const double radius = std::sqrt((1 - height) * (1 + height));
        directions[size_t(k)] =
            Vec3d(radius * std::sin(azimuth), height, radius * std::cos(azimuth)).cast<float>();
    }
    return directions;
}

std::vector<Vec3f> randomDirections(int count, uint64_t seed) {
    PRT_CHECK_LE(0, count);
    SplitMix64 random{seed};
    std::vector<Vec3f> directions(static_cast<size_t>(count));
    for (Vec3f& direction : directions) {
        const double height = 1 - 2 * random.uniform();
        const double azimuth = 2 * std::numbers::pi * random.uniform();
        const double radius = std::sqrt((1 - height) * (1 + height));
        direction = Vec3d(radius * std::sin(azimuth), height, radius * std::cos(azimuth)).cast<float>();
    }
    return directions;
}

Frame frameAround(const Vec3f& normal) {
    const Vec3d n = Vec3d(normal.cast<double>()).normalized();
    const double radiusSquared = n.x() * n.x() + n.y() * n.y();
    double a;  // 1 / (1 + z)
    if (n.z() > -0.5)
        a = 1 / (1 + n.z());
    else if (radiusSquared > 0)
        a = (1 - n.z()) / radiusSquared;
    else
        return {Vec3f(1, 0, 0), Vec3f(0, -1, 0), normal};
    const Vec3d tangent(1 - n.x() * n.x() * a, -n.x() * n.y() * a, -n.x());
    const Vec3d bitangent(-n.x() * n.y() * a, 1 - n.y() * n.y() * a, -n.y());
    return {tangent.cast<float>(), bitangent.cast<float>(), normal};
}

}  // namespace prt
