// Products of spherical harmonics without allocation: one, many lanes, and by prebuilt matrices. The
// straight-line code comes from tools/generate_sh_product.py. [Ren2006], [Sloan2008, "SH products"].
#include <algorithm>
#include <utility>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_lanes.h"
#include "precompute/math/sh_product.h"
#include "precompute/math/sh_product_generated.h"

namespace prt {
namespace {

using detail::kLanes;
using detail::Lanes;
using detail::lanesAt;
using detail::ShProductCode;

/// One column of a structure of arrays.
template <typename T>
struct Column {
    T* data;
    size_t stride;
    [[gnu::always_inline]] T& operator[](size_t i) const { return data[i * stride]; }
};

/// Sum over the table, one coefficient of the product after the other; T float or lanes of it.
/// @param load   (factor, i, T&), @param store  (k, const T&)
template <typename T, typename Load, typename Store>
[[gnu::always_inline]] inline void productByTable(const std::vector<TriplingCoefficient>& table, size_t count,
                                                  const float* f, const float* g, const Load& load,
                                                  const Store& store) {
    T y[shCount(kMaxShOrder)];
    size_t next = 0;
    for (size_t k = 0; k < count; ++k) {
        T sum{};
        for (; next < table.size() && table[next].k == k; ++next) {
            T one, other;
            load(f, table[next].i, one);
            load(g, table[next].j, other);
            sum += table[next].value * one * other;
        }
        y[k] = sum;
    }
    for (size_t k = 0; k < count; ++k) store(k, y[k]);
}

/// @param table  for orders without code
PRT_TARGET_CLONES void productSingle(int shOrder, const std::vector<TriplingCoefficient>* table,
                                     const float* f, const float* g, float* out) {
    static_assert(kMaxProductCodeOrder == 6);
    switch (shOrder) {
        case 1:
            return ShProductCode<1>::run<float>(f, g, out);
        case 2:
            return ShProductCode<2>::run<float>(f, g, out);
        case 3:
            return ShProductCode<3>::run<float>(f, g, out);
        case 4:
            return ShProductCode<4>::run<float>(f, g, out);
        case 5:
            return ShProductCode<5>::run<float>(f, g, out);
        case 6:
            return ShProductCode<6>::run<float>(f, g, out);
        default:
            return productByTable<float>(
                *table, size_t(shCount(shOrder)), f, g,
                [](const float* p, size_t i, float& value) { value = p[i]; },
                [&](size_t k, float value) { out[k] = value; });
    }
}

/// The same code as the body of a loop, which becomes vectors of whatever width the machine has.
template <int N>
[[gnu::always_inline]] inline void productLanes(const float* f, const float* g, float* out, size_t stride) {
    PRT_INDEPENDENT_LOOP
    for (size_t k = 0; k < kLanes; ++k)
        ShProductCode<N>::template run<float>(Column<const float>{f + k, stride},
                                              Column<const float>{g + k, stride},
                                              Column<float>{out + k, stride});
}

PRT_TARGET_CLONES void productBlock(int shOrder, const std::vector<TriplingCoefficient>* table,
                                    const float* f, const float* g, float* out, size_t stride) {
    switch (shOrder) {
        case 1:
            return productLanes<1>(f, g, out, stride);
        case 2:
            return productLanes<2>(f, g, out, stride);
        case 3:
            return productLanes<3>(f, g, out, stride);
        case 4:
            return productLanes<4>(f, g, out, stride);
        case 5:
            return productLanes<5>(f, g, out, stride);
        case 6:
            return productLanes<6>(f, g, out, stride);
        default:
            return productByTable<Lanes>(
                *table, size_t(shCount(shOrder)), f, g,
                [&](const float* p, size_t i, Lanes& value)
                    __attribute__((always_inline)) { value = lanesAt(p + i * stride).value; },
                [&](size_t k, const Lanes& value)
                    __attribute__((always_inline)) { lanesAt(out + k * stride) = value; });
    }
}

const std::vector<TriplingCoefficient>* tableFor(int shOrder) {
    return shOrder <= kMaxProductCodeOrder ? nullptr : &triplingCoefficients(shOrder, shOrder, shOrder);
}

/// Σ_c term(c), c < sizeof...(C), unrolled, in four sums that do not wait for each other.
template <typename Term, size_t... C>
[[gnu::always_inline]] inline float unrolledSum(std::index_sequence<C...>, const Term& term) {
    float sum[4] = {};
    ((sum[C % 4] += term(C)), ...);
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/// out = M g for a symmetric M, whose columns lie as rows: the loops over rows become vectors.
template <size_t N>
[[gnu::always_inline]] inline void applySymmetric(const float* matrix, const float* g, float* out) {
    const auto row = [&](size_t r) __attribute__((always_inline)) {
        out[r] = unrolledSum(
            std::make_index_sequence<N>{}, [&](size_t c) __attribute__((always_inline)) {
                return matrix[c * N + r] * g[c];
            });
    };
    constexpr size_t kWhole = N / kLanes * kLanes;
    PRT_INDEPENDENT_LOOP
    for (size_t r = 0; r < kWhole; ++r) row(r);
    if constexpr (kWhole == N) return;
    // The last rows once more as a whole vector where there are enough: a masked one would reach beyond the
    // end, which costs ten times as much where the next page has never been touched.
    constexpr size_t kRest = N < kLanes ? 0 : N - kLanes;
    PRT_INDEPENDENT_LOOP
    for (size_t r = kRest; r < N; ++r) row(r);
}

/// out = M g, a row at a time.
[[gnu::always_inline]] inline void applyRows(const float* matrix, size_t rows, size_t columns, const float* g,
                                             float* out) {
    for (size_t r = 0; r < rows; ++r, matrix += columns) {
        Lanes lanes = {};
        size_t c = 0;
        for (; c + kLanes <= columns; c += kLanes) lanes += lanesAt(matrix + c).value * lanesAt(g + c).value;
        float sum = 0;
        for (size_t k = 0; k < kLanes; ++k) sum += lanes[k];
        for (; c < columns; ++c) sum += matrix[c] * g[c];
        out[r] = sum;
    }
}

PRT_TARGET_CLONES void applySingle(const float* matrix, size_t rows, size_t columns, const float* g,
                                   float* out) {
    if (rows != columns) return applyRows(matrix, rows, columns, g, out);
    switch (rows) {
        case 9:
            return applySymmetric<9>(matrix, g, out);
        case 16:
            return applySymmetric<16>(matrix, g, out);
        case 25:
            return applySymmetric<25>(matrix, g, out);
        case 36:
            return applySymmetric<36>(matrix, g, out);
        default:
            return applyRows(matrix, rows, columns, g, out);
    }
}

/// out = M g for sixteen columns, any size of M.
[[gnu::always_inline]] inline void applyToLanes(const float* matrix, size_t rows, size_t columns,
                                                const float* g, float* out, size_t stride) {
    for (size_t r = 0; r < rows; ++r, matrix += columns) {
        Lanes sum = {};
        for (size_t c = 0; c < columns; ++c) sum += matrix[c] * lanesAt(g + c * stride).value;
        lanesAt(out + r * stride) = sum;
    }
}

/// The same for a number of columns known to the compiler.
template <size_t Columns>
[[gnu::always_inline]] inline void applyUnrolledToLanes(const float* matrix, size_t rows, const float* g,
                                                        float* out, size_t stride) {
    for (size_t r = 0; r < rows; ++r, matrix += Columns) {
        PRT_INDEPENDENT_LOOP
        for (size_t k = 0; k < kLanes; ++k)
            out[r * stride + k] = unrolledSum(
                std::make_index_sequence<Columns>{}, [&](size_t c) __attribute__((always_inline)) {
                    return matrix[c] * g[c * stride + k];
                });
    }
}

PRT_TARGET_CLONES void applyBlock(const float* matrix, size_t rows, size_t columns, const float* g,
                                  float* out, size_t stride) {
    switch (columns) {
        case 9:
            return applyUnrolledToLanes<9>(matrix, rows, g, out, stride);
        case 16:
            return applyUnrolledToLanes<16>(matrix, rows, g, out, stride);
        case 25:
            return applyUnrolledToLanes<25>(matrix, rows, g, out, stride);
        case 36:
            return applyUnrolledToLanes<36>(matrix, rows, g, out, stride);
        default:
            return applyToLanes(matrix, rows, columns, g, out, stride);
    }
}

/// The last items of a structure of arrays, where they do not fill the lanes: in a block of their own.
struct Remainder {
    float block[shCount(kMaxShOrder) * kLanes];

    void load(const float* from, size_t stride, size_t rows, size_t count) {
        std::fill_n(block, rows * kLanes, 0.0f);
        for (size_t i = 0; i < rows; ++i) std::copy_n(from + i * stride, count, block + i * kLanes);
    }
    void store(float* to, size_t stride, size_t rows, size_t count) const {
        for (size_t i = 0; i < rows; ++i) std::copy_n(block + i * kLanes, count, to + i * stride);
    }
};

void checkOrder(int shOrder) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxShOrder);
}

void checkFits(size_t size, int shOrder, size_t count, size_t stride) {
    PRT_CHECK_LE(count, stride);
    PRT_CHECK_LE((size_t(shCount(shOrder)) - 1) * stride + count, size);
}

}  // namespace

