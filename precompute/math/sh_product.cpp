// Products of spherical-harmonic expansions. [Ren2006] "Real-time soft shadows in dynamic scenes using
// spherical harmonic exponentiation", [Sloan2008] "SH products". The tripling coefficients split into an
// integral over azimuth in closed form, which is zero unless |m_k| = ||m_i| ± |m_j||, and one over z by
// Gauss-Legendre quadrature, exact for its polynomials, which is zero unless the bands form a triangle of
// even sum.
#include "precompute/math/sh_product.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/sh_legendre.h"

namespace prt {
namespace {

constexpr int kNodes = (3 * (kMaxShOrder - 1)) / 2 + 1;

/// ∫ t_a t_b t_c dφ over the circle, with t_m = cos(mφ) for m >= 0 and sin(|m|φ) for m < 0.
double azimuthIntegral(int a, int b, int c) {
    const int sines = (a < 0) + (b < 0) + (c < 0);
    if (sines % 2 == 1) return 0;
    // Brings the two sines to the front: t_a t_b = ½ [cos(a − b) ± cos(a + b)].
    if (sines == 2 && a >= 0) std::swap(a, c);
    if (sines == 2 && b >= 0) std::swap(b, c);
    a = std::abs(a);
    b = std::abs(b);
    const int difference = (a - b + c == 0) + (a - b - c == 0), sum = (a + b + c == 0) + (a + b - c == 0);
    return std::numbers::pi / 2 * (sines == 2 ? difference - sum : difference + sum);
}

/// Legendre factors of all functions at all nodes, the quadrature's weights aside: [legendreIndex][node].
struct NodeTable {
    std::array<double, kNodes> weight;
    std::vector<std::array<double, kNodes>> factor;
};

NodeTable makeNodeTable(int shOrder) {
    NodeTable table;
    table.factor.resize(size_t(legendreCount(shOrder)));
    const std::vector<LineNode> nodes = gaussLegendre(kNodes);
    std::vector<double> values(table.factor.size());
    for (size_t n = 0; n < nodes.size(); ++n) {
        table.weight[n] = nodes[n].weight;
        evalShLegendre(shOrder, nodes[n].z, values);
        for (size_t i = 0; i < values.size(); ++i) table.factor[i][n] = values[i];
    }
    return table;
}

/// Appends all coefficients of one (k, i), sorted by j.
/// @param product  factors of i and k times the weights, at the nodes
void appendRow(const NodeTable& table, const std::array<double, kNodes>& product, std::array<int, 2> bandAndM,
               std::array<int, 2> outBandAndM, int orderJ, std::vector<TriplingCoefficient>& out) {
    const auto [li, mi] = bandAndM;
    const auto [lk, mk] = outBandAndM;
    // The candidates for m of j: sums and differences, as a sine where just one of the other two is a sine.
    const int sign = (mi < 0) != (mk < 0) ? -1 : 1;
    std::array<int, 2> orders = {sign * (std::abs(mi) + std::abs(mk)),
                                 sign * std::abs(std::abs(mi) - std::abs(mk))};
    if (orders[0] > orders[1]) std::swap(orders[0], orders[1]);
    for (int lj = std::abs(li - lk); lj <= std::min(li + lk, orderJ - 1); lj += 2)
        for (size_t c = 0; c < 2; ++c) {
            const int mj = orders[c];
            if (std::abs(mj) > lj || (c == 1 && mj == orders[0])) continue;
            const double azimuth = azimuthIntegral(mi, mj, mk);
            if (azimuth == 0) continue;
            const std::array<double, kNodes>& factor = table.factor[size_t(legendreIndex(lj, std::abs(mj)))];
            double sum = 0;
            for (size_t n = 0; n < kNodes; ++n) sum += product[n] * factor[n];
            const double value = azimuth * sum;
            // A few integrals vanish beyond what the rules say; rounding leaves 1e-15.
            if (std::abs(value) > 1e-12)
                out.push_back({uint16_t(shIndex(li, mi)), uint16_t(shIndex(lj, mj)),
                               uint16_t(shIndex(lk, mk)), float(value)});
        }
}

std::vector<TriplingCoefficient> computeTripling(int orderI, int orderJ, int orderK) {
    const NodeTable table = makeNodeTable(std::max({orderI, orderJ, orderK}));
    std::vector<TriplingCoefficient> result;
    std::array<double, kNodes> product;
    for (int lk = 0; lk < orderK; ++lk)
        for (int mk = -lk; mk <= lk; ++mk)
            for (int li = 0; li < orderI; ++li)
                for (int mi = -li; mi <= li; ++mi) {
                    const auto& fi = table.factor[size_t(legendreIndex(li, std::abs(mi)))];
                    const auto& fk = table.factor[size_t(legendreIndex(lk, std::abs(mk)))];
                    for (size_t n = 0; n < kNodes; ++n) product[n] = table.weight[n] * fi[n] * fk[n];
                    appendRow(table, product, {li, mi}, {lk, mk}, orderJ, result);
                }
    result.shrink_to_fit();
    return result;
}

int orderOf(size_t count) {
    const int order = shOrderFromCount(count);
    PRT_CHECK_LT(0, order);
    return order;
}

}  // namespace

const std::vector<TriplingCoefficient>& triplingCoefficients(int orderI, int orderJ, int orderK) {
    for (const int order : {orderI, orderJ, orderK}) {
        PRT_CHECK_LE(1, order);
        PRT_CHECK_LE(order, kMaxShOrder);
    }
    static std::mutex mutex;
    static std::map<std::array<int, 3>, std::unique_ptr<const std::vector<TriplingCoefficient>>> cache;
    const std::lock_guard lock(mutex);
    auto& entry = cache[{orderI, orderJ, orderK}];
    if (!entry)
        entry =
            std::make_unique<const std::vector<TriplingCoefficient>>(computeTripling(orderI, orderJ, orderK));
    return *entry;
}

std::vector<float> shProduct(std::span<const float> f, std::span<const float> g, int orderOut) {
    std::vector<double> sum(size_t(shCount(orderOut)), 0.0);
    for (const TriplingCoefficient& t : triplingCoefficients(orderOf(f.size()), orderOf(g.size()), orderOut))
        sum[t.k] += double(f[t.i]) * double(g[t.j]) * double(t.value);
    return {sum.begin(), sum.end()};
}

std::vector<float> productMatrix(std::span<const float> f, int rowsOrder, int columnsOrder) {
    // Bands of f beyond the sum of the others' do not reach the matrix.
    const int order = std::min(orderOf(f.size()), rowsOrder + columnsOrder - 1);
    const size_t columns = size_t(shCount(columnsOrder));
    std::vector<double> sum(size_t(shCount(rowsOrder)) * columns, 0.0);
    for (const TriplingCoefficient& t : triplingCoefficients(rowsOrder, columnsOrder, order))
        sum[t.i * columns + t.j] += double(f[t.k]) * double(t.value);
    return {sum.begin(), sum.end()};
}

}  // namespace prt
