// The tables of normal_tables.h made at the speed of live light: again and again for one layout, with other
// light each time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "compress/tables/normal_tables.h"
#include "precompute/math/table_layout.h"

namespace prt {

/// Bands of the clamped cosine in the paper's tables: the 9 functions of three bands.
/// @source [IwanickiSloan2012, Sec. 3.3]
inline constexpr int kPaperCosineBands = 3;

namespace detail {

/// Texels of one octant that every mirror image keeps in a row, forwards or backwards.
struct MirrorRun {
    uint32_t lane;  ///< of the first, within its block
    uint32_t length;
    std::array<uint32_t, 8> texel;  ///< of each mirror image: where its lowest texel lies
    uint8_t reversed;               ///< bit σ: mirror image σ runs backwards
};

}  // namespace detail

/// Makes tables of one layout, visibility order and number of cosine bands from projected environments, on
/// the calling thread. What does not depend on the light is computed once; the other functions allocate
/// nothing. They write to the object: one builder per thread.
///
/// Values equal those of evalLightCosine, and sums of them, at the layout's normals to 1e-5 of the
/// table's largest value.
class LightTableBuilder {
  public:
    /// @param shOrder      n of the visibility, 1..kMaxShOrder
    /// @param cosineBands  1..kMaxShOrder + 1 − n: kPaperCosineBands is the paper's variant
    LightTableBuilder(const TableLayout& layout, int shOrder, int cosineBands = kTableCosineBands);

    const TableLayout& layout() const { return layout_; }
    int shOrder() const { return shOrder_; }
    int cosineBands() const { return cosineBands_; }
    size_t texelCount() const { return size_t(layout_.texelCount()); }
    /// Order that environments must have: bands beyond it do not reach the tables.
    int environmentShOrder() const { return tableEnvironmentShOrder(shOrder_, cosineBands_); }

    /// R_i(n) = ∫ L(ω) H_n(ω) Y_i(ω) dω at every texel's normal.
    /// @param environment  of environmentShOrder() bands or more
    /// @param out          [3 colours][n²][texelCount]
    /// @source [IwanickiSloan2012, Sec. 3.2-3.3]
    void buildLightCosine(const EnvironmentSh& environment, std::span<float> out);

    /// T_m(n) = Σ_i R_i(n) basis_mi, the mean last, without a light-cosine table in between.
    /// @param environment  of environmentShOrder() bands or more
    /// @param mean   [n²]   @param basis  [M×n²], M ≤ n²
    /// @param out          [3 colours][M + 1][texelCount]
    /// @source [IwanickiSloan2012, Eq. 6]
    void buildTripleProduct(const EnvironmentSh& environment, std::span<const float> mean,
                            std::span<const float> basis, std::span<float> out);

  private:
    /// One coefficient of the environment in one entry of the product matrix.
    struct Term {
        uint32_t light;
        float tripling;
    };
    void planTexels();
    void planRows();
    void planProduct();
    void fillCosines(std::span<const int> texels);
    void fillProduct(const EnvironmentSh& environment);
    void evaluate(const float* matrix, size_t columns, float* out) const;

    TableLayout layout_;
    int shOrder_, cosineBands_;
    int mirrors_ = 0;                       ///< how many of x, y, z are mirror axes of the layout
    std::vector<int> rows_;                 ///< indices of the cosine's functions, by parity class
    std::array<uint32_t, 9> classBegin_{};  ///< rows of parity class p begin here
    size_t paddedRows_ = 0;                 ///< floats from one column of a matrix to the next
    std::vector<float> cosines_;            ///< [blocks][rows][kBlock]
    std::vector<detail::MirrorRun> runs_;
    std::vector<uint32_t> blockRuns_;  ///< [blocks + 1] where runs of a block begin
    std::vector<Term> terms_;
    std::vector<uint32_t> termBegin_;  ///< [n²·rows + 1] by (i, row)
    std::vector<float> light_;         ///< [environment's functions][4]: colours side by side
    std::vector<float> product_;       ///< [3][n²][paddedRows]: transposed product matrices
    std::vector<float> combined_;      ///< [3][n² + 1][paddedRows]: multiplied by vectors
};

}  // namespace prt
