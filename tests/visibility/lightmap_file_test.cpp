// lightmaps/ENV.exr: what is written comes back, what is damaged is refused.
#include "precompute/io/lightmap_file.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include "precompute/base/error.h"
#include "precompute/io/exr_conventions.h"
#include "precompute/io/exr_file.h"
#include "precompute/io/sun_shadow_file.h"
#include "tests/base/temporary_directory.h"

namespace prt {
namespace {

Lightmap sample(const PointGrid& grid, float scale) {
    Lightmap map;
    map.grid = grid;
    for (size_t i = 0; i < grid.count * 27; ++i)
        map.coefficients.push_back(scale * (float(i % 129) / 64 - 1));  // exact in half
    map.bounces = 3;
    map.rotationDeg = -22.5;
    map.relativeError = 0.0625;
    map.projection = Projection{};
    map.attributes = {{"environmentName", "noon"}, {"environmentHash", "12ab"}};
    return map;
}

template <class Action>
std::string messageOf(const Action& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

TEST(LightmapFile, RoundTrips) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("l.exr");
    for (const PointGrid& grid : {PointGrid{PointDomain::Texel, 7, 5, 35}, vertexGrid(1500)})
        for (const float scale : {1.0f, 131072.0f}) {  // beyond half: kept as float
            const Lightmap map = sample(grid, scale);
            writeLightmapFile(path, map);
            const Lightmap back = readLightmapFile(path);
            EXPECT_EQ(back.grid.domain, grid.domain);
            EXPECT_EQ(back.grid.count, grid.count);
            EXPECT_EQ(back.coefficients, map.coefficients);
            EXPECT_EQ(back.bounces, 3);
            EXPECT_EQ(back.rotationDeg, -22.5);
            EXPECT_EQ(back.relativeError, 0.0625);
            EXPECT_EQ(back.projection, map.projection);
            EXPECT_EQ(back.attributes, map.attributes);
            const ExrReader reader(path);
            EXPECT_EQ(reader.parts()[0].channels.at("G.08"), scale > 1 ? ExrType::Float : ExrType::Half);
        }
    EXPECT_EQ(lightmapFileName("sunny day"), "lightmaps/sunny_day.exr");
}

TEST(LightmapFile, OtherContentIsRefused) {
    const TemporaryDirectory directory;
    SunShadowMap sun;
    sun.grid = {PointDomain::Texel, 2, 2, 4};
    sun.shadow.assign(4, 1.0f);
    writeSunShadowFile(directory.file("s.exr"), sun);
    EXPECT_NE(messageOf([&] { readLightmapFile(directory.file("s.exr")); }).find("sun-shadow"),
              std::string::npos);
    EXPECT_NE(messageOf([&] { readLightmapFile(directory.file("none.exr")); }), "no error");

    // The right content, with less and less in it.
    const std::string path = directory.file("p.exr");
    const std::vector<float> zeros(35, 0.0f);
    ExrPartOut part;
    part.width = 7;
    part.height = 5;
    part.attributes = conventionAttributes("sh-lightmap", kLightmapShOrder, {});
    part.attributes.strings["domain"] = "texel";
    part.channels = {{"R.00", ExrType::Half, zeros.data(), 4, 28}};
    writeExr(path, {part});
    EXPECT_NE(messageOf([&] { readLightmapFile(path); }).find("bounces"), std::string::npos);
    part.attributes.ints["bounces"] = 2;
    writeExr(path, {part});
    EXPECT_NE(messageOf([&] { readLightmapFile(path); }).find("rotationDeg"), std::string::npos);
    part.attributes.floatVectors["rotationDeg"] = {0};
    part.attributes.floatVectors["relativeError"] = {0};
    writeExr(path, {part});
    EXPECT_NE(messageOf([&] { readLightmapFile(path); }).find("R.01"), std::string::npos);
    part.attributes.ints["bounces"] = -1;
    writeExr(path, {part});
    EXPECT_NE(messageOf([&] { readLightmapFile(path); }).find("bounces"), std::string::npos);
}

TEST(LightmapFile, TruncatedAtAnyLength) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("l.exr");
    writeLightmapFile(path, sample({PointDomain::Texel, 16, 16, 256}, 1));
    std::ifstream in(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    for (size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 150) {
        rewriteFile(path, bytes.substr(0, length));
        EXPECT_THROW(readLightmapFile(path), InputError) << length;
    }
}

TEST(LightmapFile, ValuesThatAreNoNumbers) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("l.exr");
    Lightmap map = sample({PointDomain::Texel, 4, 4, 16}, 1);
    map.coefficients[100] = NAN;
    writeLightmapFile(path, map);
    EXPECT_NE(messageOf([&] { readLightmapFile(path); }).find("finite"), std::string::npos);
}

}  // namespace
}  // namespace prt
