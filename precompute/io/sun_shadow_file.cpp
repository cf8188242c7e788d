// Sources: the layout is this project's own (tools/docs/formats.md).
#include "precompute/io/sun_shadow_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/exr_conventions.h"
#include "precompute/io/exr_file.h"
#include "precompute/io/point_channels.h"

namespace prt {
namespace {

constexpr const char* kContent = "sun-shadow";
constexpr const char* kChannel = "shadow";

std::vector<float> requireFloats(const ExrAttributes& attributes, const std::string& name, size_t count,
                                 const std::string& path) {
    const auto found = attributes.floatVectors.find(name);
    if (found == attributes.floatVectors.end() || found->second.size() != count ||
        !std::all_of(found->second.begin(), found->second.end(), [](float v) { return std::isfinite(v); }))
        throw InputError(path, fmt::format("has no attribute {} of {} numbers", name, count),
                         "the file is damaged; make it again");
    return found->second;
}

}  // namespace

std::string sunShadowFileName(const std::string& environmentName) {
    return fmt::format("tables/{}.sun.exr", environmentFileStem(environmentName));
}

void writeSunShadowFile(const std::string& path, const SunShadowMap& map) {
    checkGrid(map.grid);
    const PaddedPoints shadow(map.shadow, map.grid, 1);
    ExrPartOut part;
    part.width = map.grid.width;
    part.height = map.grid.height;
    part.attributes = conventionAttributes(kContent, 0, map.attributes);
    setDomain(map.grid, part.attributes);
    part.attributes.floatVectors["sunDirection"] = {map.direction.x(), map.direction.y(), map.direction.z()};
    part.attributes.floatVectors["sunAngularRadiusRad"] = {map.angularRadiusRad};
    part.attributes.floatVectors["sunIrradiance"] = {map.irradiance.begin(), map.irradiance.end()};
    addInterleaved(part.channels, {kChannel}, ExrType::Half, shadow.data(), part.width, 1);
    writeExr(path, {part});
}

SunShadowMap readSunShadowFile(const std::string& path) {
    const ExrReader reader(path);
    const ExrPartInfo& part = reader.parts().at(0);
    SunShadowMap map;
    map.attributes = checkConventions(part.attributes, kContent, path);
    map.grid = readGrid(part, path);
    checkChannels(part, {kChannel}, path);
    const std::vector<float> direction = requireFloats(part.attributes, "sunDirection", 3, path);
    map.direction = Vec3f(direction[0], direction[1], direction[2]);
    if (std::abs(map.direction.norm() - 1) > 1e-3f)
        throw InputError(path, "has a sunDirection that is no unit vector",
                         "the file is damaged; make it again");
    map.angularRadiusRad = requireFloats(part.attributes, "sunAngularRadiusRad", 1, path)[0];
    const std::vector<float> irradiance = requireFloats(part.attributes, "sunIrradiance", 3, path);
    std::copy_n(irradiance.begin(), 3, map.irradiance.begin());
    map.shadow.resize(gridPixels(map.grid));
    std::vector<ExrChannelIn> channels;
    addInterleaved(channels, {kChannel}, ExrType::Float, map.shadow.data(), part.width, 1);
    reader.read(0, channels);
    map.shadow.resize(map.grid.count);
    return map;
}

}  // namespace prt
