// Products of functions given by spherical harmonics: tripling coefficients, products and product matrices.
#pragma once

#include <cstddef>
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

/// The same for factors and product of one order, in float and without allocating (but for the table of an
/// order above kMaxProductCodeOrder at its first use). An error of a coefficient is at most 3e-6 of |f||g|,
/// to 6 bands.
/// @param shOrder    n, 1..kMaxShOrder; straight-line code to kMaxProductCodeOrder
/// @param f, g, out  [n²]; out may be f or g
/// @source as above
void shProduct(int shOrder, std::span<const float> f, std::span<const float> g, std::span<float> out);

/// Largest order for which products have straight-line code.
inline constexpr int kMaxProductCodeOrder = 6;

/// Many products as structures of arrays: coefficient i of item k at [i·stride + k] in f, g and out.
/// Allocates as little as the single product.
/// @param f, g, out  at least (n² − 1)·stride + count floats each; out may be f or g. What lies between the
/// rows is
///                   left alone. Fastest where rows begin at multiples of 64 bytes that share no cache sets.
/// @param stride     >= count
/// @source as above
void shProductSoa(int shOrder, std::span<const float> f, std::span<const float> g, std::span<float> out,
                  size_t count, size_t stride);

/// Matrix of "multiply by f": M[r·columns + c] = ∫ f Y_r Y_c.
/// @param f  [orderF²]; orderF >= rowsOrder + columnsOrder − 1 makes it exact for an f of unlimited bands
/// @return [rowsOrder² × columnsOrder²], row-major
/// @source [Sloan2008, "SH products"]
std::vector<float> productMatrix(std::span<const float> f, int rowsOrder, int columnsOrder);

/// Product with a prebuilt factor: out = M g. Allocates nothing.
/// @param matrix  [rowsOrder² × columnsOrder²] of productMatrix; a square one is taken to be symmetric
/// @param g       [columnsOrder²]   @param out  [rowsOrder²], apart from g
/// @source as productMatrix
void applyProductMatrix(std::span<const float> matrix, std::span<const float> g, std::span<float> out);

/// One matrix for many vectors: out_k = M g_k, structures of arrays as in shProductSoa. Allocates nothing.
/// @param matrix  [rowsOrder² × columnsOrder²]
/// @param g       at least (columnsOrder² − 1)·stride + count floats
/// @param out     at least (rowsOrder² − 1)·stride + count, apart from g
/// @param stride  >= count
/// @source as productMatrix
void applyProductMatrixSoa(std::span<const float> matrix, int rowsOrder, int columnsOrder,
                           std::span<const float> g, std::span<float> out, size_t count, size_t stride);

/// Ways of multiplying two expansions of one order.
enum class ShProductMethod {
    kTable,         ///< Σ over all non-zero tripling coefficients
    kStraightLine,  ///< shProduct's code, to kMaxProductCodeOrder
    kMatrix,        ///< a prebuilt matrix of one factor, applied
    kMatrixBuild,   ///< that matrix built, by productMatrix
};

/// What one product of n bands costs: operations counted in the code, a multiplication and an addition even
/// where a machine fuses them.
struct ShProductCost {
    int64_t multiplications, additions;
};
/// @param shOrder  1..kMaxShOrder; for kStraightLine 1..kMaxProductCodeOrder
ShProductCost shProductCost(ShProductMethod method, int shOrder);
/// Non-zero tripling coefficients of n bands: 83, 353, 1158, 2907 for n = 3…6.
/// @param shOrder  1..kMaxShOrder
int64_t shProductNonZeros(int shOrder);

}  // namespace prt
