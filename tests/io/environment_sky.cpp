// Skies with parameters.
#include <cmath>
#include <functional>
#include <numbers>

#include "precompute/base/error.h"
#include "precompute/io/environment_file.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

using testing::HasSubstr;
constexpr double kPi = std::numbers::pi;

std::string refusal(const std::string& sky) {
    try {
        loadEnvironment(sky);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "no UsageError";
}

/// Where the light of the brightest texels lies.
Vec3d brightestDirection(const FloatImage& image) {
    const float most = *std::max_element(image.pixels.begin(), image.pixels.end());
    Vec3d sum = Vec3d::Zero();
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (image.at(x, y)[0] > most / 4)
                sum += double(image.at(x, y)[0]) * latLongTexelSolidAngle(y, image.width, image.height) *
                       latLongDirection(x + 0.5, y + 0.5, image.width, image.height);
    return sum.normalized();
}

TEST(PreethamEnvironment, SunIsWhereItIsPut) {
    for (const auto& [elevation, azimuth] : {std::array{40.0, 120.0}, {15.0, -70.0}, {75.0, 200.0}}) {
        const Environment sky =
            loadEnvironment("sky:preetham?turbidity=4&elevation=" + std::to_string(elevation) +
                            "&azimuth=" + std::to_string(azimuth));
        const double e = elevation * kPi / 180, a = azimuth * kPi / 180;
        const Vec3d expected(std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a));
        // A disc of 1° on texels of 0.7°.
        EXPECT_LT(std::acos(brightestDirection(sky.image).dot(expected)), 0.1 * kPi / 180);
        EXPECT_TRUE(hasSun(sky.view()));
    }
    EXPECT_FALSE(hasSun(loadEnvironment("sky:preetham?sun=0").view()));
}

TEST(PreethamEnvironment, HasNoBlackTexels) {
    for (const char* parameters : {"?turbidity=2&elevation=0", "?turbidity=10&elevation=0",
                                   "?turbidity=2&elevation=90", "?turbidity=10&elevation=90", ""}) {
        const Environment sky = loadEnvironment(std::string("sky:preetham") + parameters);
        EXPECT_EQ(sky.clampedNegative + sky.clampedNotFinite, 0u);
        for (int y = 0; y < 256; ++y)
            for (int x = 0; x < 512; ++x) {
                const float* p = sky.image.at(x, y);
                ASSERT_GT(p[0] + p[1] + p[2], 0.0f) << parameters << ' ' << x << ' ' << y;
            }
    }
}

TEST(PreethamEnvironment, SizeOfTheDiscDoesNotChangeTheLight) {
    const auto sh = [](const char* radius) {
        return projectEnvironment(loadEnvironment(std::string("sky:preetham?sun-radius=") + radius).view(),
                                  3);
    };
    const EnvironmentSh narrow = sh("0.5"), wide = sh("3");
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < 9; ++i)
            EXPECT_NEAR(narrow.rgb[c][i], wide.rgb[c][i], 0.02f * narrow.rgb[c][0]) << c << ' ' << i;
}

TEST(ConstantEnvironment, IsWhatIsAsked) {
    const Environment sky = loadEnvironment("sky:constant?r=0.5&b=3");
    EXPECT_EQ(sky.name, "constant-r-0.5-b-3");
    EXPECT_EQ(sky.source, "sky:constant?r=0.5&b=3");
    for (size_t i = 0; i < sky.image.pixels.size(); i += 3) {
        ASSERT_EQ(sky.image.pixels[i], 0.5f);
        ASSERT_EQ(sky.image.pixels[i + 1], 1.0f);
        ASSERT_EQ(sky.image.pixels[i + 2], 3.0f);
    }
}

TEST(GradientEnvironment, HasTwoBands) {
    const Environment sky = loadEnvironment("sky:gradient?top=2,0,1&bottom=0,1,1");
    const EnvironmentSh sh = projectEnvironment(sky.view(), 6);
    const double tops[3] = {2, 0, 1}, bottoms[3] = {0, 1, 1};
    for (size_t c = 0; c < 3; ++c)
        for (int i = 0; i < 36; ++i) {
            // (t + b)/2 + (t − b)/2·y: 1 = √4π Y_00, y = −√(4π/3) Y_1,-1.
            double expected = 0;
            if (i == 0) expected = std::sqrt(4 * kPi) * (tops[c] + bottoms[c]) / 2;
            if (i == shIndex(1, -1)) expected = -std::sqrt(4 * kPi / 3) * (tops[c] - bottoms[c]) / 2;
            // Y at the middles of texels of π/256.
            EXPECT_NEAR(double(sh.rgb[c][size_t(i)]), expected, 2e-3) << c << ' ' << i;
        }
}

TEST(SkyParameters, AreChecked) {
    EXPECT_THAT(refusal("sky:preetham?turbidity=1.9"),
                testing::AllOf(HasSubstr("turbidity=1.9"), HasSubstr("2..10")));
    EXPECT_THAT(refusal("sky:preetham?turbidity=10.1"), HasSubstr("2..10"));
    EXPECT_THAT(refusal("sky:preetham?elevation=-1"), HasSubstr("0..90"));
    EXPECT_THAT(refusal("sky:preetham?elevation=nan"), HasSubstr("0..90"));
    EXPECT_THAT(refusal("sky:preetham?elevation="), HasSubstr("0..90"));
    EXPECT_THAT(refusal("sky:preetham?elevation"), HasSubstr("0..90"));
    EXPECT_THAT(refusal("sky:preetham?elevation=4x"), HasSubstr("0..90"));
    EXPECT_THAT(refusal("sky:preetham?elevation=1,2"), HasSubstr("0..90"));
    EXPECT_THAT(refusal("sky:preetham?elevation=3&elevation=4"), HasSubstr("twice"));
    EXPECT_THAT(refusal("sky:preetham?cloud=1"),
                testing::AllOf(HasSubstr("no parameter \"cloud\""), HasSubstr("sun-radius=0.5..10")));
    EXPECT_THAT(refusal("sky:preetham?"), HasSubstr("no parameter"));
    EXPECT_THAT(refusal("sky:preetham?&"), HasSubstr("no parameter"));
    EXPECT_THAT(refusal("sky:gradient?top=1,2"), HasSubstr("3 numbers"));
    EXPECT_THAT(refusal("sky:gradient?top=1,2,"), HasSubstr("3 numbers"));
    EXPECT_THAT(refusal("sky:constant?r=-1"), HasSubstr("0..65504"));
    EXPECT_THAT(refusal("sky:clear?turbidity=3"), HasSubstr("it takes none"));
    EXPECT_THROW(loadEnvironment("sky:hosek?turbidity=3"), InputError);
}

}  // namespace
}  // namespace prt
