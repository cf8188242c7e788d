// Empty rectangles inside the rectangles of charts (holes of frames, corners beside gables), where smaller
// charts may lie. Largest empty rectangle of a bitmap by a stack over its histogram: D. Vandevoorde, "The
// Maximal Rectangle Problem", Dr. Dobb's Journal 23(4), 1998.
#include "precompute/mesh/atlas_pockets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "precompute/base/parallel.h"

namespace prt {
namespace {

using Point = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;

constexpr int kMostPerChart = 8;

double turn(const Point& a, const Point& b, const Point& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

struct Bitmap {
    int width, height;
    std::vector<uint8_t> cells;
    Bitmap(int w, int h) : width(w), height(h), cells(size_t(w) * size_t(h), 0) {}
    uint8_t& at(int x, int y) { return cells[size_t(y) * size_t(width) + size_t(x)]; }
};

/// Marks texels whose square, grown on all sides, touches the triangle.
void markTriangle(Bitmap& bitmap, const std::array<Point, 3>& p, double grow) {
    const auto [xLow, xHigh] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
    const auto [yLow, yHigh] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
    const int x0 = std::max(0, int(std::floor(xLow - grow)));
    const int x1 = std::min(bitmap.width - 1, int(std::floor(xHigh + grow)));
    const int y0 = std::max(0, int(std::floor(yLow - grow)));
    const int y1 = std::min(bitmap.height - 1, int(std::floor(yHigh + grow)));
    const double side = turn(p[0], p[1], p[2]) < 0 ? -1 : 1;
    const double reach = 0.5 + grow;
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            uint8_t& cell = bitmap.at(x, y);
            if (cell) continue;
            bool touches = true;
            for (size_t k = 0; k < 3 && touches; ++k) {
                const Point &a = p[k], &b = p[(k + 1) % 3];
                const double slack = reach * (std::abs(b.x() - a.x()) + std::abs(b.y() - a.y()));
                touches = side * turn(a, b, Point(x + 0.5, y + 0.5)) >= -slack;
            }
            cell = touches;
        }
}

/// Largest rectangle without a marked cell.
Pocket largestEmpty(Bitmap& bitmap) {
    Pocket best;
    std::vector<int> depth(size_t(bitmap.width) + 1, 0), stack;
    for (int y = 0; y < bitmap.height; ++y) {
        for (int x = 0; x < bitmap.width; ++x) depth[size_t(x)] = bitmap.at(x, y) ? 0 : depth[size_t(x)] + 1;
        stack.clear();
        for (int x = 0; x <= bitmap.width; ++x) {
            while (!stack.empty() && depth[size_t(stack.back())] >= depth[size_t(x)]) {
                const int height = depth[size_t(stack.back())];
                stack.pop_back();
                const int left = stack.empty() ? 0 : stack.back() + 1;
                if (int64_t(height) * (x - left) > best.area())
                    best = {0, left, y - height + 1, x - left, height};
            }
            stack.push_back(x);
        }
    }
    return best;
}

}  // namespace

std::vector<Pocket> findPockets(const AtlasMesh& mesh, const ChartFaces& faces,
                                const std::vector<ChartShape>& shapes, double texelsPerUnit, int gutter) {
    const int smallestSide = gutter + 3;
    const int64_t smallestArea = int64_t(smallestSide) * smallestSide * 2;
    const int margin = (gutter + 1) / 2;
    std::vector<std::vector<Pocket>> ofChart(shapes.size());
    parallelFor(shapes.size(), 4, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
            const ChartShape& shape = shapes[c];
            const int width = chartExtent(shape.size[0] * texelsPerUnit, gutter);
            const int height = chartExtent(shape.size[1] * texelsPerUnit, gutter);
            const double empty = double(width) * height - shape.area * texelsPerUnit * texelsPerUnit;
            if (std::min(width, height) < smallestSide + 2 || empty < 2.0 * double(smallestArea)) continue;
            Bitmap bitmap(width, height);
            for (uint32_t f : faces.of(uint32_t(c))) {
                std::array<Point, 3> p;
                for (uint32_t k = 0; k < 3; ++k)
                    p[k] = shape.project(mesh.corner(3 * f + k)) * texelsPerUnit + Point(margin, margin);
                markTriangle(bitmap, p, margin);
            }
            for (int i = 0; i < kMostPerChart; ++i) {
                Pocket pocket = largestEmpty(bitmap);
                if (pocket.area() < smallestArea) break;
                for (int y = pocket.y; y < pocket.y + pocket.height; ++y)
                    std::fill_n(&bitmap.at(pocket.x, y), pocket.width, uint8_t(1));
                if (std::min(pocket.width, pocket.height) < smallestSide) continue;
                pocket.chart = uint32_t(c);
                ofChart[c].push_back(pocket);
            }
        }
    });
    std::vector<Pocket> pockets;
    for (const auto& list : ofChart) pockets.insert(pockets.end(), list.begin(), list.end());
    return pockets;
}

}  // namespace prt
