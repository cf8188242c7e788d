// Radiance images: every encoding, every truncation.
#include "precompute/io/rgbe.h"

#include <cmath>
#include <random>

#include "precompute/base/error.h"

namespace prt {
namespace {

using testing::HasSubstr;
using Rgbe = std::array<uint8_t, 4>;

std::string header(int width, int height) {
    return "#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1\n\n-Y " + std::to_string(height) +
           " +X " + std::to_string(width) + "\n";
}

/// Texels with runs in every channel, valid as flat data too (a channel of at least 128).
std::vector<Rgbe> texels(int count) {
    std::mt19937 random(3);
    std::vector<Rgbe> all;
    while (int(all.size()) < count) {
        const Rgbe texel{uint8_t(128 + random() % 128), uint8_t(random()), uint8_t(random() % 3),
                         uint8_t(120 + random() % 20)};
        for (size_t repeat = 1 + random() % 5; repeat > 0 && int(all.size()) < count; --repeat)
            all.push_back(texel);
    }
    return all;
}

std::string flat(const std::vector<Rgbe>& all) {
    std::string bytes;
    for (const Rgbe& texel : all) bytes.append(reinterpret_cast<const char*>(texel.data()), 4);
    return bytes;
}

std::string oldRuns(const std::vector<Rgbe>& all, int width) {
    std::string bytes;
    for (size_t i = 0; i < all.size();) {
        size_t count = 1;
        while (i + count < all.size() && (i + count) % size_t(width) != 0 && all[i + count] == all[i])
            ++count;
        bytes.append(reinterpret_cast<const char*>(all[i].data()), 4);
        // The count in base 256, lowest digit first.
        for (size_t more = count - 1; more > 0; more /= 256)
            bytes += std::string("\1\1\1") + char(more % 256);
        i += count;
    }
    return bytes;
}

std::string newRuns(const std::vector<Rgbe>& all, int width) {
    std::string bytes;
    for (size_t row = 0; row < all.size(); row += size_t(width)) {
        bytes += std::string("\2\2") + char(width / 256) + char(width % 256);
        for (size_t c = 0; c < 4; ++c)
            for (size_t x = 0; x < size_t(width);) {
                const auto at = [&](size_t i) { return all[row + i][c]; };
                size_t run = 1;
                while (x + run < size_t(width) && run < 127 && at(x + run) == at(x)) ++run;
                if (run > 2) {
                    bytes += char(128 + run);
                    bytes += char(at(x));
                } else {
                    bytes += char(run);
                    for (size_t i = 0; i < run; ++i) bytes += char(at(x + i));
                }
                x += run;
            }
    }
    return bytes;
}

void expectTexels(const FloatImage& image, const std::vector<Rgbe>& all) {
    ASSERT_EQ(image.channels, 3);
    ASSERT_EQ(image.pixels.size(), all.size() * 3);
    for (size_t i = 0; i < all.size(); ++i)
        for (size_t c = 0; c < 3; ++c)
            ASSERT_EQ(image.pixels[i * 3 + c], float(all[i][c] * std::pow(2.0, all[i][3] - 136.0))) << i;
}

class RgbeSizes : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(RgbeSizes, EveryEncodingDecodesToTheSame) {
    const auto [width, height] = GetParam();
    const std::vector<Rgbe> all = texels(width * height);
    expectTexels(decodeRgbe(header(width, height) + flat(all), "flat"), all);
    expectTexels(decodeRgbe(header(width, height) + oldRuns(all, width), "old"), all);
    if (width >= 8) expectTexels(decodeRgbe(header(width, height) + newRuns(all, width), "new"), all);
}
INSTANTIATE_TEST_SUITE_P(Each, RgbeSizes,
                         testing::Values(std::pair{2, 1}, std::pair{6, 3}, std::pair{8, 4}, std::pair{300, 5},
                                         std::pair{1024, 2}));

TEST(Rgbe, LongOldRunsCountInBase256) {
    const std::vector<Rgbe> all(1000, Rgbe{200, 100, 50, 128});
    expectTexels(decodeRgbe(header(1000, 1) + oldRuns(all, 1000), "old"), all);
}

TEST(Rgbe, ExponentZeroIsBlack) {
    const FloatImage image = decodeRgbe(header(1, 1) + std::string("\x80\x40\x20\0", 4), "black");
    EXPECT_EQ(image.pixels, (std::vector<float>{0, 0, 0}));
}

TEST(Rgbe, EveryTruncationIsRefused) {
    const std::vector<Rgbe> all = texels(64 * 4);
    for (const std::string& data : {flat(all), oldRuns(all, 64), newRuns(all, 64)}) {
        const std::string whole = header(64, 4) + data;
        ASSERT_NO_THROW(decodeRgbe(whole, "whole"));
        for (size_t length = 0; length < whole.size(); ++length)
            EXPECT_THROW(decodeRgbe(std::string_view(whole).substr(0, length), "part"), InputError) << length;
    }
}

TEST(Rgbe, FlippedBitsNeverCrash) {
    const std::string whole = header(64, 4) + newRuns(texels(64 * 4), 64);
    std::mt19937 random(5);
    int refused = 0;
    for (int i = 0; i < 20000; ++i) {
        std::string bytes = whole;
        const size_t at = random() % bytes.size();
        bytes[at] = char(bytes[at] ^ char(1u << random() % 8));
        try {
            decodeRgbe(bytes, "flipped");
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 0);
}

TEST(Rgbe, RunsOfNothingEnd) {
    EXPECT_THROW(decodeRgbe(header(8, 1) + std::string("\2\2\0\10", 4) + std::string(1000, '\0'), "x"),
                 InputError);
}

struct BadHeader {
    std::string text, message;
};
class RgbeHeader : public testing::TestWithParam<BadHeader> {};

TEST_P(RgbeHeader, IsRefused) {
    try {
        decodeRgbe(GetParam().text + std::string(100, 'x'), "sky.hdr");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("sky.hdr: "));
        EXPECT_THAT(error.what(), HasSubstr(GetParam().message));
    }
}
INSTANTIATE_TEST_SUITE_P(
    Each, RgbeHeader,
    testing::Values(BadHeader{"P6\n", "not a Radiance image"},
                    BadHeader{"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 2\n", "32-bit_rle_xyze"},
                    BadHeader{"#?RADIANCE\n\n-Y 1 +X 2\n", "without a format"},
                    BadHeader{"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n+Y 1 +X 2\n", "orientation"},
                    BadHeader{"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 -X 2\n", "orientation"},
                    BadHeader{"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 2\n", "damaged size"},
                    BadHeader{"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y -1 +X 2\n", "damaged size"},
                    BadHeader{"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 99999999999 +X 2\n", "damaged size"},
                    BadHeader{"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8200 +X 16400\n", "more than 16384"},
                    // Fits the limit, but not so few bytes.
                    BadHeader{"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8192 +X 16384\n",
                              "before its last pixel"}));

}  // namespace
}  // namespace prt
