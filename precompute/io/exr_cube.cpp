// Sources: OpenEXR ImfEnvmap.h (orientation of cube and latitude-longitude maps).
#include <ImathBox.h>
#include <ImathVec.h>
#include <ImfEnvmap.h>

#include <algorithm>
#include <cmath>

#include "precompute/base/parallel.h"
#include "precompute/io/exr_file.h"
#include "precompute/math/environment.h"

namespace prt {
namespace {

// Bilinear inside one face: ImfEnvmap puts the outer texels on the edges, so faces meet without a seam.
void addCubeSample(const std::vector<float>& cube, int size, const Vec3d& direction, double rgb[3]) {
    const Imath::Box2i window(Imath::V2i(0, 0), Imath::V2i(size - 1, 6 * size - 1));
    Imf::CubeMapFace face;
    Imath::V2f inFace;
    Imf::CubeMap::faceAndPixelPosition(
        Imath::V3f(float(direction.x()), float(direction.y()), float(direction.z())), window, face, inFace);
    const float last = float(size - 1);
    const float x = std::clamp(inFace.x, 0.0f, last), y = std::clamp(inFace.y, 0.0f, last);
    const int x0 = std::min(int(x), std::max(0, size - 2)), y0 = std::min(int(y), std::max(0, size - 2));
    for (int dy = 0; dy <= 1; ++dy)
        for (int dx = 0; dx <= 1; ++dx) {
            const double weight = std::max(0.0f, 1 - std::abs(x - float(x0 + dx))) *
                                  std::max(0.0f, 1 - std::abs(y - float(y0 + dy)));
            const Imath::V2f at = Imf::CubeMap::pixelPosition(
                face, window,
                Imath::V2f(float(std::min(x0 + dx, size - 1)), float(std::min(y0 + dy, size - 1))));
            const size_t column = size_t(std::lround(at.x)), row = size_t(std::lround(at.y));
            const float* texel = cube.data() + (row * size_t(size) + column) * 3;
            for (int c = 0; c < 3; ++c) rgb[c] += weight * double(texel[c]);
        }
}

}  // namespace

std::vector<float> latLongFromExrCube(const std::vector<float>& cube, int size, int& height) {
    height = std::clamp(2 * size, 2, 4096);
    const int width = 2 * height;
    std::vector<float> image(size_t(width) * size_t(height) * 3);
    parallelFor(size_t(height), 1, [&](size_t begin, size_t end) {
        for (size_t y = begin; y < end; ++y)
            for (int x = 0; x < width; ++x) {
                double rgb[3] = {0, 0, 0};
                for (double dy : {0.25, 0.75})
                    for (double dx : {0.25, 0.75})
                        addCubeSample(cube, size, latLongDirection(x + dx, double(y) + dy, width, height),
                                      rgb);
                for (size_t c = 0; c < 3; ++c)
                    image[(y * size_t(width) + size_t(x)) * 3 + c] = float(rgb[c] / 4);
            }
    });
    return image;
}

}  // namespace prt
