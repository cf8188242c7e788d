// Layouts of environments: one original drawn in each of them by a slow loop from its description, and by
// OpenEXR's own converter, gives the same light.
#include "precompute/math/environment_layout.h"

#include <ImfArray.h>
#include <ImfEnvmapAttribute.h>
#include <ImfHeader.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <random>

#include "precompute/base/error.h"
#include "precompute/io/environment_file.h"
#include "precompute/math/sh.h"
#include "tests/base/temporary_directory.h"

namespace prt {
namespace {

using testing::HasSubstr;
constexpr double kPi = std::numbers::pi;
using Colour = std::array<double, 3>;

/// Different from every side, with a sharp light, so that any turned or mirrored face shows.
Colour original(const Vec3d& d) {
    const double lamp = 8 * std::exp(12 * (d.dot(Vec3d(2, 1, 3).normalized()) - 1));
    return {1 + 0.5 * d.x() + lamp, 1 + 0.5 * d.y() * d.z() + 0.8 * lamp,
            1 + 0.7 * d.z() + 0.4 * d.x() * d.y() + 2 * std::exp(9 * (-d.x() - 1))};
}

Vec3d flipX(const Vec3d& d) { return {-d.x(), d.y(), d.z()}; }

/// A square of a cube: its middle, and where its right and top edge lie.
struct Square {
    double column, row;
    Vec3d middle, right, top;
};
const Vec3d kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);
// OpenGL 4.5, table 8.19: right is where s grows, top where t falls.
std::vector<Square> openGlFaces() {
    return {{0, 0, kX, -kZ, kY}, {0, 0, -kX, kZ, kY}, {0, 0, kY, kX, -kZ},
            {0, 0, -kY, kX, kZ}, {0, 0, kZ, kX, kY},  {0, 0, -kZ, -kX, kY}};
}
// Looking around from +Z to the right one sees −X, −Z, +X.
std::vector<Square> squaresOf(EnvironmentLayout layout) {
    std::vector<Square> squares;
    switch (layout) {
        case EnvironmentLayout::CubeVerticalStrip:
        case EnvironmentLayout::CubeHorizontalStrip:
            squares = openGlFaces();
            for (size_t i = 0; i < 6; ++i)
                (layout == EnvironmentLayout::CubeVerticalStrip ? squares[i].row : squares[i].column) =
                    double(i);
            break;
        case EnvironmentLayout::HorizontalCross:
            squares = {{0, 1, kX, kZ, kY},  {1, 1, kZ, -kX, kY},  {2, 1, -kX, -kZ, kY},
                       {3, 1, -kZ, kX, kY}, {1, 0, kY, -kX, -kZ}, {1, 2, -kY, -kX, kZ}};
            break;
        case EnvironmentLayout::VerticalCross:
            squares = {{0, 1, kX, kZ, kY},    {1, 1, kZ, -kX, kY},  {2, 1, -kX, -kZ, kY},
                       {1, 3, -kZ, -kX, -kY}, {1, 0, kY, -kX, -kZ}, {1, 2, -kY, -kX, kZ}};
            break;
        default:
            break;
    }
    return squares;
}

/// What a place of a picture shows (x, y in texels of faces of `size`), from the descriptions alone.
std::optional<Vec3d> slowDirection(EnvironmentLayout layout, double x, double y, int size) {
    switch (layout) {
        case EnvironmentLayout::LatLong: {
            const double longitude = kPi * (1 - x / size), latitude = kPi * (0.5 - y / size);
            return Vec3d(std::sin(longitude) * std::cos(latitude), std::sin(latitude),
                         std::cos(longitude) * std::cos(latitude));
        }
        case EnvironmentLayout::AngularMap: {
            // [Debevec1998]: from the middle, turn by π·radius, then about the axis; mirrored to ours.
            const double u = 2 * x / size - 1, v = 1 - 2 * y / size;
            const double turn = std::atan2(v, u), away = kPi * std::hypot(u, v);
            if (away > kPi) return std::nullopt;
            return Vec3d(-std::sin(away) * std::cos(turn), std::sin(away) * std::sin(turn), std::cos(away));
        }
        case EnvironmentLayout::DualParaboloid: {
            const bool back = x >= size;
            const auto ring = [&](double at) { return std::clamp((2 * at - size) / (size - 1), -1.0, 1.0); };
            const double s = ring(x - (back ? size : 0)), t = ring(y);
            // Shirley and Chiu's disc: radius is the larger of the two, the angle goes in proportion.
            double r = std::abs(s), angle = s < 0 ? kPi : 0;
            if (std::abs(s) >= std::abs(t)) {
                angle += s == 0 ? 0 : kPi / 4 * t / s;
            } else {
                r = std::abs(t);
                angle = (t < 0 ? -kPi / 2 : kPi / 2) - kPi / 4 * s / t;
            }
            const double sine = 2 * r / (1 + r * r), cosine = (1 - r * r) / (1 + r * r);
            const double across = sine * std::cos(angle), down = sine * std::sin(angle);
            return back ? Vec3d(-across, -down, -cosine) : Vec3d(across, -down, cosine);
        }
        case EnvironmentLayout::OpenExrCube:
            return std::nullopt;  // drawn by OpenEXR, and tested against it in environment_test.cpp
        default:
            for (const Square& square : squaresOf(layout)) {
                const double s = 2 * (x / size - square.column) - 1, t = 1 - 2 * (y / size - square.row);
                if (std::abs(s) <= 1 && std::abs(t) <= 1)
                    return (square.middle + s * square.right + t * square.top).normalized();
            }
            return std::nullopt;
    }
}

struct Extent {
    int width, height;
};
Extent extentOf(EnvironmentLayout layout, int size) {
    constexpr std::array<Extent, 8> kSquares{
        {{2, 1}, {1, 6}, {6, 1}, {4, 3}, {3, 4}, {1, 6}, {2, 1}, {1, 1}}};
    return {kSquares[size_t(layout)].width * size, kSquares[size_t(layout)].height * size};
}

/// Means over 4×4 places per texel of what they show; −1 where they show nothing, which must never be seen.
FloatImage draw(EnvironmentLayout layout, int size, const std::function<Colour(const Vec3d&)>& light) {
    const auto [width, height] = extentOf(layout, size);
    FloatImage image{width, height, 3, std::vector<float>(size_t(width) * size_t(height) * 3, -1.0f)};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            Colour sum{};
            int count = 0;
            for (int i = 0; i < 16; ++i) {
                const auto d = slowDirection(layout, x + (i % 4 + 0.5) / 4, y + (i / 4 + 0.5) / 4, size);
                if (!d) continue;
                const Colour colour = light(*d);
                for (size_t c = 0; c < 3; ++c) sum[c] += colour[c];
                ++count;
            }
            if (!slowDirection(layout, x + 0.5, y + 0.5, size)) continue;
            for (size_t c = 0; c < 3; ++c) image.at(x, y)[c] = float(sum[c] / count);
        }
    return image;
}

