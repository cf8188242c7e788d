// Stage 2 on a bundle: compresses its visibility [IwanickiSloan2012, Sec. 4] and writes the result back in
// one transaction.
#include "compress/compress_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "compress/choose_components.h"
#include "compress/compress_visibility.h"
#include "compress/point_areas.h"
#include "compress/renewal_command.h"
#include "compress/tables/normal_tables.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/bundle.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/glb.h"
#include "precompute/io/visibility_file.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

constexpr const char* kVisibility = "visibility.exr";
constexpr const char* kPca = "pca.exr";
constexpr const char* kMesh = "mesh.glb";
constexpr const char* kIrradiance = "irradiance";

std::string compressCommand(const CompressSettings& settings) {
    std::string command = fmt::format("prt compress {}", settings.bundlePath);
    if (settings.targetError == 0)
        command += fmt::format(" --components {}", settings.components);
    else
        command += fmt::format(" --target-error {:g}", settings.targetError);
    command += fmt::format(" --weights {} --covariance {}", settings.weights, settings.covariance);
    if (settings.areaWeighted) command += " --area-weighted";
    if (settings.targetError == 0) return command;
    for (const std::string& environment : settings.environments)
        command += " --env " + shellWord(environment);
    return command + environmentWords(settings.environmentOptions);
}

void checkComponents(int components, int shOrder) {
    if (components < 1)
        throw UsageError("--components", fmt::format("{} is not a number of vectors", components),
                         fmt::format("use 1 to {}", shCount(shOrder)));
    if (components > shCount(shOrder))
        throw UsageError(
            "--components",
            fmt::format("{} is above the {} coefficients of order {}", components, shCount(shOrder), shOrder),
            fmt::format("use at most {}", shCount(shOrder)));
}

void checkTargetError(double target) {
    if (target != 0 && !(target >= 1e-6 && target <= 1))
        throw UsageError("--target-error", fmt::format("{} is out of range", target), "use 1e-6 to 1");
}

void checkKinds(const CompressSettings& settings) {
    if (settings.weights != kIrradiance && settings.weights != "plain")
        throw UsageError("--weights",
                         fmt::format("there is no kind of weights called '{}'", settings.weights),
                         "use irradiance or plain");
    if (settings.covariance != kIrradiance && settings.covariance != "plain")
        throw UsageError("--covariance",
                         fmt::format("there is no kind of covariance called '{}'", settings.covariance),
                         "use irradiance or plain");
}

// All but the weights.
PcaMap makePcaMap(const VisibilityMap& visibility, const PcaResult& pca, const CompressSettings& settings) {
    PcaMap map = pcaMapOf(visibility, pca);
    // How the visibility was projected stays true of its compressed form.
    map.attributes = visibility.attributes;
    map.attributes["explainedVariance"] = fmt::format("{:.9g}", pca.explainedVariance);
    map.attributes["weightsFit"] = settings.weights;
    map.attributes["covariance"] = settings.covariance;
    map.attributes["pointsCount"] = settings.areaWeighted ? "area" : "equal";
    if (settings.weights == kIrradiance) {
        const IrradianceWeight& weight = visibility.projection.weight;
        map.attributes["weightsConeDegrees"] = fmt::format("{:.9g}", weight.coneDegrees);
        map.attributes["weightsFloor"] = fmt::format("{:.9g}", weight.floor);
    }
    return map;
}

// Environments that a target error holds for.
struct TargetEnvironments {
    std::vector<std::string> names, hashes;
    std::vector<Environment> loaded;

    explicit TargetEnvironments(const CompressSettings& settings) {
        if (settings.targetError == 0) return;
        std::vector<std::string> sources = settings.environments;
        if (sources.empty()) sources = builtInEnvironments();
        for (const std::string& source : sources) {
            loaded.push_back(loadEnvironment(source, settings.environmentOptions));
            names.push_back(loaded.back().name);
            hashes.push_back(loaded.back().contentHash);
        }
    }
};

nlohmann::json compressSettingsJson(const CompressSettings& settings, const TargetEnvironments& target) {
    nlohmann::json json = {{"weights", settings.weights},
                           {"covariance", settings.covariance},
                           {"area_weighted", settings.areaWeighted}};
    if (settings.targetError == 0) {
        json["components"] = settings.components;
    } else {
        json["target_error"] = settings.targetError;
        json["environments"] = target.names;
        json["environment_hashes"] = target.hashes;
    }
    return json;
}

nlohmann::json statisticsJson(const CompressReport& report) {
    nlohmann::json json = {{"components", report.components},
                           {"points", report.points},
                           {"explained_variance", report.explainedVariance},
                           {"relative_rmse", report.relativeRmse},
                           {"rmse", report.rmse},
                           {"irradiance_relative_rmse", report.irradianceRelativeRmse},
                           {"bytes", report.bytes},
                           {"seconds", report.seconds}};
    for (const RelitError& error : report.relitErrors)
        json["relit_relative_rmse"][error.environment] = error.relativeRmse;
    return json;
}

