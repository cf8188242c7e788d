// Nearest filled texel by the exact Euclidean distance transform of P. Felzenszwalb and D. Huttenlocher,
// "Distance Transforms of Sampled Functions", Theory of Computing 8, 2012, carrying the source along.
#include <algorithm>
#include <cmath>
#include <map>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/mesh/texel_raster.h"

namespace prt {
namespace {

/// Texels x0..x1, y0..y1 (inclusive) that hold everything of one group.
struct Box {
    int x0, y0, x1, y1;
};

class NearestTexel {
  public:
    NearestTexel(const std::vector<uint8_t>& has, const std::vector<uint32_t>& group, int width,
                 int reachTexels, std::vector<uint32_t>& source)
        : has_(has), group_(group), width_(width), reach_(reachTexels), source_(source) {}

    void run(const Box& box, uint32_t group);

  private:
    bool inGroup(size_t texel, uint32_t group) const { return group_.empty() || group_[texel] == group; }
    size_t texel(int x, int y) const { return size_t(y) * size_t(width_) + size_t(x); }
    void sweepColumns(const Box& box, uint32_t group);
    void fillRow(const Box& box, int y, uint32_t group);

    const std::vector<uint8_t>& has_;
    const std::vector<uint32_t>& group_;
    const int width_, reach_;
    std::vector<uint32_t>& source_;
    std::vector<int> nearestRow_;  ///< [box] row of the nearest source in the same column, or −1
};

void NearestTexel::sweepColumns(const Box& box, uint32_t group) {
    const int columns = box.x1 - box.x0 + 1, rows = box.y1 - box.y0 + 1;
    nearestRow_.assign(size_t(columns) * size_t(rows), -1);
    const auto cell = [&](int x, int y) -> int& {
        return nearestRow_[size_t(y - box.y0) * size_t(columns) + size_t(x - box.x0)];
    };
    for (int y = box.y0; y <= box.y1; ++y)
        for (int x = box.x0; x <= box.x1; ++x) {
            const size_t i = texel(x, y);
            if (has_[i] && inGroup(i, group))
                cell(x, y) = y;
            else if (y > box.y0)
                cell(x, y) = cell(x, y - 1);
        }
    for (int y = box.y1 - 1; y >= box.y0; --y)
        for (int x = box.x0; x <= box.x1; ++x) {
            const int below = cell(x, y + 1);
            if (below >= 0 && (cell(x, y) < 0 || below - y < y - cell(x, y))) cell(x, y) = below;
        }
}

/// Lower envelope of the parabolas (x − column)² + (distance down that column)².
void NearestTexel::fillRow(const Box& box, int y, uint32_t group) {
    const int columns = box.x1 - box.x0 + 1;
    const int* rowOf = nearestRow_.data() + size_t(y - box.y0) * size_t(columns);
    std::vector<int> hull;
    std::vector<double> from;
    const auto value = [&](int column) {
        const double dy = rowOf[column] - y;
        return dy * dy + double(column) * column;
    };
    for (int column = 0; column < columns; ++column) {
        if (rowOf[column] < 0) continue;
        double start = -1e30;
        while (!hull.empty()) {
            start = (value(column) - value(hull.back())) / (2.0 * (column - hull.back()));
            if (start > from.back()) break;
            hull.pop_back();
            from.pop_back();
            start = -1e30;
        }
        hull.push_back(column);
        from.push_back(start);
    }
    if (hull.empty()) return;
    size_t k = 0;
    for (int column = 0; column < columns; ++column) {
        while (k + 1 < hull.size() && from[k + 1] < column) ++k;
        const size_t i = texel(box.x0 + column, y);
        if (has_[i] || !inGroup(i, group)) continue;
        const double dx = hull[k] - column, dy = rowOf[hull[k]] - y;
        if (dx * dx + dy * dy <= double(reach_) * reach_)
            source_[i] = uint32_t(texel(box.x0 + hull[k], rowOf[hull[k]]));
    }
}

void NearestTexel::run(const Box& box, uint32_t group) {
    sweepColumns(box, group);
    for (int y = box.y0; y <= box.y1; ++y) fillRow(box, y, group);
}

}  // namespace

std::vector<uint32_t> nearestFilledTexel(const std::vector<uint8_t>& has, const std::vector<uint32_t>& group,
                                         int width, int height, int reachTexels) {
    const size_t texels = size_t(width) * size_t(height);
    PRT_CHECK_EQ(has.size(), texels);
    if (!group.empty()) PRT_CHECK_EQ(group.size(), texels);
    std::vector<uint32_t> source(texels, kNoPoint);
    for (size_t i = 0; i < texels; ++i)
        if (has[i]) source[i] = uint32_t(i);
    if (group.empty()) {
        NearestTexel(has, group, width, reachTexels, source).run({0, 0, width - 1, height - 1}, 0);
        return source;
    }
    std::map<uint32_t, Box> boxes;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const uint32_t id = group[size_t(y) * size_t(width) + size_t(x)];
            Box& box = boxes.try_emplace(id, Box{x, y, x, y}).first->second;
            box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x), std::max(box.y1, y)};
        }
    // Groups own different texels, so they may be filled at the same time.
    const std::vector<std::pair<uint32_t, Box>> list(boxes.begin(), boxes.end());
    parallelFor(list.size(), 1, [&](size_t begin, size_t end) {
        for (size_t g = begin; g < end; ++g)
            NearestTexel(has, group, width, reachTexels, source).run(list[g].second, list[g].first);
    });
    return source;
}

}  // namespace prt
