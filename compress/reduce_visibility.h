// Fewer bands or fewer vectors of what a bundle holds.
#pragma once

#include <span>

#include "precompute/io/visibility_file.h"
#include "precompute/math/vec.h"

namespace prt {

/// Visibility of shOrder bands from visibility of as many or more.
///
/// Plain coefficients: the leading ones. Coefficients that were projected for irradiance are not the leading
/// ones of a higher order; but what they were solved from is in them. They are c = A⁻¹(b + μh), so that
/// A c = b + μh: its leading entries are those of the lower order but for a multiple of h, which the
/// constraint c·h = E takes out again whatever it is; and E = c·h was kept exactly. The lower order's system
/// solved for these gives what the bake would have stored, to rounding. Texels filled from a neighbour are
/// solved about their own normals, as in compression.
/// @param visibility  of shOrder bands or more
/// @param shOrder     1..visibility.shOrder
/// @source math/irradiance_projection.h
VisibilityMap reduceOrder(const VisibilityMap& visibility, int shOrder);

/// The leading vectors, and weights for them alone. Weights that were fitted for irradiance are fitted again,
/// each in the metric of its normal: the fit is a projection, so that fitting what all vectors gave equals
/// fitting the rows themselves. Plain weights are the leading ones. Vectors that were refined for irradiance
/// stay those refined for the larger number: compressing anew with fewer is somewhat better.
/// @param pca         of `components` vectors or more
/// @param normals     [grid.count] geometric; zero where there is none
/// @param components  1..pca.components
/// @throws InputError  attributes of pca name no known fit; Interrupted
/// @source [IwanickiSloan2012, Sec. 4]
PcaMap reduceComponents(const PcaMap& pca, std::span<const Vec3f> normals, int components);

}  // namespace prt
