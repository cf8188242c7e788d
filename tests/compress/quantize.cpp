// Number formats of textures, against slow and obvious references and over every code they have.
#include "compress/quantize.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "precompute/base/error.h"

namespace prt {
namespace {

// A non-negative float of 5 bits of exponent, by its definition.
double ufloatValue(uint32_t code, int mantissaBits) {
    const double fraction = double(code % (1u << mantissaBits)) / double(1u << mantissaBits);
    const int exponent = int(code >> mantissaBits);
    return exponent == 0 ? fraction * std::pow(2.0, -14) : (1 + fraction) * std::pow(2.0, exponent - 15);
}

// Finite codes: their values rise with the code.
uint32_t finiteCodes(int mantissaBits) { return 31u << mantissaBits; }

// Code of the nearest value by search over all; ties go to the even code.
uint32_t nearestCode(double value, int mantissaBits) {
    uint32_t best = 0;
    for (uint32_t code = 1; code < finiteCodes(mantissaBits); ++code) {
        const double error = std::abs(ufloatValue(code, mantissaBits) - value);
        const double least = std::abs(ufloatValue(best, mantissaBits) - value);
        if (error < least || (error == least && code % 2 == 0)) best = code;
    }
    return best;
}

std::vector<float> positiveSamples(size_t count, double lowExponent, double highExponent, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> exponent(lowExponent, highExponent);
    std::vector<float> values(count);
    for (float& value : values) value = float(std::exp2(exponent(random)));
    return values;
}

TEST(Half, EveryCodeComesBack) {
    for (uint32_t bits = 0; bits < 0x10000; ++bits) {
        const float value = floatFromHalf(uint16_t(bits));
        const uint32_t magnitude = bits & 0x7fffu;
        if (magnitude > 0x7c00u) {
            EXPECT_TRUE(std::isnan(value)) << bits;
            EXPECT_TRUE(std::isnan(floatFromHalf(halfFromFloat(value)))) << bits;
            continue;
        }
        const double expected = magnitude == 0x7c00u ? INFINITY : ufloatValue(magnitude, 10);
        ASSERT_EQ(double(value), bits >= 0x8000u ? -expected : expected) << bits;
        ASSERT_EQ(std::signbit(value), bits >= 0x8000u);
        ASSERT_EQ(halfFromFloat(value), bits);
    }
}

TEST(Half, RoundsToNearestEven) {
    // Between neighbours: the middle goes to the even code, the floats beside it to the nearer one.
    for (uint32_t bits = 0; bits + 1 < 0x7c00u; ++bits) {
        const auto middle = float((ufloatValue(bits, 10) + ufloatValue(bits + 1, 10)) / 2);  // exact
        ASSERT_EQ(halfFromFloat(middle), bits + bits % 2);
        ASSERT_EQ(halfFromFloat(std::nextafter(middle, 0.0f)), bits);
        ASSERT_EQ(halfFromFloat(std::nextafter(middle, 1e9f)), bits + 1);
        ASSERT_EQ(halfFromFloat(-middle), 0x8000u + bits + bits % 2);
    }
    EXPECT_EQ(floatFromHalf(halfFromFloat(kMaxHalf)), kMaxHalf);
    EXPECT_EQ(halfFromFloat(65519.99f), 0x7bffu);
    EXPECT_EQ(halfFromFloat(65520.0f), 0x7c00u);
    EXPECT_EQ(halfFromFloat(-INFINITY), 0xfc00u);
}

TEST(PackedFloat, EveryCodeComesBack) {
    for (uint32_t code = 0; code < finiteCodes(6); ++code) {
        const uint32_t blue = code / 2;
        const uint32_t word = code | (finiteCodes(6) - 1 - code) << 11 | blue << 22;
        const std::array<float, 3> rgb = unpackR11fG11fB10f(word);
        ASSERT_EQ(double(rgb[0]), ufloatValue(code, 6));
        ASSERT_EQ(double(rgb[1]), ufloatValue(finiteCodes(6) - 1 - code, 6));
        ASSERT_EQ(double(rgb[2]), ufloatValue(blue, 5));
        ASSERT_EQ(packR11fG11fB10f(rgb), word);
    }
    EXPECT_EQ(unpackR11fG11fB10f(31u << 6)[0], INFINITY);
    EXPECT_TRUE(std::isnan(unpackR11fG11fB10f((31u << 6) + 1)[0]));
    EXPECT_EQ(unpackR11fG11fB10f(31u << 27)[2], INFINITY);
}

TEST(PackedFloat, RoundsToNearestEven) {
    const std::vector<float> samples = positiveSamples(600, -22, 17, 1);
    for (size_t i = 0; i < samples.size(); ++i) {
        const uint32_t word = packR11fG11fB10f({samples[i], samples[samples.size() - 1 - i], samples[i]});
        ASSERT_EQ(word & 0x7ffu, nearestCode(double(samples[i]), 6)) << samples[i];
        ASSERT_EQ(word >> 11 & 0x7ffu, nearestCode(double(samples[samples.size() - 1 - i]), 6));
        ASSERT_EQ(word >> 22, nearestCode(double(samples[i]), 5)) << samples[i];
    }
    for (uint32_t code = 0; code + 1 < finiteCodes(6); ++code) {
        const auto middle = float((ufloatValue(code, 6) + ufloatValue(code + 1, 6)) / 2);
        ASSERT_EQ(packR11fG11fB10f({middle, 0, 0}), code + code % 2);
        ASSERT_EQ(packR11fG11fB10f({std::nextafter(middle, 0.0f), 0, 0}), code);
        ASSERT_EQ(packR11fG11fB10f({std::nextafter(middle, 1e9f), 0, 0}), code + 1);
    }
}

TEST(PackedFloat, ClampsWhatItCannotHold) {
    const uint32_t largest = packR11fG11fB10f({kMaxUfloat11, kMaxUfloat11, kMaxUfloat10});
    EXPECT_EQ(unpackR11fG11fB10f(largest), (std::array<float, 3>{kMaxUfloat11, kMaxUfloat11, kMaxUfloat10}));
    EXPECT_EQ(packR11fG11fB10f({INFINITY, 1e30f, 65535.0f}), largest);
    EXPECT_EQ(packR11fG11fB10f({-1.0f, NAN, -INFINITY}), 0u);
    EXPECT_EQ(packR11fG11fB10f({-0.0f, 1e-30f, std::numeric_limits<float>::denorm_min()}), 0u);
}

TEST(SharedExponent, DecodesByItsDefinition) {
    for (uint32_t exponent = 0; exponent < 32; ++exponent)
        for (uint32_t mantissa = 0; mantissa < 512; ++mantissa) {
            const uint32_t word = mantissa | (511 - mantissa) << 9 | (mantissa ^ 85u) << 18 | exponent << 27;
            const double unit = std::pow(2.0, int(exponent) - 24);
            const std::array<float, 3> rgb = unpackRgb9e5(word);
            ASSERT_EQ(double(rgb[0]), mantissa * unit);
            ASSERT_EQ(double(rgb[1]), (511 - mantissa) * unit);
            ASSERT_EQ(double(rgb[2]), (mantissa ^ 85u) * unit);
        }
}

TEST(SharedExponent, EveryColourComesBack) {
    // A colour may have several codes (mantissas that are all even or small): the value must come back, and
    // the code where its largest mantissa uses the top bit.
    for (uint32_t exponent = 0; exponent < 32; ++exponent)
        for (uint32_t mantissa = 0; mantissa < 512; ++mantissa)
            for (const uint32_t other : {0u, 1u, 255u, 511u}) {
                const uint32_t word = other | mantissa << 9 | (other / 2) << 18 | exponent << 27;
                const uint32_t again = packRgb9e5(unpackRgb9e5(word));
                ASSERT_EQ(unpackRgb9e5(again), unpackRgb9e5(word));
                if (std::max(mantissa, other) >= 256) {
                    ASSERT_EQ(again, word);
                }
            }
}

TEST(SharedExponent, ErrsByHalfAStepAtMostWithTheSmallestStepThatFits) {
    const std::vector<float> samples = positiveSamples(3000, -26, 16.5, 2);
    for (size_t i = 0; i + 2 < samples.size(); i += 3) {
        const std::array<float, 3> rgb{samples[i], samples[i + 1], samples[i + 2]};
        const uint32_t word = packRgb9e5(rgb);
        const double unit = std::pow(2.0, int(word >> 27) - 24);
        const double largest =
            std::min(double(*std::max_element(rgb.begin(), rgb.end())), double(kMaxRgb9e5));
        // One exponent less would have to round the largest to 512 or more.
        if (word >> 27 > 0) {
            EXPECT_GE(largest / (unit / 2), 511.5);
        }
        const std::array<float, 3> back = unpackRgb9e5(word);
        for (size_t c = 0; c < 3; ++c)
            EXPECT_LE(std::abs(double(back[c]) - std::min(double(rgb[c]), double(kMaxRgb9e5))), unit / 2);
    }
}

TEST(SharedExponent, ClampsWhatItCannotHold) {
    EXPECT_EQ(unpackRgb9e5(packRgb9e5({INFINITY, 1e9f, 65500.0f})),
              (std::array<float, 3>{kMaxRgb9e5, kMaxRgb9e5, kMaxRgb9e5}));
    EXPECT_EQ(packRgb9e5({NAN, -1.0f, -INFINITY}), 0u);
    EXPECT_EQ(packRgb9e5({1e-30f, 0, 0}), 0u);
    // Rounds up to the next exponent: 0.9995 is nearer to 1 than to 511/512.
    EXPECT_EQ(unpackRgb9e5(packRgb9e5({0.9995f, 0, 0}))[0], 1.0f);
    EXPECT_EQ(unpackRgb9e5(packRgb9e5({0.9985f, 0, 0}))[0], 511.0f / 512);
}

double unormError(std::span<const float> values, const UnormRange& range, int bits) {
    double sum = 0;
    for (const float value : values) {
        const double error = double(value - unormValue(unormCode(value, range, bits), range, bits));
        sum += error * error;
    }
    return sum;
}

TEST(Unorm, CodesAreTheNearest) {
    const UnormRange range{3.0f, -1.25f};
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-2, 3);
    for (const int bits : {1, 8, 16})
        for (int i = 0; i < 2000; ++i) {
            const float value = uniform(random);
            const int top = (1 << bits) - 1;
            const double place = (double(value) + 1.25) / 3 * top;
            const double nearest = std::clamp(std::round(place), 0.0, double(top));
            // At 16 bits float arithmetic moves places by up to 0.01 codes.
            if (std::abs(place - std::floor(place) - 0.5) > 0.02) {
                EXPECT_EQ(unormCode(value, range, bits), nearest) << value;
            }
        }
    EXPECT_EQ(unormCode(NAN, range, 8), 0);
    EXPECT_EQ(unormCode(INFINITY, range, 8), 255);
    EXPECT_EQ(unormCode(-INFINITY, range, 16), 0);
    EXPECT_EQ(unormValue(255, range, 8), 1.75f);
    EXPECT_EQ(unormValue(0, range, 16), -1.25f);
    for (uint32_t code = 0; code < 65536; ++code)
        ASSERT_EQ(unormCode(unormValue(uint16_t(code), range, 16), range, 16), code);
}

TEST(Unorm, UniformValuesUseTheWholeRange) {
    std::vector<float> values;
    for (int i = 0; i <= 1000; ++i) values.push_back(-2 + 0.005f * float(i));
    const UnormRange range = fitUnormRanges(values, 1, 8, {})[0];
    EXPECT_NEAR(range.bias, -2, 5.0 / 255);
    EXPECT_NEAR(range.scale, 5, 10.0 / 255);
    // Uniform error within half a step: step²/12 on average.
    EXPECT_LE(unormError(values, range, 8) / 1001, 1.05 * std::pow(5.0 / 255, 2) / 12);
}

TEST(Unorm, ClipsOutliersOnlyWhereThatPays) {
    std::mt19937 random(4);
    std::normal_distribution<float> gauss;
    std::vector<float> values(40000);
    for (float& value : values) value = gauss(random);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const UnormRange full{*high - *low, *low};
    const UnormRange coarse = fitUnormRanges(values, 1, 4, {})[0];
    // With 16 levels the best uniform quantiser of a Gaussian loses 0.01154 of its variance (Max 1960), the
    // one over ±4.1 twice that.
    EXPECT_LT(coarse.scale, 0.9f * full.scale);
    EXPECT_LE(unormError(values, coarse, 4) / 40000, 0.0135);
    EXPECT_GT(unormError(values, full, 4) / 40000, 0.02);
    // With 65536 levels clipping anything costs more than it gives.
    const UnormRange fine = fitUnormRanges(values, 1, 16, {})[0];
    EXPECT_NEAR(fine.scale, full.scale, 1e-3 * double(full.scale));
    // Sums of floats decide, which are good to 1e-5.
    EXPECT_LE(unormError(values, fine, 16), (1 + 1e-5) * unormError(values, full, 16));
}

TEST(Unorm, EveryComponentHasItsOwnRangeOverThePointsInUse) {
    const std::vector<float> values = {0, 100, 7, 1, 300, 7, -1e9f, NAN, 5, 0.5f, 200, 7};
    const std::vector<uint8_t> used = {1, 1, 0, 1};
    const std::vector<UnormRange> ranges = fitUnormRanges(values, 3, 8, used);
    ASSERT_EQ(ranges.size(), 3u);
    const std::vector<uint16_t> codes = quantizeUnorm(values, ranges, 8);
    const std::vector<float> back = dequantizeUnorm(codes, ranges, 8);
    for (const size_t point : {0u, 1u, 3u})
        for (size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(back[point * 3 + c], values[point * 3 + c], ranges[c].scale / 510 * 1.001f);
    EXPECT_EQ(ranges[2], (UnormRange{0, 7}));
    EXPECT_EQ(fitUnormRanges(values, 3, 8, std::vector<uint8_t>(4)), std::vector<UnormRange>(3));
    const std::vector<uint8_t> all(4, 1);
    EXPECT_THAT([&] { fitUnormRanges(values, 3, 8, all); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr("point 2")));
}

TEST(Unorm, MoreBitsNeverErrMore) {
    std::mt19937 random(5);
    std::gamma_distribution<float> skewed(0.7f);
    std::vector<float> values(5000);
    for (float& value : values) value = skewed(random);
    double before = 1e30;
    for (const int bits : {2, 4, 6, 8, 10, 12}) {
        const double error = unormError(values, fitUnormRanges(values, 1, bits, {})[0], bits);
        EXPECT_LT(error, before / 2) << bits;
        before = error;
    }
}

}  // namespace
}  // namespace prt
