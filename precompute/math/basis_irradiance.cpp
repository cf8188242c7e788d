// Bases made for irradiance: the H-basis [HabelWimmer2010, Eqs. 8-13; Eq. 10 with its bracket outside the
// root] and that of Half-Life 2 [HabelWimmer2010, Eqs. 1-3].
#include <array>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/basis_kernel.h"

namespace prt {
namespace {

using std::numbers::pi;

class HBasis final : public detail::BasisOf<HBasis> {
  public:
    explicit HBasis(int order)
        : BasisOf("h", order, order == 2 ? 4 : 6, BasisDomain::UpperHemisphere, true) {}
    template <typename T>
    void functions(const T& x, const T& y, const T& z, T* out) const {
        const double linear = std::sqrt(3 / (2 * pi)), quadratic = std::sqrt(15 / (2 * pi));
        out[0] = T(std::sqrt(1 / (2 * pi)));
        out[1] = -linear * y;
        out[2] = linear * (2.0 * z - T(1.0));
        out[3] = -linear * x;
        if (order() == 2) return;
        out[4] = quadratic * (x * y);
        out[5] = 0.5 * quadratic * (x * x - y * y);
    }
};

// 1/√6, 1/√2, 1/√3
constexpr double kA = std::numbers::inv_sqrt3 / std::numbers::sqrt2, kB = 1 / std::numbers::sqrt2,
                 kC = std::numbers::inv_sqrt3;
constexpr std::array<std::array<double, 3>, 3> kHalfLife2Directions = {
    {{-kA, -kB, kC}, {-kA, kB, kC}, {2 * kA, 0, kC}}};
/// √(3/2π)
constexpr double kHalfLife2Norm = std::numbers::sqrt3 * std::numbers::inv_sqrtpi / std::numbers::sqrt2;

class HalfLife2Basis final : public detail::BasisOf<HalfLife2Basis> {
  public:
    HalfLife2Basis() : BasisOf("hl2", 2, 3, BasisDomain::UpperHemisphere, true) {}
    template <typename T>
    void functions(const T& x, const T& y, const T& z, T* out) const {
        for (const std::array<double, 3>& h : kHalfLife2Directions)
            *out++ = kHalfLife2Norm * (h[0] * x + h[1] * y + h[2] * z);
    }
};

}  // namespace

std::unique_ptr<Basis> detail::makeIrradianceFamily(const std::string& name, int order) {
    if (name == "h") return std::make_unique<HBasis>(order);
    return std::make_unique<HalfLife2Basis>();
}

Vec3d directionalOcclusionVector(std::span<const double> coefficients) {
    PRT_CHECK_EQ(coefficients.size(), size_t(3));
    Vec3d sum = Vec3d::Zero();
    for (size_t i = 0; i < 3; ++i) sum += coefficients[i] * Vec3d(kHalfLife2Directions[i].data());
    return kHalfLife2Norm * sum;
}

}  // namespace prt