EnvironmentSh exactSh(const std::function<Colour(const Vec3d&)>& light) {
    EnvironmentSh sh;
    sh.shOrder = 6;
    for (size_t c = 0; c < 3; ++c) {
        const std::vector<double> v = projectSh(6, [&](const Vec3d& d) { return light(d)[c]; });
        sh.rgb[c].assign(v.begin(), v.end());
    }
    return sh;
}

double relativeDifference(const EnvironmentSh& a, const EnvironmentSh& b) {
    double worst = 0;
    for (size_t c = 0; c < 3; ++c) {
        double difference = 0, sum = 0;
        for (size_t i = 0; i < a.rgb[c].size(); ++i) {
            difference += std::pow(double(a.rgb[c][i]) - double(b.rgb[c][i]), 2);
            sum += std::pow(double(b.rgb[c][i]), 2);
        }
        worst = std::max(worst, std::sqrt(difference / sum));
    }
    return worst;
}

std::vector<EnvironmentLayout> allLayouts() {
    std::vector<EnvironmentLayout> all;
    for (const std::string& name : environmentLayoutNames()) all.push_back(*environmentLayoutFromName(name));
    return all;
}
const std::string& nameOf(EnvironmentLayout layout) { return environmentLayoutNames()[size_t(layout)]; }

TEST(EnvironmentLayout, EveryOneShowsTheSameLight) {
    TemporaryDirectory directory;
    const std::string path = directory.file("a.exr");
    const EnvironmentSh expected = exactSh(original);
    const EnvironmentSh swapped = exactSh([](const Vec3d& d) { return original(flipX(d)); });
    ASSERT_GT(relativeDifference(swapped, expected), 0.2);
    for (const EnvironmentLayout layout : allLayouts()) {
        if (layout == EnvironmentLayout::OpenExrCube) continue;
        SCOPED_TRACE(nameOf(layout));
        const bool whole = layout == EnvironmentLayout::LatLong || layout == EnvironmentLayout::AngularMap;
        writeExrImage(path, draw(layout, whole ? 128 : 64, original));
        EnvironmentOptions options;
        if (layout == EnvironmentLayout::DualParaboloid) options.layout = nameOf(layout);
        testing::internal::CaptureStderr();  // it says that the places that show nothing were negative
        const Environment environment = loadEnvironment(path, options);
        options.mirrored = true;
        const Environment mirrored = loadEnvironment(path, options);
        testing::internal::GetCapturedStderr();
        EXPECT_EQ(environment.image.width, 256);
        EXPECT_EQ(environment.image.height, 128);
        // Bilinear smoothing takes about (l h)²/4 of what band l holds: 4e-3 of the last with texels of
        // h = 2/64 in the middle of a cube's face, twice that in a paraboloid's. Measured: 3e-3 at most.
        EXPECT_LT(relativeDifference(projectEnvironment(environment.view(), 6), expected), 5e-3);
        EXPECT_LT(relativeDifference(projectEnvironment(mirrored.view(), 6), swapped), 5e-3);
    }
}

