// The clamped cosine in spherical harmonics: [RamamoorthiHanrahan2001] "On the relationship between radiance
// and irradiance", Eq. 19; the addition theorem turns its zonal bands A_l into A_l Y_lm(n).
#include "precompute/math/clamped_cosine.h"

#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/sh.h"

namespace prt {

double clampedCosineBand(int band) {
    PRT_CHECK_LE(0, band);
    PRT_CHECK_LT(band, kMaxShOrder);
    constexpr double kPi = std::numbers::pi;
    if (band == 1) return 2 * kPi / 3;
    if (band % 2 == 1) return 0;
    double binomial = 1;  // l! / (2^l (l/2)!²) = Π (2k − 1) / 2k
    for (int k = 1; k <= band / 2; ++k) binomial *= (2.0 * k - 1) / (2.0 * k);
    const double sign = band / 2 % 2 == 0 ? -1 : 1;
    return 2 * kPi * sign * binomial / ((band + 2.0) * (band - 1.0));
}

void evalClampedCosineSh(int bands, const Vec3f& normal, std::span<float> out) {
    evalSh(bands, normal, out);
    for (int l = 0; l < bands; ++l) {
        const float band = float(clampedCosineBand(l));
        for (int m = -l; m <= l; ++m) out[size_t(shIndex(l, m))] *= band;
    }
}

}  // namespace prt
