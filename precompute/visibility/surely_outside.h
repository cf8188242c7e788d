// Faces that are wholly outside geometry: where no face is pierced, a surface does not pass from outside to
// inside.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/rays/ray_caster.h"

namespace prt {

/// 1 for faces no point of which is inside geometry (find_inside.h): those of a region of faces that meet at
/// edges with the same winding, where every sample is outside and none of the faces is crossed: pierced or
/// touched by an edge of a face that does not share a corner with it, or the owner of such an edge. Where
/// samples of a region disagree, those faces that are not crossed, all of whose own samples are outside, and
/// those of the faces that they meet. 0 says nothing.
/// @param doubleSided  [triangles] or empty: faces whose back does not count
/// @param mostFaces    of regions whose samples disagree; where there are more, all of those are 0
/// @return [triangles]
std::vector<uint8_t> findSurelyOutside(const RayCaster& caster, std::span<const uint8_t> doubleSided,
                                       size_t mostFaces);

}  // namespace prt
