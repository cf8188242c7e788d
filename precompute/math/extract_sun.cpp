// Suns by region growing around the brightest texel; the disc that stands for one has its zeroth, first and
// (isotropic) second moments. The idea of taking the sun out of a light probe is that of P. Debevec,
// "Rendering Synthetic Objects into Real Scenes" (1998); the criteria are our own.
#include "precompute/math/extract_sun.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;
using Colour = std::array<double, 3>;

double luminance(const Colour& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

class Picture {
  public:
    explicit Picture(const LatLongView& image) : image_(image) {}
    int width() const { return image_.width; }
    int height() const { return image_.height; }
    size_t texels() const { return size_t(image_.width) * size_t(image_.height); }
    Colour colour(size_t texel) const {
        const float* p = image_.rgb.data() + 3 * texel;
        return {double(p[0]), double(p[1]), double(p[2])};
    }
    int row(size_t texel) const { return int(texel / size_t(image_.width)); }
    Vec3d direction(size_t texel) const {
        return latLongDirection(double(texel % size_t(image_.width)) + 0.5, row(texel) + 0.5, image_.width,
                                image_.height);
    }
    double solidAngle(size_t texel) const {
        return latLongTexelSolidAngle(row(texel), image_.width, image_.height);
    }
    /// Second moment of a texel about its middle, rad².
    double extent(size_t texel) const {
        const double high = kPi / image_.height, wide = solidAngle(texel) / high;
        return (high * high + wide * wide) / 12;
    }
    /// Left, right, above and below, around the back and over the poles.
    std::array<size_t, 4> neighbours(size_t texel) const {
        const int w = image_.width, h = image_.height, x = int(texel % size_t(w)), y = row(texel);
        const auto at = [&](int column, int line) {
            if (line < 0 || line >= h) {
                line = std::clamp(line, 0, h - 1);
                column += w / 2;
            }
            return size_t(line) * size_t(w) + size_t((column + w) % w);
        };
        return {at(x - 1, y), at(x + 1, y), at(x, y - 1), at(x, y + 1)};
    }

  private:
    LatLongView image_;
};

double medianOf(std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

Colour medianAround(const Picture& picture, const Vec3d& centre, double inner, double outer) {
    std::array<std::vector<double>, 3> values;
    const double most = std::cos(inner), least = std::cos(outer);
    for (size_t i = 0; i < picture.texels(); ++i) {
        const double cosine = picture.direction(i).dot(centre);
        if (cosine > most || cosine < least) continue;
        const Colour colour = picture.colour(i);
        for (size_t c = 0; c < 3; ++c) values[c].push_back(colour[c]);
    }
    return {medianOf(values[0]), medianOf(values[1]), medianOf(values[2])};
}

/// The texels connected with the first whose luminance exceeds a limit, and those around them above a lower
/// one: texels on the rim of a disc show a part of it only.
/// @return  empty where they reach further from it than 2·radius, more than any disc of this radius can
std::vector<size_t> growRegion(const Picture& picture, size_t first, double limit, double rimLimit,
                               double radius) {
    const double least = std::cos(std::min(2 * radius, kPi));
    const Vec3d centre = picture.direction(first);
    std::vector<bool> seen(picture.texels());
    std::vector<size_t> region{first};
    seen[first] = true;
    for (size_t next = 0; next < region.size(); ++next)
        for (const size_t neighbour : picture.neighbours(region[next])) {
            if (seen[neighbour] || luminance(picture.colour(neighbour)) < limit) continue;
            if (picture.direction(neighbour).dot(centre) < least) return {};
            seen[neighbour] = true;
            region.push_back(neighbour);
        }
    for (size_t i = 0, core = region.size(); i < core; ++i)
        for (const size_t neighbour : picture.neighbours(region[i])) {
            if (seen[neighbour] || luminance(picture.colour(neighbour)) < rimLimit) continue;
            seen[neighbour] = true;
            region.push_back(neighbour);
        }
    return region;
}

Colour excess(const Colour& colour, const Colour& surroundings) {
    Colour result{};
    for (size_t c = 0; c < 3; ++c) result[c] = std::max(0.0, colour[c] - surroundings[c]);
    return result;
}

/// Shape of what a region has above its surroundings.
struct Shape {
    Vec3d direction = Vec3d::Zero();
    std::array<Vec3d, 3> vectors{Vec3d::Zero(), Vec3d::Zero(), Vec3d::Zero()};  // Σ L ω ΔΩ per colour
    double flux = 0, solidAngle = 0;                                            // of luminance; sr
    double secondMoment = 0, elongation = 1, reach = 0;                         // rad², ratio, rad
};

Shape measure(const Picture& picture, const std::vector<size_t>& region, const Colour& surroundings) {
    Shape shape;
    for (const size_t texel : region) {
        const Colour above = excess(picture.colour(texel), surroundings);
        const double solidAngle = picture.solidAngle(texel);
        const Vec3d direction = picture.direction(texel);
        for (size_t c = 0; c < 3; ++c) shape.vectors[c] += above[c] * solidAngle * direction;
        shape.direction += luminance(above) * solidAngle * direction;
        shape.flux += luminance(above) * solidAngle;
        shape.solidAngle += solidAngle;
    }
    if (!(shape.direction.norm() > 0)) return shape;
    shape.direction.normalize();

    Vec3d across = shape.direction.cross(Vec3d(0, 1, 0));
    if (across.norm() < 1e-6) across = Vec3d(1, 0, 0);
    across.normalize();
    const Vec3d along = across.cross(shape.direction);
    double xx = 0, xy = 0, yy = 0, extent = 0;
    for (const size_t texel : region) {
        const double weight =
            luminance(excess(picture.colour(texel), surroundings)) * picture.solidAngle(texel) / shape.flux;
        const Vec3d direction = picture.direction(texel);
        const double x = direction.dot(across), y = direction.dot(along);
        shape.reach = std::max(shape.reach, std::acos(std::min(1.0, direction.dot(shape.direction))));
        xx += weight * x * x;
        xy += weight * x * y;
        yy += weight * y * y;
        extent += weight * picture.extent(texel);
    }
    shape.secondMoment = xx + yy + extent;
    const double middle = shape.secondMoment / 2, spread = std::hypot((xx - yy) / 2, xy);
    shape.elongation = std::sqrt((middle + spread) / std::max(middle - spread, 1e-12));
    return shape;
}

std::string percent(double share) { return fmt::format("{:.2g} % of the light", 100 * share); }

std::string describe(const ExtractedSun& sun) {
    const double degree = kPi / 180;
    return fmt::format("sun of radius {:.2f} degrees at elevation {:.1f}, azimuth {:.1f}: {}",
                       sun.angularRadiusRad / degree,
                       std::asin(std::clamp(sun.direction.y(), -1.0, 1.0)) / degree,
                       std::atan2(sun.direction.x(), sun.direction.z()) / degree, percent(sun.share));
}

/// Why a region is no sun; empty where it is one.
std::string reasonAgainst(const Shape& shape, double share, double surroundings, const SunOptions& options) {
    if (share < options.minShare) return fmt::format("the brightest area gives only {}", percent(share));
    if (shape.reach > options.maxRadiusRad)
        return fmt::format("the brightest area is wider than {:.1f} degrees in radius",
                           options.maxRadiusRad * 180 / kPi);
    if (shape.flux / shape.solidAngle < options.minContrast * surroundings)
        return "the brightest area hardly exceeds its surroundings";
    if (shape.elongation > options.maxElongation)
        return fmt::format("the brightest area is {:.1f} times as long as wide", shape.elongation);
    return {};
}

}  // namespace

std::array<double, 3> ExtractedSun::irradiance() const {
    const double sine = std::sin(angularRadiusRad);
    std::array<double, 3> result = radiance;
    for (double& value : result) value *= kPi * sine * sine;
    return result;
}

SunExtraction extractSun(const LatLongView& image, const SunOptions& options) {
    PRT_CHECK(image.width > 0 && image.height > 0);
    PRT_CHECK_EQ(image.rgb.size(), size_t(image.width) * size_t(image.height) * 3);
    PRT_CHECK(options.maxRadiusRad > 0 && options.maxRadiusRad <= kPi / 4);
    const Picture picture(image);
    SunExtraction result;
    result.rest.assign(image.rgb.begin(), image.rgb.end());
    size_t brightest = 0;
    double most = 0, total = 0;
    for (size_t i = 0; i < picture.texels(); ++i) {
        const double light = luminance(picture.colour(i));
        total += light * picture.solidAngle(i);
        if (light > most) {
            most = light;
            brightest = i;
        }
    }
    if (!(total > 0)) {
        result.sun.summary = "no sun: there is no light";
        return result;
    }
    const Colour surroundings =
        medianAround(picture, picture.direction(brightest), options.maxRadiusRad, 1.6 * options.maxRadiusRad);
    const double around = luminance(surroundings);
    const std::vector<size_t> region = growRegion(picture, brightest, around + 0.05 * (most - around),
                                                  around + 0.005 * (most - around), options.maxRadiusRad);
    Shape shape = measure(picture, region, surroundings);
    if (region.empty()) {
        shape.reach = kPi;
        shape.flux = total;
    }
    const double share = shape.flux / total;
    const std::string reason = reasonAgainst(shape, share, around, options);
    if (!region.empty()) result.sun.share = share;
    if (!reason.empty() || !(shape.flux > 0)) {
        result.sun.summary = "no sun: " + (reason.empty() ? "all directions are alike" : reason);
        return result;
    }
    result.sun.found = true;
    result.sun.direction = shape.direction;
    // A disc of radius r has the second moment r²/2.
    result.sun.angularRadiusRad = std::min(std::sqrt(2 * shape.secondMoment), kPi / 4);
    const double sine = std::sin(result.sun.angularRadiusRad);
    for (size_t c = 0; c < 3; ++c)
        result.sun.radiance[c] = shape.vectors[c].dot(shape.direction) / (kPi * sine * sine);
    for (const size_t texel : region)
        for (size_t c = 0; c < 3; ++c)
            result.rest[3 * texel + c] = std::min(result.rest[3 * texel + c], float(surroundings[c]));
    result.sun.summary = describe(result.sun);
    return result;
}

}  // namespace prt
