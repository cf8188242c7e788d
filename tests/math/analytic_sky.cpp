// Preetham's sky against values worked out by hand, and over its whole range.
#include "precompute/math/analytic_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

double luminance(const std::array<double, 3>& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

TEST(PreethamSky, ZenithByHand) {
    // T = 3, sun 30° from the zenith: χ = (4/9 − 3/120)·(2π/3) = 0.87848, tan χ = 1.2058 →
    // Y = 7.1649·1.2058 − 0.6465 + 2.4192 = 10.412 kcd/m². The printed colour matrices are rounded to 4
    // digits.
    const double theta = kPi / 6, t2 = theta * theta, t3 = t2 * theta;
    const double x = 9 * (0.00166 * t3 - 0.00375 * t2 + 0.00209 * theta) +
                     3 * (-0.02903 * t3 + 0.06377 * t2 - 0.03202 * theta + 0.00394) + 0.11693 * t3 -
                     0.21196 * t2 + 0.06052 * theta + 0.25886;
    const double y = 9 * (0.00275 * t3 - 0.00610 * t2 + 0.00317 * theta) +
                     3 * (-0.04214 * t3 + 0.08970 * t2 - 0.04153 * theta + 0.00516) + 0.15346 * t3 -
                     0.26756 * t2 + 0.06670 * theta + 0.26688;
    const PreethamSky sky(3, kPi / 3);
    const std::array<double, 3> zenith = sky.radiance(1, theta);
    EXPECT_NEAR(luminance(zenith), 10.412, 1e-2);
    // Back from linear Rec. 709 to chromaticity.
    const double bigX = 0.4124 * zenith[0] + 0.3576 * zenith[1] + 0.1805 * zenith[2];
    const double bigY = luminance(zenith);
    const double bigZ = 0.0193 * zenith[0] + 0.1192 * zenith[1] + 0.9505 * zenith[2];
    EXPECT_NEAR(bigX / (bigX + bigY + bigZ), x, 1e-4);
    EXPECT_NEAR(bigY / (bigX + bigY + bigZ), y, 1e-4);
}

TEST(PreethamSky, FollowsItsDistribution) {
    // Ratios at T = 2: A = −1.1056, B = −0.2833, C = 5.2797, D = −2.3359, E = 0.2363.
    const auto perez = [](double cosZenith, double gamma) {
        return (1 - 1.1056 * std::exp(-0.2833 / cosZenith)) *
               (1 + 5.2797 * std::exp(-2.3359 * gamma) + 0.2363 * std::cos(gamma) * std::cos(gamma));
    };
    const PreethamSky sky(2, 0.6);
    const double zenith = luminance(sky.radiance(1, kPi / 2 - 0.6)) / perez(1, kPi / 2 - 0.6);
    for (const double cosZenith : {0.2, 0.5, 0.9})
        for (const double gamma : {0.3, 1.0, 1.8}) {
            const std::array<double, 3> colour = sky.radiance(cosZenith, gamma);
            if (*std::min_element(colour.begin(), colour.end()) > 0) {
                EXPECT_NEAR(luminance(colour) / perez(cosZenith, gamma), zenith, 2e-3 * zenith);
            }
        }
}

TEST(PreethamSky, IsLightEverywhere) {
    for (double turbidity = 2; turbidity <= 10; turbidity += 0.5)
        for (double elevationDeg = 0; elevationDeg <= 90; elevationDeg += 5) {
            const double elevation = elevationDeg * kPi / 180;
            const PreethamSky sky(turbidity, elevation);
            for (double height = 0; height <= 1; height += 0.05)
                for (double azimuth = 0; azimuth <= kPi; azimuth += 0.2) {
                    const double cosine = height * std::sin(elevation) + std::sqrt(1 - height * height) *
                                                                             std::cos(elevation) *
                                                                             std::cos(azimuth);
                    const auto colour = sky.radiance(height, std::acos(std::clamp(cosine, -1.0, 1.0)));
                    for (const double value : colour) {
                        ASSERT_TRUE(std::isfinite(value) && value >= 0);
                        ASSERT_LT(value, 1000);
                    }
                    ASSERT_GT(luminance(colour), 0)
                        << turbidity << ' ' << elevationDeg << ' ' << height << ' ' << azimuth;
                }
        }
}

/// Σ over the upper half of radiance · cosine, klx.
double diffuseIlluminance(const PreethamSky& sky, double elevation) {
    double sum = 0;
    constexpr int kRows = 100, kColumns = 200;
    for (int i = 0; i < kRows * kColumns; ++i) {
        const double height = (double(i / kColumns) + 0.5) / kRows,
                     azimuth = 2 * kPi * (i % kColumns) / kColumns;
        const double cosine = height * std::sin(elevation) +
                              std::sqrt(1 - height * height) * std::cos(elevation) * std::cos(azimuth);
        sum += luminance(sky.radiance(height, std::acos(cosine))) * height;
    }
    return sum * 2 * kPi / (kRows * kColumns);
}

TEST(PreethamSky, GivesWhatAClearDayGives) {
    // Clear skies at 40 to 60° give 8 to 25 klx, of which the model is known to make up to half too much; the
    // sun 60 to 110 klx on a surface that faces it.
    for (const double elevationDeg : {40.0, 60.0}) {
        const double elevation = elevationDeg * kPi / 180;
        const PreethamSky sky(3, elevation);
        EXPECT_GT(diffuseIlluminance(sky, elevation), 8);
        EXPECT_LT(diffuseIlluminance(sky, elevation), 35);
        EXPECT_GT(luminance(sky.sunIrradiance()), 60);
        EXPECT_LT(luminance(sky.sunIrradiance()), 110);
    }
}

TEST(PreethamSky, ColoursAreThoseOfTheDay) {
    // Blue overhead, a red sun in the evening, haze takes the sun's light.
    const std::array<double, 3> overhead = PreethamSky(3, 0.8).radiance(1, kPi / 2 - 0.8);
    EXPECT_GT(overhead[2], 1.5 * overhead[0]);
    double redness = 0;
    for (const double elevation : {1.4, 0.8, 0.4, 0.2, 0.1, 0.02}) {
        const std::array<double, 3> sun = PreethamSky(3, elevation).sunIrradiance();
        EXPECT_GT(sun[0] / sun[2], redness);
        redness = sun[0] / sun[2];
        EXPECT_GT(sun[0], luminance(PreethamSky(6, elevation).sunIrradiance()));
    }
    EXPECT_GT(redness, 3);
}

}  // namespace
}  // namespace prt
