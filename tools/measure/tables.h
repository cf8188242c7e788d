// What tables over the normal lose: to bilinear interpolation, to the paper's cosine of three bands; what
// they cost.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "precompute/io/environment_file.h"
#include "precompute/math/vec.h"

namespace prt::tools {

/// "paper" (cosine of three bands), "exact" (kTableCosineBands).
const std::vector<std::string>& tableVariants();
/// Bands of the cosine of a variant.
int tableVariantBands(const std::string& variant);

struct TableStudy {
    int shOrder = 6;  ///< of visibility, 1..kMaxBundleShOrder
    std::vector<int> sizes = {8, 16, 32, 64};
    std::vector<std::string> layouts;   ///< of TableLayout::names()
    std::vector<std::string> variants;  ///< of tableVariants()
    int points = 4000;                  ///< where irradiance is judged
    double coneDeg = 35;                ///< shading normals lie so far from geometric ones at most
    int components = 16;                ///< vectors of the triple-product tables that are timed; at most n²
    int rounds = 15;                    ///< of timing; 0: nothing is timed
    uint64_t seed = 1;
};

/// Points of no particular surface: shading normals, and visibility of the half-space about geometric ones
/// with round holes cut into it.
struct TablePoints {
    std::vector<Vec3f> normals;
    std::vector<float> visibility;  ///< [points×n²]
};
/// The same for the same study.
TablePoints makeTablePoints(const TableStudy& study);

/// Errors are RMS over all points and colours, relative to the RMS of irradiance.
struct TableErrorRow {
    std::string environment, variant, layout;
    int size;
    double interpolation;  ///< looked up against the same variant evaluated at the normal
    double total;          ///< looked up against a cosine of all bands evaluated at the normal
    double worst;          ///< largest error of interpolation over the RMS of irradiance
};
/// Errors without a table.
struct TableVariantRow {
    std::string environment;
    double paper;  ///< the paper's variant against a cosine of all bands
    double exact;  ///< kTableCosineBands against a cosine of all bands
};
struct TableCostRow {
    std::string variant, layout;
    int size;
    uint64_t texels, bytes;          ///< of a light-cosine table of three colours in float
    double lightCosineMs, tripleMs;  ///< from projected environment to tables, one thread; NaN: not timed
};
struct TableResult {
    std::vector<TableErrorRow> errors;      ///< by environment, variant, layout, size
    std::vector<TableVariantRow> variants;  ///< by environment
    std::vector<TableCostRow> costs;        ///< by variant, layout, size
};

/// @throws InputError  a size that a layout cannot have
/// @throws Interrupted
/// @source [IwanickiSloan2012, Sec. 3.2-3.3]
TableResult studyTables(const std::vector<Environment>& environments, const TableStudy& study);

}  // namespace prt::tools
