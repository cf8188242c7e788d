// tables/ENV.sun.exr: the sun of an environment, and what of it every point sees.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "precompute/io/visibility_file.h"
#include "precompute/math/vec.h"

namespace prt {

struct SunShadowMap {
    PointGrid grid;
    Vec3f direction = Vec3f::UnitY();  ///< towards the middle of the disc, unit, world
    float angularRadiusRad = 0;
    std::array<float, 3> irradiance{};              ///< of a surface that faces the whole disc, per colour
    std::vector<float> shadow;                      ///< [grid.count] visible share of the disc, 0..1
    std::map<std::string, std::string> attributes;  ///< environmentName, environmentHash
};

/// tables/ENV.sun.exr
std::string sunShadowFileName(const std::string& environmentName);

/// Channel shadow (half).
/// @throws OutputError
void writeSunShadowFile(const std::string& path, const SunShadowMap& map);
/// @throws InputError  another content, attributes missing or out of range, no such channel
SunShadowMap readSunShadowFile(const std::string& path);

}  // namespace prt
