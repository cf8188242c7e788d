// Environments: every kind of file, every refusal, the skies against their formulas.
#include "precompute/io/environment_file.h"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfEnvmap.h>
#include <ImfEnvmapAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/io/bundle.h"
#include "tests/base/temporary_directory.h"

namespace prt {
namespace {

using testing::HasSubstr;
constexpr double kPi = std::numbers::pi;

std::string messageOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no InputError";
}

/// Writes float pixels under any header; channels interleaved in the order of `names`.
struct ExrSource {
    int width = 8, height = 4;
    Imath::V2i offset{0, 0};
    std::vector<std::string> names{"R", "G", "B"};
    Imf::PixelType type = Imf::FLOAT;
    Imf::Compression compression = Imf::ZIP_COMPRESSION;
    int envmap = -1;
    std::function<float(int x, int y, int channel)> value = [](int x, int y, int c) {
        return float(x + 10 * y + 100 * c);
    };

    void write(const std::string& path) const {
        const Imath::Box2i window(offset, offset + Imath::V2i(width - 1, height - 1));
        // The display window lies elsewhere: only the data window counts.
        const Imath::Box2i display(Imath::V2i(-3, -3), Imath::V2i(50, 50));
        Imf::Header header(display, window);
        header.compression() = compression;
        if (envmap >= 0) Imf::addEnvmap(header, Imf::Envmap(envmap));
        const size_t count = size_t(width) * size_t(height);
        std::vector<std::vector<float>> planes;
        std::vector<std::vector<half>> halves;
        std::vector<std::vector<uint32_t>> integers;
        Imf::FrameBuffer frame;
        for (size_t c = 0; c < names.size(); ++c) {
            header.channels().insert(names[c], Imf::Channel(type));
            planes.emplace_back();
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) planes.back().push_back(value(x, y, int(c)));
            halves.emplace_back(planes.back().begin(), planes.back().end());
            integers.emplace_back();
            if (type == Imf::UINT)
                for (float number : planes.back()) integers.back().push_back(uint32_t(number));
        }
        for (size_t c = 0; c < names.size(); ++c) {
            const void* data = type == Imf::HALF   ? static_cast<const void*>(halves[c].data())
                               : type == Imf::UINT ? static_cast<const void*>(integers[c].data())
                                                   : planes[c].data();
            frame.insert(names[c], Imf::Slice::Make(type, data, window));
        }
        ASSERT_EQ(planes.at(0).size(), count);
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(height);
    }
};

void expectSourceValues(const Environment& environment) {
    ASSERT_EQ(environment.image.width, 8);
    ASSERT_EQ(environment.image.height, 4);
    ASSERT_EQ(environment.image.channels, 3);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 8; ++x)
            for (int c = 0; c < 3; ++c) ASSERT_EQ(environment.image.at(x, y)[c], float(x + 10 * y + 100 * c));
}

TEST(EnvironmentExr, EveryPixelTypeAndCompression) {
    TemporaryDirectory directory;
    for (Imf::PixelType type : {Imf::HALF, Imf::FLOAT, Imf::UINT})
        for (Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                             Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
            ExrSource source;
            source.type = type;
            source.compression = compression;
            source.write(directory.file("night.exr"));
            const Environment environment = loadEnvironment(directory.file("night.exr"));
            expectSourceValues(environment);
            EXPECT_EQ(environment.name, "night");
            EXPECT_EQ(environment.source, directory.file("night.exr"));
        }
}

TEST(EnvironmentExr, DataWindowMayLieAnywhere) {
    TemporaryDirectory directory;
    for (const Imath::V2i& offset : {Imath::V2i(5, 7), Imath::V2i(-100, -3), Imath::V2i(1000, 0)}) {
        ExrSource source;
        source.offset = offset;
        source.write(directory.file("a.exr"));
        expectSourceValues(loadEnvironment(directory.file("a.exr")));
    }
}

