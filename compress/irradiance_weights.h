// Weights of principal vectors, fitted to the irradiance that a point receives.
//
// An error of V counts by what irradiance sees of it (precompute/math/irradiance_weight.h). Plain projection
// spends most of its accuracy on the half of the sphere below the horizon.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "compress/pca.h"
#include "precompute/math/irradiance_weight.h"

namespace prt {

/// Sums of what irradiance sees; they add up over parts of the rows.
struct IrradianceErrorSums {
    double error = 0;   ///< Σ a eᵀ A(n) e, e = v − reconstruction, a what the row v counts
    double square = 0;  ///< Σ a vᵀ A(n) v
    IrradianceErrorSums& operator+=(const IrradianceErrorSums& other);
    double relativeRmse() const;  ///< √(error / square); 0 where all rows are zero
};

/// Least squares for the weights of one basis, over any number of parts of the rows.
class IrradianceFit {
  public:
    /// @param shOrder  of the rows: the basis has n² columns
    IrradianceFit(const PcaResult& pca, int shOrder, const IrradianceWeight& weight = {});
    ~IrradianceFit();
    IrradianceFit(const IrradianceFit&) = delete;
    IrradianceFit& operator=(const IrradianceFit&) = delete;

    /// Weights that minimise eᵀ A(n) e with e = row − mean − Σ w_m basis_m, for all N rows. Each depends on
    /// its own row and normal alone. Where the normal is zero or not finite they are those of projectPca,
    /// within rounding.
    /// @param rows     [N×n²]   @param normals  [N] geometric
    /// @param weights  [N×M] out
    /// @throws Interrupted
    void fit(std::span<const float> rows, std::span<const Vec3f> normals, std::span<float> weights) const;
    /// The same, with the errors that are left in rows in use: cheaper than one after the other.
    /// @param use  [N], or empty = all   @param rowWeights  [N] what a row counts, or empty = all 1
    IrradianceErrorSums fitAndSum(std::span<const float> rows, std::span<const Vec3f> normals,
                                  std::span<const uint8_t> use, std::span<const float> rowWeights,
                                  std::span<float> weights) const;
    /// Errors that any weights leave.
    /// @param weights  [N×M]
    IrradianceErrorSums sum(std::span<const float> rows, std::span<const Vec3f> normals,
                            std::span<const uint8_t> use, std::span<const float> rowWeights,
                            std::span<const float> weights) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// IrradianceFit::fit of rows in memory.
/// @param rows     [N×n²]   @param normals  [N] geometric
/// @return [N×M]
std::vector<float> projectPcaForIrradiance(const PcaResult& pca, std::span<const float> rows,
                                           std::span<const Vec3f> normals, int shOrder,
                                           const IrradianceWeight& weight = {});

/// √(Σ eᵀ A(n) e / Σ vᵀ A(n) v) over the rows v in use, e = v − reconstruction.
/// @param weights  [N×M]   @param use  [N], or empty = all
double irradianceRelativeRmse(const PcaResult& pca, std::span<const float> rows,
                              std::span<const float> weights, std::span<const Vec3f> normals,
                              std::span<const uint8_t> use, int shOrder, const IrradianceWeight& weight = {});

}  // namespace prt
