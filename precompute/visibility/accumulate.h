// The inner loop of projection: sums of rows of a table.
#pragma once

#include <cstddef>
#include <cstdint>

namespace prt {

/// Row length of a table for so many columns: the next multiple of 4.
constexpr size_t paddedColumns(size_t columns) { return (columns + 3) / 4 * 4; }

/// sum[c] += Σ_j table[rows[j]·stride + c], added in the order of j: only additions, so the same bits on
/// every machine and for any grouping of calls by rows.
/// @param stride  floats per row, a multiple of 4
/// @param sum     [stride]
void addTableRows(const float* table, size_t stride, const uint16_t* rows, size_t rowCount, float* sum);

}  // namespace prt
