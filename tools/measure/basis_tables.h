// Tables, figures and text of `prt measure basis` from what was measured.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/measure/basis_brdf.h"
#include "tools/measure/basis_cost.h"
#include "tools/measure/basis_irradiance.h"
#include "tools/measure/output.h"

namespace prt::tools {

/// One measured signal of the irradiance comparison.
struct IrradianceResult {
    std::string signal;  ///< "random", "lights-5-sh", "environment:NAME", …
    RadianceModel model;
    IrradianceErrors errors;
};
const char* radianceName(RadianceModel model);

/// @param figured  names of the signals that the figure and the printed table show
Measurement irradianceMeasurement(const IrradianceComparison& comparison,
                                  std::span<const IrradianceResult> results,
                                  std::span<const EvaluationCost> costs,
                                  std::span<const std::string> figured);

/// Lobes of one kind, measured.
struct LobeResult {
    std::string signal;   ///< "phong" or "ward"
    std::string variant;  ///< "clamped", "raw-cut-89" or "times-cosine"
    std::vector<Lobe> lobes;
    std::vector<LobeAccuracy> accuracies;
};

Measurement lobeMeasurement(std::span<const LobeResult> results, std::span<const LightError> wrongLight);

}  // namespace prt::tools
