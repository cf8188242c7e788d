// Real spherical harmonics, one direction at a time, and projection.
// [Sloan2008] "Stupid Spherical Harmonics (SH) Tricks", appendix A2: polynomials in x, y and z without
// trigonometry. sphereQuadrature: Gauss-Legendre × trapezoid [AtkinsonHan2012, Sec. 5.1].
#include "precompute/math/sh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/math/sh_legendre.h"
#include "precompute/math/sh_straight_line.h"

namespace prt {
namespace {

template <typename T>
void evalByTable(int shOrder, T x, T y, T z, T* out) {
    constexpr const LegendreRecurrence<T>& t = kLegendreRecurrence<T>;
    T cosPart = 1, sinPart = 0;
    for (int m = 0; m < shOrder; ++m) {
        T before = 0, here = t.diagonal[m];
        for (int l = m;;) {
            // For m = 0 the first store is overwritten by the second.
            out[shIndex(l, -m)] = here * sinPart;
            out[shIndex(l, m)] = here * cosPart;
            if (++l >= shOrder) break;
            const int i = legendreIndex(l, m);
            const T next = t.rise[i] * z * here - t.fall[i] * before;
            before = here;
            here = next;
        }
        const T c = x * cosPart - y * sinPart;
        sinPart = x * sinPart + y * cosPart;
        cosPart = c;
    }
}

template <int N>
[[gnu::always_inline]] inline void evalStraightLine(const Vec3f& d, float* out) {
    detail::evalShStraightLine<N, float>(
        d.x(), d.y(), d.z(), [&](int i, float value) __attribute__((always_inline)) { out[i] = value; });
}

void evalFloat(int shOrder, const Vec3f& d, float* out) {
    static_assert(detail::kMaxStraightLineOrder == 10);
    switch (shOrder) {
        case 1:
            return evalStraightLine<1>(d, out);
        case 2:
            return evalStraightLine<2>(d, out);
        case 3:
            return evalStraightLine<3>(d, out);
        case 4:
            return evalStraightLine<4>(d, out);
        case 5:
            return evalStraightLine<5>(d, out);
        case 6:
            return evalStraightLine<6>(d, out);
        case 7:
            return evalStraightLine<7>(d, out);
        case 8:
            return evalStraightLine<8>(d, out);
        case 9:
            return evalStraightLine<9>(d, out);
        case 10:
            return evalStraightLine<10>(d, out);
        default:
            return evalByTable<float>(shOrder, d.x(), d.y(), d.z(), out);
    }
}

void checkOrder(int shOrder) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxShOrder);
}

}  // namespace

void evalSh(int shOrder, const Vec3f& direction, std::span<float> out) {
    checkOrder(shOrder);
    PRT_CHECK_EQ(out.size(), size_t(shCount(shOrder)));
    evalFloat(shOrder, direction, out.data());
}

void evalSh(int shOrder, const Vec3d& direction, std::span<double> out) {
    checkOrder(shOrder);
    PRT_CHECK_EQ(out.size(), size_t(shCount(shOrder)));
    evalByTable<double>(shOrder, direction.x(), direction.y(), direction.z(), out.data());
}

std::vector<float> projectShSamples(int shOrder, std::span<const Vec3f> directions,
                                    std::span<const float> values) {
    checkOrder(shOrder);
    PRT_CHECK_EQ(directions.size(), values.size());
    if (directions.empty())
        throw InputError("SH projection", "no directions to project from", "give at least one sample");
    constexpr size_t kBlock = 256;
    const size_t count = size_t(shCount(shOrder));
    std::vector<float> basis(kBlock * count);
    std::vector<double> sum(count, 0.0);
    for (size_t first = 0; first < directions.size(); first += kBlock) {
        const size_t n = std::min(kBlock, directions.size() - first);
        evalShBatch(shOrder, directions.subspan(first, n), std::span(basis).first(n * count));
        for (size_t k = 0; k < n; ++k) {
            const double value = values[first + k];
            for (size_t i = 0; i < count; ++i) sum[i] += value * double(basis[k * count + i]);
        }
    }
    const double scale = 4 * std::numbers::pi / double(directions.size());
    std::vector<float> result(count);
    for (size_t i = 0; i < count; ++i) result[i] = float(scale * sum[i]);
    return result;
}

std::vector<double> projectSh(int shOrder, const std::function<double(const Vec3d&)>& function, int degree) {
    checkOrder(shOrder);
    const size_t count = size_t(shCount(shOrder));
    std::vector<double> basis(count), result(count, 0.0);
    for (const SphereNode& node : sphereQuadrature(degree)) {
        evalSh(shOrder, node.direction, std::span<double>(basis));
        const double value = node.weightSr * function(node.direction);
        for (size_t i = 0; i < count; ++i) result[i] += value * basis[i];
    }
    return result;
}

double evalShExpansion(int shOrder, std::span<const float> coefficients, const Vec3d& direction) {
    checkOrder(shOrder);
    PRT_CHECK_EQ(coefficients.size(), size_t(shCount(shOrder)));
    double basis[shCount(kMaxShOrder)];
    evalSh(shOrder, direction, std::span(basis).first(coefficients.size()));
    double sum = 0;
    for (size_t i = 0; i < coefficients.size(); ++i) sum += double(coefficients[i]) * basis[i];
    return sum;
}

std::vector<SphereNode> sphereQuadrature(int degree) {
    PRT_CHECK_LE(0, degree);
    const std::vector<LineNode> rows = gaussLegendre(degree / 2 + 1);
    const int columns = degree + 1;
    std::vector<SphereNode> nodes;
    nodes.reserve(rows.size() * size_t(columns));
    for (const LineNode& row : rows) {
        const double sinTheta = std::sqrt((1 - row.z) * (1 + row.z));
        for (int j = 0; j < columns; ++j) {
            const double phi = 2 * std::numbers::pi * (j + 0.5) / columns;
            nodes.push_back({Vec3d(sinTheta * std::cos(phi), sinTheta * std::sin(phi), row.z),
                             row.weight * 2 * std::numbers::pi / columns});
        }
    }
    return nodes;
}

}  // namespace prt
