// Directions of the reference. Cells of equal area in rings, as in the equal-area partitions of
// [Leopardi2006] (without his polar caps), halved in height and longitude where the light is; sums over boxes
// of the environment by an integral table [Crow1984].
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "runtime/reference/reference.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

// A box in longitude (rad, low ≤ high, may pass π) and height y = sin(latitude).
struct Cell {
    double longitudeLow, longitudeHigh, yLow, yHigh;
    double solidAngle() const { return (longitudeHigh - longitudeLow) * (yHigh - yLow); }
};

// ∫∫ L over boxes in longitude and height, exact for radiance that is constant over texels.
class BoxIntegral {
  public:
    BoxIntegral(const FloatImage& image, double rotationRad)
        : width_(image.width), height_(image.height), rotationRad_(rotationRad) {
        PRT_CHECK_EQ(image.channels, 3);
        table_.assign(size_t(width_ + 1) * size_t(height_ + 1) * 3, 0.0);
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x)
                for (int c = 0; c < 3; ++c)
                    entry(x + 1, y + 1)[c] = entry(x, y + 1)[c] + entry(x + 1, y)[c] - entry(x, y)[c] +
                                             double(image.at(x, y)[c]) * columnWidth() * rowHeight(y);
    }

    Vec3d over(const Cell& cell) const {
        // Columns run from longitude π downwards; the light of longitude λ comes from λ − rotation.
        const double left = column(cell.longitudeHigh),
                     right = left + (cell.longitudeHigh - cell.longitudeLow) / columnWidth();
        const double top = row(cell.yHigh), bottom = row(cell.yLow);
        const Vec3d sum = upTo(right, bottom) - upTo(left, bottom) - upTo(right, top) + upTo(left, top);
        return sum.cwiseMax(0.0);
    }
    Vec3d total() const { return Vec3d(entry(width_, height_)); }

    // Whether a cell is at most half a texel in both directions.
    bool fine(const Cell& cell) const {
        const int y = std::clamp(int(row((cell.yLow + cell.yHigh) / 2)), 0, height_ - 1);
        return cell.longitudeHigh - cell.longitudeLow <= columnWidth() / 2 &&
               cell.yHigh - cell.yLow <= rowHeight(y) / 2;
    }

  private:
    double* entry(int x, int y) { return &table_[(size_t(y) * size_t(width_ + 1) + size_t(x)) * 3]; }
    const double* entry(int x, int y) const {
        return &table_[(size_t(y) * size_t(width_ + 1) + size_t(x)) * 3];
    }
    double columnWidth() const { return 2 * kPi / width_; }
    double rowHeight(int y) const { return std::cos(kPi * y / height_) - std::cos(kPi * (y + 1) / height_); }

    // Left coordinate of a longitude, brought into [0, width).
    double column(double longitude) const {
        const double turns = (kPi - (longitude - rotationRad_)) / (2 * kPi);
        return std::min((turns - std::floor(turns)) * width_, double(width_));
    }
    // Row coordinate whose fractional part is linear in y within a row.
    double row(double y) const {
        const double clamped = std::clamp(y, -1.0, 1.0);
        const int r = std::clamp(int(std::acos(clamped) / kPi * height_), 0, height_ - 1);
        return r + std::clamp((std::cos(kPi * r / height_) - clamped) / rowHeight(r), 0.0, 1.0);
    }
    // Integral of columns 0..x (x may be in [0, 2·width]) and rows 0..y.
    Vec3d upTo(double x, double y) const {
        if (x > width_) return upTo(double(width_), y) + upTo(x - width_, y);
        const int column = std::min(int(x), width_ - 1), line = std::min(int(y), height_ - 1);
        const double fx = x - column, fy = y - line;
        Vec3d sum;
        for (int c = 0; c < 3; ++c)
            sum[c] = (1 - fy) * ((1 - fx) * entry(column, line)[c] + fx * entry(column + 1, line)[c]) +
                     fy * ((1 - fx) * entry(column, line + 1)[c] + fx * entry(column + 1, line + 1)[c]);
        return sum;
    }

    int width_, height_;
    double rotationRad_;
    std::vector<double> table_;  // [height+1][width+1][3], ∫ over rows above and columns to the left
};

