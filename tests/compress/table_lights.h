// Lights that tables are tested with, and names of such tests. For the tests of tables and of their layouts.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "precompute/math/environment.h"
#include "precompute/math/sh.h"

namespace prt {

/// A layout's name as part of a test's.
inline std::string layoutTestName(const testing::TestParamInfo<std::string>& tested) {
    std::string name = tested.param;
    std::erase(name, '-');
    return name;
}

inline Vec3d randomDirection(std::mt19937& random) {
    std::normal_distribution<double> normal;
    return Vec3d(normal(random), normal(random), normal(random)).normalized();
}

// Random light of lightOrder bands, padded with zeros to the order that tables ask for; colours differ.
inline EnvironmentSh randomLight(int lightOrder, int paddedOrder, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    EnvironmentSh light{paddedOrder, {}};
    for (std::vector<float>& colour : light.rgb) {
        colour.assign(size_t(shCount(paddedOrder)), 0.0f);
        for (int band = 0; band < lightOrder; ++band)
            for (int m = -band; m <= band; ++m)
                colour[size_t(shIndex(band, m))] = normal(random) / float(1 + band);
        colour[0] += 3;
    }
    return light;
}

// Light of one function of the basis over a constant: radiance 1 + ½ Y_lm, or 1 alone for i = 0.
inline EnvironmentSh basisLight(int i, int paddedOrder) {
    EnvironmentSh light{paddedOrder, {}};
    for (std::vector<float>& colour : light.rgb) {
        colour.assign(size_t(shCount(paddedOrder)), 0.0f);
        colour[0] = float(std::sqrt(4 * std::numbers::pi));
        if (i > 0) colour[size_t(i)] += 0.5f;
    }
    return light;
}

// A sky with a horizon, a sun of 3 degrees and dark ground, projected.
inline EnvironmentSh skyLight(int shOrder, double sunRadiance = 300) {
    const int width = 256, height = 128;
    std::vector<float> rgb;
    const Vec3d sun = Vec3d(0.5, 0.6, -0.4).normalized();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Vec3d d = latLongDirection(x + 0.5, y + 0.5, width, height);
            const double sky = d.y() > 0 ? 0.4 + 0.8 * std::pow(1 - d.y(), 3.0) : 0.12;
            const double disc = d.dot(sun) > std::cos(0.05) ? sunRadiance : 0.0;
            for (const double tint : {0.6, 0.8, 1.0}) rgb.push_back(float(sky * tint + disc * (1.6 - tint)));
        }
    return projectEnvironment({width, height, rgb}, shOrder);
}

inline double largest(std::span<const float> values) {
    double result = 0;
    for (const float value : values) result = std::max(result, double(std::abs(value)));
    return result;
}

}  // namespace prt
