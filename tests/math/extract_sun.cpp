// Suns put into made environments are found again, and no light is lost.
#include "precompute/math/extract_sun.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/math/directions.h"

namespace prt {
namespace {

using testing::HasSubstr;
constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
using Colour = std::array<double, 3>;

struct Image {
    int width, height;
    std::vector<float> rgb;
    double discSr = 0;  // of the disc as drawn
    LatLongView view() const { return {width, height, rgb}; }
};

/// A sky that is brighter above, and a disc on top of it, as means over 16×16 directions per texel.
Image skyWithDisc(int height, const Vec3d& sun, double radius, const Colour& radiance, double stretch = 1) {
    Image image{2 * height, height, {}, 0};
    const Vec3d across = sun.cross(std::abs(sun.y()) < 0.9 ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0)).normalized();
    const Vec3d along = across.cross(sun);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < image.width; ++x) {
            double inside = 0;
            const Vec3d middle = latLongDirection(x + 0.5, y + 0.5, image.width, height);
            if (middle.dot(sun) > std::cos(stretch * radius + 3 * kPi / height))
                for (int i = 0; i < 256; ++i) {
                    // Rows of equal solid angle.
                    const double top = std::cos(kPi * y / height), bottom = std::cos(kPi * (y + 1) / height);
                    const double up = top + (bottom - top) * (double(i / 16) + 0.5) / 16;
                    const Vec3d d = latLongDirection(x + (i % 16 + 0.5) / 16, std::acos(up) / kPi * height,
                                                     image.width, height);
                    const double u = d.dot(across) / stretch, v = d.dot(along);
                    inside += d.dot(sun) > 0 && std::hypot(u, v) < std::sin(radius) ? 1.0 / 256 : 0.0;
                }
            image.discSr += inside * latLongTexelSolidAngle(y, image.width, height);
            for (size_t c = 0; c < 3; ++c)
                image.rgb.push_back(
                    float((0.6 + 0.2 * double(c)) * (1 + 0.5 * middle.y()) + inside * radiance[c]));
        }
    return image;
}

/// Direction times solid angle of every texel.
std::vector<Vec3d> weightedDirections(int width, int height) {
    std::vector<Vec3d> result;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            result.push_back(latLongTexelSolidAngle(y, width, height) *
                             latLongDirection(x + 0.5, y + 0.5, width, height));
    return result;
}

Colour irradianceOf(const std::vector<Vec3d>& directions, std::span<const float> rgb, const Vec3d& normal) {
    Colour sum{};
    for (size_t i = 0; i < directions.size(); ++i) {
        const double weight = std::max(0.0, directions[i].dot(normal));
        for (size_t c = 0; c < 3; ++c) sum[c] += weight * double(rgb[3 * i + c]);
    }
    return sum;
}

/// Irradiance from a disc, by rings of equal solid angle.
Colour discIrradiance(const ExtractedSun& sun, const Vec3d& normal) {
    const Frame frame = frameAround(sun.direction.cast<float>());
    const Vec3d tangent = frame.tangent.cast<double>(), bitangent = frame.bitangent.cast<double>();
    constexpr int kRings = 40, kSectors = 80;
    double sum = 0;
    for (int i = 0; i < kRings * kSectors; ++i) {
        const double cosine =
            1 - (1 - std::cos(sun.angularRadiusRad)) * (double(i / kSectors) + 0.5) / kRings;
        const double sine = std::sqrt(1 - cosine * cosine), turn = 2 * kPi * (i % kSectors) / kSectors;
        sum += std::max(0.0, normal.dot(cosine * sun.direction + sine * std::cos(turn) * tangent +
                                        sine * std::sin(turn) * bitangent));
    }
    sum *= 2 * kPi * (1 - std::cos(sun.angularRadiusRad)) / (kRings * kSectors);
    return {sum * sun.radiance[0], sum * sun.radiance[1], sum * sun.radiance[2]};
}

/// Largest relative change of irradiance at many normals, those with the disc on their horizon among them.
double lightLost(const Image& image, const SunExtraction& extraction) {
    std::vector<Vec3d> normals;
    for (const Vec3f& d : sphericalFibonacci(40)) normals.push_back(d.cast<double>());
    const Frame frame = frameAround(extraction.sun.direction.cast<float>());
    for (int i = 0; i < 8; ++i)
        normals.push_back(
            (std::cos(i * kPi / 4) * frame.tangent + std::sin(i * kPi / 4) * frame.bitangent).cast<double>());
    const std::vector<Vec3d> directions = weightedDirections(image.width, image.height);
    double worst = 0;
    for (const Vec3d& normal : normals) {
        const Colour before = irradianceOf(directions, image.rgb, normal);
        const Colour rest = irradianceOf(directions, extraction.rest, normal);
        const Colour disc = discIrradiance(extraction.sun, normal);
        for (size_t c = 0; c < 3; ++c)
            worst = std::max(worst, std::abs(rest[c] + disc[c] - before[c]) / before[c]);
    }
    return worst;
}