// Rings of nearly square cells, all of the same area; each ring starts at another longitude, so that cell
// edges do not line up along planes of symmetry of the scene.
std::vector<Cell> baseCells(int baseCount) {
    // An even number: the horizon of level ground lies between two rings, not through the centres of one.
    const int rings = 2 * std::max(1, int(std::lround(std::sqrt(kPi * baseCount / 4) / 2)));
    std::vector<int> cellsOfRing(static_cast<size_t>(rings));
    int total = 0;
    for (int r = 0; r < rings; ++r) {
        const double ideal = 2.0 * rings * std::sin(kPi * (r + 0.5) / rings);
        cellsOfRing[size_t(r)] = std::max(3, int(std::lround(ideal)));
        total += cellsOfRing[size_t(r)];
    }
    std::vector<Cell> cells;
    int passed = 0;
    for (int r = 0; r < rings; ++r) {
        const int count = cellsOfRing[size_t(r)];
        const double yHigh = 1 - 2.0 * passed / total, yLow = 1 - 2.0 * (passed + count) / total;
        passed += count;
        const double start = 2 * kPi * std::fmod(r * 0.754877666246693, 1.0) / count - kPi;  // plastic number
        for (int i = 0; i < count; ++i)
            cells.push_back({start + 2 * kPi * i / count, start + 2 * kPi * (i + 1) / count, yLow, yHigh});
    }
    return cells;
}

bool needsSplit(const Cell& cell, const std::vector<BoxIntegral>& light, double largestShare) {
    for (const BoxIntegral& integral : light) {
        const double total = integral.total().sum();
        if (total > 0 && integral.over(cell).sum() > largestShare * total && !integral.fine(cell))
            return true;
    }
    return false;
}

void splitInto(const Cell& cell, const std::vector<BoxIntegral>& light, double largestShare,
               std::vector<Cell>& out) {
    if (!needsSplit(cell, light, largestShare)) {
        out.push_back(cell);
        return;
    }
    const double longitude = (cell.longitudeLow + cell.longitudeHigh) / 2, y = (cell.yLow + cell.yHigh) / 2;
    splitInto({cell.longitudeLow, longitude, y, cell.yHigh}, light, largestShare, out);
    splitInto({longitude, cell.longitudeHigh, y, cell.yHigh}, light, largestShare, out);
    splitInto({cell.longitudeLow, longitude, cell.yLow, y}, light, largestShare, out);
    splitInto({longitude, cell.longitudeHigh, cell.yLow, y}, light, largestShare, out);
}

}  // namespace

ReferenceDirections makeReferenceDirections(std::span<const Environment> environments,
                                            std::span<const double> rotationsRad, int baseCount) {
    PRT_CHECK_EQ(environments.size(), rotationsRad.size());
    if (baseCount < 16 || baseCount > 1048576)
        throw UsageError("reference directions", fmt::format("{} is out of range", baseCount),
                         "choose 16 to 1048576");
    std::vector<BoxIntegral> light;
    for (size_t e = 0; e < environments.size(); ++e)
        light.emplace_back(environments[e].image, rotationsRad[e]);

    std::vector<Cell> cells;
    for (const Cell& cell : baseCells(baseCount)) splitInto(cell, light, 4.0 / baseCount, cells);

    ReferenceDirections result;
    result.radiance.resize(environments.size());
    for (const Cell& cell : cells) {
        const double y = (cell.yLow + cell.yHigh) / 2,
                     longitude = (cell.longitudeLow + cell.longitudeHigh) / 2;
        const double radius = std::sqrt(std::max(0.0, 1 - y * y));
        result.direction.push_back(
            Vec3d(radius * std::sin(longitude), y, radius * std::cos(longitude)).cast<float>());
        result.solidAngleSr.push_back(float(cell.solidAngle()));
        for (size_t e = 0; e < light.size(); ++e) {
            const Vec3d mean = light[e].over(cell) / cell.solidAngle();
            for (int c = 0; c < 3; ++c) result.radiance[e].push_back(float(mean[c]));
        }
    }
    return result;
}

}  // namespace prt
