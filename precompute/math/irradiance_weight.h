// What irradiance sees of an error of visibility.
//
// Displayed is E(n_s) = ∫ V L max(0, n_s·ω) dω. Under light without structure an error e of V shows as
// ∫ w(ω·n) e² dω with w(ω·n) the mean of max(0, n_s·ω)² over the shading normals n_s in a cone about the
// geometric normal n: large along the normal, small at the horizon, zero where no shading normal of the cone
// looks. A floor keeps expansions that minimise it bounded there.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "precompute/math/vec.h"

namespace prt {

/// Parameters of w; files name them.
struct IrradianceWeight {
    /// Half-angle of the cone of shading normals, in (0, 90]. A trade: a narrower one is better for shading
    /// normals near the geometric one, and bad for those outside.
    double coneDegrees = 40;
    /// Share of its largest value that is added to w, in [0, 1]. A trade: a smaller floor lowers errors of
    /// irradiance a little further and lets expansions depart more from V.
    double floor = 0.0001;
    bool operator==(const IrradianceWeight&) const = default;
};

/// How expansions of visibility are made: plain projection, or the one that irradiance sees best
/// (math/irradiance_projection.h).
enum class ProjectionKind { Plain, Irradiance };
struct Projection {
    ProjectionKind kind = ProjectionKind::Irradiance;
    IrradianceWeight weight;  ///< of ProjectionKind::Irradiance
    bool operator==(const Projection&) const = default;
};
inline constexpr Projection kPlainProjection{ProjectionKind::Plain, {}};

/// Whether the parameters are in their ranges (NaN is not).
bool isValid(const IrradianceWeight& weight);

/// w at an angle to the geometric normal, the floor included. Good to 1e-9.
/// @param cosine  ω·n, −1..1
/// @return in [0, 1 + floor]; falls from the normal on
double irradianceWeight(double cosine, const IrradianceWeight& weight = {});
/// w along the normal, its largest value, without the floor: the mean of z² over the cap.
double largestIrradianceWeight(const IrradianceWeight& weight = {});

/// w for a normal along +Z as a zonal series: w(ω) = Σ_l zonal_l Y_l0(ω). Exact.
/// @param bands  1..kMaxShOrder
/// @return [bands]
/// @source the mean over the cone convolves the squared cosine with a cap: the Funk-Hecke theorem
/// [RamamoorthiHanrahan2001]
std::vector<double> irradianceWeightZonal(int bands, const IrradianceWeight& weight = {});

/// A_ij = ∫ w(ω·n) Y_i Y_j dω over the whole sphere, so that eᵀ A e = ∫ w e² for every e of shOrder bands.
/// Symmetric, positive definite where there is a floor; its eigenvalues lie between the floor and the largest
/// value of w.
class IrradianceMetric {
  public:
    /// @param shOrder  1..kMaxBundleShOrder
    explicit IrradianceMetric(int shOrder, const IrradianceWeight& weight = {});
    ~IrradianceMetric();
    IrradianceMetric(IrradianceMetric&&) noexcept;

    /// @param normal  of any length; one that is zero or not finite gives a multiple of the identity
    /// @param out     [n²×n²]
    /// @source the matrix of "multiply by w" [Ren2006]
    void evaluate(const Vec3f& normal, std::span<float> out) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The same for a normal along +Z, in double: it couples only functions of equal m, ±m alike.
/// @param shOrder  1..kMaxBundleShOrder
/// @return [n] blocks for m = 0..n−1, each [(n−m)×(n−m)] over bands m..n−1; symmetric
std::vector<std::vector<double>> irradianceMetricBlocks(int shOrder, const IrradianceWeight& weight = {});

}  // namespace prt
