// The section "precompute" of a bundle's manifest.
#pragma once

#include <string>

#include "precompute/visibility/precompute_job.h"

namespace prt {

/// Settings and statistics as JSON text, keys in snake_case with the unit as suffix.
std::string precomputeSection(const PrecomputeSettings& settings, const PrecomputeReport& report);

}  // namespace prt
