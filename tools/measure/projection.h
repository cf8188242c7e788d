// How far irradiance from expansions of visibility is from ray-traced truth, at random points of a mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/io/environment_file.h"
#include "precompute/io/scene.h"
#include "precompute/math/irradiance_weight.h"
#include "precompute/mesh/texel_raster.h"
#include "precompute/rays/ray_caster.h"

namespace prt::tools {

/// Widest image that light is integrated over texel by texel; wider ones are halved first (means of 2×2
/// texels).
inline constexpr int kWidestJudgedImage = 1024;

/// Knows the true irradiance of points under environments, and what any expansion of their visibility gives.
///   truth     E* = Σ_k L_k V_k max(0, n_s·ω_k) ΔΩ_k
///   estimate  E  = Σ_i c_i T_i,  T_i = Σ_k L_k Y_i(ω_k) max(0, n_s·ω_k) ΔΩ_k
/// over all texels k of the environment's own image: one ray each for the truth, none of them in a direction
/// that a bake traces, and no truncation of light or cosine in the estimate.
class IrradianceJudge {
  public:
    /// @param tiltsDeg  angles between geometric and shading normal, towards a random azimuth per point
    /// @param shOrder   largest order of the expansions to judge, 1..kMaxBundleShOrder
    IrradianceJudge(const RayCaster& caster, std::span<const SurfacePoint> points,
                    std::span<const Environment> environments, std::span<const double> tiltsDeg, int shOrder,
                    uint64_t seed);

    /// Mean over the environments of √(Σ|E − E*|² / Σ|E*|²), sums over points and colours; environments that
    /// leave every point dark do not count.
    /// @param coefficients  [≥ points×n²], the judge's points first
    /// @param tilt          index into tiltsDeg
    double relativeRmse(std::span<const float> coefficients, int shOrder, size_t tilt) const;

  private:
    size_t points_, tilts_, channels_, coefficients_;
    std::vector<float> transfer_;  // [points][tilts][n²][channels]
    std::vector<float> truth_;     // [points][tilts][channels]
};

struct ProjectionStudy {
    std::vector<int> orders{3, 4, 6};
    std::vector<double> tiltsDeg{0, 20, 35};
    int points = 400;       ///< judged
    int population = 4096;  ///< baked, the judged ones among them: what principal vectors are made from
    int rays = 1024;        ///< of the bake
    int components = 16;
    uint64_t seed = 1;
    IrradianceWeight weight;
};

struct ProjectionRow {
    int order;
    double tiltDeg;
    double plain, weighted;
    double pcaPlain;     ///< principal vectors and weights of plain coefficients
    double pcaFitted;    ///< plain coefficients, weights fitted to irradiance
    double pcaWeighted;  ///< as `prt compress` makes it of weighted coefficients
};
struct ProjectionResult {
    double meanAo = 0;  ///< of the population
    std::vector<ProjectionRow> rows;
};

/// Relative RMSE of irradiance for every order and tilt.
/// @throws InputError, Interrupted
ProjectionResult studyProjection(const Scene& scene, std::span<const Environment> environments,
                                 const ProjectionStudy& study);

}  // namespace prt::tools
