// How far relit irradiance is from ray-traced truth, and how near any bake of an order can come.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "precompute/io/surface_image.h"
#include "runtime/reference/reference.h"

namespace prt::tools {

struct IrradianceError {
    double relativeRmse = 0;  ///< √(Σ|E − E_ref|² / Σ|E_ref|²) over covered pixels and colours
    double psnrDb = 0;        ///< 20 log10(max E_ref / RMSE); infinite for equal images
};

/// @param estimate, truth  [pixels×3]
/// @param surface          covered pixels are those with a triangle
IrradianceError compareIrradiance(std::span<const float> estimate, std::span<const float> truth,
                                  const SurfaceImage& surface);

/// Irradiance of every pixel from its own traced visibility projected to shOrder bands, lit by the whole
/// environment:
///   v_i = Σ_k ΔΩ_k V_k Y_i(ω_k),   E = Σ_k (v·Y(ω_k)) max(0, n_s·ω_k) L_k ΔΩ_k
/// What remains against the reference is the truncation to that order alone, so no bake of that order can do
/// better.
class TruncationFloor {
  public:
    TruncationFloor(const SurfaceImage& surface, const ReferenceDirections& directions, int shOrder);
    /// To be handed to traceReference; the object must outlive the call.
    ReferenceVisitor visitor();
    /// [environments][pixels×3]
    const std::vector<std::vector<float>>& irradiance() const { return irradiance_; }

  private:
    const SurfaceImage& surface_;
    const ReferenceDirections& directions_;
    int coefficients_;
    std::vector<float> basis_;  ///< [K×n²]
    std::vector<float> light_;  ///< [K×3·environments] L ΔΩ
    std::vector<std::vector<float>> irradiance_;
};

}  // namespace prt::tools
