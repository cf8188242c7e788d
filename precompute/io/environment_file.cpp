// Environments from files and formulas, and what is known of their suns.
// Sources: OpenEXR ImfEnvmap.h (orientation), Radiance RGBE (rgbe.cpp), skies (procedural_sky.cpp).
#include "precompute/io/environment_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
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
#include "precompute/math/environment_layout.h"

namespace prt {
namespace {

constexpr int kMaxSize = 16384, kMaxFace = 4096;
// The largest finite half, as OpenEXR writes it.
constexpr float kMaxHalf = 65504;

/// The layout that was named, or else that a file's attribute or shape says.
EnvironmentLayout findLayout(const std::string& name, ExrEnvmap envmap, int width, int height,
                             const std::string& path) {
    const auto shape = [&] { return fmt::format("{} x {} pixels", width, height); };
    std::optional<EnvironmentLayout> layout;
    if (name != "auto") {
        layout = environmentLayoutFromName(name);
    } else if (envmap == ExrEnvmap::Cube) {
        layout = EnvironmentLayout::OpenExrCube;
        if (!environmentLayoutFits(*layout, width, height))
            throw InputError(path, shape() + " are not a cube of six faces in a column");
    } else if (envmap == ExrEnvmap::LatLong) {
        layout = EnvironmentLayout::LatLong;
    } else {
        layout = detectEnvironmentLayout(width, height);
        if (!layout)
            throw InputError(
                path, shape() + " are no layout of an environment",
                "give one of the shapes " + environmentShapeList() + ", or an EXR with the envmap attribute");
    }
    if (!environmentLayoutFits(*layout, width, height))
        throw InputError(
            path,
            fmt::format("{} are not the shape of {}", shape(), environmentLayoutNames()[size_t(*layout)]),
            "name another layout, or let it be detected");
    const bool faces = *layout != EnvironmentLayout::LatLong && *layout != EnvironmentLayout::AngularMap;
    const int size = EnvironmentLayoutMap(*layout, width, height).size();
    if (std::max(width, height) > 6 * kMaxFace || (faces ? size > kMaxFace : width > kMaxSize))
        throw InputError(path,
                         fmt::format("{} are more than {} {}", shape(), faces ? kMaxFace : kMaxSize,
                                     faces ? "a face" : "in a row"),
                         "scale it down");
    return *layout;
}

size_t partWithColour(const ExrReader& reader, const std::string& path) {
    for (size_t i = 0; i < reader.parts().size(); ++i) {
        const auto& channels = reader.parts()[i].channels;
        if (channels.contains("R") && channels.contains("G") && channels.contains("B")) return i;
    }
    throw InputError(path, "has no R, G and B channels", "save the image as RGB");
}

struct Picture {
    FloatImage image;
    EnvironmentLayout layout;
};

Picture loadExr(const std::string& path, const std::string& layoutName) {
    const ExrReader reader(path);
    const size_t part = partWithColour(reader, path);
    const ExrPartInfo& info = reader.parts()[part];
    Picture picture{{info.width, info.height, 3, {}},
                    findLayout(layoutName, info.envmap, info.width, info.height, path)};
    picture.image.pixels.resize(size_t(info.width) * size_t(info.height) * 3);
    std::vector<ExrChannelIn> channels;
    for (size_t c = 0; c < 3; ++c)
        channels.push_back({std::string(1, "RGB"[c]), ExrType::Float, picture.image.pixels.data() + c,
                            3 * sizeof(float), size_t(info.width) * 3 * sizeof(float)});
    reader.read(part, channels);
    return picture;
}

/// To latitude-longitude; one that is mirrored shows the same with its columns in reverse.
FloatImage unwrap(Picture picture, bool mirrored) {
    FloatImage& image = picture.image;
    if (picture.layout != EnvironmentLayout::LatLong) {
        const int height = latLongHeightForLayout(picture.layout, image.width, image.height);
        return {2 * height, height, 3,
                latLongFromLayout(picture.layout, image.width, image.height, image.pixels, mirrored)};
    }
    if (mirrored)
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width / 2; ++x)
                std::swap_ranges(image.at(x, y), image.at(x, y) + 3, image.at(image.width - 1 - x, y));
    return std::move(image);
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

/// A sky's name and parameters as part of a file's name: `preetham-turbidity-3`.
std::string fileName(std::string request) {
    for (char& c : request)
        if (c == '?' || c == '&' || c == '=' || c == ',') c = '-';
    return request;
}

}  // namespace

Environment loadEnvironment(const std::string& pathOrSky, const EnvironmentOptions& options) {
    if (options.layout != "auto" && !environmentLayoutFromName(options.layout))
        throw UsageError(options.layout, "is not a layout of environments",
                         fmt::format("use auto or one of {}", fmt::join(environmentLayoutNames(), ", ")));
    Environment environment;
    environment.source = pathOrSky;
    Picture picture{{}, EnvironmentLayout::LatLong};
    if (pathOrSky.starts_with("sky:")) {
        environment.image = makeProceduralSky(pathOrSky.substr(4));
        environment.name = fileName(pathOrSky.substr(4));
        clampValues(environment);
    } else {
        const std::filesystem::path path(pathOrSky);
        environment.name = path.stem().string();
        const std::string extension = lowerExtension(path);
        if (extension == ".exr") {
            picture = loadExr(pathOrSky, options.layout);
        } else if (extension == ".hdr") {
            picture.image = decodeRgbe(readFile(path), pathOrSky);
            picture.layout = findLayout(options.layout, ExrEnvmap::None, picture.image.width,
                                        picture.image.height, pathOrSky);
        } else {
            throw InputError(pathOrSky, "is not an environment",
                             fmt::format("give an .exr or .hdr file, or sky:{}",
                                         fmt::join(proceduralSkyNames(), ", sky:")));
        }
        environment.image = std::move(picture.image);
        clampValues(environment);
        environment.image = unwrap({std::move(environment.image), picture.layout}, options.mirrored);
    }
    const FloatImage& image = environment.image;
    environment.contentHash = xxh3Hex(image.pixels.data(), image.pixels.size() * sizeof(float));
    return environment;
}

std::string environmentFileStem(const std::string& environmentName) {
    std::string stem = environmentName;
    for (char& c : stem)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') c = '_';
    return stem;
}

const std::vector<std::string>& builtInEnvironments() {
    static const std::vector<std::string> names = {"sky:clear", "sky:overcast", "sky:sunset", "sky:uniform"};
    return names;
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
