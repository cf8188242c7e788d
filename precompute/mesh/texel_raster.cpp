// Conservative rasterisation of the atlas with a nearest point per texel. The overlap test of a triangle and
// a square is the separating axis test of T. Akenine-Möller and T. Aila, "Conservative and Tiled
// Rasterization Using a Modified Triangle Set-Up", JGT 10(3), 2005; the nearest point follows C. Ericson,
// "Real-Time Collision Detection", 2005, 5.1.5. Pieces of triangles within a cell: I. Sutherland and G.
// Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974.
#include "precompute/mesh/texel_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/mesh/index_table.h"
#include "precompute/mesh/interrupt.h"
#include "precompute/mesh/topology.h"

namespace prt {
namespace {

using Vec2d = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;

constexpr int kBandRows = 8;
/// A point that was clamped to the border of its triangle moves this far inwards, in texels: rays from it
/// must not start in the plane of a wall that stands on that border.
constexpr double kInsetTexels = 1.0 / 32;

struct UvTriangle {
    std::array<Vec2d, 3> p;  ///< in texels
    std::array<double, 3> barycentric(const Vec2d& at) const;
};

double cross2(const Vec2d& a, const Vec2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Point of segment a–b nearest to q, as the share of b.
double nearestOnSegment(const Vec2d& a, const Vec2d& b, const Vec2d& q) {
    const Vec2d d = b - a;
    const double length2 = d.squaredNorm();
    return length2 > 0 ? std::clamp((q - a).dot(d) / length2, 0.0, 1.0) : 0.0;
}

/// Barycentric coordinates of the point of the triangle nearest to `at`.
std::array<double, 3> UvTriangle::barycentric(const Vec2d& at) const {
    const double area = cross2(p[1] - p[0], p[2] - p[0]);
    const double w0 = cross2(p[2] - p[1], at - p[1]), w1 = cross2(p[0] - p[2], at - p[2]),
                 w2 = cross2(p[1] - p[0], at - p[0]);
    const bool inside = area > 0 ? (w0 >= 0 && w1 >= 0 && w2 >= 0) : (w0 <= 0 && w1 <= 0 && w2 <= 0);
    if (inside && area != 0) {
        const double sum = w0 + w1 + w2;
        return {w0 / sum, w1 / sum, w2 / sum};
    }
    double bestDistance = std::numeric_limits<double>::max();
    std::array<double, 3> best{1, 0, 0};
    for (size_t k = 0; k < 3; ++k) {
        const size_t l = (k + 1) % 3;
        const double t = nearestOnSegment(p[k], p[l], at);
        const double distance = (p[k] + t * (p[l] - p[k]) - at).squaredNorm();
        if (distance >= bestDistance) continue;
        bestDistance = distance;
        best = {0, 0, 0};
        best[k] = 1 - t;
        best[l] = t;
    }
    return best;
}

/// Whether the open square of half-size 1 around a texel centre meets the triangle: the centres that bilinear
/// filtering fetches with a weight above zero.
bool footprintTouches(const UvTriangle& t, const Vec2d& centre) {
    for (int axis = 0; axis < 2; ++axis) {
        const double low = std::min({t.p[0][axis], t.p[1][axis], t.p[2][axis]});
        const double high = std::max({t.p[0][axis], t.p[1][axis], t.p[2][axis]});
        if (low >= centre[axis] + 1 || high <= centre[axis] - 1) return false;
    }
    for (size_t k = 0; k < 3; ++k) {
        const Vec2d &a = t.p[k], &b = t.p[(k + 1) % 3], &c = t.p[(k + 2) % 3];
        const Vec2d normal(a.y() - b.y(), b.x() - a.x());
        const double reach = std::abs(normal.x()) + std::abs(normal.y());
        const double side = normal.dot(c - a), at = normal.dot(centre - a);
        if (at - reach >= std::max(side, 0.0) || at + reach <= std::min(side, 0.0)) {
            if (reach > 0) return false;
        }
    }
    return true;
}

enum class Overlap { None, Some, Full };

/// How a square of half-size `half` lies to a triangle, by the triangle's edges alone: Some may be none.
Overlap overlapOf(const UvTriangle& t, const Vec2d& middle, double half) {
    const double area = cross2(t.p[1] - t.p[0], t.p[2] - t.p[0]);
    bool full = true;
    for (size_t k = 0; k < 3; ++k) {
        const Vec2d edge = t.p[(k + 1) % 3] - t.p[k];
        const double at = cross2(edge, middle - t.p[k]) * (area < 0 ? -1 : 1);
        const double reach = half * (std::abs(edge.x()) + std::abs(edge.y()));
        if (at <= -reach) return Overlap::None;
        full = full && at >= reach;
    }
    return full && area != 0 ? Overlap::Full : Overlap::Some;
}

/// What lies in a square of the texture.
struct Piece {
    double area = 0;
    Vec2d centroid{0, 0};
};

/// Piece of a triangle within [low, low + size]².
Piece pieceWithin(const UvTriangle& t, const Vec2d& low, double size) {
    std::array<Vec2d, 8> polygon, clipped;
    size_t count = 3;
    for (size_t k = 0; k < 3; ++k) polygon[k] = t.p[k] - low;
    for (int side = 0; side < 4; ++side) {
        const int axis = side / 2;
        const auto within = [&](const Vec2d& q) { return side % 2 ? size - q[axis] : q[axis]; };
        size_t kept = 0;
        for (size_t k = 0; k < count; ++k) {
            const Vec2d &a = polygon[k], &b = polygon[(k + 1) % count];
            const double da = within(a), db = within(b);
            if (da >= 0) clipped[kept++] = a;
            if ((da > 0 && db < 0) || (da < 0 && db > 0)) clipped[kept++] = a + da / (da - db) * (b - a);
        }
        if (kept < 3) return {};
        count = kept;
        polygon = clipped;
    }
    double twice = 0;
    Vec2d moment(0, 0);
    for (size_t k = 1; k + 1 < count; ++k) {
        const double part = cross2(polygon[k] - polygon[0], polygon[k + 1] - polygon[0]);
        twice += part;
        moment += part / 3 * (polygon[0] + polygon[k] + polygon[k + 1]);
    }
    if (!(std::abs(twice) > 1e-12)) return {};
    return {std::abs(twice) / 2, low + moment / twice};
}

/// A quarter of a texel: how much of it charts cover, and the largest piece.
struct Cell {
    double area = 0, largest = 0;
    Vec2d moment{0, 0}, centroid{0, 0};
    uint32_t triangle = kNone;
    void add(uint32_t index, const Piece& piece) {
        area += piece.area;
        moment += piece.area * piece.centroid;
        if (!(piece.area > largest)) return;
        largest = piece.area;
        centroid = piece.centroid;
        triangle = index;
    }
    /// The centroid of all pieces where it lies on the triangle of the largest, as in a cell that an edge
    /// cuts.
    void centre(const UvTriangle& t) {
        const Vec2d all = moment / area;
        const auto b = t.barycentric(all);
        if ((b[0] * t.p[0] + b[1] * t.p[1] + b[2] * t.p[2] - all).squaredNorm() < 1e-18) centroid = all;
    }
};
constexpr double kCellEdge = 0.5;
/// Parts of less of a texel are left out: few directions would fall to them.
constexpr double kSmallestShare = 1.0 / 128;

/// The cells that the texels of one band see.
struct BandCells {
    int columns = 0, rowBegin = 0, rowEnd = 0;
    std::vector<Cell> cells;
    Cell* row(int y) { return &cells[size_t(y - rowBegin) * size_t(columns)]; }
    /// Null off the atlas.
    const Cell* find(int x, int y) const {
        if (x < 0 || x >= columns || y < rowBegin || y >= rowEnd) return nullptr;
        return &cells[size_t(y - rowBegin) * size_t(columns) + size_t(x)];
    }
};

/// Parts of the texels of one band.
struct BandParts {
    BandCells grid;                        ///< while the band is worked on
    std::vector<uint32_t> subPointOfCell;  ///< too
    std::vector<SurfacePoint> subPoints;
    std::vector<TexelPart> parts;
    std::vector<uint32_t> counts;  ///< parts of each point
    std::vector<uint8_t> whole;    ///< [points]
};

struct Rasterizer {
    const Scene& scene;
    int width, height;
    std::vector<uint32_t> bestTriangle;  ///< [texels]
    std::vector<uint32_t> bandFirst, bandTriangles;
    std::vector<uint32_t> chartOfTriangle;

    UvTriangle uvTriangle(size_t triangle) const {
        UvTriangle t;
        for (size_t k = 0; k < 3; ++k) {
            const Vec2f& uv = scene.uv1[scene.indices[3 * triangle + k]];
            t.p[k] = Vec2d(double(uv.x()) * width, double(uv.y()) * height);
        }
        return t;
    }

    static int firstTexel(double low) { return int(std::floor(low - 1.5)) + 1; }
    static int lastTexel(double high) { return int(std::ceil(high + 0.5)) - 1; }

    void binTriangles();
    void rasterizeBand(int band);
    SurfacePoint surfacePoint(uint32_t triangle, const Vec2d& centre) const;
    BandCells cellsOfBand(int band) const;
    void splitTexel(int x, int y, uint32_t chartId, const SurfacePoint& own, BandParts& out) const;
    BandParts splitBand(int band, const TexelSurface& surface) const;
};

/// Sorts triangles into bands of rows by their bounds, in index order within each.
void Rasterizer::binTriangles() {
    const size_t triangles = scene.triangleCount();
    const int bands = (height + kBandRows - 1) / kBandRows;
    std::vector<std::array<int, 2>> range(triangles);
    parallelFor(triangles, 1 << 15, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const UvTriangle t = uvTriangle(i);
            const double low = std::min({t.p[0].y(), t.p[1].y(), t.p[2].y()});
            const double high = std::max({t.p[0].y(), t.p[1].y(), t.p[2].y()});
            range[i] = {std::clamp(firstTexel(low), 0, height - 1) / kBandRows,
                        std::clamp(lastTexel(high), 0, height - 1) / kBandRows};
        }
    });
    bandFirst.assign(size_t(bands) + 1, 0);
    for (const auto& r : range)
        for (int b = r[0]; b <= r[1]; ++b) ++bandFirst[size_t(b) + 1];
    std::partial_sum(bandFirst.begin(), bandFirst.end(), bandFirst.begin());
    bandTriangles.resize(bandFirst.back());
    std::vector<uint32_t> cursor(bandFirst.begin(), bandFirst.end() - 1);
    for (size_t i = 0; i < triangles; ++i) {
        throwIfInterruptedAt(i);
        for (int b = range[i][0]; b <= range[i][1]; ++b) bandTriangles[cursor[size_t(b)]++] = uint32_t(i);
    }
}

void Rasterizer::rasterizeBand(int band) {
    const int rowBegin = band * kBandRows, rowEnd = std::min(height, rowBegin + kBandRows);
    std::vector<double> distance(size_t(width) * size_t(rowEnd - rowBegin),
                                 std::numeric_limits<double>::max());
    for (uint32_t i = bandFirst[size_t(band)]; i < bandFirst[size_t(band) + 1]; ++i) {
        const uint32_t triangle = bandTriangles[i];
        const UvTriangle t = uvTriangle(triangle);
        const int x0 = std::max(0, firstTexel(std::min({t.p[0].x(), t.p[1].x(), t.p[2].x()})));
        const int x1 = std::min(width - 1, lastTexel(std::max({t.p[0].x(), t.p[1].x(), t.p[2].x()})));
        const int y0 = std::max(rowBegin, firstTexel(std::min({t.p[0].y(), t.p[1].y(), t.p[2].y()})));
        const int y1 = std::min(rowEnd - 1, lastTexel(std::max({t.p[0].y(), t.p[1].y(), t.p[2].y()})));
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x) {
                const Vec2d centre(x + 0.5, y + 0.5);
                if (!footprintTouches(t, centre)) continue;
                const auto b = t.barycentric(centre);
                const double d = (b[0] * t.p[0] + b[1] * t.p[1] + b[2] * t.p[2] - centre).squaredNorm();
                double& best = distance[size_t(y - rowBegin) * size_t(width) + size_t(x)];
                // Triangles come in index order: at a tie within rounding the lowest stays.
                if (d < best - 1e-12) {
                    best = d;
                    bestTriangle[size_t(y) * size_t(width) + size_t(x)] = triangle;
                }
            }
    }
}

