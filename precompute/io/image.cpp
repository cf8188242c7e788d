// 8-bit images: decoding, encoding and the way from linear light to display.
// Sources: PNG, JPEG and WebP by stb and libwebp; IEC 61966-2-1 (sRGB).
#include "precompute/io/image.h"

#include <fmt/format.h>
#include <stb_image.h>
#include <stb_image_write.h>
#include <webp/decode.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "precompute/base/check.h"
#include "precompute/base/error.h"

namespace prt {
namespace {

constexpr int kMaxImageSize = 16384;

void checkSize(int width, int height, const std::string& where) {
    if (width < 1 || height < 1) throw InputError(where, "image without pixels");
    if (width > kMaxImageSize || height > kMaxImageSize)
        throw InputError(
            where, fmt::format("image of {} x {} pixels is larger than {}", width, height, kMaxImageSize),
            "scale it down");
}

ByteImage decodeWebp(std::span<const uint8_t> encoded, const std::string& where) {
    int width = 0, height = 0;
    if (!WebPGetInfo(encoded.data(), encoded.size(), &width, &height))
        throw InputError(where, "damaged WebP image");
    checkSize(width, height, where);
    ByteImage image{width, height, 4, std::vector<uint8_t>(size_t(width) * size_t(height) * 4)};
    if (!WebPDecodeRGBAInto(encoded.data(), encoded.size(), image.pixels.data(), image.pixels.size(),
                            width * 4))
        throw InputError(where, "damaged WebP image");
    return image;
}

ByteImage decodeByStb(std::span<const uint8_t> encoded, const std::string& where) {
    if (encoded.size() > size_t(std::numeric_limits<int>::max()))
        throw InputError(where, "image file of more than 2 GB");
    int width = 0, height = 0, channels = 0;
    const int size = int(encoded.size());
    if (!stbi_info_from_memory(encoded.data(), size, &width, &height, &channels))
        throw InputError(where, fmt::format("damaged image ({})", stbi_failure_reason()));
    checkSize(width, height, where);
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
        stbi_load_from_memory(encoded.data(), size, &width, &height, &channels, 4), stbi_image_free);
    if (!pixels) throw InputError(where, fmt::format("damaged image ({})", stbi_failure_reason()));
    checkSize(width, height, where);
    ByteImage image{width, height, 4, {}};
    image.pixels.assign(pixels.get(), pixels.get() + size_t(width) * size_t(height) * 4);
    return image;
}

uint8_t byteFromLinear(double linear) {
    // Also takes NaN to 0.
    if (!(linear > 0)) return 0;
    const double display =
        linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(std::min(linear, 1.0), 1 / 2.4) - 0.055;
    return uint8_t(std::lround(255 * std::min(display, 1.0)));
}

}  // namespace

std::string imageMimeType(std::span<const uint8_t> encoded) {
    const auto startsWith = [&](std::string_view magic, size_t at) {
        return encoded.size() >= at + magic.size() &&
               std::memcmp(encoded.data() + at, magic.data(), magic.size()) == 0;
    };
    if (startsWith("\x89PNG\r\n\x1a\n", 0)) return "image/png";
    if (startsWith("\xff\xd8\xff", 0)) return "image/jpeg";
    if (startsWith("RIFF", 0) && startsWith("WEBP", 8)) return "image/webp";
    return {};
}

ByteImage decodeImage(std::span<const uint8_t> encoded, const std::string& where) {
    const std::string type = imageMimeType(encoded);
    if (type == "image/webp") return decodeWebp(encoded, where);
    if (!type.empty()) return decodeByStb(encoded, where);
    throw InputError(where, "not a PNG, JPEG or WebP image", "convert it to one of these");
}

std::vector<uint8_t> encodePng(const ByteImage& image) {
    PRT_CHECK(image.width > 0 && image.height > 0 && image.channels >= 1 && image.channels <= 4);
    PRT_CHECK_EQ(image.pixels.size(), size_t(image.width) * size_t(image.height) * size_t(image.channels));
    std::vector<uint8_t> bytes;
    const auto append = [](void* context, void* data, int size) {
        auto& out = *static_cast<std::vector<uint8_t>*>(context);
        const auto* first = static_cast<const uint8_t*>(data);
        out.insert(out.end(), first, first + size);
    };
    const int written = stbi_write_png_to_func(append, &bytes, image.width, image.height, image.channels,
                                               image.pixels.data(), image.width * image.channels);
    if (!written) throw OutputError("PNG image", "cannot be encoded: out of memory");
    return bytes;
}

ByteImage toDisplay(const FloatImage& image, double exposureStops) {
    PRT_CHECK(image.channels == 3 || image.channels == 4);
    const double scale = std::exp2(exposureStops);
    ByteImage display{image.width, image.height, image.channels, {}};
    display.pixels.resize(image.pixels.size());
    const size_t channels = size_t(image.channels);
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        const double value = image.pixels[i];
        display.pixels[i] = i % channels == 3
                                ? uint8_t(std::lround(255 * (value > 0 ? std::min(value, 1.0) : 0.0)))
                                : byteFromLinear(value * scale);
    }
    return display;
}

}  // namespace prt
