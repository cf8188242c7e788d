// The exchange of y and z in the bands that the fast rotation does not unroll, by the recurrence of Ivanic
// and Ruedenberg [IvanicRuedenberg1996], which holds for reflections as for rotations.
#include "precompute/math/sh_rotation_bands.h"

#include <cmath>

#include "precompute/base/check.h"

namespace prt::detail {
namespace {

SparseSwap sparse(const std::vector<double>& dense, int band) {
    const size_t size = size_t(2 * band + 1);
    SparseSwap result;
    for (size_t i = 0; i < size * size; ++i) {
        if (i % size == 0) result.rowStart.push_back(int(result.value.size()));
        if (std::abs(dense[i]) < kSwapZero) continue;
        result.column.push_back(int(i % size));
        result.value.push_back(dense[i]);
    }
    result.rowStart.push_back(int(result.value.size()));
    return result;
}

}  // namespace

const SparseSwap& sparseSwap(int band) {
    static const std::array<SparseSwap, kMaxShOrder> all = [] {
        std::array<SparseSwap, kMaxShOrder> result;
        std::vector<double> below(std::begin(kSwapOfBandOne), std::end(kSwapOfBandOne));
        for (int l = 2; l < kMaxShOrder; ++l) {
            const size_t size = size_t(2 * l + 1);
            std::vector<double> here(size * size, 0.0);
            addNextBand({kSwapOfBandOne, 1}, {below.data(), l - 1}, 1, {here.data(), l});
            result[size_t(l)] = sparse(here, l);
            below = std::move(here);
        }
        return result;
    }();
    PRT_CHECK_LE(kUnrolledBands, band);
    PRT_CHECK_LT(band, kMaxShOrder);
    return all[size_t(band)];
}

}  // namespace prt::detail
