// CIE standard general sky, Preetham's, and light without a sun.
// Sources: ISO 15469:2004 / CIE S 011/E:2003, "Spatial distribution of daylight — CIE standard general sky"
// (gradation and indicatrix functions, table 1: types 1, 12 and 13). The standard gives luminance only;
// colours, ground and the share of the sun are this file's own choice, in the range of clear days. A. J.
// Preetham, P. Shirley, B. Smits, "A Practical Analytic Model for Daylight" (1999).
#include "precompute/io/procedural_sky.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/io/environment_file.h"
#include "precompute/math/analytic_sky.h"

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
    Colour skyIrradiance{}, sunIrradiance{};  // on the ground
};

/// What is above the horizon.
struct Dome {
    std::function<Colour(const Vec3d& direction, double sunAngleRad)> radiance;
    double sunElevationRad = 0, sunAzimuthRad = 0, sunRadiusRad = 1;
    Colour sun{};  // radiance at the middle of the disc
};

Layers evaluateLayers(const Dome& dome) {
    constexpr int kSubsamples = 4;
    const double across = std::cos(dome.sunElevationRad);
    const Vec3d sun(across * std::sin(dome.sunAzimuthRad), std::sin(dome.sunElevationRad),
                    across * std::cos(dome.sunAzimuthRad));
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
                const Colour radiance = dome.radiance(direction, angle);
                const double disc = discProfile(angle, dome.sunRadiusRad);
                for (size_t c = 0; c < 3; ++c) {
                    layers.sky[texel + c] += radiance[c] / (kSubsamples * kSubsamples);
                    layers.sun[texel + c] += disc * dome.sun[c] / (kSubsamples * kSubsamples);
                }
            }
            const double weight = latLongTexelSolidAngle(y, kWidth, kHeight) *
                                  latLongDirection(x + 0.5, y + 0.5, kWidth, kHeight).y();
            for (size_t c = 0; c < 3; ++c) {
                layers.skyIrradiance[c] += layers.sky[texel + c] * weight;
                layers.sunIrradiance[c] += layers.sun[texel + c] * weight;
            }
        }
    return layers;
}

double meanOf(const Colour& colour) { return (colour[0] + colour[1] + colour[2]) / 3; }

/// Both layers above, a diffuse ground below: radiance = albedo · E / π.
FloatImage composeSky(const Layers& layers, double skyScale, double sunScale, const Colour& ground) {
    FloatImage image{kWidth, kHeight, 3, std::vector<float>(size_t(kWidth) * kHeight * 3)};
    for (size_t i = 0; i < layers.sky.size(); ++i)
        image.pixels[i] = float(skyScale * layers.sky[i] + sunScale * layers.sun[i]);
    for (size_t i = layers.sky.size(); i < image.pixels.size(); ++i) image.pixels[i] = float(ground[i % 3]);
    return image;
}

FloatImage makeCieSky(const SkyModel& model) {
    Dome dome;
    dome.radiance = [&](const Vec3d& direction, double angle) {
        return skyRadiance(model, direction, angle);
    };
    dome.sunElevationRad = model.sunElevationDeg * kPi / 180;
    dome.sunAzimuthRad = 0.7;  // lit from the right for a viewer who looks along −Z, in front of the model
    dome.sunRadiusRad = model.sunRadiusDeg * kPi / 180;
    dome.sun = model.sun;
    const Layers layers = evaluateLayers(dome);
    Colour ground = model.ground;
    for (double& value : ground) value *= kHorizontalIrradiance / kPi;
    return composeSky(layers, kHorizontalIrradiance * (1 - model.sunShare) / meanOf(layers.skyIrradiance),
                      kHorizontalIrradiance * model.sunShare / meanOf(layers.sunIrradiance), ground);
}

// ---- parameters

struct Parameter {
    std::string name;
    std::vector<double> values;  // by default; as many must be given
    double least, most;
};
using Parameters = std::map<std::string, std::vector<double>>;

std::vector<double> parseNumbers(std::string_view text) {
    std::vector<double> numbers;
    for (size_t at = 0; at <= text.size();) {
        const size_t end = std::min(text.find(',', at), text.size());
        double value = 0;
        const auto [stop, error] = std::from_chars(text.data() + at, text.data() + end, value);
        if (error != std::errc() || stop != text.data() + end) return {};
        numbers.push_back(value);
        at = end + 1;
    }
    return numbers;
}

std::string describe(const Parameter& parameter) {
    std::string text = parameter.name + "=";
    if (parameter.values.size() > 1)
        text += fmt::format("{} numbers with commas between, each ", parameter.values.size());
    return text + fmt::format("{}..{}", parameter.least, parameter.most);
}

