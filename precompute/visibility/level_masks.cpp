// Refinement along silhouettes: visibility is constant but at the outlines of what blocks, so that finer
// directions are worth a ray only there. The idea of tracing where coarser samples disagree is that of
// adaptive supersampling [Whitted1980].
#include "precompute/visibility/level_masks.h"

#include "precompute/base/check.h"
#include "precompute/base/error.h"

namespace prt {
namespace {

constexpr size_t kInterruptStep = 512;  // directions between two looks at Ctrl-C
// Rounds along silhouettes that coarser directions missed, up and down the indices in turn.
constexpr int kSpreadRounds = 4;

// Starts a level: no answers yet.
void reset(const DirectionLevel& level, LevelMasks& masks) {
    masks.above.resize(level.size());
    masks.visible.resize(level.size());
}

// Adds the cosines of all directions for items of several sub-points.
void addCosines(const RayBlock& block, const DirectionLevel& level, const LevelMasks& masks,
                SharedCosines& cosines) {
    if (!block.shared().any()) return;
    for (size_t k = 0; k < level.size(); ++k)
        (masks.above[k] & block.shared()).forEach([&](size_t i) {
            const CosineSum cosine{double(block.cosineOf(level, i, uint32_t(k))), 1};
            cosines.open[i] += cosine;
            if (masks.visible[k].test(i)) cosines.seen[i] += cosine;
        });
}

// What the nearest coarser directions say.
struct Prediction {
    PointMask open;  // items that any of them sees past the scene
    PointMask sure;  // items for which all that are above the horizon, at least one, agree
};
Prediction predict(const std::array<uint16_t, 4>& nearest, const LevelMasks& coarser) {
    PointMask open, closed;
    for (const uint16_t q : nearest) {
        open = open | coarser.visible[q];
        closed = closed | without(coarser.above[q], coarser.visible[q]);
    }
    return {open, open ^ closed};
}

// Answers that were taken over though a traced direction beside them says otherwise.
PointMask doubtful(const DirectionLevel& level, const LevelMasks& masks, const std::vector<PointMask>& traced,
                   size_t k) {
    PointMask differing;
    for (const uint16_t q : level.near[k])
        differing = differing | (traced[q] & (masks.visible[q] ^ masks.visible[k]));
    return without(differing & masks.above[k], traced[k]);
}

// One round over all directions; an answer that changes is seen by those that follow.
bool spread(RayBlock& block, const DirectionLevel& level, bool up, LevelMasks& masks,
            std::vector<PointMask>& traced) {
    bool found = false;
    for (size_t step = 0; step < level.size(); ++step) {
        if (step % kInterruptStep == 0) throwIfInterrupted();
        const size_t k = up ? step : level.size() - 1 - step;
        const PointMask rays = doubtful(level, masks, traced, k);
        if (!rays.any()) continue;
        found = true;
        const PointMask seen = block.visible(level, uint32_t(k), rays, RayCasting::Stream);
        masks.visible[k] = without(masks.visible[k], rays) | seen;
        traced[k] = traced[k] | rays;
    }
    return found;
}

}  // namespace

void traceAll(RayBlock& block, const DirectionLevel& level, RayCasting casting, LevelMasks& masks,
              SharedCosines& cosines) {
    reset(level, masks);
    for (size_t k = 0; k < level.size(); ++k) {
        if (k % kInterruptStep == 0) throwIfInterrupted();
        masks.above[k] = block.above(level, uint32_t(k));
        masks.visible[k] = {};
        if (!masks.above[k].any()) continue;
        masks.visible[k] = block.visible(level, uint32_t(k), masks.above[k], casting);
    }
    addCosines(block, level, masks, cosines);
}

void traceSilhouettes(RayBlock& block, const DirectionLevel& level, const LevelMasks& coarser,
                      LevelMasks& masks, SharedCosines& cosines) {
    PRT_CHECK_EQ(level.coarser.size(), level.size());
    reset(level, masks);
    std::vector<PointMask> traced(level.size());
    size_t looked = 0;
    for (const uint16_t k : level.order) {
        if (looked++ % kInterruptStep == 0) throwIfInterrupted();
        const PointMask above = block.above(level, k);
        const Prediction prediction = predict(level.coarser[k], coarser);
        const bool audit = level.auditStep != 0 && k % level.auditStep == level.auditStep / 2;
        const PointMask rays = audit ? above : without(above, prediction.sure);
        masks.above[k] = above;
        masks.visible[k] = without(above & prediction.open & prediction.sure, rays);
        traced[k] = rays;
        if (rays.any()) block.enqueue(level, k, rays, masks.visible);
    }
    block.flush(masks.visible);
    for (int round = 0; round < kSpreadRounds; ++round)
        if (!spread(block, level, round % 2 == 0, masks, traced)) break;
    addCosines(block, level, masks, cosines);
}

void MaskGather::add(const LevelMasks& source, const PointMask& chosen) {
    for (size_t w = 0; w < chosen.words.size(); ++w) {
        if (chosen.words[w] == 0) continue;
        const BitCompressor compressor(chosen.words[w]);
        runs_.push_back({&source, w, compressor, count_});
        count_ += size_t(compressor.count());
    }
    PRT_CHECK_LE(count_, kMostBlockPoints);
}

LevelMasks MaskGather::gather() const {
    LevelMasks result;
    if (runs_.empty()) return result;
    const size_t directions = runs_[0].source->above.size();
    const auto collect = [&](std::vector<PointMask> LevelMasks::*answers) {
        std::vector<PointMask>& to = result.*answers;
        to.resize(directions);
        for (const Run& run : runs_) {
            const std::vector<PointMask>& from = run.source->*answers;
            const size_t word = run.place / 64, shift = run.place % 64;
            for (size_t k = 0; k < directions; ++k) {
                const uint64_t bits = run.compressor(from[k].words[run.word]);
                to[k].words[word] |= bits << shift;
                if (shift + size_t(run.compressor.count()) > 64)
                    to[k].words[word + 1] |= bits >> (64 - shift);
            }
        }
    };
    collect(&LevelMasks::above);
    collect(&LevelMasks::visible);
    return result;
}

}  // namespace prt
