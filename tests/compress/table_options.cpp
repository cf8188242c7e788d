// Options of tables: what they refuse, the words that renew a table, and what they make of light.
#include "compress/tables/table_options.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "precompute/base/error.h"
#include "precompute/math/environment.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_window.h"
#include "tests/compress/table_lights.h"

namespace prt {
namespace {

std::string refusalOf(const TableOptions& options) {
    try {
        checkTableOptions(options, "--table-");
        return "";
    } catch (const UsageError& error) {
        return error.what();
    }
}

TEST(TableOptions, RefuseWhatThereIsNot) {
    TableOptions options;
    EXPECT_EQ(refusalOf(options), "");
    options.layout = "sphere";
    EXPECT_THAT(refusalOf(options), testing::HasSubstr("--table-layout"));
    options = {};
    options.variant = "rough";
    EXPECT_THAT(refusalOf(options), testing::HasSubstr("--table-variant"));
    options = {};
    options.layout = "dual-paraboloid";
    options.size = 1;
    EXPECT_THAT(refusalOf(options), testing::HasSubstr("use 2 to 1024"));
    for (const char* window : {"box", "", "lanczos:", "lanczos:0", "lanczos:-3", "lanczos:x", "lanczos:4x",
                               "lanczos:nan", "lanczos:2000", "none:3"}) {
        options = {};
        options.window = window;
        EXPECT_THAT(refusalOf(options), testing::HasSubstr("--window")) << window;
    }
    for (const char* window : {"hanning", "lanczos:5.5", "gaussian:auto"}) {
        options.window = window;
        EXPECT_EQ(refusalOf(options), "") << window;
    }
}

TEST(TableOptions, WordsNameWhatIsNotTheDefault) {
    TableOptions options;
    EXPECT_EQ(tableWords(options), " --layout cube --size 32");
    options = {"octahedral", 16, "paper", "hanning:4", true};
    EXPECT_EQ(tableWords(options),
              " --layout octahedral --size 16 --variant paper --window hanning:4 --extract-sun");
}

TEST(TableOptions, WindowsAreAppliedAsAsked) {
    const EnvironmentSh light = skyLight(14);
    const auto applied = [&](const std::string& window, double& width) {
        TableOptions options;
        options.window = window;
        EnvironmentSh windowed = light;
        width = applyTableWindow(options, windowed);
        return windowed;
    };
    double width = -1;
    EXPECT_EQ(applied("none", width).rgb, light.rgb);
    EXPECT_EQ(width, 0);
    EnvironmentSh expected = light;
    applyShWindow(ShWindow::Hanning, 14, expected);
    EXPECT_EQ(applied("hanning", width).rgb, expected.rgb);
    EXPECT_EQ(width, 14);
    expected = light;
    applyShWindow(ShWindow::Lanczos, 5.5, expected);
    EXPECT_EQ(applied("lanczos:5.5", width).rgb, expected.rgb);
    EXPECT_EQ(width, 5.5);
    applied("gaussian:auto", width);
    EXPECT_EQ(width, findNonNegativeWindow(light, ShWindow::Gaussian));
}

// A sun of 3 degrees on a dark sky: the light that is left and the disc add up to what there was.
TEST(TableOptions, ExtractedSunsKeepTheirEnergy) {
    const int width = 256, height = 128;
    std::vector<float> pixels;
    const Vec3d sun = Vec3d(0.3, 0.7, 0.2).normalized();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const bool inside = latLongDirection(x + 0.5, y + 0.5, width, height).dot(sun) > std::cos(0.05);
            pixels.insert(pixels.end(),
                          {inside ? 200.0f : 0.2f, inside ? 180.0f : 0.3f, inside ? 90.0f : 0.6f});
        }
    const LatLongView image{width, height, pixels};
    TableOptions options;
    const TableLight joined = projectTableLight(image, 6, options);
    EXPECT_FALSE(joined.sun.found);
    EXPECT_EQ(joined.rest.shOrder, 17);
    options.extractSun = true;
    const TableLight split = projectTableLight(image, 6, options);
    ASSERT_TRUE(split.sun.found);
    EXPECT_GT(split.sun.direction.dot(sun), std::cos(0.01));
    std::vector<float> basis(size_t(shCount(17)));
    evalSh(17, Vec3f(split.sun.direction.cast<float>()), basis);
    for (size_t c = 0; c < 3; ++c) {
        // Bands 0 to 2 are what irradiance of an open point sees.
        for (size_t i = 0; i < 9; ++i)
            EXPECT_NEAR(double(split.rest.rgb[c][i]) + split.sun.irradiance()[c] * double(basis[i]),
                        double(joined.rest.rgb[c][i]), 0.01 * double(joined.rest.rgb[c][0]))
                << i;
        EXPECT_GT(split.sun.irradiance()[c], 0.2 * double(joined.rest.rgb[c][0]));
    }
    options.variant = "paper";
    EXPECT_EQ(projectTableLight(image, 6, options).rest.shOrder, 8);
}

}  // namespace
}  // namespace prt
