// Environments from files and formulas, and what is known of their suns.
// Sources: OpenEXR ImfEnvmap.h (orientation), Radiance RGBE (rgbe.cpp), CIE sky (procedural_sky.cpp).
#include "precompute/io/environment_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "precompute/base/atomic_file.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/bundle.h"
#include "precompute/io/exr_file.h"
#include "precompute/io/procedural_sky.h"
#include "precompute/io/rgbe.h"

namespace prt {
namespace {

constexpr int kMaxWidth = 16384;
// The largest finite half, as OpenEXR writes it.
constexpr float kMaxHalf = 65504;

void checkLatLongSize(int width, int height, const std::string& path) {
    if (width != 2 * height)
        throw InputError(path,
                         fmt::format("{} x {} pixels are not a latitude-longitude image", width, height),
                         "give one twice as wide as high, or an EXR with the envmap attribute");
    if (width > kMaxWidth)
        throw InputError(path, fmt::format("is {} pixels wide, more than {}", width, kMaxWidth),
                         "scale it down");
}

size_t partWithColour(const ExrReader& reader, const std::string& path) {
    for (size_t i = 0; i < reader.parts().size(); ++i) {
        const auto& channels = reader.parts()[i].channels;
        if (channels.contains("R") && channels.contains("G") && channels.contains("B")) return i;
    }
    throw InputError(path, "has no R, G and B channels", "save the image as RGB");
}

FloatImage loadExr(const std::string& path) {
    const ExrReader reader(path);
    const size_t part = partWithColour(reader, path);
    const ExrPartInfo& info = reader.parts()[part];
    FloatImage image{info.width, info.height, 3, {}};
    const bool cube = info.envmap == ExrEnvmap::Cube;
    if (cube && (info.height != 6 * info.width || info.width > kMaxWidth / 4))
        throw InputError(path,
                         fmt::format("{} x {} pixels are not a cube of six faces in a column of at most "
                                     "{} pixels each",
                                     info.width, info.height, kMaxWidth / 4));
    if (!cube) checkLatLongSize(info.width, info.height, path);
    image.pixels.resize(size_t(info.width) * size_t(info.height) * 3);
    std::vector<ExrChannelIn> channels;
    for (size_t c = 0; c < 3; ++c)
        channels.push_back({std::string(1, "RGB"[c]), ExrType::Float, image.pixels.data() + c,
                            3 * sizeof(float), size_t(info.width) * 3 * sizeof(float)});
    reader.read(part, channels);
    return image;
}

void clampValues(Environment& environment) {
    for (float& value : environment.image.pixels) {
        if (!std::isfinite(value)) {
            value = 0;
            ++environment.clampedNotFinite;
        } else if (value < 0) {
            value = 0;
            ++environment.clampedNegative;
        }
    }
    std::string found;
    if (environment.clampedNegative > 0) found = fmt::format("{} negative", environment.clampedNegative);
    if (environment.clampedNotFinite > 0)
        found += fmt::format("{}{} infinite or undefined", found.empty() ? "" : " and ",
                             environment.clampedNotFinite);
    if (!found.empty()) logWarning(fmt::format("{}: {} values set to 0", environment.source, found));
}

std::string lowerExtension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return extension;
}

std::string skyNameList() {
    std::string list;
    for (const std::string& name : proceduralSkyNames()) list += (list.empty() ? "sky:" : ", sky:") + name;
    return list;
}

}  // namespace

Environment loadEnvironment(const std::string& pathOrSky) {
    Environment environment;
    environment.source = pathOrSky;
    if (pathOrSky.starts_with("sky:")) {
        environment.name = pathOrSky.substr(4);
        const auto& names = proceduralSkyNames();
        if (std::find(names.begin(), names.end(), environment.name) == names.end())
            throw InputError(pathOrSky, "unknown sky", "use one of " + skyNameList());
        environment.image = makeProceduralSky(environment.name);
    } else {
        const std::filesystem::path path(pathOrSky);
        environment.name = path.stem().string();
        const std::string extension = lowerExtension(path);
        if (extension == ".exr") {
            environment.image = loadExr(pathOrSky);
        } else if (extension == ".hdr") {
            environment.image = decodeRgbe(readFile(path), pathOrSky);
            checkLatLongSize(environment.image.width, environment.image.height, pathOrSky);
        } else {
            throw InputError(pathOrSky, "is not an environment",
                             "give an .exr or .hdr file, or " + skyNameList());
        }
    }
    clampValues(environment);
    FloatImage& image = environment.image;
    // Only now: a cube's values are clamped before they are mixed.
    if (image.height == 6 * image.width) {
        int height = 0;
        image.pixels = latLongFromExrCube(image.pixels, image.width, height);
        image.width = 2 * height;
        image.height = height;
    }
    environment.contentHash = xxh3Hex(image.pixels.data(), image.pixels.size() * sizeof(float));
    return environment;
}

double brightestFluxShare(const LatLongView& image, double solidAngleFraction) {
    PRT_CHECK_EQ(image.rgb.size(), size_t(image.width) * size_t(image.height) * 3);
    struct Texel {
        float radiance;
        int row;
    };
    std::vector<Texel> texels;
    texels.reserve(image.rgb.size() / 3);
    std::vector<double> solidAngle(size_t(image.height));
    double total = 0;
    for (int y = 0; y < image.height; ++y) {
        const double texelSr = solidAngle[size_t(y)] = latLongTexelSolidAngle(y, image.width, image.height);
        const float* row = image.rgb.data() + size_t(y) * size_t(image.width) * 3;
        for (size_t x = 0; x < size_t(image.width); ++x) {
            const float radiance = (row[x * 3] + row[x * 3 + 1] + row[x * 3 + 2]) / 3;
            texels.push_back({radiance, y});
            total += double(radiance) * texelSr;
        }
    }
    if (!(total > 0)) return 0;
    std::sort(texels.begin(), texels.end(), [](const Texel& a, const Texel& b) {
        return a.radiance != b.radiance ? a.radiance > b.radiance : a.row < b.row;
    });
    const double limit = solidAngleFraction * 4 * std::numbers::pi * (1 + 1e-12);
    double covered = 0, flux = 0;
    for (const Texel& texel : texels) {
        covered += solidAngle[size_t(texel.row)];
        if (covered > limit) break;
        flux += double(texel.radiance) * solidAngle[size_t(texel.row)];
    }
    return flux / total;
}

bool hasSun(const LatLongView& image) { return brightestFluxShare(image, 0.005) > 0.2; }

void writeExrImage(const std::string& path, const FloatImage& image) {
    PRT_CHECK(image.channels == 3 || image.channels == 4);
    const size_t channels = size_t(image.channels);
    // Half has 11 bits, enough for pictures; what exceeds its range keeps all its bits instead.
    const bool fitsHalf = std::all_of(image.pixels.begin(), image.pixels.end(),
                                      [](float value) { return !(std::abs(value) > kMaxHalf); });
    ExrPartOut part;
    part.width = image.width;
    part.height = image.height;
    for (size_t c = 0; c < channels; ++c)
        part.channels.push_back({std::string(1, "RGBA"[c]),
                                 channels == 3 && fitsHalf ? ExrType::Half : ExrType::Float,
                                 image.pixels.data() + c, channels * sizeof(float),
                                 size_t(image.width) * channels * sizeof(float)});
    writeExr(path, {part});
}

}  // namespace prt