TEST(EnvironmentExr, OtherChannelsDoNotDisturb) {
    TemporaryDirectory directory;
    ExrSource source;
    source.names = {"R", "G", "B", "A", "Z", "albedo.R"};
    source.envmap = Imf::ENVMAP_LATLONG;
    source.write(directory.file("a.EXR"));
    expectSourceValues(loadEnvironment(directory.file("a.EXR")));
}

TEST(EnvironmentExr, TiledFilesAreRead) {
    TemporaryDirectory directory;
    Imf::Header header(64, 32);
    header.setTileDescription(Imf::TileDescription(16, 16, Imf::ONE_LEVEL));
    std::vector<float> values(64 * 32);
    for (size_t i = 0; i < values.size(); ++i) values[i] = float(i);
    Imf::FrameBuffer frame;
    for (const char* name : {"R", "G", "B"}) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        frame.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 64 * 4));
    }
    {
        Imf::TiledOutputFile file(directory.file("t.exr").c_str(), header);
        file.setFrameBuffer(frame);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    }
    const Environment environment = loadEnvironment(directory.file("t.exr"));
    for (size_t i = 0; i < values.size(); ++i) ASSERT_EQ(environment.image.pixels[i * 3 + 1], float(i));
}

TEST(EnvironmentExr, NegativeAndUndefinedValuesAreCountedAndSaidOnce) {
    TemporaryDirectory directory;
    ExrSource source;
    source.value = [](int x, int y, int c) {
        if (c == 0 && y == 0 && x < 3) return -1.0f;
        if (c == 1 && y == 1 && x == 0) return std::numeric_limits<float>::quiet_NaN();
        if (c == 1 && y == 1 && x == 1) return std::numeric_limits<float>::infinity();
        return c == 2 ? 70000.0f : 2.0f;
    };
    source.write(directory.file("a.exr"));
    testing::internal::CaptureStderr();
    const Environment environment = loadEnvironment(directory.file("a.exr"));
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(environment.clampedNegative, 3u);
    EXPECT_EQ(environment.clampedNotFinite, 2u);
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1);
    EXPECT_THAT(said, testing::AllOf(HasSubstr("a.exr"), HasSubstr("3 negative and 2 infinite")));
    for (float value : environment.image.pixels) ASSERT_TRUE(value == 0 || value == 2 || value == 70000);
}

TEST(EnvironmentExr, HalfOverflowIsInfinite) {
    TemporaryDirectory directory;
    ExrSource source;
    source.type = Imf::HALF;
    source.value = [](int, int, int) { return 1e6f; };
    source.write(directory.file("a.exr"));
    testing::internal::CaptureStderr();
    EXPECT_EQ(loadEnvironment(directory.file("a.exr")).clampedNotFinite, 8u * 4 * 3);
    testing::internal::GetCapturedStderr();
}

TEST(EnvironmentExr, CubesAreResampledInOpenExrOrientation) {
    TemporaryDirectory directory;
    const int size = 32;
    ExrSource source;
    source.width = size;
    source.height = 6 * size;
    source.envmap = Imf::ENVMAP_CUBE;
    const Imath::Box2i window(Imath::V2i(0, 0), Imath::V2i(size - 1, 6 * size - 1));
    // Radiance 1 + direction: every orientation error shows.
    source.value = [&](int x, int y, int c) {
        const auto face = Imf::CubeMapFace(y / size);
        const Imath::Box2i faceWindow = Imf::CubeMap::dataWindowForFace(face, window);
        // Which point inside the face a pixel of the file is, by search: the library only maps the other way.
        for (int v = 0; v < size; ++v)
            for (int u = 0; u < size; ++u) {
                const Imath::V2f at =
                    Imf::CubeMap::pixelPosition(face, window, Imath::V2f(float(u), float(v)));
                if (std::lround(at.x) == x && std::lround(at.y) == y) {
                    const Imath::V3f direction =
                        Imf::CubeMap::direction(face, window, Imath::V2f(float(u), float(v))).normalized();
                    return 1 + direction[c];
                }
            }
        ADD_FAILURE() << faceWindow.min.y;
        return 0.0f;
    };
    source.write(directory.file("cube.exr"));
    const Environment environment = loadEnvironment(directory.file("cube.exr"));
    ASSERT_EQ(environment.image.width, 2 * environment.image.height);
    ASSERT_GE(environment.image.height, size);
    double worst = 0;
    for (int y = 0; y < environment.image.height; ++y)
        for (int x = 0; x < environment.image.width; ++x) {
            // In the middle by area, which beside a pole is not the middle by angle.
            const int height = environment.image.height;
            const double up = (std::cos(kPi * y / height) + std::cos(kPi * (y + 1) / height)) / 2;
            const Vec3d direction =
                latLongDirection(x + 0.5, std::acos(up) / kPi * height, environment.image.width, height);
            for (int c = 0; c < 3; ++c)
                worst = std::max(worst, std::abs(1 + direction[c] - double(environment.image.at(x, y)[c])));
        }
    // Bilinear over texels of 2/31: h²/8 times a second derivative of at most 2 or so, and the mean over a
    // texel.
    EXPECT_LT(worst, 2.5e-3);
}

