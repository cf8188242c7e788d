// Packing of chart rectangles with stb_rect_pack (skyline), at the highest density that fits; small charts
// first go into the holes and corners of large ones. Skyline heuristics: J. Jylänki, "A Thousand Ways to Pack
// the Bin", 2010. Rows: E. Coffman, M. Garey, D. Johnson, R. Tarjan, "Performance Bounds for Level-Oriented
// Two-Dimensional Packing Algorithms", SIAM Journal on Computing 9(4), 1980.
#include <stb_rect_pack.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "precompute/base/error.h"
#include "precompute/mesh/atlas_parts.h"
#include "precompute/mesh/atlas_pockets.h"

namespace prt {
namespace {

/// Beyond this many charts one arrangement is tried, not four.
constexpr size_t kManyCharts = 4000;
/// Beyond this many rectangles go into rows: a skyline takes hours for a million, for 2 % more of the atlas.
constexpr size_t kShelvedCharts = 20'000;
constexpr double kPrecision = 1.002;  ///< ratio of densities at which the search stops
constexpr double kPocketPrecision = 1.01;
constexpr double kMostPocketGain = 1.3;  ///< in density, hoped for from pockets

class Packer {
  public:
    Packer(const AtlasMesh& mesh, const ChartFaces& faces, const std::vector<ChartShape>& shapes, int texels,
           int gutter)
        : mesh_(mesh),
          faces_(faces),
          texels_(texels),
          // With an odd gutter a strip at the far borders keeps the larger half there.
          room_(texels - gutter % 2),
          gutter_(gutter),
          shapes_{shapes, {}},
          rects_(shapes.size()),
          nodes_(size_t(texels)) {
        for (const ChartShape& shape : shapes) shapes_[1].push_back(turned(shape));
    }

    bool fits(double density, bool upright, int heuristic) {
        if (!setRects(density, upright)) return false;
        parent_.assign(rects_.size(), kNone);
        return packIntoAtlas(heuristic);
    }

    bool fitsWithPockets(double density, bool upright, int heuristic) {
        if (!setRects(density, upright)) return false;
        parent_.assign(rects_.size(), kNone);
        fillPockets(density, upright);
        return packIntoAtlas(heuristic);
    }

    void store(double density, bool upright, Packing& packing) const {
        packing.texelsPerUnit = density;
        packing.upright = upright;
        packing.x.resize(rects_.size());
        packing.y.resize(rects_.size());
        for (size_t c = 0; c < rects_.size(); ++c) {
            packing.x[c] = rects_[c].x + (gutter_ + 1) / 2;
            packing.y[c] = rects_[c].y + (gutter_ + 1) / 2;
            for (uint32_t host = parent_[c]; host != kNone; host = parent_[host]) {
                packing.x[c] += rects_[host].x;
                packing.y[c] += rects_[host].y;
            }
        }
    }

  private:
    static int64_t areaOf(const stbrp_rect& r) { return int64_t(r.w) * r.h; }
    bool setRects(double density, bool upright);
    void fillPockets(double density, bool upright);
    void fillPocket(const Pocket& pocket, const std::vector<uint32_t>& order, size_t firstRank);
    bool packIntoAtlas(int heuristic);
    bool packIntoRows(std::vector<stbrp_rect>& rects) const;

