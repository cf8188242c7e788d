// Textures of every format and shape.
#pragma once

#include "precompute/io/texture_image.h"

namespace prt {

inline TextureImage sampleTexture(TexelFormat format, int width, int height, int layers, bool isCube) {
    TextureImage image{format, width, height, layers, isCube, {}};
    image.bytes.resize(textureBytes(image));
    for (size_t i = 0; i < image.bytes.size(); ++i) image.bytes[i] = uint8_t(i * 37 + i / 256 + 11);
    return image;
}

inline std::vector<TextureImage> sampleTextures() {
    std::vector<TextureImage> images;
    for (int i = 0; i < kTexelFormatCount; ++i) {
        const auto format = TexelFormat(i);
        images.push_back(sampleTexture(format, 3, 5, 0, false));
        images.push_back(sampleTexture(format, 5, 1, 4, false));
        images.push_back(sampleTexture(format, 3, 3, 0, true));
        images.push_back(sampleTexture(format, 2, 2, 3, true));
    }
    return images;
}

}  // namespace prt
