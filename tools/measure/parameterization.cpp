// [IwanickiSloan2012] "Normal Mapping with Low-Frequency Precomputed Visibility", Appendix A: the error of
// spherical harmonics held in textures over the sphere.
#include "tools/measure/parameterization.h"

#include <half.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <span>

#include "precompute/base/check.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "precompute/math/sh.h"
#include "precompute/math/sphere_map.h"

namespace prt::tools {
namespace {

constexpr size_t kBlock = 4096;  ///< directions per task
constexpr size_t kStrip = 256;   ///< directions whose squares are added up in float

/// Every SH function at every texel centre: [texels × shCount].
std::vector<float> tabulate(const SphereMap& map, int shOrder) {
    std::vector<Vec3f> directions(size_t(map.texelCount()));
    for (size_t texel = 0; texel < directions.size(); ++texel)
        directions[texel] = map.texelDirection(int(texel)).cast<float>();
    std::vector<float> table(directions.size() * size_t(shCount(shOrder)));
    evalShBatch(shOrder, directions, table);
    return table;
}

/// To the nearest half float, ties to even.
std::vector<float> roundedToHalf(std::vector<float> table) {
    for (float& value : table) value = float(half(value));
    return table;
}

/// sums[i] += Σ_k (Σ_tap weight · table[tap][i] − exact[k][i])²
/// @param taps   [count]
/// @param exact  [count × width]
/// @param sums   [width]
PRT_TARGET_CLONES
void addSquares(const float* table, const SphereTaps* taps, const float* exact, size_t count, size_t width,
                float* __restrict__ sums) {
    for (size_t k = 0; k < count; ++k) {
        const SphereTaps& t = taps[k];
        const float *a = table + size_t(t[0].texel) * width, *b = table + size_t(t[1].texel) * width;
        const float *c = table + size_t(t[2].texel) * width, *d = table + size_t(t[3].texel) * width;
        const float wa = t[0].weight, wb = t[1].weight, wc = t[2].weight, wd = t[3].weight;
        const float* truth = exact + k * width;
        for (size_t i = 0; i < width; ++i) {
            const float error = wa * a[i] + wb * b[i] + wc * c[i] + wd * d[i] - truth[i];
            sums[i] += error * error;
        }
    }
}

/// One layout at one size.
struct Candidate {
    std::unique_ptr<SphereMap> map;
    std::vector<std::vector<float>> tables;  ///< float, half
};

/// Sums of squares of one block of directions over all candidates: [candidates × tables × width].
class BlockSums {
  public:
    BlockSums(const std::vector<Candidate>& candidates, int shOrder)
        : candidates_(candidates), shOrder_(shOrder), width_(size_t(shCount(shOrder))) {}

    void add(std::span<const Vec3f> directions, std::span<double> sums, Progress& progress) const {
        std::vector<float> exact(directions.size() * width_);
        evalShBatch(shOrder_, directions, exact);
        std::array<SphereTaps, kStrip> taps;
        std::vector<float> stripSums(width_);
        size_t slot = 0;
        for (const Candidate& candidate : candidates_) {
            for (size_t first = 0; first < directions.size(); first += kStrip) {
                const size_t count = std::min(kStrip, directions.size() - first);
                for (size_t k = 0; k < count; ++k)
                    taps[k] = candidate.map->taps(directions[first + k].cast<double>());
                for (size_t t = 0; t < candidate.tables.size(); ++t) {
                    std::fill(stripSums.begin(), stripSums.end(), 0.0f);
                    addSquares(candidate.tables[t].data(), taps.data(), exact.data() + first * width_, count,
                               width_, stripSums.data());
                    for (size_t i = 0; i < width_; ++i) sums[(slot + t) * width_ + i] += double(stripSums[i]);
                }
            }
            slot += candidate.tables.size();
            progress.advance(directions.size());
        }
    }