    const AtlasMesh& mesh_;
    const ChartFaces& faces_;
    const int texels_, room_, gutter_;
    std::array<std::vector<ChartShape>, 2> shapes_;  ///< wide, upright
    std::vector<stbrp_rect> rects_;                  ///< [charts] position within the parent's, or the atlas
    std::vector<uint32_t> parent_;                   ///< [charts] chart in whose pocket it lies, or kNone
    std::vector<stbrp_node> nodes_;
};

bool Packer::setRects(double density, bool upright) {
    for (size_t c = 0; c < rects_.size(); ++c) {
        const ChartShape& shape = shapes_[upright][c];
        if (!(std::max(shape.size[0], shape.size[1]) * density < texels_)) return false;
        rects_[c] = {int(c),
                     chartExtent(shape.size[0] * density, gutter_),
                     chartExtent(shape.size[1] * density, gutter_),
                     0,
                     0,
                     0};
        if (rects_[c].w > room_ || rects_[c].h > room_) return false;
    }
    return true;
}

bool Packer::packIntoAtlas(int heuristic) {
    std::vector<stbrp_rect> free;
    int64_t total = 0;
    for (const stbrp_rect& r : rects_) {
        if (parent_[size_t(r.id)] != kNone) continue;
        free.push_back(r);
        total += areaOf(r);
    }
    if (total > int64_t(room_) * room_) return false;
    if (free.size() > kShelvedCharts) {
        if (!packIntoRows(free)) return false;
    } else {
        stbrp_context context;
        stbrp_init_target(&context, room_, room_, nodes_.data(), int(nodes_.size()));
        stbrp_setup_heuristic(&context, heuristic);
        if (stbrp_pack_rects(&context, free.data(), int(free.size())) == 0) return false;
    }
    for (const stbrp_rect& r : free) rects_[size_t(r.id)] = r;
    return true;
}

/// Next-fit decreasing height: from left to right in rows as high as their first, highest rectangle.
bool Packer::packIntoRows(std::vector<stbrp_rect>& rects) const {
    std::stable_sort(rects.begin(), rects.end(),
                     [](const stbrp_rect& a, const stbrp_rect& b) { return a.h > b.h; });
    int x = 0, y = 0, rowHeight = rects.front().h;
    for (stbrp_rect& r : rects) {
        if (x + r.w > room_) {
            x = 0;
            y += rowHeight;
            rowHeight = r.h;
        }
        if (y + r.h > room_) return false;
        r.x = x;
        r.y = y;
        x += r.w;
    }
    return true;
}

/// Charts go into pockets of larger ones only, so that nothing lies in itself.
void Packer::fillPockets(double density, bool upright) {
    std::vector<Pocket> pockets = findPockets(mesh_, faces_, shapes_[upright], density, gutter_);
    std::stable_sort(pockets.begin(), pockets.end(),
                     [](const Pocket& a, const Pocket& b) { return a.area() > b.area(); });
    std::vector<uint32_t> order(rects_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return areaOf(rects_[a]) > areaOf(rects_[b]); });
    std::vector<size_t> rank(order.size());
    for (size_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
    constexpr size_t kMostPockets = 400;
    for (size_t i = 0; i < std::min(pockets.size(), kMostPockets); ++i) {
        throwIfInterrupted();
        fillPocket(pockets[i], order, rank[pockets[i].chart] + 1);
    }
}

void Packer::fillPocket(const Pocket& pocket, const std::vector<uint32_t>& order, size_t firstRank) {
    stbrp_context context;
    std::vector<stbrp_node> nodes(size_t(pocket.width));
    stbrp_init_target(&context, pocket.width, pocket.height, nodes.data(), int(nodes.size()));
    stbrp_setup_heuristic(&context, STBRP_HEURISTIC_Skyline_BF_sortHeight);
    int64_t left = pocket.area();
    std::vector<stbrp_rect> batch;
    const auto place = [&] {
        stbrp_pack_rects(&context, batch.data(), int(batch.size()));
        for (stbrp_rect& r : batch) {
            if (!r.was_packed) continue;
            r.x += pocket.x;
            r.y += pocket.y;
            left -= areaOf(r);
            parent_[size_t(r.id)] = pocket.chart;
            rects_[size_t(r.id)] = r;
        }
        batch.clear();
    };
    // Largest first, in batches that could just fill what is left.
    int64_t batchArea = 0;
    for (size_t i = firstRank; i < order.size(); ++i) {
        const stbrp_rect& r = rects_[order[i]];
        if (parent_[order[i]] != kNone || r.w > pocket.width || r.h > pocket.height || areaOf(r) > left)
            continue;
        batch.push_back(r);
        batchArea += areaOf(r);
        if (batchArea < left) continue;
        place();
        batchArea = 0;
        if (left < int64_t(gutter_ + 1) * (gutter_ + 1)) return;
    }
    place();
}

}  // namespace

Packing packCharts(const AtlasMesh& mesh, const ChartFaces& faces, const std::vector<ChartShape>& shapes,
                   int texels, int gutter) {
    Packing best;
    double area = 0, longest = 0;
    for (const ChartShape& shape : shapes) {
        area += std::max(shape.area, 0.0);
        longest = std::max({longest, shape.size[0], shape.size[1]});
    }
    // No chart may be larger than the atlas, nor all of them together.
    const double limit =
        std::min(double(texels) / longest, double(texels) / std::sqrt(std::max(area, 1e-300)));
    Packer packer(mesh, faces, shapes, texels, gutter);
    struct Arrangement {
        bool upright;
        int heuristic;
    };
    constexpr std::array<Arrangement, 4> kArrangements{{{true, STBRP_HEURISTIC_Skyline_BF_sortHeight},
                                                        {false, STBRP_HEURISTIC_Skyline_BF_sortHeight},
                                                        {true, STBRP_HEURISTIC_Skyline_BL_sortHeight},
                                                        {false, STBRP_HEURISTIC_Skyline_BL_sortHeight}}};
    Arrangement chosen = kArrangements[0];
    const size_t tried = shapes.size() > kManyCharts ? 1 : kArrangements.size();
    for (size_t a = 0; a < tried; ++a) {
        throwIfInterrupted();
        const auto [upright, heuristic] = kArrangements[a];
        // The search starts where the best arrangement so far stands: another one has to beat it.
        double low = best.texelsPerUnit > 0 ? best.texelsPerUnit * kPrecision : limit * 1e-4, high = limit;
        if (!packer.fits(low, upright, heuristic)) continue;
        packer.store(low, upright, best);
        chosen = kArrangements[a];
        while (high > low * kPrecision) {
            throwIfInterrupted();
            const double middle = std::sqrt(low * high);
            if (packer.fits(middle, upright, heuristic)) {
                packer.store(middle, upright, best);
                low = middle;
            } else {
                high = middle;
            }
        }
    }
    double low = best.texelsPerUnit, high = std::min(limit, low * kMostPocketGain);
    while (low > 0 && high > low * kPocketPrecision) {
        throwIfInterrupted();
        const double middle = std::sqrt(low * high);
        if (packer.fitsWithPockets(middle, chosen.upright, chosen.heuristic)) {
            packer.store(middle, chosen.upright, best);
            low = middle;
        } else {
            high = middle;
        }
    }
    return best;
}

}  // namespace prt