TEST(EnvironmentExr, WrongShapesAndChannelsAreRefused) {
    TemporaryDirectory directory;
    const std::string path = directory.file("a.exr");
    ExrSource grey;
    grey.names = {"Y"};
    grey.write(path);
    EXPECT_THAT(messageOf([&] { loadEnvironment(path); }), HasSubstr("has no R, G and B channels"));
    ExrSource two;
    two.names = {"R", "G"};
    two.write(path);
    EXPECT_THAT(messageOf([&] { loadEnvironment(path); }), HasSubstr("has no R, G and B channels"));
    ExrSource shapeless;
    shapeless.width = 5;
    shapeless.write(path);
    EXPECT_THAT(messageOf([&] { loadEnvironment(path); }),
                testing::AllOf(HasSubstr("5 x 4 pixels are no layout"), HasSubstr("4:3 (horizontal-cross)"),
                               HasSubstr("envmap attribute")));
    // What the attribute says is not doubted.
    ExrSource square;
    square.width = 4;
    square.envmap = Imf::ENVMAP_LATLONG;
    square.write(path);
    EXPECT_THAT(messageOf([&] { loadEnvironment(path); }),
                HasSubstr("4 x 4 pixels are not the shape of latitude-longitude"));
    ExrSource cube;
    cube.envmap = Imf::ENVMAP_CUBE;
    cube.write(path);
    EXPECT_THAT(messageOf([&] { loadEnvironment(path); }), HasSubstr("six faces"));
}

TEST(EnvironmentExr, TruncationsAreRefused) {
    TemporaryDirectory directory;
    const std::string path = directory.file("a.exr");
    for (Imf::Compression compression : {Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION, Imf::NO_COMPRESSION}) {
        ExrSource source;
        source.width = 64;
        source.height = 32;
        source.compression = compression;
        source.write(path);
        const std::string whole = readFile(path);
        for (size_t length = 0; length < whole.size(); length += length < 400 ? 1 : 37) {
            rewriteFile(path, whole.substr(0, length));
            EXPECT_THROW(loadEnvironment(path), InputError) << length;
        }
    }
}

TEST(EnvironmentExr, IncompleteFilesAreRefused) {
    // Lines never written: the table of lines says so, and nothing is invented.
    TemporaryDirectory directory;
    {
        Imf::Header header(64, 32);
        std::vector<float> row(64, 1.0f);
        Imf::FrameBuffer frame;
        for (const char* name : {"R", "G", "B"}) {
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
            frame.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(row.data()), 4, 0));
        }
        Imf::OutputFile file(directory.file("a.exr").c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(16);
    }
    EXPECT_THROW(loadEnvironment(directory.file("a.exr")), InputError);
}

