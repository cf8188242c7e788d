// Conversion from spherical harmonics [HabelWimmer2010, Sec. 4.1], [Gautron2004, Eq. 18]. Functions of
// different azimuth are orthogonal: what is left are integrals over z of products of normalised Legendre
// functions, taken by Gauss quadrature in t = √z. There hemispherical harmonics are polynomials but for
// √(1 + t²)^m, whose nearest singularity t = ±i makes 32 more nodes than a polynomial needs exact to
// rounding.
#include "precompute/math/basis_conversion.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"

namespace prt {
namespace {

using std::numbers::pi;

/// ∫ cos² mφ dφ
double azimuthIntegral(int m) { return m == 0 ? 2 * pi : pi; }

/// Calls visit(z, weight) for a quadrature over z in [0, 1].
template <typename Visit>
void forEachHeight(int nodes, const Visit& visit) {
    for (const LineNode& node : gaussLegendre(nodes)) {
        const double t = (node.z + 1) / 2;
        visit(t * t, node.weight * t);
    }
}

void checkOrder(int order) {
    PRT_CHECK_LE(1, order);
    PRT_CHECK_LE(order, kMaxShOrder);
}

}  // namespace

std::vector<double> shToHshMatrix(int hshOrder, int shOrder) {
    checkOrder(hshOrder);
    checkOrder(shOrder);
    const size_t columns = size_t(shCount(shOrder));
    std::vector<double> matrix(size_t(shCount(hshOrder)) * columns, 0.0);
    std::vector<double> hsh(size_t(legendreCount(hshOrder))), sh(size_t(legendreCount(shOrder)));
    forEachHeight(hshOrder + shOrder + 32, [&](double z, double weight) {
        evalShLegendre(hshOrder, 2 * z - 1, hsh);
        evalShLegendre(shOrder, z, sh);
        for (int m = 0; m < std::min(hshOrder, shOrder); ++m)
            for (int l = m; l < hshOrder; ++l) {
                const double factor =
                    weight * azimuthIntegral(m) * std::numbers::sqrt2 * hsh[size_t(legendreIndex(l, m))];
                for (int k = m; k < shOrder; ++k)
                    matrix[size_t(shIndex(l, m)) * columns + size_t(shIndex(k, m))] +=
                        factor * sh[size_t(legendreIndex(k, m))];
            }
    });
    for (int l = 1; l < hshOrder; ++l)
        for (int m = 1; m <= l; ++m)
            for (int k = m; k < shOrder; ++k)
                matrix[size_t(shIndex(l, -m)) * columns + size_t(shIndex(k, -m))] =
                    matrix[size_t(shIndex(l, m)) * columns + size_t(shIndex(k, m))];
    return matrix;
}

std::vector<double> shToHMatrix(int shOrder) {
    checkOrder(shOrder);
    // H¹ … H⁶ are √2·Y_lm, of z or, only H³, of 2z − 1.
    struct Row {
        int l, m;
        bool shifted;
    };
    constexpr std::array<Row, 6> kRows = {
        {{0, 0, false}, {1, -1, false}, {1, 0, true}, {1, 1, false}, {2, -2, false}, {2, 2, false}}};
    const size_t columns = size_t(shCount(shOrder));
    std::vector<double> matrix(kRows.size() * columns, 0.0);
    std::vector<double> plain(size_t(legendreCount(3))), shifted(plain.size());
    std::vector<double> sh(size_t(legendreCount(shOrder)));
    forEachHeight(shOrder + 3, [&](double z, double weight) {
        evalShLegendre(3, z, plain);
        evalShLegendre(3, 2 * z - 1, shifted);
        evalShLegendre(shOrder, z, sh);
        for (size_t i = 0; i < kRows.size(); ++i) {
            const int m = std::abs(kRows[i].m), index = legendreIndex(kRows[i].l, m);
            const double value = (kRows[i].shifted ? shifted : plain)[size_t(index)];
            for (int k = m; k < shOrder; ++k)
                matrix[i * columns + size_t(shIndex(k, kRows[i].m))] += weight * azimuthIntegral(m) *
                                                                        std::numbers::sqrt2 * value *
                                                                        sh[size_t(legendreIndex(k, m))];
        }
    });
    return matrix;
}

}  // namespace prt