TEST(EnvironmentLayout, TexelsShowWhatTheDescriptionSays) {
    for (const EnvironmentLayout layout : allLayouts()) {
        if (layout == EnvironmentLayout::OpenExrCube) continue;
        SCOPED_TRACE(nameOf(layout));
        for (const int size : {4, 7}) {
            const auto [width, height] = extentOf(layout, size);
            ASSERT_TRUE(environmentLayoutFits(layout, width, height));
            const EnvironmentLayoutMap map(layout, width, height);
            EXPECT_EQ(map.size(), size);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const auto expected = slowDirection(layout, x + 0.5, y + 0.5, size);
                    const auto found = map.texelDirection(x, y);
                    ASSERT_EQ(found.has_value(), expected.has_value()) << x << ' ' << y;
                    if (!found) {
                        EXPECT_TRUE(layout == EnvironmentLayout::AngularMap ||
                                    map.texelSolidAngle(x, y) == 0);
                        continue;
                    }
                    EXPECT_LT((*found - *expected).norm(), 1e-12) << x << ' ' << y;
                    // A lookup towards a texel's centre is that texel alone, but on a dual map's equator and
                    // beside the rim of an angular map, where several stand for nearly one direction.
                    float own = 0;
                    for (const SphereTap& tap : map.taps(3 * *found))
                        if (tap.texel == y * width + x) own += tap.weight;
                    const bool edge =
                        layout == EnvironmentLayout::DualParaboloid && std::abs(found->z()) < 1e-9;
                    if (!edge) {
                        EXPECT_NEAR(own, 1, 1e-5) << x << ' ' << y;
                    }
                }
        }
    }
}

TEST(EnvironmentLayout, SolidAnglesSumToTheSphere) {
    for (const EnvironmentLayout layout : allLayouts())
        for (const int size : {16, 37}) {
            const auto [width, height] = extentOf(layout, size);
            const EnvironmentLayoutMap map(layout, width, height);
            double sum = 0;
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) sum += map.texelSolidAngle(x, y);
            const double tolerance = layout == EnvironmentLayout::AngularMap ? 1e-4 : 1e-9;
            EXPECT_NEAR(sum / (4 * kPi), 1, tolerance) << nameOf(layout) << ' ' << size;
        }
}

/// Σ L ΔΩ of one channel, by the layout's own solid angles.
double flux(const EnvironmentLayoutMap& map, std::span<const float> rgb) {
    double sum = 0;
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x)
            sum += double(rgb[size_t(y * map.width() + x) * 3]) * map.texelSolidAngle(x, y);
    return sum;
}

TEST(EnvironmentLayout, ResamplingKeepsTheFlux) {
    std::mt19937 random(3);
    for (const EnvironmentLayout layout : allLayouts()) {
        SCOPED_TRACE(nameOf(layout));
        const auto [width, height] = extentOf(layout, 32);
        const EnvironmentLayoutMap map(layout, width, height);
        std::vector<float> rgb(size_t(width) * size_t(height) * 3);
        // Rough: every texel its own, of a wide range.
        for (float& value : rgb) value = std::pow(std::uniform_real_distribution<float>(0, 2)(random), 6.0f);
        const auto resampled = [&] {
            const int rows = latLongHeightForLayout(layout, map.width(), map.height());
            return flux(EnvironmentLayoutMap(EnvironmentLayout::LatLong, 2 * rows, rows),
                        latLongFromLayout(layout, map.width(), map.height(), rgb));
        };
        EXPECT_NEAR(resampled() / flux(map, rgb), 1, 5e-3);
        // One bright texel, wherever it is not on an edge that it shares.
        for (int k = 0; k < 12; ++k) {
            std::fill(rgb.begin(), rgb.end(), 0.0f);
            const int x = int(random() % unsigned(width)), y = int(random() % unsigned(height));
            const bool rim = x % 32 < 2 || x % 32 > 29 || y % 32 < 2 || y % 32 > 29;
            const auto direction = map.texelDirection(x, y);
            if (!direction || rim) continue;
            if (layout == EnvironmentLayout::AngularMap && direction->z() < -0.7) continue;
            rgb[size_t(y * width + x) * 3] = 1;
            EXPECT_NEAR(resampled() / flux(map, rgb), 1, 0.03) << x << ' ' << y;
        }
    }
}