void shProduct(int shOrder, std::span<const float> f, std::span<const float> g, std::span<float> out) {
    checkOrder(shOrder);
    for (const size_t size : {f.size(), g.size(), out.size()}) PRT_CHECK_EQ(size, size_t(shCount(shOrder)));
    productSingle(shOrder, tableFor(shOrder), f.data(), g.data(), out.data());
}

void shProductSoa(int shOrder, std::span<const float> f, std::span<const float> g, std::span<float> out,
                  size_t count, size_t stride) {
    checkOrder(shOrder);
    if (count == 0) return;
    for (const size_t size : {f.size(), g.size(), out.size()}) checkFits(size, shOrder, count, stride);
    const std::vector<TriplingCoefficient>* table = tableFor(shOrder);
    size_t k = 0;
    for (; k + kLanes <= count; k += kLanes) productBlock(shOrder, table, &f[k], &g[k], &out[k], stride);
    if (k == count) return;
    const size_t rows = size_t(shCount(shOrder));
    Remainder restF, restG;
    restF.load(&f[k], stride, rows, count - k);
    restG.load(&g[k], stride, rows, count - k);
    productBlock(shOrder, table, restF.block, restG.block, restF.block, kLanes);
    restF.store(&out[k], stride, rows, count - k);
}

void applyProductMatrix(std::span<const float> matrix, std::span<const float> g, std::span<float> out) {
    PRT_CHECK_EQ(matrix.size(), g.size() * out.size());
    applySingle(matrix.data(), out.size(), g.size(), g.data(), out.data());
}

