// 8-bit images: decoding, encoding and the way from linear light to display.
// Sources: PNG, JPEG and WebP by stb and libwebp; [IEC61966-2-1] sRGB; [Hill2016], [KhronosNeutral2024] tone
// curves.
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
#include <utility>

#include "precompute/base/check.h"
#include "precompute/base/error.h"

namespace prt {
namespace {

constexpr int kMaxImageSize = 16384;

constexpr std::pair<ToneCurve, std::string_view> kToneCurves[] = {
    {ToneCurve::None, "none"}, {ToneCurve::Filmic, "filmic"}, {ToneCurve::Neutral, "neutral"}};

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

// Of a value in [0, 1].
uint8_t byteFromLinear(double linear) {
    const double display = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    return uint8_t(std::lround(255 * display));
}

Vec3d withinDisplay(const Vec3d& colour) { return colour.cwiseMax(0.0).cwiseMin(1.0); }

// The ACES reference and display transforms of one channel, fitted [Hill2016].
double filmicChannel(double x) {
    return (x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.4329510) + 0.238081);
}

Vec3d filmic(const Vec3d& colour) {
    constexpr double kMiddleGrey = 1.46193;  // filmicChannel(kMiddleGrey · 0.18) = 0.18
    Mat3d in, out;
    in << 0.59719, 0.35458, 0.04823, 0.07600, 0.90834, 0.01566, 0.02840, 0.13383, 0.83777;
    out << 1.60475, -0.53108, -0.07367, -0.10208, 1.10813, -0.00605, -0.00327, -0.07276, 1.07602;
    return withinDisplay(out * (in * (kMiddleGrey * colour)).unaryExpr(&filmicChannel));
}

Vec3d neutral(const Vec3d& colour) {
    constexpr double kReflection = 0.04, kStart = 0.8 - kReflection, kDesaturation = 0.15;
    const double least = colour.minCoeff();
    const double offset = least < 2 * kReflection ? least - least * least / (4 * kReflection) : kReflection;
    const Vec3d lower = colour - Vec3d::Constant(offset);
    const double peak = lower.maxCoeff();
    if (peak < kStart) return lower;
    constexpr double kRoom = 1 - kStart;
    const double newPeak = 1 - kRoom * kRoom / (peak + kRoom - kStart);
    const double white = 1 - 1 / (kDesaturation * (peak - newPeak) + 1);
    return withinDisplay((1 - white) * (newPeak / peak) * lower + Vec3d::Constant(white * newPeak));
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

std::string_view toneCurveName(ToneCurve curve) {
    const auto found = std::ranges::find(kToneCurves, curve, &std::pair<ToneCurve, std::string_view>::first);
    PRT_CHECK(found != std::end(kToneCurves));
    return found->second;
}

std::optional<ToneCurve> toneCurveFromName(std::string_view name) {
    for (const auto& [value, known] : kToneCurves)
        if (known == name) return value;
    return std::nullopt;
}

Vec3d toneMapped(const Vec3d& linear, ToneCurve curve) {
    // Far beyond white; its square is still a number. NaN is not greater than 0.
    static constexpr double kBrightest = 1e6;
    const Vec3d colour = linear.unaryExpr([](double x) { return x > 0 ? std::min(x, kBrightest) : 0.0; });
    switch (curve) {
        case ToneCurve::None:
            break;
        case ToneCurve::Filmic:
            return filmic(colour);
        case ToneCurve::Neutral:
            return neutral(colour);
    }
    return withinDisplay(colour);
}

ByteImage toDisplay(const FloatImage& image, double exposureStops, ToneCurve curve) {
    PRT_CHECK(image.channels == 3 || image.channels == 4);
    const double scale = std::exp2(exposureStops);
    ByteImage display{image.width, image.height, image.channels, {}};
    display.pixels.resize(image.pixels.size());
    const size_t channels = size_t(image.channels);
    for (size_t i = 0; i + channels <= image.pixels.size(); i += channels) {
        const float* from = &image.pixels[i];
        const Vec3d colour = toneMapped(scale * Vec3d(from[0], from[1], from[2]), curve);
        for (size_t c = 0; c < 3; ++c) display.pixels[i + c] = byteFromLinear(colour[int(c)]);
        if (channels == 4)
            display.pixels[i + 3] =
                uint8_t(std::lround(255 * (from[3] > 0 ? std::min(double(from[3]), 1.0) : 0.0)));
    }
    return display;
}

}  // namespace prt