// What an earlier run reported, where the bundle still has its result and it is just what is wanted.
std::optional<CompressReport> reportOfSame(const Bundle& bundle, const std::string& wantedSettings) {
    if (!bundle.find(kPca) || !bundle.staleReason(kPca, true).empty()) return std::nullopt;
    const nlohmann::json section = nlohmann::json::parse(bundle.section("compress"), nullptr, false);
    if (!section.is_object() || !section.contains("settings") || !section.contains("statistics") ||
        section["settings"].dump() != wantedSettings)
        return std::nullopt;
    const nlohmann::json& statistics = section["statistics"];
    if (!statistics.is_object() || !statistics.contains("components")) return std::nullopt;
    try {
        CompressReport report;
        report.upToDate = true;
        report.components = statistics["components"].get<int>();
        report.points = statistics.at("points").get<size_t>();
        report.explainedVariance = statistics.at("explained_variance").get<double>();
        report.relativeRmse = statistics.at("relative_rmse").get<double>();
        report.rmse = statistics.at("rmse").get<double>();
        report.irradianceRelativeRmse = statistics.at("irradiance_relative_rmse").get<double>();
        report.bytes = statistics.at("bytes").get<size_t>();
        report.seconds = statistics.at("seconds").get<double>();
        if (statistics.contains("relit_relative_rmse"))
            for (const auto& [name, value] : statistics["relit_relative_rmse"].items())
                report.relitErrors.push_back({name, value.get<double>()});
        return report;
    } catch (const nlohmann::json::exception&) {  // written by hand: made again
        return std::nullopt;
    }
}

RowWeightSource areaWeights(const Bundle& bundle, const PointGrid& grid) {
    bundle.require(kMesh, "prt precompute");
    const auto areas = std::make_shared<const PointAreas>(readGltf(bundle.pathOf(kMesh).string()), grid);
    return [areas](int firstRow, int rows, std::vector<float>& weights) {
        areas->evaluate(firstRow, rows, weights);
    };
}

CompressionSettings compressionSettings(const CompressSettings& settings) {
    return {settings.components, settings.weights == kIrradiance ? WeightsFit::Irradiance : WeightsFit::Plain,
            settings.covariance == kIrradiance ? Covariance::Irradiance : Covariance::Plain};
}

PcaResult findBasis(const VisibilityOnDisk& rows, const VisibilityStatistics& statistics,
                    const CompressSettings& settings, const TargetEnvironments& target,
                    CompressReport& report) {
    const CompressionSettings wanted = compressionSettings(settings);
    if (settings.targetError == 0) return statistics.basis(wanted);
    std::vector<EnvironmentSh> environments;
    for (const Environment& environment : target.loaded)
        environments.push_back(
            projectEnvironment(environment.view(), tableEnvironmentShOrder(rows.shOrder())));
    ChosenBasis chosen = chooseBasis(statistics, rows.shOrder(), rows.header().projection, wanted,
                                     environments, settings.targetError);
    for (size_t k = 0; k < target.names.size(); ++k)
        report.relitErrors.push_back({target.names[k], chosen.relitErrors[k]});
    return std::move(chosen.pca);
}

}  // namespace

CompressReport runCompress(const CompressSettings& settings) {
    const Stopwatch watch;
    checkKinds(settings);
    checkTargetError(settings.targetError);
    const Bundle bundle = Bundle::open(settings.bundlePath);
    bundle.require(kVisibility, "prt precompute");
    const TargetEnvironments target(settings);
    const std::string wanted = compressSettingsJson(settings, target).dump();
    if (!settings.force)
        if (const auto report = reportOfSame(bundle, wanted)) return *report;

    VisibilityOnDisk rows(bundle.pathOf(kVisibility).string());
    const VisibilityMap& header = rows.header();
    if (settings.targetError == 0) checkComponents(settings.components, header.shOrder);

    std::map<std::string, std::string> madeFrom = {{kVisibility, bundle.find(kVisibility)->xxh3}};
    if (settings.areaWeighted) {
        rows.setRowWeights(areaWeights(bundle, header.grid));
        madeFrom[kMesh] = bundle.find(kMesh)->xxh3;
    }
    CompressReport report;
    const VisibilityStatistics statistics(rows, header.projection);
    const PcaResult pca = findBasis(rows, statistics, settings, target, report);
    BundleTransaction transaction(settings.bundlePath, false);
    const std::filesystem::path staged =
        transaction.stage(kPca, std::move(madeFrom), compressCommand(settings));
    PcaWriter writer(staged.string(), makePcaMap(header, pca, settings));
    CompressionErrors errors;
    compressRows(
        rows, header.projection, pca, compressionSettings(settings).fit,
        [&](std::span<const float> weights) { writer.write(weights); }, &errors);
    writer.commit();
    report.components = pca.components;
    report.points = statistics.pointsUsed();
    report.explainedVariance = pca.explainedVariance;
    report.relativeRmse = errors.relativeRmse;
    report.rmse = errors.rmse;
    report.irradianceRelativeRmse = errors.irradianceRelativeRmse;
    report.bytes = size_t(std::filesystem::file_size(staged));
    report.seconds = watch.seconds();
    nlohmann::json section = {{"settings", nlohmann::json::parse(wanted)},
                              {"statistics", statisticsJson(report)}};
    section["statistics"]["variance"] = pca.variance;
    section["statistics"]["total_variance"] = pca.totalVariance;
    transaction.setSection("compress", section.dump());
    transaction.commit();
    report.seconds = watch.seconds();
    return report;
}

}  // namespace prt
