// Skies by formula, for scenes without a measured environment.
#pragma once

#include <string>
#include <vector>

#include "precompute/io/image.h"

namespace prt {

/// @param name  one of proceduralSkyNames()
/// @return      512×256 RGB; an upward horizontal surface receives π (uniform: radiance 1)
FloatImage makeProceduralSky(const std::string& name);

}  // namespace prt