void applyProductMatrixSoa(std::span<const float> matrix, int rowsOrder, int columnsOrder,
                           std::span<const float> g, std::span<float> out, size_t count, size_t stride) {
    checkOrder(rowsOrder);
    checkOrder(columnsOrder);
    const size_t rows = size_t(shCount(rowsOrder)), columns = size_t(shCount(columnsOrder));
    PRT_CHECK_EQ(matrix.size(), rows * columns);
    if (count == 0) return;
    checkFits(g.size(), columnsOrder, count, stride);
    checkFits(out.size(), rowsOrder, count, stride);
    size_t k = 0;
    for (; k + kLanes <= count; k += kLanes) applyBlock(matrix.data(), rows, columns, &g[k], &out[k], stride);
    if (k == count) return;
    Remainder restG, restOut;
    restG.load(&g[k], stride, columns, count - k);
    applyBlock(matrix.data(), rows, columns, restG.block, restOut.block, kLanes);
    restOut.store(&out[k], stride, rows, count - k);
}

int64_t shProductNonZeros(int shOrder) {
    return int64_t(triplingCoefficients(shOrder, shOrder, shOrder).size());
}

ShProductCost shProductCost(ShProductMethod method, int shOrder) {
    checkOrder(shOrder);
    const int64_t count = shCount(shOrder);
    switch (method) {
        case ShProductMethod::kTable: {
            const int64_t nonZeros = shProductNonZeros(shOrder);
            return {2 * nonZeros, nonZeros - count};
        }
        case ShProductMethod::kMatrix:
            return {count * count, count * (count - 1)};
        case ShProductMethod::kMatrixBuild: {
            // Every coefficient once, added to its entry, which starts at zero.
            const int64_t nonZeros = shProductNonZeros(shOrder);
            return {nonZeros, nonZeros};
        }
        case ShProductMethod::kStraightLine:
            break;
    }
    PRT_CHECK_LE(shOrder, kMaxProductCodeOrder);
    constexpr ShProductCost kCosts[kMaxProductCodeOrder] = {
        {ShProductCode<1>::kMultiplications, ShProductCode<1>::kAdditions},
        {ShProductCode<2>::kMultiplications, ShProductCode<2>::kAdditions},
        {ShProductCode<3>::kMultiplications, ShProductCode<3>::kAdditions},
        {ShProductCode<4>::kMultiplications, ShProductCode<4>::kAdditions},
        {ShProductCode<5>::kMultiplications, ShProductCode<5>::kAdditions},
        {ShProductCode<6>::kMultiplications, ShProductCode<6>::kAdditions}};
    return kCosts[shOrder - 1];
}

}  // namespace prt
