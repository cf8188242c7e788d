// KTX 2.0 files [Ktx2] with the basic data format descriptor of [KhronosDataFormat].
#include "precompute/io/ktx2.h"

#include <fmt/format.h>

#include <array>
#include <bit>

#include "precompute/base/atomic_file.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/io/little_endian.h"

namespace prt {
namespace {

constexpr std::string_view kIdentifier("\xABKTX 20\xBB\r\n\x1A\n", 12);
constexpr const char* kOrientation = "KTXorientation";
constexpr const char* kWriter = "KTXwriter";
constexpr size_t kHeaderBytes = 80, kLevelIndexBytes = 24;

// Of the Khronos data format specification.
constexpr uint32_t kModelRgbsda = 1, kPrimariesBt709 = 1, kTransferLinear = 1, kDescriptorVersion = 2;
constexpr uint32_t kAlpha = 15;
constexpr uint32_t kSampleExponent = 0x20, kSampleSigned = 0x40, kSampleFloat = 0x80;

// What KTX says of a format: Vulkan's number, the size of the words that endianness concerns.
struct KtxFormat {
    TexelFormat format;
    uint32_t vkFormat, typeSize;
};
constexpr KtxFormat kFormats[kTexelFormatCount] = {
    {TexelFormat::R8Unorm, 9, 1},        {TexelFormat::Rgba8Unorm, 37, 1},
    {TexelFormat::R16Unorm, 70, 2},      {TexelFormat::Rgba16Unorm, 91, 2},
    {TexelFormat::R16Float, 76, 2},      {TexelFormat::Rgba16Float, 97, 2},
    {TexelFormat::R32Float, 100, 4},     {TexelFormat::Rgba32Float, 109, 4},
    {TexelFormat::R11fG11fB10f, 122, 4}, {TexelFormat::Rgb9e5, 123, 4},
};

const KtxFormat& ktxFormat(TexelFormat format) {
    for (const KtxFormat& known : kFormats)
        if (known.format == format) return known;
    PRT_CHECK(!"a texel format that KTX files know");
    return kFormats[0];
}

struct Sample {
    uint32_t bitOffset, bits, channel, lower, upper;
};

std::vector<Sample> samplesOf(TexelFormat format) {
    constexpr uint32_t kChannels[] = {0, 1, 2, kAlpha};
    const auto one = std::bit_cast<uint32_t>(1.0f), minusOne = std::bit_cast<uint32_t>(-1.0f);
    std::vector<Sample> samples;
    switch (format) {
        case TexelFormat::Rgb9e5:
            // Each colour is a mantissa and the exponent that all share; 8448 stands for 1 at the
            // exponent 15.
            for (uint32_t c = 0; c < 3; ++c) {
                samples.push_back({9 * c, 9, c, 0, 8448});
                samples.push_back({27, 5, c | kSampleExponent, 15, 31});
            }
            return samples;
        case TexelFormat::R11fG11fB10f:
            return {{0, 11, 0 | kSampleFloat, 0, one},
                    {11, 11, 1 | kSampleFloat, 0, one},
                    {22, 10, 2 | kSampleFloat, 0, one}};
        default:
            break;
    }
    const uint32_t bits = 8 * ktxFormat(format).typeSize;
    const bool isUnorm = format == TexelFormat::R8Unorm || format == TexelFormat::Rgba8Unorm ||
                         format == TexelFormat::R16Unorm || format == TexelFormat::Rgba16Unorm;
    for (uint32_t c = 0; c * bits < 8 * texelBytes(format); ++c)
        if (isUnorm)
            samples.push_back({c * bits, bits, kChannels[c], 0, (1u << bits) - 1});
        else
            samples.push_back({c * bits, bits, kChannels[c] | kSampleFloat | kSampleSigned, minusOne, one});
    return samples;
}

std::string dataFormatDescriptor(TexelFormat format) {
    const std::vector<Sample> samples = samplesOf(format);
    const auto blockBytes = uint32_t(24 + 16 * samples.size());
    LittleEndianWriter out;
    out.put(uint32_t(4 + blockBytes));
    out.put(uint32_t(0));  // Khronos, basic descriptor
    out.put(kDescriptorVersion | blockBytes << 16);
    out.put(kModelRgbsda | kPrimariesBt709 << 8 | kTransferLinear << 16);
    out.put(uint32_t(0));                   // blocks of 1×1×1×1 texels
    out.put(uint64_t(texelBytes(format)));  // one plane
    for (const Sample& sample : samples) {
        out.put(sample.bitOffset | (sample.bits - 1) << 16 | sample.channel << 24);
        out.put(uint32_t(0));  // position
        out.put(sample.lower);
        out.put(sample.upper);
    }
    return out.bytes;
}

std::string keyValueData(const KtxMetadata& metadata) {
    LittleEndianWriter out;
    for (const auto& [key, value] : metadata) {
        PRT_CHECK(!key.empty());
        PRT_CHECK(key.find('\0') == std::string::npos && value.find('\0') == std::string::npos);
        out.put(uint32_t(key.size() + 1 + value.size() + 1));
        out.bytes.append(key).push_back('\0');
        out.bytes.append(value).push_back('\0');
        out.align(4);
    }
    return out.bytes;
}

// Levels begin at multiples of the texel's size and of 4.
size_t levelAlignment(TexelFormat format) { return std::max<size_t>(texelBytes(format), 4); }

[[noreturn]] void refuse(const std::string& where, const std::string& problem) {
    throw InputError(where, problem, "the file is damaged, or of a kind that prt does not write");
}

// The part of the header before the index.
TextureImage readHeader(LittleEndianReader& in, const std::string& where) {
    TextureImage image;
    const auto vkFormat = in.get<uint32_t>();
    const KtxFormat* known = nullptr;
    for (const KtxFormat& candidate : kFormats)
        if (candidate.vkFormat == vkFormat) known = &candidate;
    if (!known) refuse(where, fmt::format("has the Vulkan format {}, which is not read", vkFormat));
    image.format = known->format;
    in.expect(known->typeSize, "type size");
    const auto side = [&](const char* name, uint32_t least) {
        const auto value = in.get<uint32_t>();
        if (value < least || value > uint32_t(kMaxTextureSide))
            refuse(where, fmt::format("has {} {}, outside of {} to {}", name, value, least, kMaxTextureSide));
        return int(value);
    };
    image.width = side("width", 1);
    image.height = side("height", 1);
    in.expect(uint32_t(0), "depth");
    image.layers = side("layers", 0);
    const auto faces = in.get<uint32_t>();
    if (faces != 1 && faces != 6) refuse(where, fmt::format("has {} faces, expected 1 or 6", faces));
    image.isCube = faces == 6;
    if (image.isCube && image.width != image.height)
        refuse(where, fmt::format("has faces of {} x {} texels", image.width, image.height));
    in.expect(uint32_t(1), "levels");
    in.expect(uint32_t(0), "supercompression scheme");
    return image;
}

KtxMetadata readKeyValues(std::string_view bytes, const std::string& where) {
    KtxMetadata metadata;
    std::string before;
    size_t offset = 0;
    while (offset < bytes.size()) {
        LittleEndianReader in(bytes.substr(offset), where);
        const size_t length = in.get<uint32_t>(), padded = (length + 3) / 4 * 4;
        if (padded > bytes.size() - offset - 4) refuse(where, "has key/value data beyond its end");
        const std::string_view pair = bytes.substr(offset + 4, length);
        const size_t zero = pair.find('\0');
        if (zero == 0 || zero == std::string_view::npos) refuse(where, "has a key without a name or an end");
        const std::string key(pair.substr(0, zero));
        std::string_view value = pair.substr(zero + 1);
        if (!value.empty() && value.back() == '\0') value.remove_suffix(1);
        if (offset > 0 && key <= before) refuse(where, fmt::format("has the key {} out of order", key));
        metadata[key] = value;
        before = key;
        offset += 4 + padded;
    }
    const auto orientation = metadata.find(kOrientation);
    if (orientation != metadata.end() && orientation->second != "rd")
        refuse(where, fmt::format("has orientation \"{}\", expected \"rd\"", orientation->second));
    return metadata;
}

}  // namespace

void writeKtx2(const std::filesystem::path& path, const TextureImage& image, const KtxMetadata& metadata) {
    checkTexture(image);
    KtxMetadata all = metadata;
    for (const auto& [key, value] : metadata) PRT_CHECK(!key.starts_with("KTX") && !key.starts_with("ktx"));
    all[kOrientation] = "rd";
    all[kWriter] = "prt";
    const std::string descriptor = dataFormatDescriptor(image.format), keyValues = keyValueData(all);
    const size_t descriptorOffset = kHeaderBytes + kLevelIndexBytes;
    const size_t keyValueOffset = descriptorOffset + descriptor.size();
    const size_t alignment = levelAlignment(image.format);
    const size_t levelOffset = (keyValueOffset + keyValues.size() + alignment - 1) / alignment * alignment;

    LittleEndianWriter out;
    out.bytes.reserve(levelOffset + image.bytes.size());
    out.bytes = kIdentifier;
    const KtxFormat& format = ktxFormat(image.format);
    for (const uint32_t word :
         {format.vkFormat, format.typeSize, uint32_t(image.width), uint32_t(image.height), 0u,
          uint32_t(image.layers), image.isCube ? 6u : 1u, 1u, 0u})
        out.put(word);
    for (const size_t word : {descriptorOffset, descriptor.size(), keyValueOffset, keyValues.size()})
        out.put(uint32_t(word));
    out.put(uint64_t(0));  // no supercompression data
    out.put(uint64_t(0));
    for (const size_t word : {levelOffset, image.bytes.size(), image.bytes.size()}) out.put(uint64_t(word));
    out.bytes += descriptor + keyValues;
    out.align(alignment);
    out.bytes.append(reinterpret_cast<const char*>(image.bytes.data()), image.bytes.size());
    writeFileAtomically(path, std::string_view(out.bytes));
}

TextureImage readKtx2(const std::filesystem::path& path, KtxMetadata* metadata) {
    const std::string bytes = readFile(path), where = path.string();
    if (!bytes.starts_with(kIdentifier)) refuse(where, "is no KTX 2.0 file");
    LittleEndianReader in(std::string_view(bytes).substr(kIdentifier.size()), where);
    TextureImage image = readHeader(in, where);
    const std::string descriptor = dataFormatDescriptor(image.format);
    in.expect(uint32_t(kHeaderBytes + kLevelIndexBytes), "descriptor offset");
    in.expect(uint32_t(descriptor.size()), "descriptor length");
    const size_t keyValueOffset = kHeaderBytes + kLevelIndexBytes + descriptor.size();
    const size_t storedOffset = in.get<uint32_t>(), keyValueBytes = in.get<uint32_t>();
    if (storedOffset != keyValueOffset && (storedOffset != 0 || keyValueBytes != 0))
        refuse(where, fmt::format("has key/value data at {}, expected {}", storedOffset, keyValueOffset));
    in.expect(uint64_t(0), "supercompression data offset");
    in.expect(uint64_t(0), "supercompression data length");
    const size_t size = textureBytes(image), alignment = levelAlignment(image.format);
    const size_t levelOffset = (keyValueOffset + keyValueBytes + alignment - 1) / alignment * alignment;
    in.expect(uint64_t(levelOffset), "level offset");
    in.expect(uint64_t(size), "level length");
    in.expect(uint64_t(size), "uncompressed level length");
    if (bytes.size() < levelOffset || bytes.size() - levelOffset != size)
        refuse(where, fmt::format("has {} bytes, expected {}", bytes.size(), levelOffset + size));
    if (bytes.compare(kHeaderBytes + kLevelIndexBytes, descriptor.size(), descriptor) != 0)
        refuse(where, fmt::format("has a data format descriptor that is not that of {}",
                                  texelFormatName(image.format)));
    KtxMetadata found = readKeyValues(std::string_view(bytes).substr(keyValueOffset, keyValueBytes), where);
    if (metadata) *metadata = std::move(found);
    image.bytes.assign(bytes.begin() + ptrdiff_t(levelOffset), bytes.end());
    return image;
}

}  // namespace prt
