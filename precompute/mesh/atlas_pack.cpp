// Packing of chart rectangles with stb_rect_pack (skyline), at the highest density that fits. Skyline
// heuristics: J. Jylänki, "A Thousand Ways to Pack the Bin", 2010.
#include <stb_rect_pack.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "precompute/base/error.h"
#include "precompute/mesh/atlas_parts.h"

namespace prt {
namespace {

/// Beyond this many charts one arrangement is tried, not four.
constexpr size_t kManyCharts = 4000;
constexpr double kPrecision = 1.002;  ///< ratio of densities at which the search stops

class Packer {
  public:
    Packer(const std::vector<ChartShape>& shapes, int texels, int gutter)
        : shapes_(shapes), texels_(texels), gutter_(gutter), rects_(shapes.size()), nodes_(size_t(texels)) {}

    bool fits(double density, bool upright, int heuristic) {
        double total = 0;
        for (size_t c = 0; c < shapes_.size(); ++c) {
            stbrp_rect& r = rects_[c];
            r.id = int(c);
            r.w = extent(shapes_[c].size[upright ? 1 : 0] * density);
            r.h = extent(shapes_[c].size[upright ? 0 : 1] * density);
            r.x = r.y = r.was_packed = 0;
            if (r.w > texels_ || r.h > texels_) return false;
            total += double(r.w) * r.h;
        }
        // With an odd gutter a strip at the far borders keeps the larger half there.
        const int room = texels_ - gutter_ % 2;
        if (total > double(room) * room) return false;
        stbrp_context context;
        stbrp_init_target(&context, room, room, nodes_.data(), int(nodes_.size()));
        stbrp_setup_heuristic(&context, heuristic);
        return stbrp_pack_rects(&context, rects_.data(), int(rects_.size())) != 0;
    }

    void store(double density, bool upright, Packing& packing) const {
        packing.texelsPerUnit = density;
        packing.upright = upright;
        packing.x.resize(rects_.size());
        packing.y.resize(rects_.size());
        for (const stbrp_rect& r : rects_) {
            packing.x[size_t(r.id)] = r.x + (gutter_ + 1) / 2;
            packing.y[size_t(r.id)] = r.y + (gutter_ + 1) / 2;
        }
    }

  private:
    int extent(double texels) const {
        if (!(texels < texels_)) return texels_ + 1;
        return std::max(1, int(std::ceil(texels - 1e-9))) + gutter_;
    }

    const std::vector<ChartShape>& shapes_;
    const int texels_, gutter_;
    std::vector<stbrp_rect> rects_;
    std::vector<stbrp_node> nodes_;
};

}  // namespace

Packing packCharts(const std::vector<ChartShape>& shapes, int texels, int gutter) {
    Packing best;
    double area = 0, longest = 0;
    for (const ChartShape& shape : shapes) {
        area += std::max(shape.area, 0.0);
        longest = std::max({longest, shape.size[0], shape.size[1]});
    }
    // No chart may be larger than the atlas, nor all of them together.
    const double limit =
        std::min(double(texels) / longest, double(texels) / std::sqrt(std::max(area, 1e-300)));
    Packer packer(shapes, texels, gutter);
    const std::array<std::pair<bool, int>, 4> arrangements{{{true, STBRP_HEURISTIC_Skyline_BF_sortHeight},
                                                            {false, STBRP_HEURISTIC_Skyline_BF_sortHeight},
                                                            {true, STBRP_HEURISTIC_Skyline_BL_sortHeight},
                                                            {false, STBRP_HEURISTIC_Skyline_BL_sortHeight}}};
    const size_t tried = shapes.size() > kManyCharts ? 1 : arrangements.size();
    for (size_t a = 0; a < tried; ++a) {
        throwIfInterrupted();
        const auto [upright, heuristic] = arrangements[a];
        // The search starts where the best arrangement so far stands: another one has to beat it.
        double low = best.texelsPerUnit > 0 ? best.texelsPerUnit * kPrecision : limit * 1e-4, high = limit;
        if (!packer.fits(low, upright, heuristic)) continue;
        packer.store(low, upright, best);
        while (high > low * kPrecision) {
            const double middle = std::sqrt(low * high);
            if (packer.fits(middle, upright, heuristic)) {
                packer.store(middle, upright, best);
                low = middle;
            } else {
                high = middle;
            }
        }
    }
    return best;
}

}  // namespace prt
