#include "tools/exposure.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace prt::tools {

double autoExposure(const FloatImage& radiance, const SurfaceImage& surface) {
    std::vector<float> luminance;
    for (size_t p = 0; p < surface.pixels(); ++p)
        if (surface.triangle[p] != kNoTriangle) {
            const float* v = radiance.pixels.data() + 3 * p;
            luminance.push_back(0.2126f * v[0] + 0.7152f * v[1] + 0.0722f * v[2]);
        }
    if (luminance.empty()) return 0;
    const auto at = luminance.begin() + std::ptrdiff_t(luminance.size() * 9 / 10);
    std::nth_element(luminance.begin(), at, luminance.end());
    return *at > 0 ? std::log2(0.6 / double(*at)) : 0;
}

}  // namespace prt::tools
