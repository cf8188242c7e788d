// Products of functions given by spherical harmonics: tripling coefficients, products and product matrices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace prt {

/// ∫ Y_i Y_j Y_k, of which few are not zero.
struct TriplingCoefficient {
    uint16_t i, j, k;
    float value;
};

/// All non-zero coefficients with i < orderI², j < orderJ², k < orderK², sorted by (k, i, j). Computed once
/// per triple of orders and kept; thread-safe.
/// @param orderI, orderJ, orderK  1..kMaxShOrder
const std::vector<TriplingCoefficient>& triplingCoefficients(int orderI, int orderJ, int orderK);

/// (f·g)_k = Σ_ij f_i g_j ∫Y_i Y_j Y_k, to orderOut bands.
/// @param f [orderF²]  @param g [orderG²]  @return [orderOut²]
/// @source [Ren2006], [Sloan2008, "SH products"]
std::vector<float> shProduct(std::span<const float> f, std::span<const float> g, int orderOut);

/// Matrix of "multiply by f": M[r·columns + c] = ∫ f Y_r Y_c.
/// @param f  [orderF²]; orderF >= rowsOrder + columnsOrder − 1 makes it exact for an f of unlimited bands
/// @return [rowsOrder² × columnsOrder²], row-major
std::vector<float> productMatrix(std::span<const float> f, int rowsOrder, int columnsOrder);

}  // namespace prt
