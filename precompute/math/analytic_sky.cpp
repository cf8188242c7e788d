// Source: A. J. Preetham, P. Shirley, B. Smits, "A Practical Analytic Model for Daylight" (1999): zenith
// values and distribution coefficients of appendix A.2, transmittances of appendix A.1. The model of Hošek
// and Wilkie (2012) is not offered: its coefficients are no part of their paper's text.
#include "precompute/math/analytic_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

/// Coefficients A to E of Y, x and y, each slope·T + offset.
struct Line {
    double slope, offset;
};
constexpr Line kCoefficients[3][5] = {
    {{0.1787, -1.4630}, {-0.3554, 0.4275}, {-0.0227, 5.3251}, {0.1206, -2.5771}, {-0.0670, 0.3703}},
    {{-0.0193, -0.2592}, {-0.0665, 0.0008}, {-0.0004, 0.2125}, {-0.0641, -0.8989}, {-0.0033, 0.0452}},
    {{-0.0167, -0.2608}, {-0.0950, 0.0092}, {-0.0079, 0.2102}, {-0.0441, -1.6537}, {-0.0109, 0.0529}}};

/// Chromaticity of the zenith, rows T², T, 1, columns θ³, θ², θ, 1 of the sun's zenith angle.
constexpr double kZenithX[3][4] = {{0.00166, -0.00375, 0.00209, 0},
                                   {-0.02903, 0.06377, -0.03202, 0.00394},
                                   {0.11693, -0.21196, 0.06052, 0.25886}};
constexpr double kZenithY[3][4] = {{0.00275, -0.00610, 0.00317, 0},
                                   {-0.04214, 0.08970, -0.04153, 0.00516},
                                   {0.15346, -0.26756, 0.06670, 0.26688}};

double zenithChromaticity(const double (&table)[3][4], double turbidity, double theta) {
    double sum = 0;
    for (const auto& row : table)
        sum = sum * turbidity + ((row[0] * theta + row[1]) * theta + row[2]) * theta + row[3];
    return sum;
}

double zenithLuminance(double turbidity, double theta) {
    const double chi = (4.0 / 9 - turbidity / 120) * (kPi - 2 * theta);
    return (4.0453 * turbidity - 4.9710) * std::tan(chi) - 0.2155 * turbidity + 2.4192;
}

/// Perez' distribution: gradation from zenith to horizon times indicatrix around the sun.
double perez(const std::array<double, 5>& p, double cosZenith, double sunAngle) {
    const double cosine = std::cos(sunAngle);
    return (1 + p[0] * std::exp(p[1] / cosZenith)) *
           (1 + p[2] * std::exp(p[3] * sunAngle) + p[4] * cosine * cosine);
}

/// IEC 61966-2-1, from CIE xyY of the 2° observer.
std::array<double, 3> rec709FromXyY(double x, double y, double luminance) {
    const double bigX = luminance * x / y, bigZ = luminance * (1 - x - y) / y;
    return {3.2406 * bigX - 1.5372 * luminance - 0.4986 * bigZ,
            -0.9689 * bigX + 1.8758 * luminance + 0.0415 * bigZ,
            0.0557 * bigX - 0.2040 * luminance + 1.0570 * bigZ};
}

}  // namespace

PreethamSky::PreethamSky(double turbidity, double sunElevationRad)
    : turbidity_(turbidity), sunZenithRad_(kPi / 2 - sunElevationRad) {
    PRT_CHECK(turbidity >= 2 && turbidity <= 10);
    PRT_CHECK(sunElevationRad >= 0 && sunElevationRad <= kPi / 2 + 1e-9);
    const double zenith[3] = {zenithLuminance(turbidity, sunZenithRad_),
                              zenithChromaticity(kZenithX, turbidity, sunZenithRad_),
                              zenithChromaticity(kZenithY, turbidity, sunZenithRad_)};
    for (size_t i = 0; i < 3; ++i) {
        Distribution& distribution = distributions_[i];
        for (size_t k = 0; k < 5; ++k)
            distribution.coefficients[k] = kCoefficients[i][k].slope * turbidity + kCoefficients[i][k].offset;
        distribution.scale = zenith[i] / perez(distribution.coefficients, 1, sunZenithRad_);
    }
}

std::array<double, 3> PreethamSky::radiance(double cosZenith, double sunAngleRad) const {
    double values[3];
    for (size_t i = 0; i < 3; ++i)
        values[i] = distributions_[i].scale *
                    perez(distributions_[i].coefficients, std::max(cosZenith, 0.01), sunAngleRad);
    std::array<double, 3> colour = rec709FromXyY(values[1], values[2], values[0]);
    for (double& value : colour) value = std::max(value, 0.0);
    return colour;
}

std::array<double, 3> PreethamSky::sunIrradiance() const {
    // Of the sun above the air: a black body of 5778 K, x = 0.3262, y = 0.3354.
    constexpr double kAboveAir = 128;
    const std::array<double, 3> white = rec709FromXyY(0.3262, 0.3354, kAboveAir);
    constexpr double kMicrometres[3] = {0.610, 0.550, 0.465};
    const double zenithDeg = sunZenithRad_ * 180 / kPi;
    const double airMass = 1 / (std::cos(sunZenithRad_) + 0.15 * std::pow(93.885 - zenithDeg, -1.253));
    const double aerosols = 0.04608 * turbidity_ - 0.04586;
    std::array<double, 3> result{};
    for (size_t c = 0; c < 3; ++c)
        result[c] = white[c] * std::exp(-airMass * (0.008735 * std::pow(kMicrometres[c], -4.08) +
                                                    aerosols * std::pow(kMicrometres[c], -1.3)));
    return result;
}

}  // namespace prt
