// How near the bake comes to bare ray casting, on one mesh and in one run.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "precompute/io/scene.h"
#include "precompute/visibility/bake.h"

namespace prt::tools {

struct BakeStudy {
    int texels = 512;  ///< edge of the atlas
    int rays = 512;    ///< directions over the sphere, at most 65,535
    int shOrder = 6;
    Projection projection;
    double error = 0.01;  ///< of an adaptive bake that is measured too; 0: none
    std::vector<int> threadCounts{1};
    int rounds = 3;  ///< every round runs everything once, one after another; rates are medians over rounds
    /// Points of the bare loops: runs of 256 neighbours spread evenly over the surface; 0: all points.
    int loopPoints = 65536;
};

/// Rays per second of one way to cast them.
struct BakeRate {
    int threads;
    /// Bare loops: the names of rayArrangementName, and with "-not-robust" the same on a scene that is not
    /// watertight. Bakes of all points: "pipeline" as prt precompute runs it, "pipeline-no-inside" without
    /// the search for points inside geometry, "adaptive".
    std::string arrangement;
    double raysPerSecond;
    double ratio;            ///< to the ceiling: the fastest bare loop, robust, at as many threads
    double lowest, highest;  ///< of the ratios within single rounds
    double seconds;          ///< of one run, median
    uint64_t rays, points;   ///< of one run
};

/// Seconds of the pipeline by what was done, summed over threads; median over rounds.
struct BakeStageTime {
    int threads;
    std::string stage;  ///< "set-up", "trace", "project", "inside", and "other": what the bake does not name
    double seconds, share;
};

struct BakeRates {
    size_t triangles = 0, points = 0;
    std::string instructionSet;
    std::vector<BakeRate> rates;        ///< by number of threads
    std::vector<BakeStageTime> stages;  ///< by number of threads
    /// Blocked rays per point by the bare loops: the largest sum of differences between any robust
    /// arrangement and the stream, and blocked rays by the latter.
    uint64_t largestDifference = 0, blockedRays = 0;

    /// @return nullptr where there is none
    const BakeRate* find(int threads, const std::string& arrangement) const;
    /// The ceiling: the robust bare loop of the highest rate.
    const BakeRate& ceiling(int threads) const;
};

/// Makes the atlas where the scene has none that is valid, then times the loops and the bakes on it.
/// @throws UsageError, InputError, Interrupted
BakeRates measureBake(Scene scene, const BakeStudy& study);

/// A closed mesh of 69,692 triangles whose points see each other: a sphere with bumps.
Scene bumpySphere();

}  // namespace prt::tools
