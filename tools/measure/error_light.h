// Light that judges errors: environments as rays, and as tables over the normal.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "compress/tables/table_options.h"
#include "precompute/io/environment_file.h"
#include "precompute/math/table_layout.h"

namespace prt::tools {

/// Environments as directions that are traced, denser where the light is (runtime/reference), and what any
/// expansion of visibility receives by the same directions:
///   E* = Σ_k V_k max(0, n_s·ω_k) L_k ΔΩ_k,   R_i = Σ_k Y_i(ω_k) max(0, n_s·ω_k) L_k ΔΩ_k
/// with L_k the mean of the whole image over the cell of direction k. Channels are the colours of all
/// environments side by side.
class RayLight {
  public:
    /// @param shOrder    of expansions, 1..kMaxBundleShOrder
    /// @param baseCount  cells before those with much light are split, 16..1048576
    RayLight(std::span<const Environment> environments, int shOrder, int baseCount);

    const std::vector<Vec3f>& directions() const { return directions_; }
    size_t channels() const { return channels_; }
    /// E* of one point.
    /// @param visible  [directions] 0..1   @param normal  shading, unit
    /// @param out      [channels]
    void irradiance(std::span<const float> visible, const Vec3f& normal, std::span<float> out) const;
    /// R of one shading normal.
    /// @param out  [channels×n²]
    void transfer(const Vec3f& normal, std::span<float> out) const;

  private:
    size_t channels_, coefficients_;
    std::vector<Vec3f> directions_;
    std::vector<float> basis_;  // [K×n²]
    std::vector<float> light_;  // [K×channels] L ΔΩ
};

/// Largest tables that are judged: those of all coefficients are held in memory.
inline constexpr int kLargestJudgedTable = 256;

/// Tables of all environments for one set of vectors.
class TabulatedLight {
  public:
    /// @param mean [n²]   @param basis [M×n²]
    /// @param options  without extraction of suns   @param format  "float", "half"; of cubes also "rgb9e5",
    /// "r11f"
    /// @throws UsageError  a format that the layout does not have, a size out of range, extraction of suns
    TabulatedLight(std::span<const Environment> environments, int shOrder, std::span<const float> mean,
                   std::span<const float> basis, const TableOptions& options, const std::string& format);

    /// R of a normal as the tables give it: bilinear lookup in float tables of the coefficients.
    /// @param out  [channels×n²]
    void transfer(const Vec3f& normal, std::span<float> out) const;
    /// T_m of a normal looked up in tables as they are stored; the mean last.
    /// @param out  [channels×(M + 1)]
    void stored(const Vec3f& normal, std::span<float> out) const;
    /// R of the tables' bands of the cosine without a table, of many normals.
    /// @return [normals×channels×n²]
    std::vector<float> transferWithoutTable(std::span<const Vec3f> normals) const;

  private:
    TableLayout layout_;
    int cosineBands_;
    int shOrder_;
    size_t coefficients_, vectors_, texels_;
    std::vector<EnvironmentSh> environments_;
    std::vector<float> exact_;   // [texel][channels×n²]
    std::vector<float> stored_;  // [texel][channels×(M + 1)]
};

}  // namespace prt::tools