  private:
    const std::vector<Candidate>& candidates_;
    int shOrder_;
    size_t width_;
};

std::vector<Candidate> makeCandidates(const std::string& layout, int shOrder,
                                      const ParameterizationSettings& settings) {
    std::vector<Candidate> candidates;
    for (const int size : parameterizationSizes(layout, settings.maxSamples)) {
        Candidate candidate{makeSphereMap(layout, size), {}};
        candidate.tables.push_back(tabulate(*candidate.map, shOrder));
        if (settings.half) candidate.tables.push_back(roundedToHalf(candidate.tables.front()));
        candidates.push_back(std::move(candidate));
    }
    return candidates;
}

/// @return [candidates × tables × n²] sums over all directions
std::vector<double> sumSquares(const std::vector<Candidate>& candidates, int shOrder,
                               std::span<const Vec3f> directions, Progress& progress) {
    const size_t tables = candidates.empty() ? 0 : candidates.front().tables.size();
    const size_t slots = candidates.size() * tables * size_t(shCount(shOrder));
    const size_t blocks = (directions.size() + kBlock - 1) / kBlock;
    std::vector<double> perBlock(blocks * slots, 0.0);
    const BlockSums block(candidates, shOrder);
    parallelFor(blocks, 1, [&](size_t begin, size_t end) {
        for (size_t b = begin; b < end; ++b) {
            const size_t first = b * kBlock;
            block.add(directions.subspan(first, std::min(kBlock, directions.size() - first)),
                      std::span(perBlock).subspan(b * slots, slots), progress);
        }
    });
    std::vector<double> sums(slots, 0.0);
    for (size_t b = 0; b < blocks; ++b)
        for (size_t i = 0; i < slots; ++i) sums[i] += perBlock[b * slots + i];
    return sums;
}

}  // namespace

std::vector<int> parameterizationSizes(const std::string& layout, int maxSamples) {
    const double samplesPerSquare = makeSphereMap(layout, 2)->texelCount() / 4.0;
    // Octahedral maps at even sizes only, as textures mostly are: odd ones err less, and a curve through both
    // would be crooked.
    const int step = layout.ends_with("octahedral") ? 2 : 1;
    std::vector<int> sizes;
    for (double edge = 8 * std::pow(2, -1.5);; edge *= std::sqrt(2.0)) {
        const double target = 6 * std::round(edge) * std::round(edge);
        const int size = std::max(2, step * int(std::lround(std::sqrt(target / samplesPerSquare) / step)));
        if (samplesPerSquare * size * size > maxSamples || size > kMaxSphereMapSize) return sizes;
        if (sizes.empty() || sizes.back() != size) sizes.push_back(size);
    }
}

std::vector<ParameterizationRow> measureParameterization(const ParameterizationSettings& settings) {
    PRT_CHECK(!settings.shOrders.empty() && settings.points >= 1);
    const int shOrder = *std::max_element(settings.shOrders.begin(), settings.shOrders.end());
    const std::vector<Vec3f> directions = randomDirections(settings.points, settings.seed);
    size_t candidateCount = 0;
    for (const std::string& layout : settings.layouts)
        candidateCount += parameterizationSizes(layout, settings.maxSamples).size();
    Progress progress("looking up", candidateCount * directions.size(), "lookups");

    std::vector<ParameterizationRow> rows;
    for (const std::string& layout : settings.layouts) {
        const std::vector<Candidate> candidates = makeCandidates(layout, shOrder, settings);
        const std::vector<double> sums = sumSquares(candidates, shOrder, directions, progress);
        const size_t tables = settings.half ? 2 : 1, width = size_t(shCount(shOrder));
        for (size_t t = 0; t < tables; ++t)
            for (size_t c = 0; c < candidates.size(); ++c)
                for (const int n : settings.shOrders) {
                    // the functions of a lower order come first in those of a higher one
                    const auto first = sums.begin() + std::ptrdiff_t((c * tables + t) * width);
                    const double sum = std::accumulate(first, first + shCount(n), 0.0);
                    const SphereMap& map = *candidates[c].map;
                    rows.push_back({n, layout, t == 0 ? "float" : "half", map.faceHeight(), map.texelCount(),
                                    sum / (double(directions.size()) * shCount(n))});
                }
    }
    std::stable_sort(rows.begin(), rows.end(),
                     [](const auto& a, const auto& b) { return a.shOrder < b.shOrder; });
    return rows;
}

}  // namespace prt::tools
