// Visibility by ray casting and its projection [IwanickiSloan2012, Sec. 3]: batches of near items go through
// one set of directions after another, and those whose error is small enough leave.
#include "precompute/visibility/trace_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/block_projection.h"
#include "precompute/visibility/direction_levels.h"
#include "precompute/visibility/find_inside.h"
#include "precompute/visibility/level_masks.h"
#include "precompute/visibility/ray_block.h"

namespace prt {
namespace {

// Blocks of one batch: those who stay share blocks again at the next set.
constexpr size_t kBatchBlocks = 8;

class StageClock {
  public:
    /// Seconds since the last call.
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - last_).count();
        last_ = now;
        return seconds;
    }

  private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

struct Bake {
    const RayCaster& caster;
    const BakeItems& items;
    const BakeOptions& options;
    const DirectionLevels& levels;
    const ProjectionTables& tables;
    RayCasting casting;
    size_t columns;
};

// Everything one thread needs while it bakes a batch.
class Batch {
  public:
    Batch(const Bake& bake, BakeResult& result)
        : bake_(bake),
          result_(result),
          rays_(bake.caster, bake.items),
          projection_(bake.tables, bake.levels[0].stride) {}

    /// @param items  near each other, in order
    void run(std::span<const uint32_t> items) {
        std::vector<Block> blocks;
        for (size_t begin = 0; begin < items.size(); begin += blockPoints()) {
            const auto block = items.subspan(begin, std::min(blockPoints(), items.size() - begin));
            blocks.push_back({{block.begin(), block.end()}, {}, {}});
        }
        for (size_t level = 0; level < bake_.levels.count() && !blocks.empty(); ++level) {
            const bool last = level + 1 == bake_.levels.count();
            for (Block& block : blocks) {
                bakeLevel(block, level, last);
                if (last) block.answers = {};
            }
            if (!last) blocks = regrouped(blocks);
        }
    }
    const BakeStages& stages() const { return stages_; }
    uint64_t rays() const { return rays_.rays(); }

  private:
    struct Block {
        std::vector<uint32_t> items;
        LevelMasks answers;  // of the set before; empty at the first
        PointMask staying;   // items that go on to the next set
    };
    size_t blockPoints() const { return size_t(bake_.options.blockPoints); }

    void bakeLevel(Block& block, size_t levelIndex, bool last) {
        const DirectionLevel& level = bake_.levels[levelIndex];
        clock_.lap();
        rays_.begin(block.items);
        LevelMasks answers;
        SharedCosines cosines;
        if (levelIndex == 0)
            traceAll(rays_, level, bake_.casting, answers, cosines);
        else
            traceSilhouettes(rays_, level, block.answers, answers, cosines);
        block.answers = std::move(answers);
        stages_.trace += clock_.lap();
        project(block, level, levelIndex);
        block.staying = {};
        for (size_t i = 0; i < block.items.size(); ++i) {
            finish(block, i, cosines);
            if (!last && double(result_.error[block.items[i]]) > bake_.options.error) block.staying.set(i);
        }
        stages_.project += clock_.lap();
    }

    void project(const Block& block, const DirectionLevel& level, size_t levelIndex) {
        normals_.clear();
        orientations_.clear();
        openShares_.clear();
        for (const uint32_t item : block.items) {
            normals_.push_back(bake_.items.normal(item));
            openShares_.push_back(bake_.items.openShare(item));
            if (!bake_.items.orientations.empty()) orientations_.push_back(bake_.items.orientations[item]);
        }
        projection_.project(level, orientations_, block.answers, normals_, rays_.shared(), openShares_);
        coarserDifferences_.assign(block.items.size(), 0.0f);
        if (levelIndex > 0) projection_.compare(block.items, result_.coefficients, coarserDifferences_);
    }

    // Writes what this set says of item i of the block.
    void finish(const Block& block, size_t i, const SharedCosines& cosines) {
        const uint32_t item = block.items[i];
        projection_.expansion(i,
                              std::span(&result_.coefficients[size_t(item) * bake_.columns], bake_.columns));
        result_.error[item] = float(std::max(kHalfSetShare * double(projection_.halfSetDifferences()[i]),
                                             kCoarserSetShare * double(coarserDifferences_[i])));
        if (rays_.shared().test(i))
            result_.ao[item] = seenShare(cosines.seen[i], cosines.open[i]);
        else
            result_.ao[item] = projection_.openness(i);
    }

    // Those who stay, in full blocks.
    std::vector<Block> regrouped(const std::vector<Block>& blocks) {
        std::vector<Block> result;
        size_t first = 0;
        while (first < blocks.size()) {
            Block together;
            MaskGather gather;
            size_t next = first;
            for (; next < blocks.size(); ++next) {
                const Block& block = blocks[next];
                if (together.items.size() + block.staying.count() > blockPoints()) break;
                gather.add(block.answers, block.staying);
                block.staying.forEach([&](size_t i) { together.items.push_back(block.items[i]); });
            }
            together.answers = gather.gather();
            if (!together.items.empty()) result.push_back(std::move(together));
            first = next;
        }
        return result;
    }

