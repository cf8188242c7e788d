// Plain pixels.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "precompute/math/environment.h"

namespace prt {

/// Float pixels, rows from the top, channels interleaved.
struct FloatImage {
    int width = 0, height = 0, channels = 0;
    std::vector<float> pixels;  ///< [height×width×channels]
    float* at(int x, int y) {
        return pixels.data() + (size_t(y) * size_t(width) + size_t(x)) * size_t(channels);
    }
    const float* at(int x, int y) const {
        return pixels.data() + (size_t(y) * size_t(width) + size_t(x)) * size_t(channels);
    }
};

/// 8-bit pixels, rows from the top, channels interleaved.
struct ByteImage {
    int width = 0, height = 0, channels = 0;
    std::vector<uint8_t> pixels;
};

/// Decodes PNG, JPEG or WebP (told apart by their first bytes) to 4 channels.
/// @param where  names the image in errors
/// @throws InputError  damaged, unknown format, or larger than 16384 in either direction
ByteImage decodeImage(std::span<const uint8_t> encoded, const std::string& where);
/// "image/png", "image/jpeg", "image/webp" or "".
std::string imageMimeType(std::span<const uint8_t> encoded);
std::vector<uint8_t> encodePng(const ByteImage& image);
/// Linear to display: exposure in stops, sRGB transfer curve, rounded to 8 bits.
/// @param image  3 or 4 channels (alpha is not touched by exposure or curve)
ByteImage toDisplay(const FloatImage& image, double exposureStops);

}  // namespace prt
