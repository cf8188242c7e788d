// How a file says which projection its expansions of visibility come from.
#pragma once

#include <map>
#include <string>

#include "precompute/math/irradiance_weight.h"

namespace prt {

/// "plain", "irradiance"
const char* projectionName(ProjectionKind kind);

/// Sets `projection`, and for irradiance `projectionConeDegrees` and `projectionFloor`; a plain one has no
/// parameters.
void setProjection(const Projection& projection, std::map<std::string, std::string>& attributes);

/// Takes those attributes out again. Files without them are plain: they come from versions that knew no
/// other.
/// @throws InputError  an unknown projection, or parameters that are absent or out of range
Projection takeProjection(std::map<std::string, std::string>& attributes, const std::string& path);

}  // namespace prt
