// Numbers in the formats that graphics hardware samples. Arrays in, arrays out.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace prt {

/// Largest finite values of the formats.
inline constexpr float kMaxHalf = 65504.0f, kMaxRgb9e5 = 65408.0f, kMaxUfloat11 = 65024.0f,
                       kMaxUfloat10 = 64512.0f;

/// IEEE binary16, rounded to nearest even; beyond 65520 infinity, NaN stays NaN.
/// @return the 16 bits
/// @source [IEEE754]
uint16_t halfFromFloat(float value);
/// Exact.
/// @param bits  any; infinities and NaN too
float floatFromHalf(uint16_t bits);

/// Three values with 9 bits of mantissa each over a common exponent of 5 bits (bias 15), rounded to nearest;
/// negative numbers and NaN become 0, what is above kMaxRgb9e5 becomes that.
/// @return R in bits 0…8, G in 9…17, B in 18…26, the exponent in 27…31
/// @source [SharedExponent], encoding of RGB9_E5
uint32_t packRgb9e5(const std::array<float, 3>& rgb);
/// Exact.
/// @param word  any: every one is a colour
std::array<float, 3> unpackRgb9e5(uint32_t word);

/// Unsigned floats of 5 bits of exponent (bias 15) and 6, 6 and 5 bits of mantissa, rounded to nearest even;
/// negative numbers and NaN become 0, what is above the largest finite value (infinity too) becomes that.
/// @return R in bits 0…10, G in 11…21, B in 22…31
/// @source [PackedFloat], R11F_G11F_B10F
uint32_t packR11fG11fB10f(const std::array<float, 3>& rgb);
/// Exact; the largest exponent means infinity or NaN.
std::array<float, 3> unpackR11fG11fB10f(uint32_t word);

/// A component as normalised integers: value = bias + scale · code / (2^bits − 1), so that what hardware
/// reads from a UNORM texture (the quotient, filtered or not) needs one multiply-add.
struct UnormRange {
    float scale = 0;  ///< ≥ 0; 0 where all values are the same
    float bias = 0;
    bool operator==(const UnormRange&) const = default;
};

/// Scale and bias of each component that make the squared error of the points in use small: from their
/// minimum and maximum, from quantiles near them (values outside are clipped; taken where that lowers the
/// error), and by least squares given the codes. Never worse than minimum and maximum.
/// @param values      [N×components], finite where used
/// @param bits        1 to 16
/// @param used        [N] 0 for points that do not count; empty: all count
/// @return            [components]; of zero scale and bias when no point counts
/// @throws InputError  a value in use that is not finite (names point and component)
std::vector<UnormRange> fitUnormRanges(std::span<const float> values, size_t components, int bits,
                                       std::span<const uint8_t> used);

/// Nearest code (clamped; NaN becomes 0).
uint16_t unormCode(float value, const UnormRange& range, int bits);
/// What a code stands for, computed as shaders do.
float unormValue(uint16_t code, const UnormRange& range, int bits);

/// @param values  [N×components]   @param ranges  [components]
/// @return [N×components] codes below 2^bits
std::vector<uint16_t> quantizeUnorm(std::span<const float> values, std::span<const UnormRange> ranges,
                                    int bits);
/// The inverse of quantizeUnorm, up to half a step.
std::vector<float> dequantizeUnorm(std::span<const uint16_t> codes, std::span<const UnormRange> ranges,
                                   int bits);

}  // namespace prt
