// The error report: what each stage of the pipeline costs in irradiance, against ray-traced truth.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "precompute/io/environment_file.h"
#include "tools/measure/error_light.h"
#include "tools/measure/error_points.h"

namespace prt::tools {

/// Stages in the order of the pipeline.
enum class ErrorStage { Sampling, Truncation, Projection, Pca, Quantisation, Tables };
inline constexpr size_t kErrorStages = 6;
/// "sampling", "truncation", "projection", "pca", "quantisation", "tables".
const char* errorStageName(ErrorStage stage);

/// Fewer leave no two different sets.
inline constexpr int kFewestErrorRays = 256;

struct ErrorStudy {
    size_t points = 2048;  ///< judged, spread evenly over the valid ones; 0: all
    /// Directions over the sphere, of the truth (more where the light is) and of the dense bakes: two
    /// independent sets that share them, whose difference is the noise. kFewestErrorRays..kMaxBakeRays
    int rays = 16384;
    double tiltDeg = 20;            ///< of four shading normals about the geometric one, 0..60
    std::string weights = "unorm8"; /**< "float", "half", "unorm16", "unorm8"; coefficients of a bundle that
                                         is not compressed: float for "float", else half */
    TableOptions table;             ///< without extraction of suns
    std::string tables = "half";    ///< "float", "half"; of cubes also "rgb9e5", "r11f"
    bool maps = false;              ///< keep errors of every point
};

/// √(Σ|e|² / Σ|E*|²) over points, normals and colours, e the mean of both halves. Both sums are of products
/// of the two halves, in which independent noise averages out.
struct ErrorFigure {
    double relativeRmse = 0;  ///< of all five normals
    double geometric = 0;     ///< of the geometric normals alone
    double tilted = 0;        ///< of the tilted ones
    double psnrDb = 0;        ///< 20 log10(max E* / RMSE); infinite for no error
    /// What the two halves differ by, over two: the noise of the directions in e. A figure below it says no
    /// more than that the error is below it.
    double noise = 0;
    bool isBelowNoise() const { return relativeRmse < noise; }
};

/// Irradiances are compared for each environment alone; those of the mean are means of its figures.
struct ErrorBlock {
    std::string environment;  ///< name, or "mean"
    bool isDark = false;      ///< no light reaches any point: all figures are 0, and it counts in no mean
    double truthNoise = 0;    ///< of E*, relative
    ErrorFigure total;        ///< as shipped
    std::array<ErrorFigure, kErrorStages> alone;    ///< [ErrorStage] all others exact
    std::array<ErrorFigure, kErrorStages> without;  ///< [ErrorStage] that one exact, all others as shipped
    /// [ErrorStage] exact up to where a stage enters, in the order truncation, projection, sampling, pca,
    /// quantisation, tables: the last is the total
    std::array<ErrorFigure, kErrorStages> upTo;
    ErrorFigure plain;        ///< truncation alone had the projection been plain
    ErrorFigure bands;        ///< part of tables: bands of the cosine
    ErrorFigure lookup;       ///< part of tables: texels and bilinear lookup
    ErrorFigure weights;      ///< part of quantisation: format of the weights
    ErrorFigure tableFormat;  ///< part of quantisation: format of the tables

    /// total − without: what making the stage exact gains; negative where errors cancel.
    double gain(ErrorStage stage) const { return total.relativeRmse - without[size_t(stage)].relativeRmse; }
};

/// Errors of every point under one environment: √(mean |e|² over normals and colours), as a share of the RMS
/// of E* over all points, so that the RMS of a map is about the figure.
struct ErrorMap {
    std::vector<float> total;                            ///< [points]
    std::array<std::vector<float>, kErrorStages> alone;  ///< [ErrorStage][points]
};

struct ErrorResult {
    size_t points = 0;
    size_t directions = 0;  ///< of the truth, both halves
    bool isCompressed = false;
    int components = 0;
    std::vector<ErrorBlock> environments;
    ErrorBlock mean;
    std::vector<ErrorMap> maps;  ///< [environments]; empty unless asked for
};

/// Definitions of all stages, with formulas: tools/docs/error_report.md.
/// @param caster  of the bundle's mesh
/// @throws UsageError   a value out of range
/// @throws Interrupted
ErrorResult studyError(const JudgedBundle& bundle, const RayCaster& caster, const JudgedPoints& points,
                       std::span<const Environment> environments, const ErrorStudy& study);

}  // namespace prt::tools