TEST(EnvironmentHdr, IsReadAndChecked) {
    TemporaryDirectory directory;
    const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X ";
    std::string pixels;
    for (int i = 0; i < 8; ++i) pixels += std::string("\x80\x40\x20\x81", 4);
    writeFileAtomically(directory.path() / "sky.HDR", head + "4\n" + pixels);
    const Environment environment = loadEnvironment(directory.file("sky.HDR"));
    EXPECT_EQ(environment.image.width, 4);
    for (size_t i = 0; i < 8; ++i) {
        EXPECT_EQ(environment.image.pixels[i * 3], 1.0f);
        EXPECT_EQ(environment.image.pixels[i * 3 + 1], 0.5f);
        EXPECT_EQ(environment.image.pixels[i * 3 + 2], 0.25f);
    }
    writeFileAtomically(directory.path() / "bad.hdr", head + "3\n" + pixels);
    EXPECT_THAT(messageOf([&] { loadEnvironment(directory.file("bad.hdr")); }),
                HasSubstr("3 x 2 pixels are no layout"));
}

TEST(Environment, UnknownSourcesAreRefused) {
    TemporaryDirectory directory;
    EXPECT_THAT(messageOf([&] { loadEnvironment("sky:green"); }), HasSubstr("sky:clear"));
    EXPECT_THAT(messageOf([&] { loadEnvironment(directory.file("absent.exr")); }), HasSubstr("No such file"));
    EXPECT_THAT(messageOf([&] { loadEnvironment(directory.file("absent.hdr")); }), HasSubstr("No such file"));
    EXPECT_THAT(messageOf([&] { loadEnvironment(directory.file("a.png")); }), HasSubstr(".exr or .hdr"));
}

TEST(Environment, RealOnesLoad) {
    const std::filesystem::path folder = std::filesystem::path(PRT_SOURCE_DIR) / "assets" / "hdri";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "tools/fetch-assets was not run";
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() != ".exr") continue;
        const Environment environment = loadEnvironment(entry.path().string());
        ++count;
        EXPECT_EQ(environment.image.width, 2 * environment.image.height);
        for (float value : environment.image.pixels) ASSERT_TRUE(std::isfinite(value) && value >= 0);
    }
    EXPECT_GT(count, 0);
}

// ---- skies

double horizontalIrradiance(const LatLongView& image, int colour) {
    double sum = 0;
    for (int y = 0; y < image.height / 2; ++y)
        for (int x = 0; x < image.width; ++x)
            sum += double(image.rgb[size_t((y * image.width + x) * 3 + colour)]) *
                   latLongDirection(x + 0.5, y + 0.5, image.width, image.height).y() *
                   latLongTexelSolidAngle(y, image.width, image.height);
    return sum;
}

TEST(Sky, EveryOneIsLightOfTheSameStrength) {
    for (const std::string& name : proceduralSkyNames()) {
        const Environment sky = loadEnvironment("sky:" + name);
        EXPECT_EQ(sky.name, name);
        EXPECT_EQ(sky.image.width, 512);
        EXPECT_EQ(sky.image.height, 256);
        EXPECT_EQ(sky.clampedNegative + sky.clampedNotFinite, 0u);
        double mean = 0;
        for (int c = 0; c < 3; ++c) {
            const double irradiance = horizontalIrradiance(sky.view(), c);
            EXPECT_GT(irradiance, 0.3 * kPi) << name;
            EXPECT_LT(irradiance, 2 * kPi) << name;
            mean += irradiance / 3;
        }
        // The cosine at texel centres is not its mean over texels: relative error (π/256)²/6.
        EXPECT_NEAR(mean, kPi, 1e-4 * kPi) << name;
    }
}

TEST(Sky, UniformIsOne) {
    const Environment sky = loadEnvironment("sky:uniform");
    for (float value : sky.image.pixels) ASSERT_EQ(value, 1.0f);
}

