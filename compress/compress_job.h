// prt compress: the PCA of a bundle's visibility.
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
    /// What the vectors are the principal ones of: "irradiance" refines them for what irradiance sees, where
    /// weights are for irradiance too; "plain" takes coefficients as they are.
    std::string covariance = "irradiance";
    /// Points count as much as the surface that they stand for (PointAreas), in the vectors and in the errors
    /// of the report; else all the same. Needs mesh.glb.
    bool areaWeighted = false;
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
/// pca.exr is current and was made with the same settings. Reads the file twice, some rows at a time: memory
/// does not depend on their number (VisibilityOnDisk, VisibilityStatistics).
/// @throws UsageError  components above n² (names the limit), no such kind of weights or covariance
/// @throws InputError, OutputError
CompressReport runCompress(const CompressSettings& settings);

}  // namespace prt
