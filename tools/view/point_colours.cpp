// Sources: [IwanickiSloan2012, Fig. 3] for coefficients as pictures.
#include "tools/view/point_colours.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/math/sh.h"
#include "precompute/mesh/texel_raster.h"

namespace prt::tools {
namespace {

constexpr double kShareInScale = 0.99;  // of the points that have a surface
const Vec3f kNegative(0.02f, 0.15f, 0.80f), kZero(1, 1, 1), kPositive(0.75f, 0.06f, 0.02f);

Vec3f signedColour(float value) {
    const float size = std::min(std::abs(value), 1.0f);
    return (1 - size) * kZero + size * (value < 0 ? kNegative : kPositive);
}

void put(std::vector<float>& rgb, size_t point, const Vec3f& colour) {
    std::copy_n(colour.data(), 3, &rgb[3 * point]);
}

PointColours aoColours(const VisibilityMap& map) {
    PointColours colours{map.grid, {}, true, "ambient occlusion", {}, true};
    colours.rgb.resize(map.grid.count * 3);
    for (size_t i = 0; i < map.grid.count; ++i)
        put(colours.rgb, i, Vec3f::Constant(std::clamp(map.ao[i], 0.0f, 1.0f)));
    colours.legend = {{Vec3f::Zero(), "0 closed"}, {Vec3f::Constant(0.5f), "0.5"}, {Vec3f::Ones(), "1 open"}};
    return colours;
}

PointColours validityColours(const VisibilityMap& map) {
    PointColours colours{map.grid, {}, false, "where values come from", {}, false};
    colours.rgb.resize(map.grid.count * 3);
    std::array<size_t, kValidityCount> counts{};
    for (size_t i = 0; i < map.grid.count; ++i) {
        put(colours.rgb, i, validityColour(map.validity[i]));
        ++counts[size_t(map.validity[i])];
    }
    for (int reason = 0; reason < kValidityCount; ++reason)
        colours.legend.push_back(
            {validityColour(Validity(reason)),
             fmt::format("{} ({})", validityName(Validity(reason)), counts[size_t(reason)])});
    return colours;
}

// Steps of the golden ratio through the hues, so that neighbouring numbers look different.
Vec3f chartColour(uint32_t chart) {
    const double hue = 6 * std::fmod(0.61803398875 * double(chart), 1.0);
    Vec3f colour;
    for (int c = 0; c < 3; ++c) {
        const double distance = std::abs(std::remainder(hue - 2 * c, 6.0));
        colour[c] = float(0.25 + 0.5 * std::clamp(2 - distance, 0.0, 1.0));
    }
    return colour;
}

PointColours chartColours(const Scene& scene, const PointGrid& grid) {
    const TexelSurface texels = rasterizeTexels(scene, grid.width, grid.height);
    PointColours colours{grid, {}, false, "charts", {}, false};
    colours.rgb.assign(grid.count * 3, 0.0f);
    uint32_t charts = 0;
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) {
            const size_t texel = size_t(y) * size_t(grid.width) + size_t(x);
            const uint32_t chart = texels.chartOfTexel[texel];
            if (chart == kNoPoint) continue;
            charts = std::max(charts, chart + 1);
            const bool edge =
                (x > 0 && texels.chartOfTexel[texel - 1] != chart) ||
                (x + 1 < grid.width && texels.chartOfTexel[texel + 1] != chart) ||
                (y > 0 && texels.chartOfTexel[texel - size_t(grid.width)] != chart) ||
                (y + 1 < grid.height && texels.chartOfTexel[texel + size_t(grid.width)] != chart);
            put(colours.rgb, texel, edge ? Vec3f(Vec3f::Zero()) : chartColour(chart));
        }
    colours.legend = {{Vec3f::Zero(), "edge of a chart"},
                      {chartColour(0), fmt::format("{} charts, a colour each", charts)}};
    return colours;
}

const VisibilityMap& needed(const VisibilityMap* visibility) {
    if (!visibility) throw InputError("visibility.exr", "there is none", "run prt precompute");
    return *visibility;
}

}  // namespace

Vec3f validityColour(Validity validity) {
    switch (validity) {
        case Validity::Empty:
            return {0.5f, 0.0f, 0.5f};
        case Validity::Valid:
            return {0.35f, 0.5f, 0.35f};
        case Validity::GutterFilled:
            return {0.05f, 0.15f, 0.8f};
        case Validity::InsideFilled:
            return {0.9f, 0.4f, 0.02f};
        case Validity::Inside:
            return {0.8f, 0.02f, 0.02f};
    }
    return Vec3f::Zero();
}

PointColours signedColours(const PointGrid& grid, std::span<const float> values, size_t stride,
                           std::span<const Validity> validity, std::string title) {
    PRT_CHECK(grid.count == 0 || (grid.count - 1) * stride < values.size());
    PRT_CHECK(validity.empty() || validity.size() == grid.count);
    const auto counts = [&](size_t i) { return validity.empty() || validity[i] != Validity::Empty; };
    std::vector<float> sizes;
    for (size_t i = 0; i < grid.count; ++i)
        if (counts(i)) sizes.push_back(std::abs(values[i * stride]));
    // A few points that stick out would leave all others white.
    float end = 0, largest = 0;
    if (!sizes.empty()) {
        const auto at = sizes.begin() + std::ptrdiff_t(std::ceil(kShareInScale * double(sizes.size())) - 1);
        std::ranges::nth_element(sizes, at);
        end = *at;
        largest = *std::ranges::max_element(at, sizes.end());
        if (end == 0) end = largest;
    }
    PointColours colours{grid, {}, true, std::move(title), {}, true};
    colours.rgb.assign(grid.count * 3, 0.0f);
    for (size_t i = 0; i < grid.count; ++i)
        if (counts(i)) put(colours.rgb, i, signedColour(end > 0 ? values[i * stride] / end : 0));
    const bool beyond = largest > end;
    colours.legend = {{kNegative, fmt::format("{}{:.3g}", beyond ? "<= " : "", -end)},
                      {kZero, "0"},
                      {kPositive, fmt::format("{}{:.3g}", beyond ? ">= " : "", end)}};
    return colours;
}

PointColours pointColours(Shown shown, int index, const Scene& scene, const VisibilityMap* visibility,
                          const PcaMap* pca) {
    PRT_CHECK(showsPoints(shown));
    switch (shown) {
        case Shown::Weight: {
            if (!pca) throw InputError("pca.exr", "there is none", "run prt compress");
            PRT_CHECK(index >= 0 && index < pca->components);
            const std::span<const float> all = pca->weights;
            return signedColours(
                pca->grid, all.subspan(size_t(index)), size_t(pca->components),
                visibility ? std::span<const Validity>(visibility->validity) : std::span<const Validity>(),
                fmt::format("weight {} of 0..{}", index, pca->components - 1));
        }
        case Shown::Coefficient: {
            const VisibilityMap& map = needed(visibility);
            const int count = map.shOrder * map.shOrder, band = int(std::sqrt(double(index)));
            PRT_CHECK(index >= 0 && index < count);
            const std::span<const float> all = map.coefficients;
            return signedColours(
                map.grid, all.subspan(size_t(index)), size_t(count), map.validity,
                fmt::format("coefficient {}: band {}, m {:+}", index, band, index - band * (band + 1)));
        }
        case Shown::Ao:
            return aoColours(needed(visibility));
        case Shown::Validity:
            return validityColours(needed(visibility));
        default:
            return chartColours(scene, needed(visibility).grid);
    }
}

}  // namespace prt::tools