SurfacePoint Rasterizer::surfacePoint(uint32_t triangle, const Vec2d& centre) const {
    const UvTriangle t = uvTriangle(triangle);
    auto b = t.barycentric(centre);
    const Vec2d nearest = b[0] * t.p[0] + b[1] * t.p[1] + b[2] * t.p[2];
    if ((nearest - centre).squaredNorm() > 1e-18) {
        const Vec2d middle = (t.p[0] + t.p[1] + t.p[2]) / 3;
        const double toMiddle = (middle - nearest).norm();
        const double share = toMiddle > 2 * kInsetTexels ? kInsetTexels / toMiddle : 0.5;
        for (double& weight : b) weight += share * (1.0 / 3 - weight);
    }
    const auto corner = [&](size_t k) -> const Vec3f& {
        return scene.positions[scene.indices[3 * triangle + k]];
    };
    const Vec3d position =
        b[0] * corner(0).cast<double>() + b[1] * corner(1).cast<double>() + b[2] * corner(2).cast<double>();
    const Vec3d cross = triangleCross(corner(0), corner(1), corner(2));
    const double length = cross.norm();
    return {position.cast<float>(), length > 0 ? Vec3f((cross / length).cast<float>()) : Vec3f(0, 0, 0),
            triangle};
}

BandCells Rasterizer::cellsOfBand(int band) const {
    const int texelEnd = std::min(height, (band + 1) * kBandRows);
    BandCells grid{
        2 * width, std::max(0, 2 * band * kBandRows - 1), std::min(2 * height, 2 * texelEnd + 1), {}};
    grid.cells.resize(size_t(grid.columns) * size_t(grid.rowEnd - grid.rowBegin));
    const double full = kCellEdge * kCellEdge;
    for (uint32_t i = bandFirst[size_t(band)]; i < bandFirst[size_t(band) + 1]; ++i) {
        const UvTriangle t = uvTriangle(bandTriangles[i]);
        const auto cellRange = [&](int axis, int begin, int end) {
            const auto [low, high] = std::minmax({t.p[0][axis], t.p[1][axis], t.p[2][axis]});
            return std::array{std::max(begin, int(std::floor(low / kCellEdge))),
                              std::min(end, int(std::floor(high / kCellEdge)) + 1)};
        };
        const auto columns = cellRange(0, 0, grid.columns), rows = cellRange(1, grid.rowBegin, grid.rowEnd);
        for (int y = rows[0]; y < rows[1]; ++y)
            for (int x = columns[0]; x < columns[1]; ++x) {
                const Vec2d middle((x + 0.5) * kCellEdge, (y + 0.5) * kCellEdge);
                const Overlap overlap = overlapOf(t, middle, kCellEdge / 2);
                if (overlap == Overlap::None) continue;
                grid.row(y)[x].add(bandTriangles[i],
                                   overlap == Overlap::Full
                                       ? Piece{full, middle}
                                       : pieceWithin(t, Vec2d(x * kCellEdge, y * kCellEdge), kCellEdge));
            }
    }
    for (Cell& cell : grid.cells)
        if (cell.area > cell.largest) cell.centre(uvTriangle(cell.triangle));
    return grid;
}