TEST(EnvironmentLayout, ConstantLightStaysConstant) {
    for (const EnvironmentLayout layout : allLayouts())
        for (const int size : {2, 5, 16}) {
            const auto [width, height] = extentOf(layout, size);
            const EnvironmentLayoutMap map(layout, width, height);
            // What shows nothing is not mixed in.
            std::vector<float> rgb(size_t(width) * size_t(height) * 3, 1.0f);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x)
                    if (!map.texelDirection(x, y)) rgb[size_t(y * width + x) * 3] = 1e6f;
            for (const float value : latLongFromLayout(layout, width, height, rgb))
                ASSERT_NEAR(value, 1, 1e-6) << nameOf(layout) << ' ' << size;
        }
}

TEST(EnvironmentLayout, IsDetectedByShapeOrNamed) {
    EXPECT_EQ(detectEnvironmentLayout(8, 4), EnvironmentLayout::LatLong);
    EXPECT_EQ(detectEnvironmentLayout(5, 30), EnvironmentLayout::CubeVerticalStrip);
    EXPECT_EQ(detectEnvironmentLayout(30, 5), EnvironmentLayout::CubeHorizontalStrip);
    EXPECT_EQ(detectEnvironmentLayout(16, 12), EnvironmentLayout::HorizontalCross);
    EXPECT_EQ(detectEnvironmentLayout(12, 16), EnvironmentLayout::VerticalCross);
    EXPECT_EQ(detectEnvironmentLayout(9, 9), EnvironmentLayout::AngularMap);
    EXPECT_EQ(detectEnvironmentLayout(9, 8), std::nullopt);
    EXPECT_EQ(detectEnvironmentLayout(13, 16), std::nullopt);
    EXPECT_EQ(detectEnvironmentLayout(1, 1), std::nullopt);
    EXPECT_EQ(environmentLayoutFromName("auto"), std::nullopt);
    for (const EnvironmentLayout layout : allLayouts())
        EXPECT_EQ(environmentLayoutFromName(nameOf(layout)), layout);

    TemporaryDirectory directory;
    const std::string path = directory.file("a.exr");
    writeExrImage(path, {16, 8, 3, std::vector<float>(16 * 8 * 3, 1.0f)});
    const auto refused = [&](const std::string& layout) -> std::string {
        EnvironmentOptions options;
        options.layout = layout;
        try {
            loadEnvironment(path, options);
        } catch (const Error& error) {
            return error.what();
        }
        return "accepted";
    };
    EXPECT_EQ(refused("latitude-longitude"), "accepted");
    EXPECT_EQ(refused("dual-paraboloid"), "accepted");
    EXPECT_THAT(refused("angular-map"), HasSubstr("16 x 8 pixels are not the shape of angular-map"));
    EXPECT_THAT(refused("openexr-cube"), HasSubstr("16 x 8 pixels"));
    EXPECT_THAT(refused("octahedral"), HasSubstr("use auto or one of latitude-longitude, cube-vertical"));
    EnvironmentOptions unknown;
    unknown.layout = "octahedral";
    EXPECT_THROW(loadEnvironment(path, unknown), UsageError);
    EXPECT_THROW(loadEnvironment("sky:clear", unknown), UsageError);
}

TEST(EnvironmentLayout, OpenExrsConverterShowsTheSame) {
    if (std::system("command -v exrenvmap > /dev/null 2>&1") != 0)
        GTEST_SKIP() << "exrenvmap (package openexr) is not installed";
    TemporaryDirectory directory;
    const FloatImage source = draw(EnvironmentLayout::LatLong, 256, original);
    {
        Imf::Header header(source.width, source.height);
        Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
        Imf::RgbaOutputFile file(directory.file("source.exr").c_str(), header, Imf::WRITE_RGB);
        std::vector<Imf::Rgba> pixels;
        for (int y = 0; y < source.height; ++y)
            for (int x = 0; x < source.width; ++x)
                pixels.emplace_back(source.at(x, y)[0], source.at(x, y)[1], source.at(x, y)[2], 1.0f);
        file.setFrameBuffer(pixels.data(), 1, size_t(source.width));
        file.writePixels(source.height);
    }
    const EnvironmentSh expected =
        projectEnvironment(loadEnvironment(directory.file("source.exr")).view(), 6);
    for (const std::string arguments : {"-c -w 128 source.exr cube.exr", "-l -w 512 cube.exr back.exr"}) {
        ASSERT_EQ(std::system(("cd '" + directory.path().string() + "' && exrenvmap " + arguments).c_str()),
                  0);
        const std::string name = arguments.substr(arguments.rfind(' ') + 1);
        const Environment converted = loadEnvironment(directory.file(name));
        EXPECT_LT(relativeDifference(projectEnvironment(converted.view(), 6), expected), 1e-2) << name;
    }
}

}  // namespace
}  // namespace prt
