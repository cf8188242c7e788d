// Merging of small charts across their longest border, as in B. Lévy, S. Petitjean, N. Ray, J. Maillot,
// "Least Squares Conformal Maps for Automatic Texture Atlas Generation", SIGGRAPH 2002, section 3.2.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "precompute/base/error.h"
#include "precompute/mesh/atlas_parts.h"
#include "precompute/mesh/interrupt.h"

namespace prt {
namespace {

constexpr int kRounds = 4;

class Merger {
  public:
    Merger(const AtlasMesh& mesh, Charts& charts, double smallArea, double leanDeg)
        : mesh_(mesh),
          charts_(charts),
          smallArea_(smallArea),
          cosLean_(std::cos(leanDeg * std::numbers::pi / 180)),
          sum_(meanNormals(mesh, charts)),
          area_(charts.count, 0),
          head_(charts.count, kNone),
          tail_(charts.count, kNone),
          next_(mesh.faces(), kNone),
          border_(charts.count, 0) {
        for (uint32_t f = uint32_t(mesh.faces()); f-- > 0;) {
            const uint32_t c = charts.ofFace[f];
            area_[c] += mesh.area[f];
            next_[f] = head_[c];
            head_[c] = f;
            if (tail_[c] == kNone) tail_[c] = f;
        }
    }

    void run() {
        for (int round = 0; round < kRounds; ++round) {
            throwIfInterrupted();
            std::vector<uint32_t> small;
            for (uint32_t c = 0; c < charts_.count; ++c)
                if (head_[c] != kNone && area_[c] < smallArea_) small.push_back(c);
            std::sort(small.begin(), small.end(), [&](uint32_t a, uint32_t b) {
                return area_[a] != area_[b] ? area_[a] < area_[b] : a < b;
            });
            bool merged = false;
            for (size_t i = 0; i < small.size(); ++i) {
                throwIfInterruptedAt(i);
                merged |= mergeOne(small[i]);
            }
            if (!merged) break;
        }
        splitIntoConnected(mesh_, charts_);
    }

  private:
    bool allWithin(uint32_t chart, const Vec3d& mean) const {
        for (uint32_t f = head_[chart]; f != kNone; f = next_[f])
            if (!withinCone(mesh_.normal[f], mean, cosLean_)) return false;
        return true;
    }

    bool mayMerge(uint32_t small, uint32_t into) const {
        const Vec3d mean = sum_[small] + sum_[into];
        if (!allWithin(small, mean)) return false;
        // A much larger chart hardly turns; ejectLeaningFaces looks again at the end.
        return area_[small] * 50 < area_[into] || allWithin(into, mean);
    }

    bool mergeOne(uint32_t chart) {
        if (head_[chart] == kNone || area_[chart] >= smallArea_) return false;
        std::vector<uint32_t> neighbours;
        for (uint32_t f = head_[chart]; f != kNone; f = next_[f])
            for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
                if (mesh_.twin[h] == kNone) continue;
                const uint32_t other = charts_.ofFace[mesh_.twin[h] / 3];
                if (other == chart) continue;
                if (border_[other] == 0) neighbours.push_back(other);
                border_[other] +=
                    (mesh_.corner(nextCorner(h)) - mesh_.corner(h)).cast<double>().norm() + 1e-300;
            }
        std::sort(neighbours.begin(), neighbours.end(), [&](uint32_t a, uint32_t b) {
            return border_[a] != border_[b] ? border_[a] > border_[b] : a < b;
        });
        neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
        for (uint32_t n : neighbours) border_[n] = 0;
        for (uint32_t into : neighbours) {
            if (!mayMerge(chart, into)) continue;
            absorb(chart, into);
            return true;
        }
        return false;
    }

    void absorb(uint32_t chart, uint32_t into) {
        for (uint32_t f = head_[chart]; f != kNone; f = next_[f]) charts_.ofFace[f] = into;
        next_[tail_[chart]] = head_[into];
        head_[into] = head_[chart];
        head_[chart] = tail_[chart] = kNone;
        sum_[into] += sum_[chart];
        area_[into] += area_[chart];
    }

    const AtlasMesh& mesh_;
    Charts& charts_;
    const double smallArea_, cosLean_;
    std::vector<Vec3d> sum_;
    std::vector<double> area_;
    std::vector<uint32_t> head_, tail_, next_;  ///< faces of each chart as lists
    std::vector<double> border_;                ///< [charts] scratch
};

}  // namespace

void mergeSmallCharts(const AtlasMesh& mesh, Charts& charts, double smallArea, double leanDeg) {
    Merger(mesh, charts, smallArea, leanDeg).run();
    ejectLeaningFaces(mesh, charts, kLargestLeanDeg);
}

}  // namespace prt
