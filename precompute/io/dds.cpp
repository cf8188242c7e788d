// DDS files [DdsGuide]: the old header says little, the DX10 header has format, array and cube.
#include "precompute/io/dds.h"

#include <fmt/format.h>

#include "precompute/base/atomic_file.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/io/little_endian.h"

namespace prt {
namespace {

constexpr uint32_t kMagic = 0x20534444, kDx10 = 0x30315844;  // "DDS ", "DX10"
constexpr uint32_t kHeaderBytes = 124, kPixelFormatBytes = 32;
constexpr size_t kDataOffset = 4 + kHeaderBytes + 20;
constexpr uint32_t kCaps = 0x1, kHeight = 0x2, kWidth = 0x4, kPitch = 0x8, kPixelFormat = 0x1000;
constexpr uint32_t kFourCc = 0x4;
constexpr uint32_t kCapsTexture = 0x1000, kCapsComplex = 0x8, kCaps2CubeAllFaces = 0xfe00;
constexpr uint32_t kDimension2d = 3, kMiscCube = 0x4;
constexpr uint32_t kAlphaUnknown = 0, kAlphaCustom = 4;  // custom: the fourth channel is data

uint32_t dxgiFormat(TexelFormat format) {
    switch (format) {
        case TexelFormat::R8Unorm:
            return 61;
        case TexelFormat::Rgba8Unorm:
            return 28;
        case TexelFormat::R16Unorm:
            return 56;
        case TexelFormat::Rgba16Unorm:
            return 11;
        case TexelFormat::R16Float:
            return 54;
        case TexelFormat::Rgba16Float:
            return 10;
        case TexelFormat::R32Float:
            return 41;
        case TexelFormat::Rgba32Float:
            return 2;
        case TexelFormat::Rgb9e5:
            return 67;
        case TexelFormat::R11fG11fB10f:
            return 26;
    }
    return 0;
}

bool hasAlpha(TexelFormat format) {
    return format == TexelFormat::Rgba8Unorm || format == TexelFormat::Rgba16Unorm ||
           format == TexelFormat::Rgba16Float || format == TexelFormat::Rgba32Float;
}

// Everything before the texels.
std::string header(const TextureImage& image) {
    LittleEndianWriter out;
    const auto put = [&](std::initializer_list<uint32_t> words) {
        for (const uint32_t word : words) out.put(word);
    };
    put({kMagic, kHeaderBytes, kCaps | kHeight | kWidth | kPitch | kPixelFormat, uint32_t(image.height),
         uint32_t(image.width), uint32_t(size_t(image.width) * texelBytes(image.format)), 0, 1});
    for (int reserved = 0; reserved < 11; ++reserved) out.put(uint32_t(0));
    put({kPixelFormatBytes, kFourCc, kDx10, 0, 0, 0, 0, 0});
    const bool isComplex = image.isCube || image.layers > 1;
    put({kCapsTexture | (isComplex ? kCapsComplex : 0), image.isCube ? kCaps2CubeAllFaces : 0, 0, 0, 0});
    put({dxgiFormat(image.format), kDimension2d, image.isCube ? kMiscCube : 0,
         uint32_t(std::max(image.layers, 1)), hasAlpha(image.format) ? kAlphaCustom : kAlphaUnknown});
    return out.bytes;
}

[[noreturn]] void refuse(const std::string& where, const std::string& problem) {
    throw InputError(where, problem, "the file is damaged, or of a kind that prt does not write");
}

int readSide(LittleEndianReader& in, const char* name, const std::string& where) {
    const auto value = in.get<uint32_t>();
    if (value < 1 || value > uint32_t(kMaxTextureSide))
        refuse(where, fmt::format("has {} {}, outside of 1 to {}", name, value, kMaxTextureSide));
    return int(value);
}

TexelFormat readFormat(LittleEndianReader& in, const std::string& where) {
    const auto dxgi = in.get<uint32_t>();
    for (int i = 0; i < kTexelFormatCount; ++i)
        if (dxgiFormat(TexelFormat(i)) == dxgi) return TexelFormat(i);
    refuse(where, fmt::format("has the DXGI format {}, which is not read", dxgi));
}

}  // namespace

void writeDds(const std::filesystem::path& path, const TextureImage& image) {
    checkTexture(image);
    std::string bytes = header(image);
    PRT_CHECK_EQ(bytes.size(), kDataOffset);
    bytes.append(reinterpret_cast<const char*>(image.bytes.data()), image.bytes.size());
    writeFileAtomically(path, std::string_view(bytes));
}

TextureImage readDds(const std::filesystem::path& path) {
    const std::string bytes = readFile(path), where = path.string();
    LittleEndianReader in(bytes, where);
    if (in.get<uint32_t>() != kMagic) refuse(where, "is no DDS file");
    TextureImage image;
    in.get<uint32_t>();
    in.get<uint32_t>();
    image.height = readSide(in, "height", where);
    image.width = readSide(in, "width", where);
    LittleEndianReader dx10(std::string_view(bytes).substr(0, kDataOffset), where);
    while (dx10.offset() < 4 + kHeaderBytes) dx10.get<uint32_t>();
    image.format = readFormat(dx10, where);
    dx10.expect(kDimension2d, "dimension");
    image.isCube = dx10.get<uint32_t>() == kMiscCube;
    const int elements = readSide(dx10, "array size", where);
    image.layers = elements == 1 ? 0 : elements;
    if (image.isCube && image.width != image.height)
        refuse(where, fmt::format("has faces of {} x {} texels", image.width, image.height));
    dx10.get<uint32_t>();
    // All other words follow from these.
    const std::string expected = header(image);
    for (size_t i = 0; i < kDataOffset; ++i)
        if (bytes[i] != expected[i])
            refuse(where, fmt::format("has byte {} of its header {}, expected {}", i, uint8_t(bytes[i]),
                                      uint8_t(expected[i])));
    if (const size_t size = textureBytes(image); bytes.size() - kDataOffset != size)
        refuse(where, fmt::format("has {} bytes, expected {}", bytes.size(), kDataOffset + size));
    image.bytes.assign(bytes.begin() + ptrdiff_t(kDataOffset), bytes.end());
    return image;
}

}  // namespace prt
