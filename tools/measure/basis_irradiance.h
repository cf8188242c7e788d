// How well bases represent irradiance: [HabelWimmer2010, Fig. 3].
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tools/measure/basis_signals.h"

namespace prt::tools {

/// A basis in the comparison.
struct IrradianceCandidate {
    std::string basis, title;  ///< family, and "H6" for legends
    int order, coefficients;
};

/// Errors of every candidate, added up over signals.
struct IrradianceErrors {
    size_t signals = 0;
    double energy = 0;                   ///< Σ ∫_{z≥0} E²
    std::vector<double> direct, viaSh9;  ///< [candidates] Σ ∫_{z≥0} (Ê − E)²

    void add(const IrradianceErrors& other);
    double imseDirect(size_t candidate) const { return direct[candidate] / double(signals); }
    double imseViaSh9(size_t candidate) const { return viaSh9[candidate] / double(signals); }
};

/// Represents irradiance signals in every candidate and sums up
///   IMSE = ∫_{z≥0} (Ê − E)²                                             [HabelWimmer2010, Eq. 16],
/// with Ê by direct projection (integrals over the hemisphere; for spherical harmonics over the whole sphere,
/// exactly by Funk–Hecke) and by way of the first three bands of E in spherical harmonics, turned into the
/// basis by T_h, C or the projection of these nine functions.
class IrradianceComparison {
  public:
    /// @param degree  of the quadrature over the hemisphere: (degree + 1)² nodes. Irradiance has kinks where
    /// a
    ///                light sets, so that the averages over many signals are good to 1e-3 with 63
    explicit IrradianceComparison(int degree = 63);
    ~IrradianceComparison();
    IrradianceComparison(const IrradianceComparison&) = delete;
    IrradianceComparison& operator=(const IrradianceComparison&) = delete;

    const std::vector<IrradianceCandidate>& candidates() const { return candidates_; }
    /// Position of a candidate.
    size_t find(const std::string& basis, int coefficients) const;
    std::span<const DomainNode> nodes() const { return nodes_; }
    const IrradianceTruth& truth() const { return truth_; }

    /// @param irradiance  [signals×nodes]
    /// @param sh9         [signals×9] bands 0…2 of the same over the sphere of normals
    IrradianceErrors errors(std::span<const double> irradiance, std::span<const double> sh9) const;

    struct Matrices;  ///< of basis_irradiance.cpp

  private:
    std::vector<DomainNode> nodes_;
    IrradianceTruth truth_;
    std::vector<IrradianceCandidate> candidates_;
    std::unique_ptr<Matrices> matrices_;
};

/// Errors over random signals (see drawRadiance); the same for any number of threads.
/// @param report  called with the number of signals done, from any thread; may throw
/// @throws Interrupted
IrradianceErrors randomIrradianceErrors(const IrradianceComparison& comparison, RadianceModel model,
                                        int lights, double smoothFlux, size_t signals, uint64_t seed,
                                        const std::function<void(size_t)>& report = {});

/// Errors over an environment seen by surfaces of random orientation; the three colours are signals of their
/// own, flux ∫L dω of all three together 3.
/// @return for AboveSurface and FullSphere
/// @throws Interrupted
std::array<IrradianceErrors, 2> environmentIrradianceErrors(const IrradianceComparison& comparison,
                                                            const EnvironmentLights& lights, int orientations,
                                                            uint64_t seed,
                                                            const std::function<void(size_t)>& report = {});

}  // namespace prt::tools
