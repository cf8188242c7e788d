// Clear skies by published formulas.
#pragma once

#include <array>

namespace prt {

/// Daylight of a clear or hazy sky: five-parameter distribution of luminance and chromaticity, fitted to
/// simulated skies, and the direct sun behind the same air.
/// Colours are linear Rec. 709 whose luminance (weights 0.2126, 0.7152, 0.0722) is in the unit named.
/// @source [Preetham1999, appendix A.2 for the sky, A.1 for the sun]
class PreethamSky {
  public:
    /// @param turbidity        2 (very clear) to 10 (haze); the fit holds to 6 or so near a low sun
    /// @param sunElevationRad  0 to π/2
    PreethamSky(double turbidity, double sunElevationRad);

    /// Radiance of the sky without the sun. Where the fit leaves the gamut of Rec. 709, negative colours are
    /// 0.
    /// @param cosZenith    of the direction, above 0; below 0.01 the value of 0.01
    /// @param sunAngleRad  between the direction and the sun, 0 to π
    /// @return             kcd/m², every colour ≥ 0
    std::array<double, 3> radiance(double cosZenith, double sunAngleRad) const;
    /// What a surface that faces the sun receives from it: 128 klx above the air, less what molecules and
    /// aerosols scatter at one wavelength per colour (610, 550 and 465 nm); ozone, mixed gases and water
    /// vapour, which take some per cent, are left out.
    /// @return  klx, every colour ≥ 0
    std::array<double, 3> sunIrradiance() const;

  private:
    /// Distribution of Y (kcd/m²), x or y: coefficients A to E, and the scale that gives the zenith's value.
    struct Distribution {
        std::array<double, 5> coefficients;
        double scale;
    };
    double turbidity_, sunZenithRad_;
    std::array<Distribution, 3> distributions_;
};

}  // namespace prt
