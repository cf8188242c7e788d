// Sources: the layout is this project's own (tools/docs/formats.md).
#include "precompute/io/lightmap_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/exr_conventions.h"
#include "precompute/io/exr_file.h"
#include "precompute/io/point_channels.h"
#include "precompute/io/projection_attributes.h"
#include "precompute/math/clamped_cosine.h"

namespace prt {
namespace {

constexpr const char* kContent = "sh-lightmap";
constexpr size_t kColumns = size_t(3) * kLightmapCoefficients;
constexpr float kLargestHalf = 65504;

std::vector<std::string> channelNames() {
    std::vector<std::string> names;
    for (const char* colour : {"R", "G", "B"})
        for (const std::string& name : indexedNames(colour, kLightmapCoefficients)) names.push_back(name);
    return names;
}

float requireFloat(const ExrAttributes& attributes, const char* name, const std::string& path) {
    const auto found = attributes.floatVectors.find(name);
    if (found == attributes.floatVectors.end() || found->second.size() != 1 ||
        !std::isfinite(found->second[0]))
        throw InputError(path, fmt::format("has no number {}", name), "the file is damaged; make it again");
    return found->second[0];
}

}  // namespace

FloatImage lightmapIrradiance(const Lightmap& map, std::span<const Vec3f> normals) {
    PRT_CHECK_EQ(normals.size(), map.grid.count);
    PRT_CHECK_EQ(map.coefficients.size(), map.grid.count * kColumns);
    FloatImage image{map.grid.width, map.grid.height, 3, {}};
    image.pixels.assign(gridPixels(map.grid) * 3, 0.0f);
    std::array<float, kLightmapCoefficients> cosine{};
    for (size_t k = 0; k < map.grid.count; ++k) {
        if (normals[k] == Vec3f::Zero()) continue;
        evalClampedCosineSh(kLightmapShOrder, normals[k], cosine);
        for (size_t c = 0; c < 3; ++c) {
            const float* light = &map.coefficients[k * kColumns + c * cosine.size()];
            const float sum = std::inner_product(cosine.begin(), cosine.end(), light, 0.0f);
            image.pixels[3 * k + c] = std::max(sum, 0.0f);
        }
    }
    return image;
}

std::string lightmapFileName(const std::string& environmentName) {
    return fmt::format("lightmaps/{}.exr", environmentFileStem(environmentName));
}

void writeLightmapFile(const std::string& path, const Lightmap& map) {
    checkGrid(map.grid);
    PRT_CHECK_LE(0, map.bounces);
    PRT_CHECK_LE(map.bounces, kMaxLightmapBounces);
    const PaddedPoints values(map.coefficients, map.grid, kColumns);
    const bool fits = std::all_of(map.coefficients.begin(), map.coefficients.end(),
                                  [](float value) { return std::abs(value) <= kLargestHalf; });
    std::map<std::string, std::string> attributes = map.attributes;
    setProjection(map.projection, attributes);
    ExrPartOut part;
    part.width = map.grid.width;
    part.height = map.grid.height;
    part.attributes = conventionAttributes(kContent, kLightmapShOrder, attributes);
    setDomain(map.grid, part.attributes);
    part.attributes.ints["bounces"] = map.bounces;
    part.attributes.floatVectors["rotationDeg"] = {float(map.rotationDeg)};
    part.attributes.floatVectors["relativeError"] = {float(map.relativeError)};
    addInterleaved(part.channels, channelNames(), fits ? ExrType::Half : ExrType::Float, values.data(),
                   part.width, kColumns);
    writeExr(path, {part});
}

Lightmap readLightmapFile(const std::string& path) {
    const ExrReader reader(path);
    const ExrPartInfo& part = reader.parts().at(0);
    Lightmap map;
    map.attributes = checkConventions(part.attributes, kContent, path);
    map.projection = takeProjection(map.attributes, path);
    requireInt(part.attributes, "shOrder", kLightmapShOrder, kLightmapShOrder, path);
    map.grid = readGrid(part, path);
    map.bounces = requireInt(part.attributes, "bounces", 0, kMaxLightmapBounces, path);
    map.rotationDeg = double(requireFloat(part.attributes, "rotationDeg", path));
    map.relativeError = double(requireFloat(part.attributes, "relativeError", path));
    checkChannels(part, channelNames(), path);
    map.coefficients.resize(gridPixels(map.grid) * kColumns);
    std::vector<ExrChannelIn> channels;
    addInterleaved(channels, channelNames(), ExrType::Float, map.coefficients.data(), part.width, kColumns);
    reader.read(0, channels);
    map.coefficients.resize(map.grid.count * kColumns);
    if (!std::all_of(map.coefficients.begin(), map.coefficients.end(),
                     [](float value) { return std::isfinite(value); }))
        throw InputError(path, "has values that are not finite numbers",
                         "the file is damaged; make it again");
    return map;
}

}  // namespace prt
