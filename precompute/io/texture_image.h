// Texels as graphics hardware takes them, before they go into a container (ktx2.h, dds.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace prt {

enum class TexelFormat {
    R8Unorm,
    Rgba8Unorm,
    R16Unorm,
    Rgba16Unorm,
    R16Float,
    Rgba16Float,
    R32Float,
    Rgba32Float,
    Rgb9e5,        ///< one word: compress/quantize.h
    R11fG11fB10f,  ///< one word: compress/quantize.h
};
inline constexpr int kTexelFormatCount = 10;

/// Vulkan's name of the format, e.g. "R8G8B8A8_UNORM".
const char* texelFormatName(TexelFormat format);
/// Bytes of a texel: 1, 2, 4, 8 or 16.
size_t texelBytes(TexelFormat format);

/// A 2D image, cube, or array of either, without smaller levels. Rows from the top (the first row is at v =
/// 0, and a cube's faces are as math/sphere_map.h has them), components and words little-endian.
struct TextureImage {
    TexelFormat format = TexelFormat::Rgba8Unorm;
    int width = 0, height = 0;  ///< equal for cubes
    int layers = 0;             ///< 0: no array, which is not the same as an array of one
    bool isCube = false;
    std::vector<uint8_t> bytes;  ///< [max(layers, 1)][6 if a cube][height][width] texels

    bool operator==(const TextureImage&) const = default;
};

/// Largest width, height and number of layers that files may have.
inline constexpr int kMaxTextureSide = 65536;

/// Bytes that a texture's sizes and format call for.
size_t textureBytes(const TextureImage& image);
/// Checks (PRT_CHECK) that sizes are in 1…kMaxTextureSide, a cube is square and the bytes are as many as they
/// should be.
void checkTexture(const TextureImage& image);

}  // namespace prt
