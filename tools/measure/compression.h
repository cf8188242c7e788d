// What compression of visibility loses and saves, by order and number of vectors.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "precompute/io/environment_file.h"
#include "tools/measure/compression_cost.h"
#include "tools/measure/compression_scene.h"

namespace prt::tools {

/// Largest CompressionStudy::lightOrders: what tables of one band of visibility see.
inline constexpr int kMostLightBands = 12;

struct CompressionStudy {
    /// Numbers of bands, 1..kMaxBundleShOrder
    std::vector<int> orders{3, 4, 6};
    /// Numbers of vectors, rising; those below n² of an order are measured, then n² itself
    std::vector<int> components{4, 8, 12, 16, 24};
    /// Bands of the light, 1..kMostLightBands
    std::vector<int> lightOrders{3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    std::string encoding = "unorm8";  ///< of weights as shipped; coefficients are half
    int points = 400;                 ///< where irradiance is judged, over the mesh by area
    uint64_t seed = 1;
};

/// One way to store visibility. Errors are relative RMSE of irradiance at the geometric normal and four
/// normals tilted by 20 degrees, means over the environments.
struct CompressionRow {
    int shOrder = 0;
    int components = 0;  ///< 0: coefficients, uncompressed
    size_t bytes = 0;    ///< of a point, as shipped
    PixelCost cost;
    double coefficients = 0;  ///< relative RMSE of coefficients by compression, weights in float
    double compression = 0;   ///< against uncompressed visibility of the order, weights in float
    double shipped = 0;       ///< the same, in the format shipped
    double truth = 0;         ///< against ray-traced truth, in the format shipped
};

/// What an order itself gives, without compression, against ray-traced truth.
struct CompressionOrder {
    int shOrder = 0;
    double truncation = 0;    ///< of visibility baked at the very points that are judged
    double uncompressed = 0;  ///< of the bundle's, interpolated between its texels or vertices
};

/// Compression under light of few bands, against uncompressed visibility under the same light.
struct LightOrderRow {
    int shOrder, components, lightOrder;
    double compression;
};

struct CompressionResult {
    PointDomain domain = PointDomain::Texel;
    int points = 0;
    std::vector<CompressionRow> rows;  ///< by order: uncompressed, then rising numbers of vectors
    std::vector<CompressionOrder> orders;
    std::vector<LightOrderRow> lights;  ///< by order, number of vectors, bands of the light
};

/// @param scene         of study.orders' highest order or more
/// @param environments  at least one
/// @throws InputError, Interrupted
/// @source [IwanickiSloan2012, Sec. 5]
CompressionResult studyCompression(CompressionScene& scene, const std::vector<Environment>& environments,
                                   const CompressionStudy& study);

/// The numbers of vectors that are measured for an order: those of `components` below n², then n².
std::vector<int> componentsOf(const std::vector<int>& components, int shOrder);

/// "12 vectors for order 4", "16 to 24 for order 6": enough where compression alone changes irradiance by no
/// more than the truncation of the order does; faithful where the error against truth is at most a tenth
/// above that of uncompressed visibility.
struct CompressionClaim {
    int shOrder = 0, components = 0;
    double compression = 0, truncation = 0;
    double truth = 0, uncompressed = 0;  ///< against ray-traced truth
    bool isEnough = false, isFaithful = false;
    int leastEnough = 0, leastFaithful = 0;  ///< fewest vectors measured that are; 0: none
};

/// Those of the paper's claims whose order and number of vectors were measured.
/// @source [IwanickiSloan2012, Sec. 5]
std::vector<CompressionClaim> checkClaims(const CompressionResult& result);

/// How far errors under light of 3 and more bands lie apart, for one order and number of vectors. Visibility
/// of n bands meets n + 2 bands of light, but for what the cosine has beyond its third.
struct LightSensitivity {
    int shOrder = 0, components = 0;
    double lowest = 0, highest = 0;          ///< LightOrderRow::compression
    double lowestSeen = 0, highestSeen = 0;  ///< of light with n + 2 bands or more; NaN: none was measured
};
std::vector<LightSensitivity> lightSensitivity(const CompressionResult& result);

}  // namespace prt::tools
