// Plain pixels.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "precompute/math/environment.h"
#include "precompute/math/vec.h"

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

/// What brings exposed radiance into [0, 1], before the sRGB curve.
enum class ToneCurve {
    None,    ///< cut off at 1
    Filmic,  ///< a film's toe and shoulder; middle grey (0.18) stays, bright colours go to white
    Neutral  ///< colours as they are up to 0.76, less a reflection of 4 %; only highlights are compressed
};
/// "none", "filmic", "neutral".
std::string_view toneCurveName(ToneCurve curve);
/// Inverse of toneCurveName.
/// @return nothing where no curve has that name
std::optional<ToneCurve> toneCurveFromName(std::string_view name);

/// The curve alone, on colours of the Rec. 709 primaries. Greys stay grey, and for them it is monotone.
/// @param linear  exposed radiance; what is negative or not a number counts as 0
/// @return        linear, in [0, 1]
/// @source [Hill2016] Filmic, after a factor of 1.46193 that keeps 0.18; [KhronosNeutral2024] Neutral
Vec3d toneMapped(const Vec3d& linear, ToneCurve curve);

/// Linear to display: exposure, tone curve, sRGB transfer curve, rounded to 8 bits.
/// @param image          3 or 4 channels (alpha is not touched by exposure or curves)
/// @param exposureStops  radiance is multiplied by 2 to this power
/// @source [IEC61966-2-1]
ByteImage toDisplay(const FloatImage& image, double exposureStops, ToneCurve curve = ToneCurve::None);

}  // namespace prt
