// What a user may choose of tables: their layout and size, how much of the cosine they hold, and what becomes
// of the light before.
#pragma once

#include <optional>
#include <string>

#include "compress/tables/fast_tables.h"
#include "precompute/math/environment.h"
#include "precompute/math/extract_sun.h"
#include "precompute/math/table_layout.h"

namespace prt {

struct TableOptions {
    std::string layout = "cube";  ///< one of TableLayout::names()
    int size = 32;                ///< texels along the side of a face
    /// "exact": all bands of the cosine that matter (kTableCosineBands); "paper": its first three
    std::string variant = "exact";
    /// Of the light, against ringing: "none", or "hanning", "lanczos", "gaussian" (math/sh_window.h), each as
    /// wide as the light of exact tables has bands; "NAME:WIDTH" says how wide, in bands, "NAME:auto" the
    /// widest that leaves the light nowhere negative
    std::string window = "none";
    /// Takes the sun out of environments that have one: it becomes a light of its own with its own shadow
    bool extractSun = false;

    int cosineBands() const;
    /// Order that environments are projected to.
    int environmentShOrder(int shOrder) const { return tableEnvironmentShOrder(shOrder, cosineBands()); }
    bool operator==(const TableOptions&) const = default;
};

/// "exact", "paper".
const std::vector<std::string>& tableVariantNames();

/// @param prefix  of the options of the command line that errors name
/// @throws UsageError  names the option and what it takes
void checkTableOptions(const TableOptions& options, const std::string& prefix = "--");

/// Options of the command line for all that differs from the defaults, each behind a space.
std::string tableWords(const TableOptions& options);

/// An environment as tables take it.
struct TableLight {
    EnvironmentSh rest;  ///< of options.environmentShOrder(shOrder), without the sun, windowed
    ExtractedSun sun;    ///< found only where it was asked for
    /// Of the window, bands; infinity where the light needs none, 0 where none was asked for
    double windowWidth = 0;
};
/// @param shOrder  n of the visibility
TableLight projectTableLight(const LatLongView& image, int shOrder, const TableOptions& options);

/// Multiplies the bands of an environment as options.window says. Blends of lights that are nowhere negative
/// are not either, so each environment may be windowed by itself.
/// @return the width, as TableLight::windowWidth
double applyTableWindow(const TableOptions& options, EnvironmentSh& environment);

}  // namespace prt
