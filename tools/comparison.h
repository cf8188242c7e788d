// How far relit irradiance is from ray-traced truth, and how near any bake of an order can come.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "precompute/io/surface_image.h"
#include "precompute/math/irradiance_projection.h"
#include "precompute/visibility/accumulate.h"
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
///   v_i = Σ_k ΔΩ_k V_k Y_i(ω_k), or its weighted form about the geometric normal (IrradianceProjection),
///   E = Σ_k (v·Y(ω_k)) max(0, n_s·ω_k) L_k ΔΩ_k
/// What remains against the reference is what this projection to that order loses; what a bake adds comes
/// from its rays, from sharing values between neighbouring points and from compression.
class TruncationFloor {
  public:
    /// @param projection  that of the bake to be judged
    TruncationFloor(const SurfaceImage& surface, const ReferenceDirections& directions, int shOrder,
                    const Projection& projection = kPlainProjection);
    /// To be handed to traceReference; the object must outlive the call.
    ReferenceVisitor visitor();
    /// [environments][pixels×3]
    const std::vector<std::vector<float>>& irradiance() const { return irradiance_; }

  private:
    void projectWeighted(const Vec3f& normal, std::span<const uint8_t> visible, std::span<float> v) const;

    const SurfaceImage& surface_;
    const ReferenceDirections& directions_;
    struct Weighted {
        IrradianceProjection projection;
        CosineTable weight;
    };
    std::optional<Weighted> weighted_;
    int coefficients_;
    std::vector<float> basis_;  ///< [K×n²]
    std::vector<float> light_;  ///< [K×3·environments] L ΔΩ
    std::vector<std::vector<float>> irradiance_;
};

}  // namespace prt::tools
