// DDS files against bytes laid out by hand, damaged in every place, and read by other people's tools.
#include "precompute/io/dds.h"

#include <cstdio>
#include <cstdlib>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "tests/base/temporary_directory.h"
#include "tests/io/texture_samples.h"

namespace prt {
namespace {

std::string words(const std::vector<uint32_t>& values) {
    std::string bytes;
    for (const uint32_t value : values)
        for (int shift = 0; shift < 32; shift += 8) bytes.push_back(char(value >> shift & 0xff));
    return bytes;
}

std::string golden(uint32_t width, uint32_t height, uint32_t pitch, uint32_t caps, uint32_t caps2,
                   const std::vector<uint32_t>& dx10) {
    return "DDS " + words({124, 0x100f, height, width, pitch, 0, 1}) + words(std::vector<uint32_t>(11)) +
           words({32, 4}) + "DX10" + words({0, 0, 0, 0, 0}) + words({caps, caps2, 0, 0, 0}) + words(dx10);
}

TEST(Dds, HeadersAreThoseOfTheGuide) {
    TemporaryDirectory directory;
    const auto written = [&](const TextureImage& image) {
        writeDds(directory.file("a.dds"), image);
        std::string file = readFile(directory.file("a.dds"));
        EXPECT_EQ(file.size(), 148 + image.bytes.size());
        EXPECT_EQ(file.substr(148), std::string(image.bytes.begin(), image.bytes.end()));
        return file.substr(0, 148);
    };
    EXPECT_EQ(written(sampleTexture(TexelFormat::Rgba8Unorm, 3, 2, 0, false)),
              golden(3, 2, 12, 0x1000, 0, {28, 3, 0, 1, 4}));
    EXPECT_EQ(written(sampleTexture(TexelFormat::R8Unorm, 3, 2, 5, false)),
              golden(3, 2, 3, 0x1008, 0, {61, 3, 0, 5, 0}));
    EXPECT_EQ(written(sampleTexture(TexelFormat::Rgba16Float, 2, 2, 3, true)),
              golden(2, 2, 16, 0x1008, 0xfe00, {10, 3, 4, 3, 4}));
    EXPECT_EQ(written(sampleTexture(TexelFormat::Rgb9e5, 2, 2, 0, true)),
              golden(2, 2, 8, 0x1008, 0xfe00, {67, 3, 4, 1, 0}));
    const std::vector<std::pair<TexelFormat, uint32_t>> formats = {
        {TexelFormat::R16Unorm, 56}, {TexelFormat::Rgba16Unorm, 11}, {TexelFormat::R16Float, 54},
        {TexelFormat::R32Float, 41}, {TexelFormat::Rgba32Float, 2},  {TexelFormat::R11fG11fB10f, 26}};
    for (const auto& [format, dxgi] : formats)
        EXPECT_EQ(written(sampleTexture(format, 1, 1, 0, false)).substr(128, 4), words({dxgi}));
}

TEST(Dds, EveryTextureComesBack) {
    TemporaryDirectory directory;
    for (const TextureImage& image : sampleTextures()) {
        writeDds(directory.file("a.dds"), image);
        EXPECT_EQ(readDds(directory.file("a.dds")), image) << texelFormatName(image.format);
    }
    TextureImage one = sampleTexture(TexelFormat::R8Unorm, 2, 2, 1, false);
    writeDds(directory.file("a.dds"), one);
    one.layers = 0;
    EXPECT_EQ(readDds(directory.file("a.dds")), one);
    EXPECT_EQ(directory.names(), std::vector<std::string>{"a.dds"});
}

TEST(Dds, DamagedFilesAreRefused) {
    TemporaryDirectory directory;
    const std::string path = directory.file("a.dds");
    writeDds(path, sampleTexture(TexelFormat::Rgba16Unorm, 2, 2, 2, true));
    const std::string whole = readFile(path);
    for (size_t length = 0; length < whole.size(); length += length < 160 ? 1 : 37) {
        rewriteFile(path, whole.substr(0, length));
        EXPECT_THROW(readDds(path), InputError) << length;
    }
    rewriteFile(path, whole + '\0');
    EXPECT_THROW(readDds(path), InputError);
    for (size_t i = 0; i < 148; ++i)
        for (const int mask : {0x01, 0x80, 0xff}) {
            std::string damaged = whole;
            damaged[i] = char(damaged[i] ^ mask);
            // Another four-channel format of as many bytes is no damage that shows.
            if (i == 128 && uint8_t(damaged[i]) == 10) continue;
            rewriteFile(path, damaged);
            EXPECT_THROW(readDds(path), InputError) << i << " " << mask;
        }
    EXPECT_THROW(readDds(directory.file("absent.dds")), InputError);
}

std::string outputOf(const std::string& command) {
    std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    std::string output;
    char block[4096];
    size_t count = 0;
    while ((count = std::fread(block, 1, sizeof block, pipe)) > 0) output.append(block, count);
    return ::pclose(pipe) == 0 ? output : "failed: " + output;
}

TEST(Dds, PillowReadsTheSameTexels) {
    if (outputOf("/usr/bin/python3 -c 'import PIL.DdsImagePlugin'") != "")
        GTEST_SKIP() << "Pillow (package python3-pil) is not installed";
    TemporaryDirectory directory;
    const TextureImage image = sampleTexture(TexelFormat::Rgba8Unorm, 7, 5, 0, false);
    writeDds(directory.file("a.dds"), image);
    const std::string script =
        "import sys; from PIL import Image; i = Image.open(sys.argv[1]); "
        "print(i.mode, i.size, list(i.tobytes()), sep=\"\\n\")";
    std::string expected = "RGBA\n(7, 5)\n[";
    for (const uint8_t byte : image.bytes) expected += std::to_string(byte) + ", ";
    expected.replace(expected.size() - 2, 2, "]\n");
    EXPECT_EQ(outputOf("/usr/bin/python3 -c '" + script + "' '" + directory.file("a.dds") + "'"), expected);
}

}  // namespace
}  // namespace prt
