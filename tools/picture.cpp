// Differences as in [IwanickiSloan2012, Figs. 5 and 6].
#include "tools/picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/atomic_file.h"
#include "precompute/base/check.h"

namespace prt::tools {

FloatImage radianceOf(const std::vector<float>& irradiance, const SurfaceImage& surface) {
    PRT_CHECK_EQ(irradiance.size(), 3 * surface.pixels());
    FloatImage image{surface.width, surface.height, 3, std::vector<float>(3 * surface.pixels(), 0.0f)};
    for (size_t p = 0; p < surface.pixels(); ++p)
        if (surface.triangle[p] != kNoTriangle)
            for (size_t c = 0; c < 3; ++c)
                image.pixels[3 * p + c] =
                    surface.albedo[p][int(c)] * irradiance[3 * p + c] / std::numbers::pi_v<float>;
    return image;
}

FloatImage scaledDifference(const FloatImage& image, const FloatImage& against, const SurfaceImage& surface) {
    PRT_CHECK_EQ(image.pixels.size(), 3 * surface.pixels());
    PRT_CHECK_EQ(against.pixels.size(), image.pixels.size());
    FloatImage difference{surface.width, surface.height, 3, std::vector<float>(3 * surface.pixels(), 0.0f)};
    for (size_t p = 0; p < surface.pixels(); ++p)
        if (surface.triangle[p] != kNoTriangle)
            for (size_t c = 3 * p; c < 3 * p + 3; ++c)
                difference.pixels[c] = kDifferenceScale * std::abs(std::max(image.pixels[c], 0.0f) -
                                                                   std::max(against.pixels[c], 0.0f));
    return difference;
}

void writePng(const std::filesystem::path& path, const ByteImage& image) {
    const std::vector<uint8_t> png = encodePng(image);
    writeFileAtomically(path.string(), std::as_bytes(std::span(png)));
}

}  // namespace prt::tools
