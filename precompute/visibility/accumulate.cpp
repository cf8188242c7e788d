// Projection as a sparse matrix product: a visible direction adds its row of basis functions.
#include "precompute/visibility/accumulate.h"

#include "precompute/base/parallel.h"

namespace prt {
namespace {

// The partial sums of `Width` columns stay in registers over all rows.
template <size_t Width>
inline __attribute__((always_inline)) void addColumns(const float* table, size_t stride, const uint16_t* rows,
                                                      size_t rowCount, float* sum) {
    float partial[Width] = {};
    for (size_t j = 0; j < rowCount; ++j) {
        const float* row = table + size_t(rows[j]) * stride;
        for (size_t c = 0; c < Width; ++c) partial[c] += row[c];
    }
    for (size_t c = 0; c < Width; ++c) sum[c] += partial[c];
}

}  // namespace

PRT_TARGET_CLONES
void addTableRows(const float* table, size_t stride, const uint16_t* rows, size_t rowCount, float* sum) {
    size_t column = 0;
    for (; column + 16 <= stride; column += 16)
        addColumns<16>(table + column, stride, rows, rowCount, sum + column);
    for (; column + 4 <= stride; column += 4)
        addColumns<4>(table + column, stride, rows, rowCount, sum + column);
}

}  // namespace prt