void Rasterizer::splitTexel(int x, int y, uint32_t chartId, const SurfacePoint& own, BandParts& out) const {
    const Vec2d centre(x + 0.5, y + 0.5);
    std::array<std::pair<size_t, double>, kMaxTexelParts> seen;
    size_t count = 0;
    double sum = 0, covered = 0;
    for (int cy = 2 * y - 1; cy <= 2 * y + 2; ++cy)
        for (int cx = 2 * x - 1; cx <= 2 * x + 2; ++cx) {
            const Cell* cell = out.grid.find(cx, cy);
            if (!cell || cell->triangle == kNone || chartOfTriangle[cell->triangle] != chartId) continue;
            covered += std::min(cell->area, kCellEdge * kCellEdge);
            const Vec2d off = (cell->centroid - centre).cwiseAbs();
            const double filter = (1 - off.x()) * (1 - off.y());
            seen[count++] = {size_t(cell - out.grid.cells.data()), cell->area * filter * filter};
            sum += seen[count - 1].second;
        }
    out.whole.push_back(covered >= 4 - 1e-6);
    const size_t before = out.parts.size();
    double kept = 0;
    for (size_t k = 0; k < count; ++k)
        if (seen[k].second >= kSmallestShare * sum) kept += seen[k].second;
    for (size_t k = 0; kept > 0 && k < count; ++k) {
        if (!(seen[k].second >= kSmallestShare * sum)) continue;
        const Cell& cell = out.grid.cells[seen[k].first];
        uint32_t& id = out.subPointOfCell[seen[k].first];
        if (id == kNone) {
            id = uint32_t(out.subPoints.size());
            out.subPoints.push_back(surfacePoint(cell.triangle, cell.centroid));
        }
        out.parts.push_back({id, float(seen[k].second / kept)});
    }
    if (out.parts.size() == before) {
        out.parts.push_back({uint32_t(out.subPoints.size()), 1.0f});
        out.subPoints.push_back(own);
    }
    out.counts.push_back(uint32_t(out.parts.size() - before));
}

