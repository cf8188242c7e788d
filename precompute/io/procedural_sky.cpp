// CIE standard general sky.
// Sources: ISO 15469:2004 / CIE S 011/E:2003, "Spatial distribution of daylight — CIE standard general sky"
// (gradation and indicatrix functions, table 1: types 1, 12 and 13). The standard gives luminance only;
// colours, ground and the share of the sun are this file's own choice, in the range of clear days.
#include "precompute/io/procedural_sky.h"

#include <array>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/io/environment_file.h"

namespace prt {
namespace {

using Colour = std::array<double, 3>;
constexpr int kWidth = 512, kHeight = 256;
constexpr double kPi = std::numbers::pi;
constexpr double kHorizontalIrradiance = kPi;

struct SkyModel {
    double a, b;     // gradation φ(Z) = 1 + a exp(b / cos Z)
    double c, d, e;  // indicatrix f(χ) = 1 + c (exp(dχ) − exp(dπ/2)) + e cos²χ
    double sunElevationDeg;
    double sunShare;      // of the horizontal irradiance
    double sunRadiusDeg;  // of the smeared disc
    Colour zenith, horizon, glow, sun, ground;
};

// The real sun is 0.53° wide; smeared to this it still reads as one and fits on a table texel.
constexpr SkyModel kClear{-1,
                          -0.32,
                          10,
                          -3,
                          0.45,
                          45,
                          0.75,
                          2.5,
                          {0.30, 0.52, 1.00},
                          {0.72, 0.86, 1.00},
                          {1.00, 0.96, 0.88},
                          {1.00, 0.93, 0.80},
                          {0.22, 0.20, 0.16}};
constexpr SkyModel kSunset{-1,
                           -0.32,
                           16,
                           -3,
                           0.30,
                           8,
                           0.35,
                           3,
                           {0.26, 0.36, 0.70},
                           {1.00, 0.62, 0.40},
                           {1.00, 0.50, 0.20},
                           {1.00, 0.55, 0.25},
                           {0.20, 0.17, 0.14}};
constexpr SkyModel kOvercast{4,
                             -0.7,
                             0,
                             -1,
                             0,
                             45,
                             0,
                             2.5,
                             {0.95, 0.98, 1.00},
                             {0.95, 0.98, 1.00},
                             {0.95, 0.98, 1.00},
                             {1, 1, 1},
                             {0.22, 0.21, 0.19}};

double gradation(const SkyModel& sky, double cosZenith) {
    return 1 + sky.a * std::exp(sky.b / std::max(cosZenith, 1e-4));
}

double indicatrix(const SkyModel& sky, double angleRad) {
    const double cosine = std::cos(angleRad);
    return 1 + sky.c * (std::exp(sky.d * angleRad) - std::exp(sky.d * kPi / 2)) + sky.e * cosine * cosine;
}

Colour mix(const Colour& a, const Colour& b, double t) {
    return {a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t};
}

Colour skyRadiance(const SkyModel& sky, const Vec3d& direction, double sunAngle) {
    const double luminance = gradation(sky, direction.y()) * indicatrix(sky, sunAngle);
    const double haze = std::pow(1 - std::min(direction.y(), 1.0), 4);
    Colour tint = mix(sky.zenith, sky.horizon, haze);
    tint = mix(tint, sky.glow, std::exp(-3 * sunAngle));
    // The tint changes colour, not the standard's luminance (Rec. 709 weights).
    const double weight = 0.2126 * tint[0] + 0.7152 * tint[1] + 0.0722 * tint[2];
    for (double& value : tint) value *= luminance / weight;
    return tint;
}

// Falls smoothly to zero at the rim, so that no texel edge shows.
double discProfile(double angleRad, double radiusRad) {
    const double t = angleRad / radiusRad;
    return t < 1 ? (1 - t * t) * (1 - t * t) : 0;
}

/// Two layers over the upper half: the sky, and the disc of the sun (each [height/2×width×3]).
struct Layers {
    std::vector<double> sky, sun;
    double skyIrradiance = 0, sunIrradiance = 0;  // on the ground, mean of the colours
};

Layers evaluateLayers(const SkyModel& model) {
    constexpr int kSubsamples = 4;
    const double elevation = model.sunElevationDeg * kPi / 180, radius = model.sunRadiusDeg * kPi / 180;
    // South-east of the viewer who looks along −Z: lit from the right, in front of the model.
    const Vec3d sun(std::cos(elevation) * std::sin(0.7), std::sin(elevation),
                    std::cos(elevation) * std::cos(0.7));
    Layers layers;
    layers.sky.assign(size_t(kHeight / 2) * kWidth * 3, 0.0);
    layers.sun = layers.sky;
    for (int y = 0; y < kHeight / 2; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const size_t texel = (size_t(y) * kWidth + size_t(x)) * 3;
            for (int s = 0; s < kSubsamples * kSubsamples; ++s) {
                const double dx = (s % kSubsamples + 0.5) / kSubsamples;
                const double dy = (s / kSubsamples + 0.5) / kSubsamples;
                const Vec3d direction = latLongDirection(x + dx, y + dy, kWidth, kHeight);
                const double angle = std::acos(std::min(1.0, direction.dot(sun)));
                const Colour radiance = skyRadiance(model, direction, angle);
                const double disc = discProfile(angle, radius);
                for (size_t c = 0; c < 3; ++c) {
                    layers.sky[texel + c] += radiance[c] / (kSubsamples * kSubsamples);
                    layers.sun[texel + c] += disc * model.sun[c] / (kSubsamples * kSubsamples);
                }
            }
            const double weight = latLongTexelSolidAngle(y, kWidth, kHeight) *
                                  latLongDirection(x + 0.5, y + 0.5, kWidth, kHeight).y() / 3;
            for (size_t c = 0; c < 3; ++c) {
                layers.skyIrradiance += layers.sky[texel + c] * weight;
                layers.sunIrradiance += layers.sun[texel + c] * weight;
            }
        }
    return layers;
}

FloatImage makeSky(const SkyModel& model) {
    const Layers layers = evaluateLayers(model);
    const double skyScale = kHorizontalIrradiance * (1 - model.sunShare) / layers.skyIrradiance;
    const double sunScale = kHorizontalIrradiance * model.sunShare / layers.sunIrradiance;
    FloatImage image{kWidth, kHeight, 3, std::vector<float>(size_t(kWidth) * kHeight * 3)};
    for (size_t i = 0; i < layers.sky.size(); ++i)
        image.pixels[i] = float(skyScale * layers.sky[i] + sunScale * layers.sun[i]);
    // A diffuse ground: radiance = albedo · E / π.
    for (size_t i = layers.sky.size(); i < image.pixels.size(); ++i)
        image.pixels[i] = float(model.ground[i % 3] * kHorizontalIrradiance / kPi);
    return image;
}

}  // namespace

const std::vector<std::string>& proceduralSkyNames() {
    static const std::vector<std::string> names{"clear", "overcast", "sunset", "uniform"};
    return names;
}

FloatImage makeProceduralSky(const std::string& name) {
    if (name == "clear") return makeSky(kClear);
    if (name == "sunset") return makeSky(kSunset);
    if (name == "overcast") return makeSky(kOvercast);
    PRT_CHECK(name == "uniform");
    return {kWidth, kHeight, 3, std::vector<float>(size_t(kWidth) * kHeight * 3, 1.0f)};
}

}  // namespace prt
