#include "tools/background.h"

#include <algorithm>
#include <cmath>

#include "precompute/math/environment.h"
#include "precompute/math/sh_rotation.h"
#include "runtime/camera_frame.h"

namespace prt::tools {
namespace {

/// Bilinear, wrapping around in longitude.
Vec3f sample(const FloatImage& image, double x, double y) {
    const double fx = x - 0.5, fy = std::clamp(y - 0.5, 0.0, double(image.height - 1));
    const int x0 = int(std::floor(fx)), y0 = int(fy);
    const float tx = float(fx - x0), ty = float(fy - y0);
    Vec3f sum = Vec3f::Zero();
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const float weight = (i ? tx : 1 - tx) * (j ? ty : 1 - ty);
            const int column = ((x0 + i) % image.width + image.width) % image.width;
            const float* pixel = image.at(column, std::min(y0 + j, image.height - 1));
            sum += weight * Vec3f(pixel[0], pixel[1], pixel[2]);
        }
    return sum;
}

}  // namespace

FloatImage blendImages(const std::vector<Environment>& environments, const std::vector<double>& weights) {
    FloatImage blend;
    blend.channels = 3;
    for (const Environment& environment : environments)
        if (environment.image.width > blend.width) {
            blend.width = environment.image.width;
            blend.height = environment.image.height;
        }
    blend.pixels.assign(size_t(blend.width) * size_t(blend.height) * 3, 0.0f);
    for (size_t e = 0; e < environments.size(); ++e) {
        const FloatImage& image = environments[e].image;
        for (int y = 0; y < blend.height; ++y)
            for (int x = 0; x < blend.width; ++x) {
                const Vec3f value = sample(image, (x + 0.5) * image.width / blend.width,
                                           (y + 0.5) * image.height / blend.height);
                for (int c = 0; c < 3; ++c) blend.at(x, y)[c] += float(weights[e]) * value[c];
            }
    }
    return blend;
}

void paintBackground(FloatImage& image, const SurfaceImage& surface, const Camera& camera,
                     const Bounds& bounds, const FloatImage& latLong, double rotationRad) {
    const CameraFrame frame = makeCameraFrame(camera, surface.width, surface.height, bounds);
    const Mat3d sourceFromWorld = rotationAboutUp(-rotationRad);
    for (int y = 0; y < surface.height; ++y)
        for (int x = 0; x < surface.width; ++x) {
            const size_t pixel = size_t(y) * size_t(surface.width) + size_t(x);
            if (surface.triangle[pixel] != kNoTriangle) continue;
            const Vec3d direction =
                (frame.rayCorner + (x + 0.5) * frame.rayPerPixelX + (y + 0.5) * frame.rayPerPixelY)
                    .normalized();
            const auto point = latLongPoint(sourceFromWorld * direction, latLong.width, latLong.height);
            const Vec3f value = sample(latLong, point[0], point[1]);
            std::copy_n(value.data(), 3, image.at(x, y));
        }
}

}  // namespace prt::tools
