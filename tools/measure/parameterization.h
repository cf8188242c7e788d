// How well textures over the sphere hold spherical harmonics: Figure 8 of Iwanicki & Sloan 2012 for every
// parameterization there is.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace prt::tools {

struct ParameterizationSettings {
    std::vector<int> shOrders = {3, 6};  ///< each 1..kMaxShOrder
    std::vector<std::string> layouts;    ///< names of sphereMapFamilies()
    int points = 1'000'000;              ///< directions, >= 1
    int maxSamples = 25'000;             ///< of the largest table
    bool half = false;                   ///< tables rounded to half floats too
    uint64_t seed = 2012;                ///< of the directions
};

struct ParameterizationRow {
    int shOrder;
    std::string layout;
    std::string table;  ///< "float" or "half"
    int size;           ///< as makeSphereMap takes it
    int samples;        ///< all stored texels, duplicates on shared equators counted
    double mse;         ///< mean over directions and functions of (looked up − exact)²
};

/// The sizes at which a layout is measured, rising: those nearest in samples to cubes of 3, 4, 6, 8, 11, 16,
/// … texels along an edge (54, 96, 216, 384, 726, 1536, …), so that layouts can be compared; of octahedral
/// maps the even ones.
/// @param maxSamples  no table is larger; none may fit
/// @throws InputError  unknown layout
std::vector<int> parameterizationSizes(const std::string& layout, int maxSamples);

/// Evaluates every SH function at all texel centres, looks it up in `points` uniform random directions with
/// the layout's own filter, and compares with its exact value. The result does not depend on the number of
/// threads.
/// @return rows by order, then layout (as given), then table, then size
/// @throws InputError   unknown layout
/// @throws Interrupted
/// @source [IwanickiSloan2012, Appendix A, Fig. 8]
std::vector<ParameterizationRow> measureParameterization(const ParameterizationSettings& settings);

}  // namespace prt::tools
