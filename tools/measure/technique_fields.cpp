// Fig. 3 of [IwanickiSloan2012].
#include "tools/measure/technique_fields.h"

#include <fmt/format.h>

#include <algorithm>

#include "precompute/base/check.h"
#include "precompute/math/sh.h"
#include "tools/picture.h"
#include "tools/view/point_colours.h"

namespace prt::tools {
namespace {

constexpr int kEdgePx = 256;
constexpr size_t kWeightColumns = 6;

// Means of squares of pixels, so that it is at most so wide.
FloatImage shrink(const FloatImage& image, int mostPx) {
    const int factor = (std::max(image.width, image.height) + mostPx - 1) / mostPx;
    if (factor <= 1) return image;
    FloatImage small{image.width / factor, image.height / factor, 3, {}};
    small.pixels.assign(size_t(small.width) * size_t(small.height) * 3, 0.0f);
    for (int y = 0; y < small.height * factor; ++y)
        for (int x = 0; x < small.width * factor; ++x)
            for (int c = 0; c < 3; ++c)
                small.at(x / factor, y / factor)[c] += image.at(x, y)[c] / float(factor * factor);
    return small;
}

std::vector<std::string> coefficientLabels(int shOrder) {
    std::vector<std::string> labels;
    for (int l = 0; l < shOrder; ++l)
        for (int m = -l; m <= l; ++m) labels.push_back(fmt::format("V{:02} l={} m={}", shIndex(l, m), l, m));
    return labels;
}

// One row for each band, m = 0 below m = 0.
std::vector<std::vector<SheetCell>> triangleOfBands(const std::vector<SheetCell>& cells, int shOrder) {
    std::vector<std::vector<SheetCell>> rows;
    for (int l = 0; l < shOrder; ++l) {
        rows.emplace_back(size_t(shOrder - 1 - l));
        for (int m = -l; m <= l; ++m) rows.back().push_back(cells[size_t(shIndex(l, m))]);
    }
    return rows;
}

}  // namespace

std::vector<SheetCell> fieldPictures(Renderer& renderer, const Camera& camera, const PointGrid& grid,
                                     std::span<const float> values, std::span<const Validity> validity,
                                     const std::vector<std::string>& labels, int edgePx) {
    const size_t perPoint = labels.size();
    PRT_CHECK_EQ(values.size(), grid.count * perPoint);
    std::vector<SheetCell> cells;
    for (size_t k = 0; k < perPoint; ++k) {
        const PointColours colours = signedColours(grid, values.subspan(k), perPoint, validity, labels[k]);
        FloatImage image{grid.width, grid.height, 3, {}};
        if (grid.domain == PointDomain::Texel) {
            image.pixels = colours.rgb;
            image = shrink(image, edgePx);
        } else {
            renderer.setPointColours(grid, colours.rgb, true);
            image = renderer.renderPoints(camera, {edgePx, std::max(1, edgePx * 5 / 8), false});
        }
        cells.push_back({labels[k], toDisplay(image, 0),
                         fmt::format("{} to {}", colours.legend.front().text, colours.legend.back().text)});
    }
    return cells;
}

std::vector<std::filesystem::path> drawFieldSheets(GlContext& context, const RelightData& data,
                                                   const Camera& camera,
                                                   const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    Renderer renderer(context, data.scene, nullptr, nullptr);
    const std::string scale = "blue below 0, white at 0, red above; the ends of each scale are below it";
    if (data.visibility) {
        const VisibilityMap& map = *data.visibility;
        const std::vector<SheetCell> cells =
            fieldPictures(renderer, camera, map.grid, map.coefficients, map.validity,
                          coefficientLabels(map.shOrder), kEdgePx);
        files.push_back(folder / "figure3-visibility.png");
        writePng(files.back(), composeSheet(fmt::format("Coefficients of visibility, {}", scale),
                                            triangleOfBands(cells, map.shOrder)));
    }
    if (data.pca) {
        const PcaMap& map = *data.pca;
        std::vector<std::string> labels;
        for (int m = 1; m <= map.components; ++m) labels.push_back(fmt::format("weight {}", m));
        const std::span<const Validity> validity = data.visibility
                                                       ? std::span<const Validity>(data.visibility->validity)
                                                       : std::span<const Validity>();
        const std::vector<SheetCell> cells =
            fieldPictures(renderer, camera, map.grid, map.weights, validity, labels, kEdgePx);
        files.push_back(folder / "figure3-weights.png");
        writePng(files.back(),
                 composeSheet(fmt::format("PCA weights, {}", scale), inColumns({cells}, kWeightColumns)));
    }
    return files;
}

}  // namespace prt::tools
