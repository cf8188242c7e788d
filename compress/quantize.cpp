// Number formats of textures: half floats [IEEE754], shared exponents [SharedExponent], packed floats
// [PackedFloat], normalised integers with a range per component.
#include "compress/quantize.h"

#include <fmt/format.h>
#include <half.h>

#include <algorithm>
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"

namespace prt {
namespace {

constexpr int kExponentBias = 15;
constexpr int kSharedMantissaBits = 9;

float clampPositive(float value, float largest) { return value > 0 ? std::min(value, largest) : 0.0f; }

// Unsigned float of 5 bits of exponent.
uint32_t packUfloat(float value, int mantissaBits) {
    if (!(value > 0)) return 0;
    const uint32_t largest = (31u << mantissaBits) - 1;
    if (std::isinf(value)) return largest;
    int exponent = 0;
    std::frexp(value, &exponent);  // value = [0.5, 1)·2^exponent
    // Below the smallest normal number the step stays what it is there.
    const int power = std::max(exponent - 1, 1 - kExponentBias);
    const auto steps = uint32_t(std::nearbyint(std::ldexp(double(value), mantissaBits - power)));
    // For normal numbers steps holds the leading one, which counts as one unit of the exponent field;
    // rounding up to the next power of two carries into it.
    const int64_t code = (int64_t(power + kExponentBias - 1) << mantissaBits) + int64_t(steps);
    return uint32_t(std::min<int64_t>(code, largest));
}

float unpackUfloat(uint32_t code, int mantissaBits) {
    const int exponent = int(code >> mantissaBits);
    const uint32_t mantissa = code & ((1u << mantissaBits) - 1);
    if (exponent == 31) return mantissa ? NAN : INFINITY;
    if (exponent == 0) return std::ldexp(float(mantissa), 1 - kExponentBias - mantissaBits);
    return std::ldexp(float(mantissa | (1u << mantissaBits)), exponent - kExponentBias - mantissaBits);
}

float largestCode(int bits) { return float((1 << bits) - 1); }

float nearestLevel(float value, const UnormRange& range, float top) {
    return float(int(std::clamp((value - range.bias) / range.scale * top, 0.0f, top) + 0.5f));
}

float levelValue(float level, const UnormRange& range, float top) {
    return range.bias + range.scale * (level / top);
}

// Sum of squared errors; several sums at once, so that the compiler may use vectors.
// @param range  of positive scale
double squaredError(std::span<const float> values, const UnormRange& range, int bits) {
    constexpr size_t kLanes = 8, kBlock = 1024;
    const float top = largestCode(bits);
    const auto squared = [&](float value) {
        const float error = levelValue(nearestLevel(value, range, top), range, top) - value;
        return error * error;
    };
    double total = 0;
    for (size_t begin = 0; begin < values.size(); begin += kBlock) {
        const size_t end = std::min(begin + kBlock, values.size());
        float sums[kLanes] = {};
        size_t i = begin;
        for (; i + kLanes <= end; i += kLanes)
            for (size_t k = 0; k < kLanes; ++k) sums[k] += squared(values[i + k]);
        for (; i < end; ++i) sums[0] += squared(values[i]);
        for (const float sum : sums) total += double(sum);
    }
    return total;
}

// Scale and bias that suit the codes of `range` best.
UnormRange regressRange(std::span<const float> values, const UnormRange& range, int bits) {
    const double top = double(largestCode(bits)), count = double(values.size());
    double sumC = 0, sumV = 0, sumCc = 0, sumCv = 0;
    for (const float value : values) {
        const double code = double(unormCode(value, range, bits)) / top, v = double(value);
        sumC += code;
        sumV += v;
        sumCc += code * code;
        sumCv += code * v;
    }
    const double spread = count * sumCc - sumC * sumC;
    if (!(spread > 0)) return range;
    const double scale = (count * sumCv - sumC * sumV) / spread;
    if (!(scale > 0)) return range;
    return {float(scale), float((sumV - scale * sumC) / count)};
}

// @param values  sorted
UnormRange fitRange(std::span<const float> values, int bits) {
    constexpr double kClipped[] = {0, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2};
    constexpr int kRegressions = 4;
    if (values.empty()) return {};
    UnormRange best{values.back() - values.front(), values.front()};
    if (!std::isfinite(best.scale)) best.scale = 3.4e38f;  // a range that no float holds
    if (best.scale == 0) return best;
    double bestError = squaredError(values, best, bits);
    const size_t last = values.size() - 1;
    size_t lowBefore = last + 1;
    for (const double low : kClipped) {
        const auto lowIndex = size_t(low * double(last));
        if (lowIndex == lowBefore) continue;
        lowBefore = lowIndex;
        size_t highBefore = 0;
        for (const double high : kClipped) {
            const size_t highIndex = last - size_t(high * double(last));
            if (highIndex == highBefore) continue;
            highBefore = highIndex;
            const UnormRange range{values[highIndex] - values[lowIndex], values[lowIndex]};
            if (!(range.scale > 0) || !std::isfinite(range.scale)) continue;
            const double error = squaredError(values, range, bits);
            if (error < bestError) best = range, bestError = error;
        }
    }
    for (int i = 0; i < kRegressions; ++i) {
        const UnormRange range = regressRange(values, best, bits);
        const double error = squaredError(values, range, bits);
        if (!(error < bestError)) break;
        best = range;
        bestError = error;
    }
    return best;
}

}  // namespace

uint16_t halfFromFloat(float value) { return half(value).bits(); }

float floatFromHalf(uint16_t bits) {
    half value;
    value.setBits(bits);
    return value;
}

uint32_t packRgb9e5(const std::array<float, 3>& rgb) {
    std::array<float, 3> clamped{};
    for (size_t c = 0; c < 3; ++c) clamped[c] = clampPositive(rgb[c], kMaxRgb9e5);
    const float largest = *std::max_element(clamped.begin(), clamped.end());
    int exponent = -kExponentBias;
    if (largest > 0) std::frexp(largest, &exponent);  // floor(log2) + 1
    int shared = std::max(exponent, -kExponentBias) + kExponentBias;
    const auto steps = [&](float value) {
        return uint32_t(
            std::floor(std::ldexp(double(value), kExponentBias + kSharedMantissaBits - shared) + 0.5));
    };
    if (steps(largest) == 1u << kSharedMantissaBits) ++shared;
    return steps(clamped[0]) | steps(clamped[1]) << 9 | steps(clamped[2]) << 18 | uint32_t(shared) << 27;
}

std::array<float, 3> unpackRgb9e5(uint32_t word) {
    const int power = int(word >> 27) - kExponentBias - kSharedMantissaBits;
    const auto value = [&](int shift) { return std::ldexp(float(word >> shift & 0x1ffu), power); };
    return {value(0), value(9), value(18)};
}

uint32_t packR11fG11fB10f(const std::array<float, 3>& rgb) {
    return packUfloat(rgb[0], 6) | packUfloat(rgb[1], 6) << 11 | packUfloat(rgb[2], 5) << 22;
}

std::array<float, 3> unpackR11fG11fB10f(uint32_t word) {
    return {unpackUfloat(word & 0x7ffu, 6), unpackUfloat(word >> 11 & 0x7ffu, 6),
            unpackUfloat(word >> 22, 5)};
}

std::vector<UnormRange> fitUnormRanges(std::span<const float> values, size_t components, int bits,
                                       std::span<const uint8_t> used) {
    PRT_CHECK(components > 0 && bits >= 1 && bits <= 16);
    PRT_CHECK_EQ(values.size() % components, size_t(0));
    const size_t points = values.size() / components;
    if (!used.empty()) PRT_CHECK_EQ(used.size(), points);
    std::vector<UnormRange> ranges(components);
    parallelFor(components, 1, [&](size_t component, size_t) {
        std::vector<float> column;
        column.reserve(points);
        for (size_t i = 0; i < points; ++i) {
            if (!used.empty() && !used[i]) continue;
            const float value = values[i * components + component];
            if (!std::isfinite(value))
                throw InputError("quantisation",
                                 fmt::format("component {} of point {} is {}", component, i, value),
                                 "make the file again");
            column.push_back(value);
        }
        std::sort(column.begin(), column.end());
        ranges[component] = fitRange(column, bits);
    });
    return ranges;
}

uint16_t unormCode(float value, const UnormRange& range, int bits) {
    if (!(range.scale > 0) || !(value > range.bias)) return 0;
    return uint16_t(nearestLevel(value, range, largestCode(bits)));
}

float unormValue(uint16_t code, const UnormRange& range, int bits) {
    return levelValue(float(code), range, largestCode(bits));
}

std::vector<uint16_t> quantizeUnorm(std::span<const float> values, std::span<const UnormRange> ranges,
                                    int bits) {
    PRT_CHECK(!ranges.empty() && bits >= 1 && bits <= 16);
    PRT_CHECK_EQ(values.size() % ranges.size(), size_t(0));
    std::vector<uint16_t> codes(values.size());
    parallelFor(values.size() / ranges.size(), 65536, [&](size_t begin, size_t end) {
        for (size_t i = begin * ranges.size(); i < end * ranges.size(); ++i)
            codes[i] = unormCode(values[i], ranges[i % ranges.size()], bits);
    });
    return codes;
}

std::vector<float> dequantizeUnorm(std::span<const uint16_t> codes, std::span<const UnormRange> ranges,
                                   int bits) {
    PRT_CHECK(!ranges.empty() && bits >= 1 && bits <= 16);
    PRT_CHECK_EQ(codes.size() % ranges.size(), size_t(0));
    std::vector<float> values(codes.size());
    for (size_t i = 0; i < codes.size(); ++i)
        values[i] = unormValue(codes[i], ranges[i % ranges.size()], bits);
    return values;
}

}  // namespace prt
