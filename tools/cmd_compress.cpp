// prt compress: principal components of a bundle's visibility.
#include <fmt/format.h>

#include "compress/jobs.h"
#include "precompute/math/sh.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/report.h"

namespace prt::tools {

void runCompressCommand(int argc, char** argv) {
    CompressSettings settings;
    CommandLine line("prt compress", "Compresses a bundle's visibility to a mean and M principal vectors.",
                     "Example:\n  prt compress out/house.prt --components 16");
    line.positional("BUNDLE", settings.bundlePath, "bundle made by prt precompute");
    line.integer("--components", settings.components, 1, shCount(kMaxBundleShOrder),
                 "principal vectors M, at most the n*n coefficients of the bundle");
    line.choice("--weights", settings.weights, {"irradiance", "plain"},
                "least squares of the irradiance that shading normals receive, or of the coefficients");
    if (!line.parse(argc, argv)) return;

    const CompressReport result = runCompress(settings);
    if (line.common().json != "-")
        fmt::print(
            "{}: {} components explain {:.4f} % of the variance; relative RMSE of coefficients {:.4f}, for "
            "irradiance {:.4f}; {:.1f} MB\n",
            settings.bundlePath, result.components, 100 * result.explainedVariance, result.relativeRmse,
            result.irradianceRelativeRmse, double(result.bytes) * 1e-6);
    Report report;
    report.set("bundle", settings.bundlePath)
        .set("components", result.components)
        .set("points", uint64_t(result.points))
        .set("explained_variance", result.explainedVariance)
        .set("relative_rmse", result.relativeRmse)
        .set("rmse", result.rmse)
        .set("irradiance_relative_rmse", result.irradianceRelativeRmse)
        .set("bytes", uint64_t(result.bytes))
        .set("seconds", result.seconds);
    report.write(line.common().json);
}

}  // namespace prt::tools
