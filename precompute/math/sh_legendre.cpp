// Normalised Legendre functions by the three-term recurrence in the band, which is stable upwards;
// Gauss-Legendre nodes by Newton's iteration from Tricomi's estimate [Press2007, Sec. 4.6].
#include "precompute/math/sh_legendre.h"

#include <cmath>
#include <numbers>

#include "precompute/base/check.h"

namespace prt {

void evalShLegendre(int shOrder, double z, std::span<double> out) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxShOrder);
    PRT_CHECK_EQ(out.size(), size_t(legendreCount(shOrder)));
    constexpr const LegendreRecurrence<double>& t = kLegendreRecurrence<double>;
    const double sinTheta = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
    double sinPower = 1;
    for (int m = 0; m < shOrder; ++m) {
        double before = 0, here = t.diagonal[m] * sinPower;
        out[size_t(legendreIndex(m, m))] = here;
        for (int l = m + 1; l < shOrder; ++l) {
            const int i = legendreIndex(l, m);
            const double next = t.rise[i] * z * here - t.fall[i] * before;
            before = here;
            here = next;
            out[size_t(i)] = here;
        }
        sinPower *= sinTheta;
    }
}

std::vector<LineNode> gaussLegendre(int count) {
    PRT_CHECK_LE(1, count);
    std::vector<LineNode> nodes(static_cast<size_t>(count));
    for (int i = 0; i < (count + 1) / 2; ++i) {
        double z = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5));
        double slope = 1;
        // Newton doubles the digits: the estimate is good to 1e-2 at worst, so that ten rounds always do.
        for (int round = 0; round < 10; ++round) {
            double before = 1, here = z;
            for (int l = 2; l <= count; ++l) {
                const double next = ((2.0 * l - 1) * z * here - (l - 1.0) * before) / l;
                before = here;
                here = next;
            }
            slope = count == 1 ? 1 : count * (before - z * here) / ((1 - z) * (1 + z));
            const double step = (count == 1 ? z : here) / slope;
            z -= step;
            if (std::abs(step) < 1e-16) break;
        }
        if (2 * i + 1 == count) z = 0;
        const double weight = 2 / ((1 - z) * (1 + z) * slope * slope);
        nodes[size_t(i)] = {-z, weight};
        nodes[size_t(count - 1 - i)] = {z, weight};
    }
    return nodes;
}

}  // namespace prt
