// Room inside the rectangles of charts. Internal to the mesh stage.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "precompute/mesh/atlas_parts.h"

namespace prt {

/// An empty rectangle of texels, in the rectangle (gutter included) of a chart. What lies in it with a gutter
/// of its own keeps the whole gutter to the chart.
struct Pocket {
    uint32_t chart = 0;
    int x = 0, y = 0, width = 0, height = 0;
    int64_t area() const { return int64_t(width) * height; }
};

/// Edge in texels of the rectangle that a chart of so many texels takes, with half a gutter on either side.
inline int chartExtent(double texels, int gutter) {
    return std::max(1, int(std::ceil(texels - 1e-9))) + gutter;
}

/// The largest pockets of every chart, by chart.
std::vector<Pocket> findPockets(const AtlasMesh& mesh, const ChartFaces& faces,
                                const std::vector<ChartShape>& shapes, double texelsPerUnit, int gutter);

}  // namespace prt
