// What the layouts of sphere_map.h share, and what makes each of them. Internal to this folder.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "precompute/math/sphere_map.h"

namespace prt {

std::unique_ptr<SphereMap> makeCubeMap(const std::string& name, int size, bool seamless);
std::unique_ptr<SphereMap> makeDualParaboloidMap(const std::string& name, int size);
std::unique_ptr<SphereMap> makeDualOrthographicMap(const std::string& name, int size);
std::unique_ptr<SphereMap> makeOctahedralMap(const std::string& name, int size);
std::unique_ptr<SphereMap> makeEqualAreaOctahedralMap(const std::string& name, int size);
std::unique_ptr<SphereMap> makeLatLongMap(const std::string& name, int size);
std::unique_ptr<SphereMap> makeHealpixMap(const std::string& name, int size);

/// From [−1, 1] to [0, size].
inline double toTexels(double s, int size) { return std::clamp(0.5 * (s + 1) * size, 0.0, double(size)); }
/// From [0, size] to [−1, 1].
inline double fromTexels(double x, int size) { return 2 * x / size - 1; }

/// Bilinear lookup at a point of a face (texel centres at half-integers).
/// @param texelAt  (x, y) → number of a texel, at most one texel outside the face; −1 for one that does not
///                 exist, which is then the mean of the other three
template <typename TexelAt>
SphereTaps bilinearTaps(double x, double y, const TexelAt& texelAt) {
    const int x0 = int(std::floor(x - 0.5)), y0 = int(std::floor(y - 0.5));
    const double fx = x - 0.5 - x0, fy = y - 0.5 - y0;
    const double weights[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
    SphereTaps taps;
    int missing = -1;
    for (int i = 0; i < 4; ++i) {
        SphereTap& tap = taps[size_t(i)];
        tap = {texelAt(x0 + i % 2, y0 + i / 2), float(weights[i])};
        if (tap.texel < 0) missing = i;
    }
    if (missing >= 0) {
        for (int i = 0; i < 4; ++i)
            taps[size_t(i)].weight = i == missing ? 0.0f : float(weights[i] + weights[missing] / 3);
        taps[size_t(missing)].texel = taps[size_t(missing ^ 1)].texel;
    }
    return taps;
}

}  // namespace prt