TEST(Sky, SunsAreWhereTheyShouldBe) {
    EXPECT_TRUE(hasSun(loadEnvironment("sky:clear").view()));
    EXPECT_TRUE(hasSun(loadEnvironment("sky:sunset").view()));
    EXPECT_FALSE(hasSun(loadEnvironment("sky:overcast").view()));
    EXPECT_FALSE(hasSun(loadEnvironment("sky:uniform").view()));
    // A sun gives most, not all.
    EXPECT_LT(brightestFluxShare(loadEnvironment("sky:clear").view(), 0.005), 0.8);
    for (const auto& [name, elevationDeg] : {std::pair{"sky:clear", 45.0}, std::pair{"sky:sunset", 8.0}}) {
        const Environment sky = loadEnvironment(name);
        const auto brightest = std::max_element(sky.image.pixels.begin(), sky.image.pixels.end());
        const int texel = int((brightest - sky.image.pixels.begin()) / 3);
        const Vec3d direction = latLongDirection(texel % 512 + 0.5, texel / 512 + 0.5, 512, 256);
        EXPECT_NEAR(std::asin(direction.y()) * 180 / kPi, elevationDeg, 1.0) << name;
    }
    // Red evening.
    const Environment sunset = loadEnvironment("sky:sunset");
    EXPECT_GT(horizontalIrradiance(sunset.view(), 0), horizontalIrradiance(sunset.view(), 2));
}

double luminance(const float* rgb) {
    return 0.2126 * double(rgb[0]) + 0.7152 * double(rgb[1]) + 0.0722 * double(rgb[2]);
}

TEST(Sky, OvercastFallsToAThirdAtTheHorizon) {
    // CIE S 011 type 1: φ(Z)/φ(0) = (1 + 4 exp(−0.7/cos Z)) / (1 + 4 exp(−0.7)), the same all around.
    const Environment sky = loadEnvironment("sky:overcast");
    const double zenith = luminance(sky.image.at(0, 0));
    for (int y : {10, 40, 80, 110, 126})
        for (int x : {0, 100, 300}) {
            double expected = 0;
            for (int s = 0; s < 100; ++s) {
                const double cosZenith = std::cos((y + (s + 0.5) / 100) * kPi / 256);
                expected += (1 + 4 * std::exp(-0.7 / cosZenith)) / (1 + 4 * std::exp(-0.7)) / 100;
            }
            EXPECT_NEAR(luminance(sky.image.at(x, y)) / zenith, expected, 2e-3) << y;
        }
    EXPECT_NEAR(luminance(sky.image.at(0, 127)) / zenith, 1 / 2.986, 0.01);
}

TEST(Sky, ClearFollowsTheStandard) {
    // CIE S 011 type 12: a = −1, b = −0.32, c = 10, d = −3, e = 0.45; away from the disc of the sun.
    const Environment sky = loadEnvironment("sky:clear");
    const float brightest = *std::max_element(sky.image.pixels.begin(), sky.image.pixels.end());
    Vec3d sun = Vec3d::Zero();
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 512; ++x)
            if (const double light = luminance(sky.image.at(x, y)); light > 0.1 * double(brightest))
                sun += light * latLongTexelSolidAngle(y, 512, 256) *
                       latLongDirection(x + 0.5, y + 0.5, 512, 256);
    sun.normalize();
    EXPECT_NEAR(std::asin(sun.y()) * 180 / kPi, 45, 0.02);
    const auto standard = [&](int x, int y) {
        const Vec3d direction = latLongDirection(x + 0.5, y + 0.5, 512, 256);
        const double angle = std::acos(direction.dot(sun));
        return (1 - std::exp(-0.32 / direction.y())) *
               (1 + 10 * (std::exp(-3 * angle) - std::exp(-1.5 * kPi)) +
                0.45 * std::cos(angle) * std::cos(angle));
    };
    const double scale = luminance(sky.image.at(0, 0)) / standard(0, 0);
    for (int y : {5, 20, 50, 90, 120})
        for (int x = 0; x < 512; x += 37) {
            if (std::acos(latLongDirection(x + 0.5, y + 0.5, 512, 256).dot(sun)) < 0.1) continue;
            const double expected = scale * standard(x, y);
            // Values are means over texels of 0.7°: off by h²/24 times the curvature, and by the sun's place.
            EXPECT_NEAR(luminance(sky.image.at(x, y)), expected, 2e-3 * expected) << x << ", " << y;
        }
}

