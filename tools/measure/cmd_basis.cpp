// prt measure basis: how well bases represent irradiance and reflectance, and what they look like.
#include <fmt/format.h>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/environment_file.h"
#include "tools/command_line.h"
#include "tools/measure/basis_functions.h"
#include "tools/measure/basis_tables.h"
#include "tools/measure/commands.h"
#include "tools/measure/output.h"

namespace prt::tools {
namespace {

struct Arguments {
    std::string signal = "irradiance";
    int signals = 10000, seed = 1;
    std::vector<std::string> environments;
    int orientations = 32, maxOrder = 10;
    std::string bases = "all";
    int order = 3;
    MeasureOptions output{.prefix = "measure-basis-SIGNAL"};
};

constexpr const char* kEpilogue =
    "Signals:\n"
    "  irradiance  IMSE of irradiance under random light (1, 2, 5, 20 directional lights, with and without\n"
    "              as much smooth light), or under --env at random orientations; cost of evaluation beside "
    "it\n"
    "  phong       accuracy for cos^5 lobes tilted by 0..75 degrees, by number of coefficients\n"
    "  ward        accuracy for the anisotropic Ward reflectance, raw (cut at 89 degrees) and times cosine\n"
    "  functions   pictures of the basis functions, one sheet per basis\n"
    "phong and ward also show by how much dot products with an environment go wrong in each basis.\n\n"
    "Examples:\n"
    "  prt measure basis --signal irradiance --json -\n"
    "  prt measure basis --signal irradiance --env studio.exr --env sky:clear\n"
    "  prt measure basis --signal functions --bases hsh,zernike --order 4 --plot png\n";

constexpr RadianceModel kModels[] = {RadianceModel::AboveSurface, RadianceModel::FullSphere};

std::vector<EnvironmentLights> loadLights(const std::vector<std::string>& sources) {
    std::vector<EnvironmentLights> lights;
    for (const std::string& source : sources) lights.push_back(environmentLights(loadEnvironment(source)));
    return lights;
}

/// One row per number of lights, with and without smooth light, and their sums. The figure's 10,000 signals
/// are those of all numbers of lights together.
std::vector<IrradianceResult> randomResults(const IrradianceComparison& comparison,
                                            const Arguments& arguments) {
    constexpr int kLights[] = {1, 2, 5, 20};
    const size_t each = (size_t(arguments.signals) + std::size(kLights) - 1) / std::size(kLights);
    Progress progress("irradiance", each * (2 * std::size(kLights) + 1) * std::size(kModels), "signals");
    const auto report = [&](size_t count) { progress.advance(count); };
    std::vector<IrradianceResult> results;
    for (const RadianceModel model : kModels) {
        results.push_back(
            {"sh", model,
             randomIrradianceErrors(comparison, model, 0, 1, each, uint64_t(arguments.seed), report)});
        for (const bool smooth : {false, true}) {
            IrradianceResult all{smooth ? "random" : "lights", model, {}};
            for (const int lights : kLights) {
                results.push_back({fmt::format("lights-{}{}", lights, smooth ? "-sh" : ""), model,
                                   randomIrradianceErrors(comparison, model, lights, smooth ? 1 : 0, each,
                                                          uint64_t(arguments.seed), report)});
                all.errors.add(results.back().errors);
            }
            results.push_back(std::move(all));
        }
    }
    return results;
}

std::vector<IrradianceResult> environmentResults(const IrradianceComparison& comparison,
                                                 const Arguments& arguments,
                                                 const std::vector<EnvironmentLights>& environments) {
    Progress progress("irradiance", environments.size() * size_t(arguments.orientations) * std::size(kModels),
                      "orientations");
    std::vector<IrradianceResult> results;
    std::array<IrradianceErrors, 2> all;
    for (const EnvironmentLights& lights : environments) {
        const auto errors =
            environmentIrradianceErrors(comparison, lights, arguments.orientations, uint64_t(arguments.seed),
                                        [&](size_t count) { progress.advance(count); });
        for (size_t i = 0; i < errors.size(); ++i) {
            results.push_back({"environment:" + lights.name, kModels[i], errors[i]});
            all[i].add(errors[i]);
        }
    }
    for (size_t i = 0; i < all.size(); ++i) results.push_back({"environments", kModels[i], all[i]});
    return results;
}

Measurement measureIrradiance(const Arguments& arguments, Report& report) {
    const auto environments = loadLights(arguments.environments);
    const IrradianceComparison comparison;
    report.set("signals", arguments.signals)
        .set("orientations", arguments.orientations)
        .set("quadrature_nodes", uint64_t(comparison.nodes().size()));
    const auto results = environments.empty() ? randomResults(comparison, arguments)
                                              : environmentResults(comparison, arguments, environments);
    const std::vector<std::string> figured = {environments.empty() ? "random" : "environments"};
    return irradianceMeasurement(comparison, results, evaluationCosts(), figured);
}

std::vector<LobeResult> lobeResults(const Arguments& arguments) {
    std::vector<LobeResult> results;
    if (arguments.signal == "phong") {
        LobeResult result{"phong", "clamped", {}, {}};
        for (const int tilt : {0, 15, 30, 45, 60, 75}) result.lobes.push_back(phongLobe(tilt));
        results.push_back(std::move(result));
    } else {
        for (const auto& [variant, name] : {std::pair(WardVariant::RawCut89, "raw-cut-89"),
                                            std::pair(WardVariant::TimesCosine, "times-cosine")}) {
            LobeResult result{"ward", name, {}, {}};
            for (const int phi : {0, 90})
                for (const int theta : {0, 30, 45, 60}) result.lobes.push_back(wardLobe(theta, phi, variant));
            results.push_back(std::move(result));
        }
    }
    for (LobeResult& result : results) result.accuracies = lobeAccuracies(result.lobes, arguments.maxOrder);
    return results;
}

Measurement measureLobes(const Arguments& arguments, Report& report) {
    std::vector<std::string> sources = arguments.environments;
    if (sources.empty()) sources = {"sky:clear", "sky:overcast", "sky:sunset"};
    const auto environments = loadLights(sources);
    report.set("max_order", arguments.maxOrder).set("orientations", arguments.orientations);
    const std::vector<LobeResult> results = lobeResults(arguments);
    std::vector<LightError> wrong;
    for (const int order : {3, 5, 8, 10}) {
        throwIfInterrupted();
        const auto errors = lightErrors(results.back().lobes, environments, order, arguments.orientations,
                                        uint64_t(arguments.seed));
        wrong.insert(wrong.end(), errors.begin(), errors.end());
    }
    return lobeMeasurement(results, wrong);
}

Measurement measureFunctions(const Arguments& arguments) {
    std::vector<std::string> names;
    for (const BasisFamily& family : basisFamilies()) names.push_back(family.name);
    Measurement measurement{.name = "basis", .rows = functionTable()};
    for (const std::string& name : parseNameList("--bases", arguments.bases, names)) {
        const auto family = std::find_if(basisFamilies().begin(), basisFamilies().end(),
                                         [&](const BasisFamily& f) { return f.name == name; });
        const auto basis = makeBasis(name, std::clamp(arguments.order, family->minOrder, family->maxOrder));
        addFunctionRows(*basis, measurement.rows);
        measurement.figures.emplace_back(
            name, basisFigure(*basis, fmt::format("{}: {} functions", family->title, basis->count())));
    }
    return measurement;
}

void checkArguments(const Arguments& arguments) {
    const bool functions = arguments.signal == "functions";
    if (!functions && arguments.bases != "all")
        throw UsageError("--bases",
                         "chooses the sheets of --signal functions; the comparisons take all bases");
    if (functions && !arguments.environments.empty())
        throw UsageError("--env", "--signal functions has no use for an environment");
}

}  // namespace

void runMeasureBasis(int argc, char** argv) {
    Arguments arguments;
    CommandLine line("prt measure basis",
                     "Represents irradiance and reflectance in every basis, by number of coefficients.",
                     kEpilogue);
    line.choice("--signal", arguments.signal, {"irradiance", "phong", "ward", "functions"},
                "what to represent");
    line.integer("--signals", arguments.signals, 4, 10000000,
                 "irradiance: random signals in the average, for each model of radiance");
    line.integer("--seed", arguments.seed, 0, 1000000000, "of random light and orientations");
    line.textList("--env", arguments.environments, "FILE|sky:NAME",
                  "environment, .exr, .hdr or a sky; repeat for several");
    line.integer("--orientations", arguments.orientations, 1, 100000,
                 "random orientations of the surface under each environment");
    line.integer("--max-order", arguments.maxOrder, 1, 16, "phong, ward: bands of the largest expansion");
    line.text("--bases", arguments.bases, "LIST", "functions: families to draw, for example hsh,zernike");
    line.integer("--order", arguments.order, 1, 6, "functions: bands to draw, as far as a family has them");
    addMeasureOptions(line, arguments.output);
    if (!line.parse(argc, argv)) return;
    checkArguments(arguments);
    if (const size_t at = arguments.output.prefix.find("SIGNAL"); at != std::string::npos)
        arguments.output.prefix.replace(at, 6, arguments.signal);
    checkMeasureOutput(arguments.output);

    Report report;
    report.set("signal", arguments.signal).set("seed", arguments.seed);
    const Measurement measurement = arguments.signal == "irradiance"  ? measureIrradiance(arguments, report)
                                    : arguments.signal == "functions" ? measureFunctions(arguments)
                                                                      : measureLobes(arguments, report);
    writeMeasurement(measurement, arguments.output, line.common(), std::move(report));
}

}  // namespace prt::tools
