// The signals that `prt measure basis` represents: irradiance under random and real light, Phong lobes and
// the Ward reflectance. All in the frame of the surface: +Z is its normal.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "precompute/io/environment_file.h"
#include "precompute/math/basis.h"

namespace prt::tools {

/// Which radiance reaches the surface, seen from its normal: none from below the horizon, or from everywhere
/// (what a normal map can tilt to).
enum class RadianceModel { AboveSurface, FullSphere };

/// Random numbers that are the same on every machine.
class SignalRandom {
  public:
    explicit SignalRandom(uint64_t seed) : engine_(seed) {}
    /// In [0, 1).
    double uniform() { return double(engine_() >> 11) * 0x1p-53; }
    /// Mean 1.
    double exponential();
    /// Mean 0, variance 1.
    double normal();
    /// Uniform on the sphere.
    Vec3d direction();
    /// Uniform over all rotations.
    Mat3d rotation();

  private:
    std::mt19937_64 engine_;
};

/// Bands of the smooth part of random radiance.
inline constexpr int kSmoothOrder = 4;

/// Directional lights and a smooth part. Under AboveSurface only what has z >= 0 counts.
struct Radiance {
    std::vector<Vec3d> directions;    ///< [N] unit
    std::vector<double> fluxes;       ///< [N] irradiance that each gives a surface facing it
    std::vector<double> smooth = {};  ///< [kSmoothOrder²] spherical harmonics, or empty: none
};

/// Random radiance: `lights` directions, uniform over the hemisphere or the sphere, of exponential flux with
/// mean 1 / lights, and smooth radiance: normally distributed coefficients of 4 bands, the constant moved so
/// that the lowest radiance of the domain is 0 (on a grid: not below −3 % of the highest), scaled to the flux
/// ∫L dω = `smoothFlux` (over the hemisphere under AboveSurface). With smoothFlux = 1 both parts bring the
/// same flux on average.
/// @param lights      0…
/// @param smoothFlux  >= 0
Radiance drawRadiance(RadianceModel model, int lights, double smoothFlux, SignalRandom& random);

/// An image as directional lights, one per texel of the image reduced to 128×64 (or its own size where that
/// is smaller): what "the environment" is in measurements, so that sums over lights are exact.
struct EnvironmentLights {
    std::string name;
    std::vector<Vec3d> directions;              ///< [N] unit, world
    std::array<std::vector<double>, 3> fluxes;  ///< [N] per colour; all together 3: one per colour on average
};
EnvironmentLights environmentLights(const Environment& environment);
/// The lights seen from a frame: localFromWorld · directions.
std::vector<Vec3d> turnedDirections(const EnvironmentLights& lights, const Mat3d& localFromWorld);

/// Irradiance E(n) = ∫ L(ω) max(0, n·ω) dω at the nodes of a quadrature over the upper hemisphere: exact sums
/// over lights; the smooth part by its exact bands (FullSphere), or by an exact quadrature of the lune that
/// n and the surface both see (AboveSurface). To 1e-12.
/// @source [HabelWimmer2010, Eq. 4] with all shading normals n; [RamamoorthiHanrahan2001, Eq. 19]
class IrradianceTruth {
  public:
    explicit IrradianceTruth(std::span<const DomainNode> nodes);

    /// Adds the lights' irradiance for several channels that share directions.
    /// @param above     leave out lights with z < 0
    /// @param fluxes    per channel [N]
    /// @param out       per channel [nodes]
    void addLights(std::span<const Vec3d> directions, bool above,
                   std::span<const std::span<const double>> fluxes,
                   std::span<const std::span<double>> out) const;
    /// Irradiance of random radiance.
    /// @param out  [nodes]
    void eval(RadianceModel model, const Radiance& radiance, std::span<double> out) const;

  private:
    std::vector<double> x_, y_, z_;                 ///< [nodes, padded to kLanes]
    std::vector<double> smoothFull_, smoothAbove_;  ///< [nodes×kSmoothOrder²]
    size_t count_;
};

/// The first three bands of irradiance as spherical harmonics over the sphere of normals, A_l L_lm.
/// @return [9]
/// @source [HabelWimmer2010, Eqs. 5-7], with π a_l for a_l
std::array<double, 9> irradianceSh9(RadianceModel model, const Radiance& radiance);
/// The same of lights alone.
std::array<double, 9> irradianceSh9(RadianceModel model, std::span<const Vec3d> directions,
                                    std::span<const double> fluxes);

/// A reflectance lobe as a function of the incoming direction.
struct Lobe {
    std::string name;             ///< "tilt-15", "theta-30-phi-90"
    double thetaDeg, phiDeg = 0;  ///< tilt of the lobe, or outgoing direction
    DirectionFunction function;
    double lowestZ = 0;  ///< it is cut to 0 below this z
};

/// max(0, ω·d)^exponent with d tilted from the normal towards +X, 0 below the horizon.
/// @source [Gautron2004, Sec. 5]
Lobe phongLobe(double tiltDeg, double exponent = 5);

/// How the Ward reflectance is made square-integrable at the horizon.
enum class WardVariant { RawCut89, TimesCosine };

/// The anisotropic reflectance of Ward without its diffuse part, k_s = 1, α_x = 0.2, α_y = 0.5:
///   f = exp(−((h_x/α_x)² + (h_y/α_y)²) / h_z²) / (4π α_x α_y √(cosθ_i cosθ_o)),  h = i + o
/// (the half vector need not be normalised: only ratios occur). Near the horizon f² ~ 1/cosθ_i, whose
/// integral diverges: RawCut89 is 0 beyond θ_i = 89°, TimesCosine is f cosθ_i.
/// @source [Ward1992, Eq. 5]; [Gautron2004, Sec. 5 and 6.2]
Lobe wardLobe(double outgoingThetaDeg, double outgoingPhiDeg, WardVariant variant);

}  // namespace prt::tools
