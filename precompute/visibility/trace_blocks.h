// Tracing and projection shared by texels and vertices.
#pragma once

#include "precompute/visibility/bake.h"
#include "precompute/visibility/bake_items.h"

namespace prt {

/// Bakes all items; results [items].
BakeResult bakeItems(const RayCaster& caster, const BakeItems& items, const BakeOptions& options,
                     const char* unit);

}  // namespace prt
