// Sources: [IwanickiSloan2012, Sec. 3.4] (four coefficients to a texel); formats: compress/quantize.h.
#include "compress/export_textures.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"

namespace prt {
namespace {

template <class Word>
void putWord(std::vector<uint8_t>& bytes, size_t index, Word word) {
    for (size_t i = 0; i < sizeof(Word); ++i) bytes[index * sizeof(Word) + i] = uint8_t(word >> (8 * i));
}

uint32_t floatBits(float value) {
    uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}

uint16_t clampedHalf(float value) { return halfFromFloat(std::clamp(value, -kMaxHalf, kMaxHalf)); }

// Writes one value of a four-channel float or half texture, returns what a reader gets.
float putFloat(TextureImage& image, size_t index, float value) {
    if (image.format == TexelFormat::Rgba32Float) {
        putWord(image.bytes, index, floatBits(value));
        return value;
    }
    const uint16_t half = clampedHalf(value);
    putWord(image.bytes, index, half);
    return floatFromHalf(half);
}

TexelFormat pointFormat(const std::string& encoding) {
    if (encoding == "float") return TexelFormat::Rgba32Float;
    if (encoding == "half") return TexelFormat::Rgba16Float;
    if (encoding == "unorm16") return TexelFormat::Rgba16Unorm;
    PRT_CHECK(encoding == "unorm8");
    return TexelFormat::Rgba8Unorm;
}

float largestMagnitude(std::span<const float> values) {
    float largest = 0;
    for (const float value : values) largest = std::max(largest, std::abs(value));
    return largest;
}

// Power of two that brings values into the range of half floats.
float halfScale(float largest) {
    float scale = 1;
    while (largest / scale > kMaxHalf) scale *= 2;
    return scale;
}

// A colour's functions 4i … 4i + 3, or the mean of all colours.
struct TexelGroup {
    const float* planes[4] = {};
    float* decoded[4] = {};
};

TexelGroup texelGroup(const NormalTable& table, int used, int layers, int group,
                      std::vector<float>& decoded) {
    TexelGroup result;
    for (int k = 0; k < 4; ++k) {
        const bool isMean = group == 3 * layers;
        const int colour = isMean ? k : group / layers, index = isMean ? used : group % layers * 4 + k;
        if (colour == 3 || (!isMean && index >= used)) continue;
        const size_t offset = (size_t(colour) * size_t(table.layers) + size_t(index)) * table.texels();
        result.planes[k] = table.values.data() + offset;
        result.decoded[k] = decoded.data() + offset;
    }
    return result;
}

TableTexture encodeFourPerTexel(const NormalTable& table, TexelFormat format) {
    TableTexture texture;
    texture.packing = "four-per-texel";
    const bool hasMean = table.kind == TableKind::TripleProduct;
    const int used = hasMean ? table.layers - 1 : table.layers, layers = (used + 3) / 4;
    const int groups = 3 * layers + (hasMean ? 1 : 0);
    texture.image = {format, table.size, table.size, groups, true, {}};
    texture.image.bytes.resize(textureBytes(texture.image));
    texture.decoded.resize(table.values.size());
    bool isScaled = false;
    for (int group = 0; group < groups; ++group) {
        const TexelGroup planes = texelGroup(table, used, layers, group, texture.decoded);
        float largest = 0;
        for (const float* plane : planes.planes)
            if (plane) largest = std::max(largest, largestMagnitude({plane, table.texels()}));
        const float scale = format == TexelFormat::Rgba16Float ? halfScale(largest) : 1;
        isScaled = isScaled || scale != 1;
        texture.ranges.push_back({0, 0, 0, scale});
        for (size_t k = 0; k < 4; ++k) {
            if (!planes.planes[k]) continue;
            for (size_t i = 0; i < table.texels(); ++i) {
                const size_t index = (size_t(group) * table.texels() + i) * 4 + k;
                planes.decoded[k][i] = scale * putFloat(texture.image, index, planes.planes[k][i] / scale);
            }
        }
    }
    if (!isScaled) texture.ranges.clear();
    return texture;
}

TableTexture encodeRgbPerLayer(const NormalTable& table, TexelFormat format) {
    TableTexture texture;
    texture.packing = "rgb-per-layer";
    texture.image = {format, table.size, table.size, table.layers, true, {}};
    texture.image.bytes.resize(textureBytes(texture.image));
    texture.decoded.resize(table.values.size());
    const size_t texels = table.texels();
    for (int layer = 0; layer < table.layers; ++layer) {
        std::array<float, 4> range{};
        for (int c = 0; c < 3; ++c) {
            const float* plane = table.layer(c, layer);
            const auto [low, high] = std::minmax_element(plane, plane + texels);
            range[size_t(c)] = *low;
            range[3] = std::max(range[3], *high - *low);
        }
        // 1 would take the next exponent, with steps of twice the size for the other colours too.
        if (format == TexelFormat::Rgb9e5) range[3] *= 512.0f / 511.0f;
        if (!(range[3] > 0)) range[3] = 1;
        for (size_t i = 0; i < texels; ++i) {
            std::array<float, 3> rgb{};
            for (size_t c = 0; c < 3; ++c) rgb[c] = (table.layer(int(c), layer)[i] - range[c]) / range[3];
            const bool isShared = format == TexelFormat::Rgb9e5;
            const uint32_t word = isShared ? packRgb9e5(rgb) : packR11fG11fB10f(rgb);
            const std::array<float, 3> back = isShared ? unpackRgb9e5(word) : unpackR11fG11fB10f(word);
            putWord(texture.image.bytes, size_t(layer) * texels + i, word);
            for (size_t c = 0; c < 3; ++c)
                texture.decoded[(c * size_t(table.layers) + size_t(layer)) * texels + i] =
                    range[c] + range[3] * back[c];
        }
        texture.ranges.push_back(range);
    }
    return texture;
}

}  // namespace

PointTexture encodePoints(std::span<const float> values, size_t perPoint, const PointGrid& grid,
                          const std::string& encoding, std::span<const uint8_t> used) {
    PRT_CHECK(perPoint >= 1);
    PRT_CHECK_EQ(values.size(), grid.count * perPoint);
    const size_t layers = (perPoint + 3) / 4, pixels = size_t(grid.width) * size_t(grid.height);
    PointTexture texture;
    texture.image = {pointFormat(encoding), grid.width, grid.height, int(layers), false, {}};
    texture.image.bytes.resize(textureBytes(texture.image));
    texture.decoded.resize(values.size());
    const auto texelIndex = [&](size_t point, size_t k) { return (k / 4 * pixels + point) * 4 + k % 4; };
    if (encoding == "float" || encoding == "half") {
        parallelFor(grid.count, 16384, [&](size_t begin, size_t end) {
            for (size_t point = begin; point < end; ++point)
                for (size_t k = 0; k < perPoint; ++k)
                    texture.decoded[point * perPoint + k] =
                        putFloat(texture.image, texelIndex(point, k), values[point * perPoint + k]);
        });
        return texture;
    }
    const int bits = encoding == "unorm8" ? 8 : 16;
    texture.ranges = fitUnormRanges(values, perPoint, bits, used);
    const std::vector<uint16_t> codes = quantizeUnorm(values, texture.ranges, bits);
    texture.decoded = dequantizeUnorm(codes, texture.ranges, bits);
    parallelFor(grid.count, 16384, [&](size_t begin, size_t end) {
        for (size_t point = begin; point < end; ++point)
            for (size_t k = 0; k < perPoint; ++k) {
                const uint16_t code = codes[point * perPoint + k];
                if (bits == 8)
                    texture.image.bytes[texelIndex(point, k)] = uint8_t(code);
                else
                    putWord(texture.image.bytes, texelIndex(point, k), code);
            }
    });
    texture.ranges.resize(4 * layers);
    return texture;
}

TableTexture encodeTable(const NormalTable& table, const std::string& encoding) {
    PRT_CHECK_EQ(table.values.size(), size_t(3) * size_t(table.layers) * table.texels());
    if (encoding == "rgb9e5") return encodeRgbPerLayer(table, TexelFormat::Rgb9e5);
    if (encoding == "r11f") return encodeRgbPerLayer(table, TexelFormat::R11fG11fB10f);
    return encodeFourPerTexel(table, pointFormat(encoding));
}

}  // namespace prt