BandParts Rasterizer::splitBand(int band, const TexelSurface& surface) const {
    BandParts out;
    out.grid = cellsOfBand(band);
    out.subPointOfCell.assign(out.grid.cells.size(), kNone);
    const int rowBegin = band * kBandRows, rowEnd = std::min(height, rowBegin + kBandRows);
    for (int y = rowBegin; y < rowEnd; ++y)
        for (int x = 0; x < width; ++x) {
            const size_t texel = size_t(y) * size_t(width) + size_t(x);
            const uint32_t point = surface.pointOfTexel[texel];
            if (point != kNoPoint) splitTexel(x, y, surface.chartOfTexel[texel], surface.points[point], out);
        }
    out.grid = {};
    out.subPointOfCell = {};
    return out;
}

/// Ids of the pieces of triangles that are connected in uv1, numbered by their lowest triangle.
std::vector<uint32_t> findCharts(const Scene& scene) {
    const auto& uv = scene.uv1;
    std::vector<uint32_t> same(uv.size());
    IndexTable table(uv.size());
    for (uint32_t v = 0; v < uv.size(); ++v) {
        throwIfInterruptedAt(v);
        same[v] = table.findOrInsert(mixHash(floatKey(uv[v].x()), floatKey(uv[v].y())), v,
                                     [&](uint32_t other) { return uv[other] == uv[v]; });
    }
    DisjointSets sets(uv.size());
    for (size_t i = 0; i < scene.indices.size(); i += 3) {
        throwIfInterruptedAt(i / 3);
        sets.unite(same[scene.indices[i]], same[scene.indices[i + 1]]);
        sets.unite(same[scene.indices[i]], same[scene.indices[i + 2]]);
    }
    std::vector<uint32_t> idOfSet(uv.size(), kNone), chart(scene.triangleCount());
    uint32_t count = 0;
    for (size_t t = 0; t < chart.size(); ++t) {
        uint32_t& id = idOfSet[sets.find(same[scene.indices[3 * t]])];
        if (id == kNone) id = count++;
        chart[t] = id;
    }
    return chart;
}

