// Who sees past the scene in which direction of a set: by tracing everything, or only what coarser directions
// leave open.
#pragma once

#include <array>
#include <vector>

#include "precompute/visibility/accumulate.h"
#include "precompute/visibility/direction_levels.h"
#include "precompute/visibility/point_mask.h"
#include "precompute/visibility/ray_block.h"

namespace prt {

/// A block's answers for one set of directions.
struct LevelMasks {
    std::vector<PointMask> above;    ///< [directions] above the horizon
    std::vector<PointMask> visible;  ///< [directions] above the horizon and not blocked
};

/// Sums of cosines at the sub-points that take the directions, of the items of several sub-points.
struct SharedCosines {
    std::array<CosineSum, kMostBlockPoints> seen{}, open{};
};

/// Traces every direction from every item that has it above its horizon.
/// @throws Interrupted
void traceAll(RayBlock& block, const DirectionLevel& level, RayCasting casting, LevelMasks& masks,
              SharedCosines& cosines);

/// Answers for a finer set from those of the coarser one before it. A direction takes the answer of its
/// nearest coarser directions where they agree; it is traced where they do not (a silhouette passes), where
/// none of them is above the horizon, where the level's audit asks for it, and then wherever an answer that
/// was taken over differs from a traced one beside it.
/// @param coarser  of the same items
/// @throws Interrupted
void traceSilhouettes(RayBlock& block, const DirectionLevel& level, const LevelMasks& coarser,
                      LevelMasks& masks, SharedCosines& cosines);

/// Puts chosen items of several blocks together: their answers in the order of the blocks.
class MaskGather {
  public:
    /// Adds the chosen items of a block that follow those added before; together at most kMostBlockPoints.
    void add(const LevelMasks& source, const PointMask& chosen);
    LevelMasks gather() const;

  private:
    struct Run {
        const LevelMasks* source;
        size_t word;
        BitCompressor compressor;
        size_t place;
    };
    std::vector<Run> runs_;
    size_t count_ = 0;
};

}  // namespace prt
