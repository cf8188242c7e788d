// What an atlas covers, on the raster of its texel centres.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>

#include "precompute/base/parallel.h"
#include "precompute/mesh/atlas_parts.h"

namespace prt {
namespace {

/// Margin in texels inside which two triangles at one centre count as touching: float coordinates of an atlas
/// of 8192 texels are exact to 5e-4.
constexpr double kMargin = 5e-3;
constexpr int kBandRows = 16;

struct RasterTriangle {
    std::array<double, 3> x, y;
};

RasterTriangle rasterTriangle(const Scene& scene, size_t t, int texels) {
    RasterTriangle r;
    for (size_t k = 0; k < 3; ++k) {
        const Vec2f& uv = scene.uv1[scene.indices[3 * t + k]];
        r.x[k] = double(uv.x()) * texels;
        r.y[k] = double(uv.y()) * texels;
    }
    return r;
}

double doubleArea(const RasterTriangle& r) {
    return (r.x[1] - r.x[0]) * (r.y[2] - r.y[0]) - (r.y[1] - r.y[0]) * (r.x[2] - r.x[0]);
}

/// Distance of a point to the nearest edge line of the triangle, positive inside, in texels.
double depthInside(const RasterTriangle& r, double side, double x, double y) {
    double depth = 1e300;
    for (size_t k = 0; k < 3; ++k) {
        const size_t l = (k + 1) % 3;
        const double ex = r.x[l] - r.x[k], ey = r.y[l] - r.y[k];
        const double length = std::sqrt(ex * ex + ey * ey);
        if (length > 0) depth = std::min(depth, side * (ex * (y - r.y[k]) - ey * (x - r.x[k])) / length);
    }
    return depth;
}

}  // namespace

std::pair<int, int> columnsInRow(const std::array<double, 3>& x, const std::array<double, 3>& y, int row,
                                 int low, int high) {
    constexpr int kNarrow = 8;
    if (high - low < kNarrow) return {low, high};
    double left = 1e300, right = -1e300;
    for (size_t k = 0; k < 3; ++k) {
        const size_t l = (k + 1) % 3;
        const double rise = y[l] - y[k];
        if (std::max(y[k], y[l]) < row || std::min(y[k], y[l]) > row + 1) continue;
        for (int end = 0; end < 2; ++end) {
            const double t = rise != 0 ? std::clamp((row + end - y[k]) / rise, 0.0, 1.0) : end;
            const double at = x[k] + t * (x[l] - x[k]);
            left = std::min(left, at);
            right = std::max(right, at);
        }
    }
    if (left > right) return {0, -1};
    return {int(std::max(double(low), std::floor(left) - 1)), int(std::min(double(high), std::ceil(right)))};
}

Coverage measureCoverage(const Scene& scene, int texels) {
    const int bands = (texels + kBandRows - 1) / kBandRows;
    const size_t triangles = scene.triangleCount();
    const auto rowRange = [&](const RasterTriangle& r) {
        const auto [low, high] = std::minmax({r.y[0], r.y[1], r.y[2]});
        return std::array<int, 2>{std::clamp(int(std::ceil(low - 0.5)), 0, texels),
                                  std::clamp(int(std::floor(high - 0.5)), -1, texels - 1)};
    };
    std::vector<uint32_t> first(size_t(bands) + 1, 0), sorted;
    const auto eachBand = [&](const auto& visit) {
        for (size_t t = 0; t < triangles; ++t) {
            const auto [y0, y1] = rowRange(rasterTriangle(scene, t, texels));
            if (y0 > y1) continue;
            for (int b = y0 / kBandRows; b <= y1 / kBandRows; ++b) visit(size_t(b), uint32_t(t));
        }
    };
    eachBand([&](size_t band, uint32_t) { ++first[band + 1]; });
    std::partial_sum(first.begin(), first.end(), first.begin());
    sorted.resize(first.back());
    std::vector<uint32_t> cursor(first.begin(), first.end() - 1);
    eachBand([&](size_t band, uint32_t t) { sorted[cursor[band]++] = t; });

    std::atomic<size_t> covered = 0, twice = 0;
    parallelFor(size_t(bands), 1, [&](size_t band, size_t) {
        const int rowBegin = int(band) * kBandRows, rowEnd = std::min(texels, rowBegin + kBandRows);
        std::vector<uint8_t> touched(size_t(texels) * kBandRows, 0), inside(touched.size(), 0);
        size_t again = 0;
        for (uint32_t i = first[band]; i < first[band + 1]; ++i) {
            const RasterTriangle r = rasterTriangle(scene, sorted[i], texels);
            const double side = doubleArea(r) < 0 ? -1 : 1;
            const auto [low, high] = std::minmax({r.x[0], r.x[1], r.x[2]});
            const int x0 = std::max(0, int(std::ceil(low - 0.5))),
                      x1 = std::min(texels - 1, int(std::floor(high - 0.5)));
            const auto [yLow, yHigh] = rowRange(r);
            for (int y = std::max(rowBegin, yLow); y <= std::min(rowEnd - 1, yHigh); ++y) {
                const auto [from, to] = columnsInRow(r.x, r.y, y, x0, x1);
                for (int x = from; x <= to; ++x) {
                    const double depth = depthInside(r, side, x + 0.5, y + 0.5);
                    if (depth < 0) continue;
                    const size_t cell = size_t(y - rowBegin) * size_t(texels) + size_t(x);
                    touched[cell] = 1;
                    if (depth <= kMargin) continue;
                    again += inside[cell];
                    inside[cell] = 1;
                }
            }
        }
        covered += size_t(std::count(touched.begin(), touched.end(), uint8_t(1)));
        twice += again;
    });
    return {covered, twice};
}

bool isValidAtlas(const Scene& scene, int texels) {
    if (scene.uv1.empty() || scene.uv1.size() != scene.positions.size() || scene.indices.empty())
        return false;
    for (const Vec2f& uv : scene.uv1)
        if (!(uv.x() >= 0 && uv.x() <= 1 && uv.y() >= 0 && uv.y() <= 1)) return false;
    // Triangles squeezed to nothing have no texel; a few slivers may be, by rounding.
    constexpr double kMostSqueezed = 1e-4;
    double squeezed = 0, total = 0;
    for (size_t t = 0; t < scene.triangleCount(); ++t) {
        const uint32_t* corner = scene.indices.data() + 3 * t;
        const double area =
            triangleCross(scene.positions[corner[0]], scene.positions[corner[1]], scene.positions[corner[2]])
                .norm();
        total += area;
        if (doubleArea(rasterTriangle(scene, t, texels)) == 0) squeezed += area;
    }
    if (squeezed > kMostSqueezed * total) return false;
    return measureCoverage(scene, texels).twice == 0;
}

}  // namespace prt
