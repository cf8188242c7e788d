// Sources: the formats are Vulkan's [VulkanFormats].
#include "precompute/io/texture_image.h"

#include <algorithm>

#include "precompute/base/check.h"

namespace prt {

const char* texelFormatName(TexelFormat format) {
    switch (format) {
        case TexelFormat::R8Unorm:
            return "R8_UNORM";
        case TexelFormat::Rgba8Unorm:
            return "R8G8B8A8_UNORM";
        case TexelFormat::R16Unorm:
            return "R16_UNORM";
        case TexelFormat::Rgba16Unorm:
            return "R16G16B16A16_UNORM";
        case TexelFormat::R16Float:
            return "R16_SFLOAT";
        case TexelFormat::Rgba16Float:
            return "R16G16B16A16_SFLOAT";
        case TexelFormat::R32Float:
            return "R32_SFLOAT";
        case TexelFormat::Rgba32Float:
            return "R32G32B32A32_SFLOAT";
        case TexelFormat::Rgb9e5:
            return "E5B9G9R9_UFLOAT_PACK32";
        case TexelFormat::R11fG11fB10f:
            return "B10G11R11_UFLOAT_PACK32";
    }
    return "unknown";
}

size_t texelBytes(TexelFormat format) {
    switch (format) {
        case TexelFormat::R8Unorm:
            return 1;
        case TexelFormat::R16Unorm:
        case TexelFormat::R16Float:
            return 2;
        case TexelFormat::Rgba8Unorm:
        case TexelFormat::R32Float:
        case TexelFormat::Rgb9e5:
        case TexelFormat::R11fG11fB10f:
            return 4;
        case TexelFormat::Rgba16Unorm:
        case TexelFormat::Rgba16Float:
            return 8;
        case TexelFormat::Rgba32Float:
            return 16;
    }
    return 0;
}

size_t textureBytes(const TextureImage& image) {
    return size_t(std::max(image.layers, 1)) * (image.isCube ? 6 : 1) * size_t(image.width) *
           size_t(image.height) * texelBytes(image.format);
}

void checkTexture(const TextureImage& image) {
    PRT_CHECK(image.width >= 1 && image.width <= kMaxTextureSide);
    PRT_CHECK(image.height >= 1 && image.height <= kMaxTextureSide);
    PRT_CHECK(image.layers >= 0 && image.layers <= kMaxTextureSide);
    if (image.isCube) PRT_CHECK_EQ(image.width, image.height);
    PRT_CHECK_EQ(image.bytes.size(), textureBytes(image));
}

}  // namespace prt
