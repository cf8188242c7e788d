// 8-bit images and the display curve.
#include "precompute/io/image.h"

#include <webp/encode.h>

#include <cmath>
#include <limits>

#include "precompute/base/error.h"
#include "tests/io/small_scene.h"

namespace prt {
namespace {

using testing::HasSubstr;

class Png : public testing::TestWithParam<int> {};

TEST_P(Png, RoundTripIsExact) {
    const int channels = GetParam();
    const ByteImage image = gradientImage(17, 9, channels);
    const std::vector<uint8_t> bytes = encodePng(image);
    EXPECT_EQ(imageMimeType(bytes), "image/png");
    const ByteImage back = decodeImage(bytes, "image");
    ASSERT_EQ(back.width, 17);
    ASSERT_EQ(back.height, 9);
    ASSERT_EQ(back.channels, 4);
    const bool grey = channels <= 2, alpha = channels == 2 || channels == 4;
    for (size_t i = 0; i < 17 * 9; ++i) {
        for (size_t c = 0; c < 3; ++c)
            ASSERT_EQ(back.pixels[i * 4 + c], image.pixels[i * size_t(channels) + (grey ? 0 : c)]);
        ASSERT_EQ(back.pixels[i * 4 + 3],
                  alpha ? image.pixels[i * size_t(channels) + size_t(channels) - 1] : 255);
    }
}
INSTANTIATE_TEST_SUITE_P(Channels, Png, testing::Values(1, 2, 3, 4));

TEST(WebP, LosslessRoundTripIsExact) {
    ByteImage image = gradientImage(13, 7, 4);
    // Colour under transparent pixels is not kept, so none is.
    for (size_t i = 3; i < image.pixels.size(); i += 4) image.pixels[i] = 255;
    uint8_t* encoded = nullptr;
    const size_t size = WebPEncodeLosslessRGBA(image.pixels.data(), 13, 7, 13 * 4, &encoded);
    const std::vector<uint8_t> bytes(encoded, encoded + size);
    WebPFree(encoded);
    EXPECT_EQ(imageMimeType(bytes), "image/webp");
    const ByteImage back = decodeImage(bytes, "image");
    EXPECT_EQ(back.width, 13);
    EXPECT_EQ(back.pixels, image.pixels);
    for (size_t length = 0; length + 4 < bytes.size(); length += 3)
        EXPECT_THROW(decodeImage(std::span(bytes).first(length), "image"), InputError) << length;
}

TEST(DecodeImage, RefusesTheUnknown) {
    const std::vector<uint8_t> text{'h', 'e', 'l', 'l', 'o'};
    EXPECT_EQ(imageMimeType(text), "");
    EXPECT_EQ(imageMimeType({}), "");
    try {
        decodeImage(text, "wall.tga");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("wall.tga"));
    }
}

TEST(DecodeImage, RefusesImpossibleSizesBeforeAllocating) {
    // A PNG header that promises 100000 × 100000 pixels.
    std::vector<uint8_t> bytes = encodePng(gradientImage(4, 4, 3));
    for (size_t at : {size_t(16), size_t(20)}) {
        bytes[at] = 0;
        bytes[at + 1] = 1;
        bytes[at + 2] = 0x86;
        bytes[at + 3] = 0xa0;
    }
    EXPECT_THROW(decodeImage(bytes, "image"), InputError);
}

TEST(DecodeImage, TruncationNeverCrashes) {
    const std::vector<uint8_t> bytes = encodePng(gradientImage(31, 17, 3));
    int refused = 0;
    for (size_t length = 0; length < bytes.size(); ++length) {
        try {
            decodeImage(std::span(bytes).first(length), "image");
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, int(bytes.size()) / 2);
}

double srgbOf(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

TEST(ToDisplay, FollowsTheExactCurve) {
    FloatImage image{256, 1, 3, {}};
    for (int i = 0; i < 256; ++i)
        for (int c = 0; c < 3; ++c) image.pixels.push_back(float(i * i) / (255.0f * 255.0f));
    const ByteImage display = toDisplay(image, 0);
    for (size_t i = 0; i < 768; ++i)
        EXPECT_EQ(display.pixels[i], uint8_t(std::lround(255 * srgbOf(double(image.pixels[i])))));
}

TEST(ToDisplay, KnownPoints) {
    const FloatImage image{3, 1, 3, {0, 0.0031308f, 0.18f, 0.21404114f, 0.5f, 1, 2, 1e30f, -1}};
    const ByteImage display = toDisplay(image, 0);
    EXPECT_EQ(display.pixels, (std::vector<uint8_t>{0, 10, 118, 128, 188, 255, 255, 255, 0}));
}

TEST(ToDisplay, ExposureIsInStops) {
    const FloatImage image{1, 1, 3, {0.1f, 0.2f, 0.05f}};
    const FloatImage brighter{1, 1, 3, {0.4f, 0.8f, 0.2f}};
    EXPECT_EQ(toDisplay(image, 2).pixels, toDisplay(brighter, 0).pixels);
    EXPECT_EQ(toDisplay(brighter, -2).pixels, toDisplay(image, 0).pixels);
}

TEST(ToDisplay, AlphaIsLinearAndNotExposed) {
    const FloatImage image{1, 1, 4, {0.5f, 0.5f, 0.5f, 0.5f}};
    EXPECT_EQ(toDisplay(image, 1).pixels, (std::vector<uint8_t>{255, 255, 255, 128}));
}

TEST(ToDisplay, UndefinedIsBlack) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(toDisplay({1, 1, 3, {nan, infinity, -infinity}}, 0).pixels, (std::vector<uint8_t>{0, 255, 0}));
}

TEST(ToneCurves, NamesGoBothWays) {
    for (const ToneCurve curve : {ToneCurve::None, ToneCurve::Filmic, ToneCurve::Neutral})
        EXPECT_EQ(toneCurveFromName(toneCurveName(curve)), curve);
    EXPECT_EQ(toneCurveName(ToneCurve::Filmic), "filmic");
    EXPECT_EQ(toneCurveFromName("Filmic"), std::nullopt);
    EXPECT_EQ(toneCurveFromName(""), std::nullopt);
}

class EachToneCurve : public testing::TestWithParam<ToneCurve> {
  protected:
    double grey(double x) const {
        const Vec3d mapped = toneMapped(Vec3d::Constant(x), GetParam());
        // Rows of the filmic matrices sum to one, but for their five digits.
        EXPECT_NEAR(mapped.x(), mapped.y(), 2e-5);
        EXPECT_NEAR(mapped.x(), mapped.z(), 2e-5);
        return mapped.x();
    }
};

// Steps of 1/2000 of a stop: neither a fall nor a jump, from black to white.
TEST_P(EachToneCurve, IsMonotoneAndContinuousInGrey) {
    EXPECT_EQ(grey(0), 0);
    double before = 0;
    for (double stops = -16; stops <= 16; stops += 0.0005) {
        const double now = grey(std::exp2(stops));
        ASSERT_GE(now, before) << stops;
        // d(curve)/d(stops) = x ln 2 · slope; no curve here has x · slope above 1.
        ASSERT_LT(now - before, 4e-4) << stops;
        before = now;
    }
    EXPECT_GT(before, 0.999);
}

TEST_P(EachToneCurve, KeepsColoursInRange) {
    const double values[] = {-1e30, -1,  0, 1e-6, 0.01, 0.079, 0.081,
                             0.5,   0.8, 1, 7,    1e4,  1e30,  std::numeric_limits<double>::infinity()};
    for (const double r : values)
        for (const double g : values)
            for (const double b : values) {
                const Vec3d mapped = toneMapped(Vec3d(r, g, b), GetParam());
                ASSERT_TRUE((mapped.array() >= 0).all() && (mapped.array() <= 1).all())
                    << r << " " << g << " " << b;
            }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(toneMapped(Vec3d(nan, -1, 0), GetParam()), Vec3d(0, 0, 0));
}

TEST_P(EachToneCurve, IsAppliedAfterExposure) {
    const FloatImage image{2, 1, 4, {0.3f, 0.1f, 0.05f, 0.25f, 0.9f, 4, 2, 1}};
    const ByteImage display = toDisplay(image, 1.5, GetParam());
    for (size_t i = 0; i < 8; i += 4) {
        const float* p = &image.pixels[i];
        const Vec3d mapped = toneMapped(std::exp2(1.5) * Vec3d(p[0], p[1], p[2]), GetParam());
        for (size_t c = 0; c < 3; ++c)
            EXPECT_EQ(display.pixels[i + c], uint8_t(std::lround(255 * srgbOf(mapped[int(c)]))));
        EXPECT_EQ(display.pixels[i + 3], i == 0 ? 64 : 255);
    }
}
INSTANTIATE_TEST_SUITE_P(Curves, EachToneCurve,
                         testing::Values(ToneCurve::None, ToneCurve::Filmic, ToneCurve::Neutral),
                         [](const auto& curve) { return std::string(toneCurveName(curve.param)); });

TEST(ToneCurves, FixedPoints) {
    const auto grey = [](double x, ToneCurve curve) { return toneMapped(Vec3d::Constant(x), curve).x(); };
    EXPECT_NEAR(grey(0.18, ToneCurve::Filmic), 0.18, 1e-5);
    EXPECT_NEAR(grey(0.18, ToneCurve::None), 0.18, 1e-15);
    // Khronos: 0.04 is taken off above 0.08, quadratically below; from 0.8 on highlights are compressed to
    // 1 − 0.24² / (x − 0.04 + 0.24 − 0.76).
    EXPECT_NEAR(grey(0.18, ToneCurve::Neutral), 0.14, 1e-15);
    EXPECT_NEAR(grey(0.04, ToneCurve::Neutral), 6.25 * 0.04 * 0.04, 1e-15);
    EXPECT_NEAR(grey(0.8, ToneCurve::Neutral), 0.76, 1e-15);
    EXPECT_NEAR(grey(4, ToneCurve::Neutral), 1 - 0.0576 / 3.44, 1e-12);
}

TEST(ToneCurves, NeutralKeepsColoursBelowItsShoulder) {
    const Vec3d colour(0.7, 0.3, 0.12);
    EXPECT_LT((toneMapped(colour, ToneCurve::Neutral) - (colour - Vec3d::Constant(0.04))).norm(), 1e-15);
}

TEST(ToneCurves, BrightColoursGoToWhite) {
    for (const ToneCurve curve : {ToneCurve::Filmic, ToneCurve::Neutral})
        EXPECT_GT(toneMapped(Vec3d(3000, 100, 100), curve).minCoeff(), 0.9);
    EXPECT_EQ(toneMapped(Vec3d(3000, 0.5, 0.5), ToneCurve::None), Vec3d(1, 0.5, 0.5));
}

}  // namespace
}  // namespace prt
