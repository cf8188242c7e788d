// prt compress: principal components of a bundle's visibility.
#include <fmt/format.h>

#include "compress/compress_job.h"
#include "precompute/base/error.h"
#include "precompute/math/sh.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/environment_arguments.h"
#include "tools/report.h"

namespace prt::tools {

void runCompressCommand(int argc, char** argv) {
    CompressSettings settings;
    CommandLine line("prt compress", "Compresses a bundle's visibility to a mean and M principal vectors.",
                     "Does nothing where the bundle has just that already.\n"
                     "Examples:\n  prt compress out/house.prt --components 16\n"
                     "  prt compress out/house.prt --target-error 0.02 --env studio.exr --env forest.exr");
    line.positional("BUNDLE", settings.bundlePath, "bundle made by prt precompute");
    line.integer("--components", settings.components, 1, shCount(kMaxBundleShOrder),
                 "principal vectors M, at most the n*n coefficients of the bundle");
    line.choice("--weights", settings.weights, {"irradiance", "plain"},
                "least squares of the irradiance that shading normals receive, or of the coefficients");
    line.choice(
        "--covariance", settings.covariance, {"irradiance", "plain"},
        "what the vectors are the principal ones of: errors as irradiance sees them, where --weights are "
        "for irradiance too, or coefficients");
    line.flag("--area-weighted", settings.areaWeighted,
              "let points count as much as the surface they stand for, in vectors and reported errors");
    line.real("--target-error", settings.targetError, 0, 1,
              "instead of --components: as few vectors as keep the relative RMSE of irradiance under every "
              "--env at most so large, against the bundle's own visibility; 0: none");
    line.textList("--env", settings.environments, "FILE|sky:NAME",
                  "environments of --target-error; without any, the built-in skies");
    addEnvironmentOptions(line, settings.environmentOptions);
    line.flag("--force", settings.force, "compress again where the bundle has just that already");
    if (!line.parse(argc, argv)) return;
    if (settings.targetError > 0 && line.isGiven("--components"))
        throw UsageError("--target-error", "--components is given too",
                         "give the number of vectors or the error, not both");
    if (settings.targetError == 0 && line.isGiven("--env"))
        throw UsageError("--env", "only --target-error looks at environments", "give --target-error");

    const CompressReport result = runCompress(settings);
    if (line.common().json != "-") {
        if (result.upToDate)
            fmt::print("{}: pca.exr is current and made with these settings: nothing to do\n",
                       settings.bundlePath);
        fmt::print(
            "{}: {} components explain {:.4f} % of the variance; relative RMSE of coefficients {:.4f}, for "
            "irradiance {:.4f}; {:.1f} MB\n",
            settings.bundlePath, result.components, 100 * result.explainedVariance, result.relativeRmse,
            result.irradianceRelativeRmse, double(result.bytes) * 1e-6);
        for (const RelitError& error : result.relitErrors)
            fmt::print("  relit under {}: relative RMSE {:.4f}\n", error.environment, error.relativeRmse);
    }
    std::vector<Report> relit;
    for (const RelitError& error : result.relitErrors) {
        Report one;
        one.set("environment", error.environment).set("relative_rmse", error.relativeRmse);
        relit.push_back(std::move(one));
    }
    Report report;
    report.set("bundle", settings.bundlePath)
        .set("components", result.components)
        .set("points", uint64_t(result.points))
        .set("explained_variance", result.explainedVariance)
        .set("relative_rmse", result.relativeRmse)
        .set("rmse", result.rmse)
        .set("irradiance_relative_rmse", result.irradianceRelativeRmse)
        .set("relit_errors", relit)
        .set("up_to_date", result.upToDate)
        .set("bytes", uint64_t(result.bytes))
        .set("seconds", result.seconds);
    report.write(line.common().json);
}

}  // namespace prt::tools
