// The suns of skies and of photographed environments.
#include <cmath>
#include <numbers>

#include "precompute/io/environment_file.h"
#include "precompute/math/extract_sun.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

/// Σ L ω ΔΩ of a colour: what the irradiance of surfaces that see all of a light depends on, as n·v.
Vec3d lightVector(const LatLongView& image, size_t colour) {
    Vec3d sum = Vec3d::Zero();
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            sum += double(image.rgb[size_t(y * image.width + x) * 3 + colour]) *
                   latLongTexelSolidAngle(y, image.width, image.height) *
                   latLongDirection(x + 0.5, y + 0.5, image.width, image.height);
    return sum;
}

double totalLight(const LatLongView& image, size_t colour) {
    double sum = 0;
    for (size_t i = 0; i < image.rgb.size() / 3; ++i)
        sum += double(image.rgb[3 * i + colour]) *
               latLongTexelSolidAngle(int(i / size_t(image.width)), image.width, image.height);
    return sum;
}

void expectConserved(const Environment& environment, const SunExtraction& extraction) {
    const LatLongView rest{environment.image.width, environment.image.height, extraction.rest};
    for (size_t c = 0; c < 3; ++c) {
        const Vec3d moved = lightVector(environment.view(), c) - lightVector(rest, c);
        const Vec3d disc = extraction.sun.irradiance()[c] * extraction.sun.direction;
        // Of a surface turned anyhow, against the light of all directions, a quarter of which it receives.
        EXPECT_LT((moved - disc).norm(), 0.01 * totalLight(environment.view(), c) / 4) << environment.name;
    }
}

TEST(ExtractSunOf, Skies) {
    for (const std::string name : {"sky:clear", "sky:sunset", "sky:preetham", "sky:preetham?elevation=3"}) {
        const Environment sky = loadEnvironment(name);
        const SunExtraction extraction = extractSun(sky.view());
        ASSERT_TRUE(extraction.sun.found) << name << ": " << extraction.sun.summary;
        expectConserved(sky, extraction);
        EXPECT_FALSE(hasSun({512, 256, extraction.rest})) << name;
    }
    const ExtractedSun clear = extractSun(loadEnvironment("sky:clear").view()).sun;
    EXPECT_NEAR(std::asin(clear.direction.y()) * 180 / kPi, 45, 0.05);
    for (const char* name : {"sky:overcast", "sky:uniform", "sky:gradient", "sky:preetham?sun=0"})
        EXPECT_FALSE(extractSun(loadEnvironment(name).view()).sun.found) << name;
}

TEST(ExtractSunOf, PhotographedEnvironments) {
    const std::filesystem::path folder = std::filesystem::path(PRT_SOURCE_DIR) / "assets" / "hdri";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "tools/fetch-assets was not run";
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() != ".exr") continue;
        ::testing::internal::CaptureStderr();
        const Environment environment = loadEnvironment(entry.path().string());
        ::testing::internal::GetCapturedStderr();
        const SunExtraction extraction = extractSun(environment.view());
        ++count;
        RecordProperty(environment.name, extraction.sun.summary);
        std::printf("%s: %s\n", environment.name.c_str(), extraction.sun.summary.c_str());
        if (extraction.sun.found) expectConserved(environment, extraction);
    }
    EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace prt
