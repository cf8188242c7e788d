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

const std::array<Vec3d, 3>& halfLife2Directions() {
    static const std::array<Vec3d, 3> directions = [] {
        const double a = 1 / std::sqrt(6.0), b = 1 / std::sqrt(2.0), c = 1 / std::sqrt(3.0);
        return std::array<Vec3d, 3>{Vec3d(-a, -b, c), Vec3d(-a, b, c), Vec3d(2 * a, 0, c)};
    }();
    return directions;
}
const double kHalfLife2Norm = std::sqrt(3 / (2 * pi));

class HalfLife2Basis final : public detail::BasisOf<HalfLife2Basis> {
  public:
    HalfLife2Basis() : BasisOf("hl2", 2, 3, BasisDomain::UpperHemisphere, true) {}
    template <typename T>
    void functions(const T& x, const T& y, const T& z, T* out) const {
        for (const Vec3d& h : halfLife2Directions())
            *out++ = kHalfLife2Norm * (h.x() * x + h.y() * y + h.z() * z);
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
    for (size_t i = 0; i < 3; ++i) sum += coefficients[i] * halfLife2Directions()[i];
    return kHalfLife2Norm * sum;
}

}  // namespace prt
