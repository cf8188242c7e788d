// Charts that overlap themselves once flattened (spiral ramps, say): found on the raster, as in Lévy et al.,
// "Least Squares Conformal Maps", SIGGRAPH 2002, section 3.2, and cut where the second layer begins.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/mesh/atlas_parts.h"
#include "precompute/mesh/interrupt.h"

namespace prt {
namespace {

using Point = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;

/// A texel centre counts as covered when it is so far inside, in texels: neighbours share their edges.
constexpr double kMargin = 1e-3;
/// Two faces in one texel may differ so much in height above the plane, in texels: a slope of 80° across its
/// diagonal makes 8.
constexpr double kMostHeight = 10;

double turn(const Point& a, const Point& b, const Point& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// The texels of one chart while its faces are laid out one by one.
class ChartRaster {
  public:
    ChartRaster(const AtlasMesh& mesh, const ChartShape& shape, double texelsPerUnit)
        : mesh_(mesh),
          shape_(shape),
          scale_(texelsPerUnit),
          normal_(shape.right.cross(shape.up)),
          width_(int(shape.size[0] * scale_) + 1),
          height_(int(shape.size[1] * scale_) + 1) {
        covered_.assign(size_t(width_) * size_t(height_), 0);
        heightAt_.assign(covered_.size(), std::numeric_limits<float>::quiet_NaN());
    }

    /// @return false, and nothing is laid, when the face would lie on another
    bool lay(uint32_t face) {
        std::array<Point, 3> p;
        double low = 1e300, high = -1e300;
        for (uint32_t k = 0; k < 3; ++k) {
            p[k] = shape_.project(mesh_.corner(3 * face + k)) * scale_;
            const double h = normal_.dot(mesh_.corner(3 * face + k).cast<double>()) * scale_;
            low = std::min(low, h);
            high = std::max(high, h);
        }
        const auto height = float((low + high) / 2);
        const size_t middle = texelOf((p[0] + p[1] + p[2]) / 3);
        if (std::abs(heightAt_[middle] - height) > kMostHeight + (high - low)) return false;
        cells_.clear();
        eachCentre(p, [&](size_t cell) { cells_.push_back(cell); });
        for (size_t cell : cells_)
            if (covered_[cell]) return false;
        for (size_t cell : cells_) covered_[cell] = 1;
        touched_.insert(touched_.end(), cells_.begin(), cells_.end());
        if (std::isnan(heightAt_[middle])) {
            heightAt_[middle] = height;
            touched_.push_back(middle);
        }
        return true;
    }

    void clear() {
        for (size_t cell : touched_) {
            covered_[cell] = 0;
            heightAt_[cell] = std::numeric_limits<float>::quiet_NaN();
        }
        touched_.clear();
    }

  private:
    size_t texelOf(const Point& p) const {
        const int x = std::clamp(int(p.x()), 0, width_ - 1), y = std::clamp(int(p.y()), 0, height_ - 1);
        return size_t(y) * size_t(width_) + size_t(x);
    }

    template <class Visit>
    void eachCentre(const std::array<Point, 3>& p, const Visit& visit) const {
        const auto [xLow, xHigh] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
        const auto [yLow, yHigh] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
        const int x0 = std::max(0, int(std::ceil(xLow - 0.5))),
                  x1 = std::min(width_ - 1, int(std::floor(xHigh - 0.5)));
        const int y0 = std::max(0, int(std::ceil(yLow - 0.5))),
                  y1 = std::min(height_ - 1, int(std::floor(yHigh - 0.5)));
        if (x0 > x1 || y0 > y1) return;
        const double side = turn(p[0], p[1], p[2]) < 0 ? -1 : 1;
        std::array<double, 3> length;
        for (size_t k = 0; k < 3; ++k) length[k] = (p[(k + 1) % 3] - p[k]).norm();
        for (int y = y0; y <= y1; ++y) {
            const auto [from, to] =
                columnsInRow({p[0].x(), p[1].x(), p[2].x()}, {p[0].y(), p[1].y(), p[2].y()}, y, x0, x1);
            for (int x = from; x <= to; ++x) {
                const Point centre(x + 0.5, y + 0.5);
                bool inside = true;
                for (size_t k = 0; k < 3 && inside; ++k)
                    inside = side * turn(p[k], p[(k + 1) % 3], centre) > kMargin * length[k];
                if (inside) visit(size_t(y) * size_t(width_) + size_t(x));
            }
        }
    }

    const AtlasMesh& mesh_;
    const ChartShape& shape_;
    const double scale_;
    const Vec3d normal_;
    const int width_, height_;
    std::vector<uint8_t> covered_;
    std::vector<float> heightAt_;
    std::vector<size_t> cells_, touched_;
};

/// Lays a chart's faces from its first one outwards; those that do not fit, and those that are only reached
/// through them, make up the next layer, and so on.
/// @param layerOf  [faces of the mesh] kNone for those of this chart, set here
/// @return number of layers
uint32_t layOut(const AtlasMesh& mesh, const Charts& charts, uint32_t chart, std::span<const uint32_t> faces,
                ChartRaster& raster, std::vector<uint32_t>& layerOf) {
    constexpr uint32_t kWaits = kNone - 1;
    uint32_t layer = 0;
    std::vector<uint32_t> queue, waiting;
    for (uint32_t seed : faces) {
        if (layerOf[seed] != kNone) continue;
        raster.clear();
        raster.lay(seed);  // always fits, being the first
        layerOf[seed] = layer;
        queue.assign(1, seed);
        waiting.clear();
        for (size_t at = 0; at < queue.size(); ++at) {
            throwIfInterruptedAt(at);
            for (uint32_t h = 3 * queue[at]; h < 3 * queue[at] + 3; ++h) {
                if (mesh.twin[h] == kNone) continue;
                const uint32_t other = mesh.twin[h] / 3;
                if (charts.ofFace[other] != chart || layerOf[other] != kNone) continue;
                const bool fits = raster.lay(other);
                layerOf[other] = fits ? layer : kWaits;
                (fits ? queue : waiting).push_back(other);
            }
        }
        for (uint32_t face : waiting) layerOf[face] = kNone;
        ++layer;
    }
    return layer;
}

}  // namespace

int splitOverlaps(const AtlasMesh& mesh, Charts& charts, const ChartFaces& faces,
                  const std::vector<ChartShape>& shapes, double texelsPerUnit) {
    std::vector<uint32_t> layerOf(mesh.faces(), kNone), layers(charts.count, 0);
    parallelFor(charts.count, 4, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
            ChartRaster raster(mesh, shapes[c], texelsPerUnit);
            layers[c] = layOut(mesh, charts, uint32_t(c), faces.of(uint32_t(c)), raster, layerOf);
        }
    });
    int split = 0;
    std::vector<uint32_t> firstLayer(charts.count);
    uint32_t count = 0;
    for (uint32_t c = 0; c < charts.count; ++c) {
        firstLayer[c] = count;
        count += layers[c];
        split += layers[c] > 1;
    }
    if (split == 0) return 0;
    for (uint32_t f = 0; f < mesh.faces(); ++f) charts.ofFace[f] = firstLayer[charts.ofFace[f]] + layerOf[f];
    charts.count = count;
    splitIntoConnected(mesh, charts);
    return split;
}

}  // namespace prt