TEST(ExtractSun, FindsADiscWhereverItIs) {
    const Colour radiance{900, 700, 400};
    for (const Vec3d& towards : {Vec3d(1, 1, 1), Vec3d(0, 0.2, 1), Vec3d(0.01, 0.3, -1), Vec3d(0, 1, 0),
                                 Vec3d(0.02, -1, 0.01), Vec3d(-1, 0, 0)})
        for (const double radiusDeg : {1.0, 2.5, 4.0}) {
            SCOPED_TRACE(::testing::Message() << towards.transpose() << ", " << radiusDeg);
            const Vec3d sun = towards.normalized();
            const double radius = radiusDeg * kDegree;
            const Image image = skyWithDisc(256, sun, radius, radiance);
            const SunExtraction extraction = extractSun(image.view());
            ASSERT_TRUE(extraction.sun.found) << extraction.sun.summary;
            EXPECT_THAT(extraction.sun.summary, HasSubstr("sun of radius"));
            EXPECT_LT(std::acos(std::min(1.0, extraction.sun.direction.dot(sun))), 0.05 * kDegree);
            // Drawing it on texels of h = 0.7°, and taking these for squares, adds twice their second moment,
            // h²/6; r²/2 is a disc's.
            const double texel = kPi / 256, widest = std::sqrt(radius * radius + 4 * texel * texel / 6);
            EXPECT_GT(extraction.sun.angularRadiusRad, 0.97 * radius);
            EXPECT_LT(extraction.sun.angularRadiusRad, 1.03 * widest);
            for (size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(extraction.sun.irradiance()[c] / (radiance[c] * image.discSr), 1, 0.02);
            EXPECT_LT(lightLost(image, extraction), 0.01);
            // The sky stays where the sun was.
            for (const float value : extraction.rest) ASSERT_LT(value, 1.5f + 0.005f * 900);
        }
}

TEST(ExtractSun, OfOneTexel) {
    Image image{64, 32, std::vector<float>(64 * 32 * 3, 1.0f), 0};
    for (size_t c = 0; c < 3; ++c) image.rgb[(10 * 64 + 63) * 3 + c] = 5000;
    const SunExtraction extraction = extractSun(image.view());
    ASSERT_TRUE(extraction.sun.found) << extraction.sun.summary;
    EXPECT_LT((extraction.sun.direction - latLongDirection(63.5, 10.5, 64, 32)).norm(), 1e-12);
    EXPECT_EQ(extraction.rest, std::vector<float>(64 * 32 * 3, 1.0f));
    const double expected = 4999 * latLongTexelSolidAngle(10, 64, 32);
    EXPECT_NEAR(extraction.sun.irradiance()[0], expected, 1e-9 * expected);
    EXPECT_NEAR(extraction.sun.share, expected / (expected + 4 * kPi), 1e-6);
}

TEST(ExtractSun, SaysWhyThereIsNone) {
    const auto summaryOf = [](const Image& image) {
        const SunExtraction extraction = extractSun(image.view());
        EXPECT_FALSE(extraction.sun.found);
        EXPECT_EQ(extraction.rest, image.rgb);
        return extraction.sun.summary;
    };
    EXPECT_THAT(summaryOf({8, 4, std::vector<float>(96, 0.0f), 0}), HasSubstr("there is no light"));
    EXPECT_THAT(summaryOf({64, 32, std::vector<float>(64 * 32 * 3, 1.0f), 0}), HasSubstr("no sun: "));
    const Vec3d sun = Vec3d(1, 1, 1).normalized();
    EXPECT_THAT(summaryOf(skyWithDisc(128, sun, 8 * kDegree, {50, 50, 50})),
                HasSubstr("wider than 5.0 degrees"));
    EXPECT_THAT(summaryOf(skyWithDisc(128, sun, 30 * kDegree, {50, 50, 50})), HasSubstr("wider than"));
    EXPECT_THAT(summaryOf(skyWithDisc(128, sun, 2 * kDegree, {5, 5, 5})), HasSubstr("gives only"));
    EXPECT_THAT(summaryOf(skyWithDisc(256, sun, 1 * kDegree, {2000, 2000, 2000}, 4)),
                HasSubstr("times as long"));
    // What else would be asked of it is an option.
    SunOptions options;
    options.minShare = 0.001;
    options.minContrast = 1;
    EXPECT_TRUE(extractSun(skyWithDisc(128, sun, 2 * kDegree, {5, 5, 5}).view(), options).sun.found);
}

}  // namespace
}  // namespace prt