/// @param request  NAME?KEY=VALUE&KEY=VALUE
Parameters parseParameters(const std::string& request, const std::vector<Parameter>& known) {
    std::string list;
    for (const Parameter& parameter : known) list += (list.empty() ? "" : ", ") + describe(parameter);
    const std::string where = "sky:" + request;
    Parameters found;
    const size_t start = request.find('?');
    for (size_t at = start; at != std::string::npos && at < request.size();) {
        const size_t end = std::min(request.find('&', at + 1), request.size());
        const std::string item = request.substr(at + 1, end - at - 1);
        at = end;
        const std::string key = item.substr(0, item.find('='));
        const auto parameter =
            std::find_if(known.begin(), known.end(), [&](const Parameter& p) { return p.name == key; });
        if (parameter == known.end())
            throw UsageError(where, fmt::format("has no parameter \"{}\"", key),
                             list.empty() ? "it takes none" : "use " + list);
        const std::vector<double> values =
            key == item ? std::vector<double>() : parseNumbers(std::string_view(item).substr(key.size() + 1));
        if (values.size() != parameter->values.size() ||
            !std::all_of(values.begin(), values.end(),
                         [&](double v) { return v >= parameter->least && v <= parameter->most; }))
            throw UsageError(where, fmt::format("\"{}\" is out of range", item),
                             "give " + describe(*parameter));
        if (!found.emplace(key, values).second)
            throw UsageError(where, fmt::format("gives \"{}\" twice", key));
    }
    for (const Parameter& parameter : known) found.emplace(parameter.name, parameter.values);
    return found;
}

FloatImage makePreethamSky(const Parameters& given) {
    const auto number = [&](const char* name) { return given.at(name)[0]; };
    const double radian = kPi / 180;
    const PreethamSky model(number("turbidity"), number("elevation") * radian);
    Dome dome;
    dome.radiance = [&](const Vec3d& direction, double angle) {
        return model.radiance(direction.y(), angle);
    };
    dome.sunElevationRad = number("elevation") * radian;
    dome.sunAzimuthRad = number("azimuth") * radian;
    dome.sunRadiusRad = number("sun-radius") * radian;
    dome.sun = model.sunIrradiance();
    // discProfile integrates to a third of the disc.
    const double spread = number("sun") / (2 * kPi * (1 - std::cos(dome.sunRadiusRad)) / 3);
    for (double& value : dome.sun) value *= spread;
    const Layers layers = evaluateLayers(dome);
    Colour irradiance{};
    for (size_t c = 0; c < 3; ++c) irradiance[c] = layers.skyIrradiance[c] + layers.sunIrradiance[c];
    const double scale = kHorizontalIrradiance / meanOf(irradiance);
    Colour ground{};
    for (size_t c = 0; c < 3; ++c) ground[c] = number("ground") * scale * irradiance[c] / kPi;
    return composeSky(layers, scale, scale, ground);
}

FloatImage makeGradient(const std::vector<double>& top, const std::vector<double>& bottom) {
    FloatImage image{kWidth, kHeight, 3, std::vector<float>(size_t(kWidth) * kHeight * 3)};
    for (int y = 0; y < kHeight; ++y) {
        // Its mean over the texels of a row.
        const double height = (std::cos(kPi * y / kHeight) + std::cos(kPi * (y + 1) / kHeight)) / 2;
        for (int x = 0; x < kWidth; ++x)
            for (size_t c = 0; c < 3; ++c)
                image.at(x, y)[c] = float(bottom[c] + (top[c] - bottom[c]) * (1 + height) / 2);
    }
    return image;
}

/// @return  of a sky that takes any
std::vector<Parameter> parametersOf(const std::string& name) {
    constexpr double kMost = 65504;  // of a half
    if (name == "preetham")
        return {{"turbidity", {3}, 2, 10}, {"elevation", {40}, 0, 90}, {"azimuth", {40}, -360, 360},
                {"ground", {0.2}, 0, 1},   {"sun", {1}, 0, 1},         {"sun-radius", {1}, 0.5, 10}};
    if (name == "constant") return {{"r", {1}, 0, kMost}, {"g", {1}, 0, kMost}, {"b", {1}, 0, kMost}};
    if (name == "gradient")
        return {{"top", {1, 1.1, 1.2}, 0, kMost}, {"bottom", {0.55, 0.5, 0.45}, 0, kMost}};
    return {};
}

}  // namespace

const std::vector<std::string>& proceduralSkyNames() {
    static const std::vector<std::string> names{"clear",    "overcast", "sunset",  "uniform",
                                                "preetham", "constant", "gradient"};
    return names;
}

FloatImage makeProceduralSky(const std::string& request) {
    const std::string name = request.substr(0, request.find('?'));
    const auto& names = proceduralSkyNames();
    if (std::find(names.begin(), names.end(), name) == names.end())
        throw InputError("sky:" + request, "unknown sky",
                         fmt::format("use one of sky:{}", fmt::join(names, ", sky:")));
    const Parameters given = parseParameters(request, parametersOf(name));
    if (name == "clear") return makeCieSky(kClear);
    if (name == "sunset") return makeCieSky(kSunset);
    if (name == "overcast") return makeCieSky(kOvercast);
    if (name == "preetham") return makePreethamSky(given);
    if (name == "gradient") return makeGradient(given.at("top"), given.at("bottom"));
    Colour colour{1, 1, 1};
    if (name == "constant") colour = {given.at("r")[0], given.at("g")[0], given.at("b")[0]};
    const std::vector<double> same(colour.begin(), colour.end());
    return makeGradient(same, same);
}

}  // namespace prt
