// KTX 2.0 files against bytes laid out by hand from the specification, and damaged in every place.
#include "precompute/io/ktx2.h"

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "tests/base/temporary_directory.h"
#include "tests/io/texture_samples.h"

namespace prt {
namespace {

using Bytes = std::vector<uint8_t>;

std::string text(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

std::string word(uint32_t value) {
    return {char(value & 0xff), char(value >> 8 & 0xff), char(value >> 16 & 0xff), char(value >> 24)};
}

// A sample of a data format descriptor: bit offset, bits, channel with its qualifiers, lower, upper.
std::string sample(uint32_t offset, uint32_t bits, uint32_t channel, uint32_t lower, uint32_t upper) {
    return word(offset | (bits - 1) << 16 | channel << 24) + word(0) + word(lower) + word(upper);
}

std::string descriptorOf(const std::string& file) {
    const auto at = [&](size_t i) { return size_t(uint8_t(file[i])) | size_t(uint8_t(file[i + 1])) << 8; };
    return file.substr(at(48), at(52));
}

TEST(Ktx2, ImageOfTwoTexelsIsTheBytesOfTheSpecification) {
    TemporaryDirectory directory;
    TextureImage image{TexelFormat::Rgba8Unorm, 2, 1, 0, false, {1, 2, 3, 4, 250, 251, 252, 253}};
    writeKtx2(directory.file("a.ktx2"), image, {{"prtPart", "weights"}});
    // clang-format off
    const Bytes expected = {
        0xAB, 0x4B, 0x54, 0x58, 0x20, 0x32, 0x30, 0xBB, 0x0D, 0x0A, 0x1A, 0x0A,  // identifier
        37, 0, 0, 0,                                          // VK_FORMAT_R8G8B8A8_UNORM
        1, 0, 0, 0,                                           // typeSize
        2, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0,                   // width, height, depth
        0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0,                   // layers, faces, levels
        0, 0, 0, 0,                                           // no supercompression
        104, 0, 0, 0, 92, 0, 0, 0,                            // descriptor: offset, length
        196, 0, 0, 0, 64, 0, 0, 0,                            // key/values: offset, length
        0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,       // supercompression data
        4, 1, 0, 0, 0, 0, 0, 0,                               // level 0: at 260
        8, 0, 0, 0, 0, 0, 0, 0, 8, 0, 0, 0, 0, 0, 0, 0,       // its length, stored and uncompressed
        92, 0, 0, 0,                                          // descriptor: total size
        0, 0, 0, 0,                                           // Khronos, basic
        2, 0, 88, 0,                                          // version 1.3, block size
        1, 1, 1, 0,                                           // RGBSDA, BT.709, linear, straight alpha
        0, 0, 0, 0,                                           // texel block 1×1×1×1
        4, 0, 0, 0, 0, 0, 0, 0,                               // bytes of the planes
        0, 0, 7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 0, 0, 0,     // R: 8 bits at 0, of 0…255
        8, 0, 7, 1, 0, 0, 0, 0, 0, 0, 0, 0, 255, 0, 0, 0,     // G at 8
        16, 0, 7, 2, 0, 0, 0, 0, 0, 0, 0, 0, 255, 0, 0, 0,    // B at 16
        24, 0, 7, 15, 0, 0, 0, 0, 0, 0, 0, 0, 255, 0, 0, 0,   // A at 24
        18, 0, 0, 0, 'K', 'T', 'X', 'o', 'r', 'i', 'e', 'n', 't', 'a', 't', 'i', 'o', 'n', 0, 'r', 'd', 0, 0, 0,
        14, 0, 0, 0, 'K', 'T', 'X', 'w', 'r', 'i', 't', 'e', 'r', 0, 'p', 'r', 't', 0, 0, 0,
        16, 0, 0, 0, 'p', 'r', 't', 'P', 'a', 'r', 't', 0, 'w', 'e', 'i', 'g', 'h', 't', 's', 0,
        1, 2, 3, 4, 250, 251, 252, 253};
    // clang-format on
    EXPECT_EQ(readFile(directory.file("a.ktx2")), text(expected));
}

TEST(Ktx2, CubeArrayOfHalvesIsTheBytesOfTheSpecification) {
    TemporaryDirectory directory;
    const TextureImage image = sampleTexture(TexelFormat::Rgba16Float, 2, 2, 2, true);
    writeKtx2(directory.file("a.ktx2"), image);
    std::string expected = "\xABKTX 20\xBB\r\n\x1A\n";
    for (const uint32_t value : {97, 2, 2, 2, 0, 2, 6, 1, 0}) expected += word(value);
    for (const uint32_t value : {104, 92, 196, 44, 0, 0, 0, 0}) expected += word(value);
    // 196 + 44 = 240 is a multiple of the 8 bytes of a texel; 2·6·4 texels.
    for (const uint32_t value : {240, 0, 384, 0, 384, 0}) expected += word(value);
    for (const uint32_t value : {92u, 0u, 2u | 88u << 16, 0x010101u, 0u, 8u, 0u}) expected += word(value);
    for (uint32_t c = 0; c < 4; ++c)  // signed floats of −1…1
        expected += sample(16 * c, 16, 0xc0 | (c == 3 ? 15 : c), 0xbf800000, 0x3f800000);
    expected += word(18) + std::string("KTXorientation\0rd\0\0\0", 20);
    expected += word(14) + std::string("KTXwriter\0prt\0\0\0", 16);
    expected.append(image.bytes.begin(), image.bytes.end());
    EXPECT_EQ(readFile(directory.file("a.ktx2")), expected);
}

TEST(Ktx2, EveryFormatHasItsNumbersAndSamples) {
    struct Case {
        TexelFormat format;
        uint32_t vkFormat, typeSize, texelSize;
        std::string samples;
    };
    const uint32_t one = 0x3f800000, minusOne = 0xbf800000;
    const auto four = [](uint32_t bits, uint32_t flags, uint32_t lower, uint32_t upper) {
        return sample(0, bits, flags, lower, upper) + sample(bits, bits, flags | 1, lower, upper) +
               sample(2 * bits, bits, flags | 2, lower, upper) +
               sample(3 * bits, bits, flags | 15, lower, upper);
    };
    std::string shared;
    for (uint32_t c = 0; c < 3; ++c) shared += sample(9 * c, 9, c, 0, 8448) + sample(27, 5, 0x20 | c, 15, 31);
    const std::vector<Case> cases = {
        {TexelFormat::R8Unorm, 9, 1, 1, sample(0, 8, 0, 0, 255)},
        {TexelFormat::Rgba8Unorm, 37, 1, 4, four(8, 0, 0, 255)},
        {TexelFormat::R16Unorm, 70, 2, 2, sample(0, 16, 0, 0, 65535)},
        {TexelFormat::Rgba16Unorm, 91, 2, 8, four(16, 0, 0, 65535)},
        {TexelFormat::R16Float, 76, 2, 2, sample(0, 16, 0xc0, minusOne, one)},
        {TexelFormat::Rgba16Float, 97, 2, 8, four(16, 0xc0, minusOne, one)},
        {TexelFormat::R32Float, 100, 4, 4, sample(0, 32, 0xc0, minusOne, one)},
        {TexelFormat::Rgba32Float, 109, 4, 16, four(32, 0xc0, minusOne, one)},
        {TexelFormat::Rgb9e5, 123, 4, 4, shared},
        {TexelFormat::R11fG11fB10f, 122, 4, 4,
         sample(0, 11, 0x80, 0, one) + sample(11, 11, 0x81, 0, one) + sample(22, 10, 0x82, 0, one)}};
    ASSERT_EQ(cases.size(), size_t(kTexelFormatCount));
    TemporaryDirectory directory;
    for (const Case& c : cases) {
        SCOPED_TRACE(texelFormatName(c.format));
        writeKtx2(directory.file("a.ktx2"), sampleTexture(c.format, 3, 2, 0, false));
        const std::string file = readFile(directory.file("a.ktx2"));
        EXPECT_EQ(file.substr(12, 8), word(c.vkFormat) + word(c.typeSize));
        const auto block = uint32_t(24 + c.samples.size());
        EXPECT_EQ(descriptorOf(file), word(4 + block) + word(0) + word(2 | block << 16) + word(0x010101) +
                                          word(0) + word(c.texelSize) + word(0) + c.samples);
        const size_t offset = uint8_t(file[80]) | size_t(uint8_t(file[81])) << 8;
        EXPECT_EQ(offset % std::max(4u, c.texelSize), 0u);
        EXPECT_EQ(file.size() - offset, 6 * c.texelSize);
    }
}

TEST(Ktx2, EveryTextureComesBack) {
    TemporaryDirectory directory;
    for (const TextureImage& image : sampleTextures()) {
        const KtxMetadata metadata = {{"prtA", ""}, {"prtB", "two words"}};
        writeKtx2(directory.file("a.ktx2"), image, metadata);
        KtxMetadata found;
        EXPECT_EQ(readKtx2(directory.file("a.ktx2"), &found), image) << texelFormatName(image.format);
        KtxMetadata expected = metadata;
        expected.insert({{"KTXorientation", "rd"}, {"KTXwriter", "prt"}});
        EXPECT_EQ(found, expected);
        EXPECT_EQ(readKtx2(directory.file("a.ktx2")), image);
    }
    EXPECT_EQ(directory.names(), std::vector<std::string>{"a.ktx2"});
}

TEST(Ktx2, DamagedFilesAreRefused) {
    TemporaryDirectory directory;
    const std::string path = directory.file("a.ktx2");
    writeKtx2(path, sampleTexture(TexelFormat::Rgb9e5, 2, 2, 2, true));
    const std::string whole = readFile(path);
    for (size_t length = 0; length < whole.size(); length += length < 300 ? 1 : 37) {
        rewriteFile(path, whole.substr(0, length));
        EXPECT_THROW(readKtx2(path), InputError) << length;
    }
    rewriteFile(path, whole + '\0');
    EXPECT_THROW(readKtx2(path), InputError);
    // Header, index and descriptor hold nothing that may change alone, whatever the bit.
    const size_t headerEnd = 104 + 4 + 24 + 6 * 16;
    for (size_t i = 0; i < headerEnd; ++i)
        for (const int mask : {0x01, 0x80, 0xff}) {
            std::string damaged = whole;
            damaged[i] = char(damaged[i] ^ mask);
            rewriteFile(path, damaged);
            EXPECT_THROW(readKtx2(path), InputError) << i << " " << mask;
        }
    std::string damaged = whole;
    damaged.replace(damaged.find("rd"), 2, "ru");
    rewriteFile(path, damaged);
    EXPECT_THAT([&] { readKtx2(path); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr("orientation")));
    damaged = whole;
    damaged[headerEnd + 3] = 0x7f;  // length of the first pair
    rewriteFile(path, damaged);
    EXPECT_THROW(readKtx2(path), InputError);
    EXPECT_THROW(readKtx2(directory.file("absent.ktx2")), InputError);
}

}  // namespace
}  // namespace prt
