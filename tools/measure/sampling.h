// Error of visibility from finitely many rays: sets of directions, shared by all points or turned for each,
// uniform and adaptive, against the same estimator with very many rays.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "precompute/math/direction_sets.h"
#include "precompute/math/irradiance_norm.h"
#include "precompute/math/irradiance_weight.h"
#include "precompute/visibility/bake.h"

namespace prt::tools {

/// What bakeVisibility computes for a point, from any directions.
class VisibilityEstimator {
  public:
    /// @param shOrder  1..kMaxBundleShOrder
    VisibilityEstimator(int shOrder, const Projection& projection);
    ~VisibilityEstimator();

    struct Estimate {
        double ao = 0;    ///< Σ V cos / Σ cos, 0 where no direction is above the horizon
        size_t rays = 0;  ///< directions above the horizon
    };
    /// @param directions  [N] unit, world, equally weighted over the sphere
    /// @param out         [n²] world space, as BakeResult::coefficients
    Estimate estimate(const RayCaster& caster, const SurfacePoint& point, std::span<const Vec3f> directions,
                      std::span<float> out) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// A uniform spherical-Fibonacci set in an orientation that shares no direction with the sets of a bake.
/// @param count  >= 1
std::vector<Vec3f> truthDirections(int count);

/// Smallest BakeOptions::error that is measured: finer ones would ask more of the truth than it gives.
inline constexpr double kLeastError = 1e-4;

struct SamplingStudy {
    int shOrder = 6;
    Projection projection;
    int points = 256;                                                 ///< random, outside of the mesh
    std::vector<int> counts{25, 50, 100, 200, 400, 800, 1600, 3200};  ///< directions over the sphere
    std::vector<DirectionSetKind> sets{DirectionSetKind::Random, DirectionSetKind::Stratified,
                                       DirectionSetKind::SobolOwen, DirectionSetKind::Fibonacci};
    bool rotated = true;  ///< also every set turned at random for each point
    int seeds = 4;        ///< of each random set
    int truth = 65536;    ///< directions over the sphere of the truth
    std::vector<double> errors{0.04, 0.02, 0.01, 0.005, 0.0025, 0.00125};  ///< BakeOptions::error
    uint64_t seed = 1;
};

/// A NaN is a value there is none of.
struct SamplingRow {
    std::string set;    ///< "random", "random-rotated", …, "adaptive-fibonacci"
    double directions;  ///< over the sphere; none where adaptive
    double rays;        ///< traced: mean number above the horizon of a point
    double rms;         ///< √(Σ‖c − t‖² / Σ‖t‖²) over points and seeds, by IrradianceNorm
    double rmsOpen;     ///< √(mean ‖c − t‖²): as a share of what an open point receives
    double error;       ///< BakeOptions::error
    double estimated;   ///< RMS of BakeResult::error
    double belowError;  ///< share of points whose ‖c − t‖ is at most BakeOptions::error
    double belowTwiceEstimate;  ///< share of points whose ‖c − t‖ is at most twice its BakeResult::error
};
struct SamplingResult {
    double meanAo = 0;
    int points = 0;
    /// Sets of study.sets in turn, each with rising counts, shared then rotated; then adaptive bakes with
    /// falling errors. Shared Fibonacci sets are bakes too. They go on beyond study.counts, doubled until
    /// they reach the error of every adaptive bake or a quarter of the truth's directions.
    std::vector<SamplingRow> rows;
};

/// @throws InputError   no area, or every point is inside the mesh
/// @throws Interrupted
SamplingResult studySampling(const Scene& scene, const SamplingStudy& study);

/// Where the curve of a set first falls to an RMS, by straight lines between log(rms) and the logarithms.
struct SamplingEffort {
    double directions, rays;  ///< NaN: the curve does not pass that RMS
};
/// @param rows  rows of other sets are skipped
SamplingEffort effortAt(std::span<const SamplingRow> rows, const std::string& set, double rms);
/// RMS of a set at a number of directions over the sphere, likewise; NaN outside of the curve.
double rmsAt(std::span<const SamplingRow> rows, const std::string& set, double directions);

}  // namespace prt::tools