void joinParts(std::vector<BandParts>& bands, TexelSurface& surface) {
    size_t subPoints = 0, parts = 0;
    for (const BandParts& band : bands) {
        subPoints += band.subPoints.size();
        parts += band.parts.size();
    }
    surface.subPoints.reserve(subPoints);
    surface.parts.reserve(parts);
    surface.firstPart.reserve(surface.points.size() + 1);
    surface.whole.reserve(surface.points.size());
    uint32_t first = 0;
    for (BandParts& band : bands) {
        throwIfInterrupted();
        for (const uint32_t count : band.counts) {
            surface.firstPart.push_back(first);
            first += count;
        }
        const uint32_t base = uint32_t(surface.subPoints.size());
        for (const TexelPart& part : band.parts) surface.parts.push_back({base + part.subPoint, part.share});
        surface.subPoints.insert(surface.subPoints.end(), band.subPoints.begin(), band.subPoints.end());
        surface.whole.insert(surface.whole.end(), band.whole.begin(), band.whole.end());
        band = {};
    }
    surface.firstPart.push_back(first);
}

}  // namespace

TexelSurface rasterizeTexels(const Scene& scene, int width, int height) {
    PRT_CHECK_LT(0, width);
    PRT_CHECK_LT(0, height);
    PRT_CHECK_EQ(scene.uv1.size(), scene.positions.size());
    const size_t texels = size_t(width) * size_t(height);
    Rasterizer raster{scene, width, height, std::vector<uint32_t>(texels, kNone), {}, {}, findCharts(scene)};
    raster.binTriangles();
    const size_t bands = raster.bandFirst.size() - 1;
    parallelFor(bands, 1, [&](size_t begin, size_t end) {
        for (size_t band = begin; band < end; ++band) raster.rasterizeBand(int(band));
    });

    TexelSurface surface;
    surface.width = width;
    surface.height = height;
    surface.pointOfTexel.assign(texels, kNoPoint);
    surface.chartOfTexel.assign(texels, kNoPoint);
    uint32_t count = 0;
    for (size_t i = 0; i < texels; ++i) {
        throwIfInterruptedAt(i);
        if (raster.bestTriangle[i] == kNone) continue;
        surface.pointOfTexel[i] = count++;
        surface.chartOfTexel[i] = raster.chartOfTriangle[raster.bestTriangle[i]];
    }
    surface.points.resize(count);
    parallelFor(size_t(height), kBandRows, [&](size_t begin, size_t end) {
        for (size_t i = begin * size_t(width); i < end * size_t(width); ++i) {
            if (surface.pointOfTexel[i] == kNoPoint) continue;
            const Vec2d centre(double(i % size_t(width)) + 0.5, double(i / size_t(width)) + 0.5);
            surface.points[surface.pointOfTexel[i]] = raster.surfacePoint(raster.bestTriangle[i], centre);
        }
    });
    std::vector<BandParts> bandParts(bands);
    parallelFor(bands, 1, [&](size_t begin, size_t end) {
        for (size_t band = begin; band < end; ++band) bandParts[band] = raster.splitBand(int(band), surface);
    });
    joinParts(bandParts, surface);
    return surface;
}

}  // namespace prt
