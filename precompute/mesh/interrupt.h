// Long serial loops that can be interrupted. Internal to the mesh stage.
#pragma once

#include <cstddef>

#include "precompute/base/error.h"

namespace prt {

/// Looks at every 65,536th step: milliseconds of work on meshes of millions of triangles.
/// @throws Interrupted
inline void throwIfInterruptedAt(size_t step) {
    if ((step & 0xffff) == 0) throwIfInterrupted();
}

}  // namespace prt