    const Bake& bake_;
    BakeResult& result_;
    RayBlock rays_;
    BlockProjection projection_;
    std::vector<Vec3f> normals_;
    std::vector<uint8_t> orientations_;
    std::vector<float> openShares_, coarserDifferences_;
    StageClock clock_;
    BakeStages stages_;
};

void checkOptions(const RayCaster& caster, const BakeItems& items, const BakeOptions& options) {
    const auto check = [](const char* name, int value, int low, int high) {
        if (value < low || value > high)
            throw UsageError(name, fmt::format("{} is out of range", value),
                             fmt::format("choose {} to {}", low, high));
    };
    check("order", options.shOrder, 1, kMaxBundleShOrder);
    check("rays", options.rays, 1, kMaxBakeRays);
    if (!(options.error >= 0 && options.error < 1e9))
        throw UsageError("error", fmt::format("{} is out of range", options.error), "choose 0 or more");
    PRT_CHECK(std::find(kAdaptiveSets.begin(), kAdaptiveSets.end(), options.finestSet) !=
              kAdaptiveSets.end());
    // Whole words of a mask, so that packets of rays are the same for all of them.
    PRT_CHECK(options.blockPoints >= 64 && options.blockPoints % 64 == 0);
    PRT_CHECK_LE(size_t(options.blockPoints), kMostBlockPoints);
    PRT_CHECK(items.normals.empty() || items.normals.size() == items.count());
    PRT_CHECK(items.firstPoint.empty() || !items.normals.empty());
    PRT_CHECK(items.orientations.empty() || items.orientations.size() == items.count());
    PRT_CHECK(options.doubleSided.empty() || options.doubleSided.size() == caster.triangleCount());
}

std::vector<int> setSizes(const BakeOptions& options) {
    if (options.error == 0) return {options.rays};
    std::vector<int> sizes;
    for (const int size : kAdaptiveSets)
        if (size <= options.finestSet) sizes.push_back(size);
    return sizes;
}

// By the median distance between points that follow each other.
RayCasting chooseCasting(const RayCaster& caster, const BakeItems& items, std::span<const uint32_t> order) {
    std::vector<float> distances;
    const auto place = [&](uint32_t item) { return items.points[items.begin(item)].position; };
    const auto hasPoint = [&](uint32_t item) { return items.begin(item) < items.end(item); };
    for (size_t i = 1; i < order.size(); ++i)
        if (hasPoint(order[i - 1]) && hasPoint(order[i]))
            distances.push_back((place(order[i]) - place(order[i - 1])).norm());
    if (distances.empty()) return RayCasting::Stream;
    const auto median = distances.begin() + ptrdiff_t(distances.size() / 2);
    std::nth_element(distances.begin(), median, distances.end());
    return caster.packetsAreFaster(*median) ? RayCasting::Packets : RayCasting::Stream;
}

void markInside(const RayCaster& caster, const BakeItems& items, const BakeOptions& options,
                BakeResult& result) {
    result.inside = findInside(caster, items, result.ao, options.doubleSided);
    const auto count = size_t(std::count(result.inside.begin(), result.inside.end(), uint8_t(1)));
    if (count * 2 <= items.count()) return;
    result.windingSuspect = true;
    std::fill(result.inside.begin(), result.inside.end(), uint8_t(0));
    logWarning(fmt::format(
        "{} of {} points see mostly back faces: the mesh is wound inside out or inconsistently, and "
        "points inside geometry are not looked for; turn its faces outwards",
        count, items.count()));
}

}  // namespace

BakeResult bakeItems(const RayCaster& caster, const BakeItems& items, const BakeOptions& options,
                     const char* unit) {
    checkOptions(caster, items, options);
    const size_t count = items.count(), columns = size_t(shCount(options.shOrder));
    BakeResult result;
    result.coefficients.assign(count * columns, 0.0f);
    result.ao.assign(count, 0.0f);
    result.error.assign(count, 0.0f);
    result.inside.assign(count, 0);

    const Stopwatch watch;
    StageClock clock;
    const DirectionLevels levels(setSizes(options), options.shOrder);
    const ProjectionTables tables(options.shOrder, options.projection);
    const std::vector<uint32_t> order = mortonOrderOfItems(items);
    const Bake bake{caster, items, options, levels, tables, chooseCasting(caster, items, order), columns};
    levels[0];
    result.stages.setUp = clock.lap();
    std::mutex sums;
    Progress progress("tracing", count, unit);
    parallelFor(count, size_t(options.blockPoints) * kBatchBlocks, [&](size_t begin, size_t end) {
        const auto batch = std::make_unique<Batch>(bake, result);
        batch->run(std::span(&order[begin], end - begin));
        progress.advance(end - begin);
        const std::lock_guard lock(sums);
        result.rays += batch->rays();
        result.stages.trace += batch->stages().trace;
        result.stages.project += batch->stages().project;
    });
    clock.lap();
    if (options.findInside) markInside(caster, items, options, result);
    result.stages.inside = clock.lap() * threadCount();
    result.traceSeconds = watch.seconds();
    return result;
}

}  // namespace prt
