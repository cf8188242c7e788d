// How well bases represent reflectance lobes, and what light comes out when lobe and environment are
// multiplied in a basis: [Gautron2004, Figs. 4 and 5, Sec. 6.1].
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/measure/basis_signals.h"

namespace prt::tools {

/// One point of the figures.
struct LobeAccuracy {
    size_t lobe;  ///< index in what was asked for
    std::string basis;
    int order;
    int coefficients;  ///< functions that are not zero
    int stored;        ///< n² for esh, as its paper stores it; else coefficients
    /// Energy captured: Σ c² / ∫_{z≥0} f² for orthonormal bases (sh: over the sphere, of f continued by 0);
    /// 1 − ∫_{z≥0} (f − f̂)² / ∫_{z≥0} f² for the others (lsosh, makhotkin). [Gautron2004, Eq. 15]
    double accuracy;
    /// 1 − ∫_{z≥0} (f − f̂)² / ∫_{z≥0} f² for all: what is seen above the horizon only.
    double accuracyHemisphere;
};

/// Projects every lobe into sh, esh, lsosh, hsh and makhotkin of 1…maxOrder bands, and into zernike of 1…as
/// many as keep it within maxOrder² functions (as esh).
/// @param lobes     all with one lowestZ
/// @param maxOrder  1..16
/// @param degree    of the quadrature, (degree + 1)² nodes above and below lowestZ each
/// @throws Interrupted
std::vector<LobeAccuracy> lobeAccuracies(std::span<const Lobe> lobes, int maxOrder, int degree = 159);

/// The light that leaves under an environment, L_o = ∫_{z≥0} f L, by dot products of coefficients.
struct LightError {
    std::string basis;
    int order;
    double relativeRms;  ///< √(Σ (L̂_o − L_o)² / Σ L_o²) over lobes, environments, orientations, colours
    double relativeMedian;  ///< median of |L̂_o − L_o| / L_o
    double relativeMax;
};

/// What each basis gives for every lobe under every environment in `orientations` random orientations. The
/// environment is given by its spherical harmonics of the same order, over the whole sphere:
///   sh         f continued by 0, dotted with it
///   hsh        f in hemispherical harmonics, dotted with C times it [Gautron2004, Eq. 18]
///   esh        the n² coefficients of the mirrored f, dotted with it: light from below counts too
///   lsosh      the n² coefficients of the least-squares fit, dotted with it: what the fit does below
///              the horizon, where nothing holds it, counts too
/// @param order  n, 1..12
/// @throws Interrupted
std::vector<LightError> lightErrors(std::span<const Lobe> lobes,
                                    std::span<const EnvironmentLights> environments, int order,
                                    int orientations, uint64_t seed);

}  // namespace prt::tools
