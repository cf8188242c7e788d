// How much of an expansion of visibility shows as irradiance under natural light.
#pragma once

#include <memory>
#include <span>

#include "precompute/math/vec.h"

namespace prt {

/// Power of natural light at a band: the mean over environments of Σ_m L_lm² / (2l+1), as a share of that of
/// band 0. Measured on 18 HDR environments, indoors and outdoors (tools/docs/performance.md).
/// @param band  l >= 0
/// @return 1 at band 0, then 0.3·l^−0.6
double naturalLightPower(int band);

/// RMS over natural lights, randomly turned, of the irradiance that an expansion e of visibility (or of an
/// error of it) gives at its geometric normal n, as a share of the RMS that an open point receives:
///   ‖e‖² = Σ_lm C_l (∫ (e·Y) Y_lm max(0, n·ω) dω)² / the same for V = 1 above the horizon
/// with C_l = naturalLightPower(l), l < kMaxShOrder. A quadratic form that couples functions of equal m in
/// the frame of the normal.
class IrradianceNorm {
  public:
    /// @param shOrder  1..kMaxBundleShOrder
    explicit IrradianceNorm(int shOrder);
    ~IrradianceNorm();
    IrradianceNorm(IrradianceNorm&&) noexcept;

    /// @param normal        unit, world
    /// @param coefficients  [n²] world
    /// @return ‖coefficients‖ >= 0; 1 for an open point up to its truncation
    double evaluate(const Vec3f& normal, std::span<const float> coefficients) const;

    /// The same of many, in one go: coefficient i of vector k lies at [i·stride + k].
    /// @param normals       [N] unit
    /// @param stride        >= N rounded up to a multiple of 16
    /// @param coefficients  [n²×stride]
    /// @param out           [N]
    void evaluateSoa(std::span<const Vec3f> normals, size_t stride, std::span<const float> coefficients,
                     std::span<float> out) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace prt
