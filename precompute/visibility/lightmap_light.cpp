// Importance sampling of an environment by rows and columns [PharrJakobHumphreys2016, Sec. 14.2.4].
#include "precompute/visibility/lightmap_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

// Of ascending shares: the interval that u falls into, and the place in it, 0..1.
template <class Share>
std::pair<int, double> findInterval(const Share* upTo, int count, double u) {
    int k = int(std::upper_bound(upTo, upTo + count, Share(u)) - upTo);
    if (k >= count) k = int(std::lower_bound(upTo, upTo + count, upTo[count - 1]) - upTo);
    const double low = k > 0 ? double(upTo[k - 1]) : 0.0, high = double(upTo[k]);
    return {k, high > low ? std::clamp((u - low) / (high - low), 0.0, 1.0) : 0.5};
}

double heightOfRowEdge(double y, int height) { return std::cos(kPi * y / height); }

}  // namespace

EnvironmentSampler::EnvironmentSampler(const LatLongView& image, double rotationRad)
    : image_(image), rotationRad_(rotationRad) {
    PRT_CHECK(image.width > 0 && image.height > 0);
    PRT_CHECK_EQ(image.rgb.size(), size_t(image.width) * size_t(image.height) * 3);
    const auto width = size_t(image.width);
    texels_.resize(width * size_t(image.height));
    std::vector<double> upTo(width);
    for (int y = 0; y < image.height; ++y) {
        double sum = 0;
        for (size_t x = 0; x < width; ++x) {
            const float* rgb = &image.rgb[(size_t(y) * width + x) * 3];
            upTo[x] = sum += double(rgb[0]) + double(rgb[1]) + double(rgb[2]);
        }
        for (size_t x = 0; x < width; ++x)
            texels_[size_t(y) * width + x] = float(sum > 0 ? upTo[x] / sum : 0.0);
        total_ += sum * latLongTexelSolidAngle(y, image.width, image.height);
        rows_.push_back(total_);
    }
    if (dark()) return;
    for (double& row : rows_) row /= total_;
}

LightSample EnvironmentSampler::ofTexel(int x, int y) const {
    const float* rgb = &image_.rgb[(size_t(y) * size_t(image_.width) + size_t(x)) * 3];
    LightSample sample;
    sample.radiance = Vec3f(rgb[0], rgb[1], rgb[2]);
    if (!dark()) sample.pdf = float(double(sample.radiance.cast<double>().sum()) / total_);
    return sample;
}

LightSample EnvironmentSampler::sample(double u1, double u2) const {
    const auto [y, down] = findInterval(rows_.data(), image_.height, u1);
    const auto [x, across] = findInterval(&texels_[size_t(y) * size_t(image_.width)], image_.width, u2);
    const double top = heightOfRowEdge(y, image_.height), bottom = heightOfRowEdge(y + 1, image_.height);
    const double height = top + down * (bottom - top);
    const double longitude = kPi - 2 * kPi * (x + across) / image_.width + rotationRad_;
    const double radius = std::sqrt(std::max(0.0, 1 - height * height));
    LightSample sample = ofTexel(x, y);
    sample.direction =
        Vec3d(radius * std::sin(longitude), height, radius * std::cos(longitude)).cast<float>();
    return sample;
}

LightSample EnvironmentSampler::evaluate(const Vec3f& direction) const {
    const double c = std::cos(rotationRad_), s = std::sin(rotationRad_);
    const Vec3d d = direction.cast<double>();
    const Vec3d before(c * d.x() - s * d.z(), d.y(), s * d.x() + c * d.z());
    const auto [x, y] = latLongPoint(before, image_.width, image_.height);
    const int column = int(std::floor(x)) % image_.width;
    LightSample sample =
        ofTexel(column < 0 ? column + image_.width : column, std::clamp(int(y), 0, image_.height - 1));
    sample.direction = direction;
    return sample;
}

}  // namespace prt
