// Skies by formula, for scenes without a measured environment.
#pragma once

#include <string>

#include "precompute/io/image.h"

namespace prt {

/// Makes the sky that follows "sky:" in an argument: a name, or a name and parameters,
/// `preetham?turbidity=3&elevation=40`.
///   clear, overcast, sunset   CIE standard general sky, no parameters
///   uniform                   radiance 1
///   preetham                  turbidity (2..10, 3), elevation of the sun (0..90°, 40), azimuth (−360..360°,
///                             40: from +Z towards +X), ground (albedo, 0..1, 0.2), sun (0..1, 1: share of
///                             the direct light that is kept), sun-radius (0.5..10°, 1: of the disc that its
///                             light is spread over; the real sun's 0.27° would fall between texels)
///   constant                  r, g, b (0..65504, 1): radiance everywhere
///   gradient                  top (three numbers with commas between, 1,1.1,1.2), bottom (0.55,0.5,0.45):
///                             radiance at +Y and at −Y, in between linear in the height y of the direction,
///                             so that 2 bands of spherical harmonics hold all of it
/// @return  512×256 RGB, every value finite and ≥ 0. An upward horizontal surface receives π (mean of the
///          colours), but for constant and gradient light, which is as strong as said.
/// @throws InputError  unknown name
/// @throws UsageError  unknown parameter, one given twice, a value that is no number or out of range
/// @source [CieSky2003] (clear, overcast, sunset), [Preetham1999]
FloatImage makeProceduralSky(const std::string& request);

}  // namespace prt
