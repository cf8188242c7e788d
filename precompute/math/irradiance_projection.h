// Expansions of visibility that serve irradiance: weighted least squares about the surface normal.
#pragma once

#include <memory>
#include <span>

#include "precompute/math/irradiance_weight.h"

namespace prt {

/// Solves for the expansion c of V with the least ∫ w(ω·n) (c·Y − V)² over the whole sphere among those
/// whose irradiance under constant light is exact for the geometric normal: c·h = E, h the clamped cosine
/// about n, all bands exact. In the local frame (n along +Z) this is one constant linear map of (b, E) that
/// couples functions of equal m only.
///   b = ∫ w V Y,   c = A⁻¹ b + A⁻¹ h (E − h·A⁻¹ b) / (h·A⁻¹ h)
/// Where no shading normal of the cone looks (beyond 130° from n for 40°) the floor alone bounds c: c·Y is no
/// picture of visibility there.
class IrradianceProjection {
  public:
    /// @param shOrder  1..kMaxBundleShOrder
    explicit IrradianceProjection(int shOrder, const IrradianceWeight& weight = {});
    ~IrradianceProjection();
    IrradianceProjection(IrradianceProjection&&) noexcept;

    /// @param normal      geometric, unit, world
    /// @param b           [n²] ∫ w(ω·n) V Y dω, world
    /// @param irradiance  E = ∫ V max(0, n·ω) dω, 0..π
    /// @param out         [n²] c, world; may be b
    void solve(const Vec3f& normal, std::span<const float> b, float irradiance, std::span<float> out) const;

    /// The same of many, in one go: coefficient i of vector k lies at [i·stride + k]. Equal to solve() to
    /// rounding.
    /// @param normals     [N] unit
    /// @param stride      >= N rounded up to a multiple of 16
    /// @param b           [n²×stride]
    /// @param irradiance  [N]
    /// @param out         [n²×stride] may be b
    void solveSoa(std::span<const Vec3f> normals, size_t stride, std::span<const float> b,
                  std::span<const float> irradiance, std::span<float> out) const;

    /// The same where the normal is +Z, in double.
    void solveLocal(std::span<const double> b, double irradiance, std::span<double> out) const;

    /// b of an expansion c: A(n) c. Inverse of solve for the expansions that solve returns.
    /// @param normal  unit   @param out  [n²] may be c
    void weigh(const Vec3f& normal, std::span<const float> c, std::span<float> out) const;

    /// c·Y cut at the horizon and projected plainly: ∫_{n·ω > 0} (c·Y) Y dω. Of an expansion that solve()
    /// returns it is nearly the plain projection of V: bounded, and with no trace of what c is where
    /// irradiance does not look.
    /// @param out  [n²] may be c
    void cutAtHorizon(const Vec3f& normal, std::span<const float> c, std::span<float> out) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace prt