TEST(Sky, GroundIsADiffuseFloor) {
    for (const char* name : {"sky:clear", "sky:sunset", "sky:overcast"}) {
        const Environment sky = loadEnvironment(name);
        for (int c = 0; c < 3; ++c) {
            const float ground = sky.image.at(0, 128)[c];
            EXPECT_GT(ground, 0.05f);
            EXPECT_LT(ground, 0.5f);
            EXPECT_EQ(sky.image.at(300, 255)[c], ground);
        }
    }
}

TEST(Environment, ContentHashIsThatOfThePixels) {
    const Environment clear = loadEnvironment("sky:clear");
    EXPECT_EQ(clear.contentHash, loadEnvironment("sky:clear").contentHash);
    EXPECT_NE(clear.contentHash, loadEnvironment("sky:sunset").contentHash);
    EXPECT_EQ(clear.contentHash, xxh3Hex(clear.image.pixels.data(), clear.image.pixels.size() * 4));
}

// ---- flux share

TEST(BrightestFluxShare, OneTexelByHand) {
    FloatImage image{8, 4, 3, std::vector<float>(8 * 4 * 3, 1.0f)};
    for (int c = 0; c < 3; ++c) image.at(3, 1)[c] = 101;
    const LatLongView view{8, 4, image.pixels};
    const double texel = latLongTexelSolidAngle(1, 8, 4);
    const double total = 4 * kPi + 100 * texel;
    EXPECT_NEAR(brightestFluxShare(view, texel / (4 * kPi)), 101 * texel / total, 1e-12);
    // A little less area than the texel has: nothing fits.
    EXPECT_EQ(brightestFluxShare(view, 0.99 * texel / (4 * kPi)), 0);
    EXPECT_NEAR(brightestFluxShare(view, 1), 1, 1e-12);
    EXPECT_EQ(brightestFluxShare(view, 0), 0);
}

TEST(BrightestFluxShare, ConstantLightHasNoSun) {
    FloatImage image{64, 32, 3, std::vector<float>(64 * 32 * 3, 2.0f)};
    const LatLongView view{64, 32, image.pixels};
    for (double fraction : {0.005, 0.1, 0.5}) {
        const double share = brightestFluxShare(view, fraction);
        EXPECT_LE(share, fraction + 1e-12);
        EXPECT_GT(share, fraction - 2.0 / (64 * 32) * kPi);
    }
    EXPECT_FALSE(hasSun(view));
    std::fill(image.pixels.begin(), image.pixels.end(), 0.0f);
    EXPECT_EQ(brightestFluxShare(view, 0.5), 0);
}

// ---- writing

TEST(WriteExrImage, HalfUnlessTheRangeIsTooLarge) {
    TemporaryDirectory directory;
    FloatImage image{16, 8, 3, {}};
    for (int i = 0; i < 16 * 8 * 3; ++i) image.pixels.push_back(0.001f * float(i * i + 1));
    writeExrImage(directory.file("a.exr"), image);
    const Environment back = loadEnvironment(directory.file("a.exr"));
    bool rounded = false;
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        // Half has 11 significant bits.
        EXPECT_NEAR(back.image.pixels[i], image.pixels[i], image.pixels[i] / 2048);
        rounded = rounded || back.image.pixels[i] != image.pixels[i];
    }
    EXPECT_TRUE(rounded);
    image.pixels[5] = 70000;
    writeExrImage(directory.file("b.exr"), image);
    EXPECT_EQ(loadEnvironment(directory.file("b.exr")).image.pixels, image.pixels);
}

TEST(WriteExrImage, RgbaKeepsAllBits) {
    TemporaryDirectory directory;
    FloatImage image{8, 4, 4, {}};
    for (int i = 0; i < 8 * 4 * 4; ++i) image.pixels.push_back(1.0f / float(i + 1));
    writeExrImage(directory.file("a.exr"), image);
    const Environment back = loadEnvironment(directory.file("a.exr"));
    for (size_t i = 0; i < 32; ++i)
        for (size_t c = 0; c < 3; ++c) EXPECT_EQ(back.image.pixels[i * 3 + c], image.pixels[i * 4 + c]);
    EXPECT_THROW(writeExrImage(directory.file("none/a.exr"), image), OutputError);
}

}  // namespace
}  // namespace prt
