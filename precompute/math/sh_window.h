// Windows against ringing: factors per band that smooth an expansion in spherical harmonics.
#pragma once

#include <span>

#include "precompute/math/environment.h"

namespace prt {

/// Factor of band l at width w > 0, in bands; all are 1 at l = 0 and tend to 1 everywhere as w grows:
///   Hanning   (1 + cos(πl/w)) / 2 for l < w, else 0
///   Lanczos   sin(πl/w) / (πl/w)  for l < w, else 0
///   Gaussian  exp(−(πl/w)² / 2)
/// @source [Sloan2008, "Windowing"]
enum class ShWindow { Hanning, Lanczos, Gaussian };

/// @param width  > 0, in bands; infinity gives 1
/// @param band   l >= 0
/// @return dimensionless, 0..1
double shWindowFactor(ShWindow window, double width, int band);

/// Multiplies every band by its factor. The mean (band 0) stays as it is.
/// @param coefficients  [n²], changed in place
void applyShWindow(ShWindow window, double width, std::span<float> coefficients);
/// The same for the three colours.
void applyShWindow(ShWindow window, double width, EnvironmentSh& environment);

/// A value that the expansion never falls below. Seen along the direction of its linear band, every |m| > 0
/// counts with the amplitude it has at a height z, as if all had their lowest value at one azimuth:
///   min_z  Σ_l c_l0 Y_l0(z) − Σ_{m>0} √((Σ_l c_lm N_lm(z))² + (Σ_l c_l,−m N_lm(z))²)
/// @param coefficients  [n²]
/// @source [Sloan2017]
double shLowerBound(std::span<const float> coefficients);

struct ConservativeWindow {
    double width;      ///< in bands; infinity: none is needed
    bool nonNegative;  ///< false: the mean is negative, no window can help; the width is then 1
};
/// The widest window, which is the one that smooths least, for which shLowerBound of the expansion is not
/// negative: then the function is not, in any direction.
/// @param coefficients  [n²]
/// @source [Sloan2017]: one-dimensional minimisation over z, bisection over the width
ConservativeWindow findConservativeWindow(std::span<const float> coefficients,
                                          ShWindow window = ShWindow::Lanczos);
/// The widest window for which no colour is negative in any of 16 n² directions spread over the sphere. Wider
/// than the conservative one, whose bound takes every |m| at its lowest at once: at 17 bands that bound
/// leaves hardly more than the mean of a light with a sun.
/// @return width in bands; infinity: none is needed; 1 (Gaussian 1/4) where the mean is negative
double findNonNegativeWindow(const EnvironmentSh& environment, ShWindow window = ShWindow::Lanczos);
/// One window for the three colours, so that they keep their ratios: the strongest that any of them needs.
ConservativeWindow findConservativeWindow(const EnvironmentSh& environment,
                                          ShWindow window = ShWindow::Lanczos);

}  // namespace prt
