// Stage 2 as a whole: compress and tabulate a bundle.
#pragma once

#include <string>
#include <vector>

#include "precompute/io/environment_file.h"

namespace prt {

struct CompressSettings {
    std::string bundlePath;
    int components = 16;  ///< 1..n²
    /// How the weights of a point are found: "irradiance" fits the irradiance of its shading normals, "plain"
    /// projects its coefficients.
    std::string weights = "irradiance";
    /// Above 0, in place of `components`: the least number of vectors whose relative RMSE of irradiance under
    /// every one of the environments is at most this, against the bundle's own visibility.
    double targetError = 0;
    std::vector<std::string> environments = {};  ///< of targetError; empty: the built-in skies
    EnvironmentOptions environmentOptions = {};
    bool force = false;  ///< also where the bundle has just that already
};

/// What relighting loses by compression, under one environment.
struct RelitError {
    std::string environment;
    double relativeRmse = 0;
};
struct CompressReport {
    int components = 0;
    size_t points = 0;
    double explainedVariance = 0;
    double relativeRmse = 0;  ///< of coefficients, over valid points
    double rmse = 0;
    double irradianceRelativeRmse = 0;  ///< of coefficients in the metric of irradiance, over valid points
    double seconds = 0;
    size_t bytes = 0;                     ///< of pca.exr
    std::vector<RelitError> relitErrors;  ///< where a target was given
    bool upToDate = false;                ///< the bundle had just that already: nothing was written
};
/// PCA of visibility.exr over valid points, weights for all points; writes pca.exr. Does nothing where
/// pca.exr is current and was made with the same settings.
/// @throws UsageError  components above n² (names the limit), or no such kind of weights   @throws
/// InputError, OutputError
CompressReport runCompress(const CompressSettings& settings);

struct TabulateSettings {
    std::string bundlePath;
    std::vector<std::string> environments;  ///< files or sky:NAME
    std::string kind = "triple-product";    ///< or "light-cosine"
    std::string layout = "cube";
    int size = 32;
    EnvironmentOptions environmentOptions = {};
    bool force = false;  ///< also tables that the bundle has just so already
};
struct TabulateRow {
    std::string environment, file;
    std::string environmentHash;  ///< of its pixels
    size_t bytes = 0;
    double seconds = 0;
    bool upToDate = false;  ///< the bundle had just that already
};
/// Writes a table for each environment; leaves those that are current and were made with the same settings.
std::vector<TabulateRow> runTabulate(const TabulateSettings& settings);

/// File name of a table within its bundle: tables/ENV.KIND.LAYOUT.exr (characters outside [A-Za-z0-9_-]
/// become '_').
std::string tableFileName(const std::string& environmentName, const std::string& kind,
                          const std::string& layout);

}  // namespace prt
