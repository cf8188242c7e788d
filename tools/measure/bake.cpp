// The bake against the bare loops of precompute/rays/occlusion_loop.h, interleaved so that ratios hold on a
// machine that others use too.
#include "tools/measure/bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "precompute/mesh/atlas.h"
#include "precompute/mesh/load_mesh.h"
#include "precompute/rays/occlusion_loop.h"
#include "precompute/visibility/bake_items.h"

namespace prt::tools {
namespace {

constexpr size_t kRun = 256;  // neighbouring points that the bare loops take together
const std::string kNotRobust = "-not-robust";

// What one run of a loop or of a bake took.
struct Run {
    uint64_t rays = 0, points = 0;
    double seconds = 0;
    std::vector<uint32_t> blocked;  // of a bare loop
    BakeStages stages;              // of a bake
};

struct Method {
    std::string name;
    bool mayBeCeiling;
    std::function<Run()> run;
};

double median(std::vector<double> values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Points for the bare loops: whole runs of neighbours, evenly spread.
struct LoopPoints {
    std::vector<Vec3f> origins, normals;

    LoopPoints(const RayCaster& caster, const std::vector<SurfacePoint>& points, size_t limit) {
        std::vector<Vec3f> positions;
        for (const SurfacePoint& point : points) positions.push_back(point.position);
        const std::vector<uint32_t> order = mortonOrder(positions);
        const size_t runs = (order.size() + kRun - 1) / kRun;
        const size_t taken = limit == 0 ? runs : std::min(runs, (limit + kRun - 1) / kRun);
        for (size_t r = 0; r < taken; ++r) {
            const size_t begin = r * runs / taken * kRun;
            for (size_t i = begin; i < std::min(begin + kRun, order.size()); ++i) {
                const SurfacePoint& point = points[order[i]];
                origins.push_back(caster.offsetOrigin(point.position, point.normal));
                normals.push_back(point.normal);
            }
        }
    }
};

std::vector<Vec3f> neighbouringDirections(int count) {
    const std::vector<Vec3f> directions = sphericalFibonacci(count);
    std::vector<Vec3f> sorted;
    for (const uint32_t k : mortonOrder(directions)) sorted.push_back(directions[k]);
    return sorted;
}

Run runLoop(const OcclusionLoop& loop, RayArrangement arrangement) {
    OcclusionCount count = loop.run(arrangement);
    Run run;
    run.rays = count.rays;
    run.points = count.blocked.size();
    run.seconds = count.seconds;
    run.blocked = std::move(count.blocked);
    return run;
}

Run runBake(const RayCaster& caster, const TexelSurface& surface, const BakeOptions& options) {
    const Stopwatch watch;
    const BakeResult result = bakeTexelVisibility(caster, surface, options);
    Run run;
    run.seconds = watch.seconds();
    run.rays = result.rays;
    run.points = surface.points.size();
    run.stages = result.stages;
    return run;
}

std::vector<Method> makeMethods(const RayCaster& caster, const TexelSurface& surface,
                                const OcclusionLoop& robust, const OcclusionLoop& notRobust,
                                const BakeStudy& study) {
    std::vector<Method> methods;
    for (const RayArrangement arrangement : kRayArrangements)
        methods.push_back({rayArrangementName(arrangement), true,
                           [&robust, arrangement] { return runLoop(robust, arrangement); }});
    BakeOptions options;
    options.shOrder = study.shOrder;
    options.rays = study.rays;
    options.projection = study.projection;
    const auto addBake = [&](const std::string& name, const BakeOptions& of) {
        methods.push_back({name, false, [&caster, &surface, of] { return runBake(caster, surface, of); }});
    };
    addBake("pipeline", options);
    BakeOptions other = options;
    other.findInside = false;
    addBake("pipeline-no-inside", other);
    other = options;
    other.error = study.error;
    if (study.error > 0) addBake("adaptive", other);
    for (const RayArrangement arrangement :
         {RayArrangement::PacketDirectionMajor, RayArrangement::StreamDirectionMajor})
        methods.push_back({rayArrangementName(arrangement) + kNotRobust, false,
                           [&notRobust, arrangement] { return runLoop(notRobust, arrangement); }});
    return methods;
}

double rate(const Run& run) { return run.seconds > 0 ? double(run.rays) / run.seconds : 0; }

// One number over the rounds.
double medianOver(const std::vector<Run>& runs, const std::function<double(const Run&)>& value) {
    std::vector<double> values;
    for (const Run& run : runs) values.push_back(value(run));
    return median(std::move(values));
}

void addRates(int threads, const std::vector<Method>& methods, const std::vector<std::vector<Run>>& runs,
              BakeRates& result) {
    size_t ceiling = 0;
    std::vector<double> medians;
    for (size_t m = 0; m < methods.size(); ++m) {
        medians.push_back(medianOver(runs[m], rate));
        if (methods[m].mayBeCeiling && medians[m] > medians[ceiling]) ceiling = m;
    }
    for (size_t m = 0; m < methods.size(); ++m) {
        std::vector<double> ratios;
        for (size_t round = 0; round < runs[m].size(); ++round)
            ratios.push_back(rate(runs[m][round]) / rate(runs[ceiling][round]));
        const auto [low, high] = std::minmax_element(ratios.begin(), ratios.end());
        result.rates.push_back({threads, methods[m].name, medians[m], medians[m] / medians[ceiling], *low,
                                *high, medianOver(runs[m], [](const Run& run) { return run.seconds; }),
                                runs[m][0].rays, runs[m][0].points});
    }
}

void addStages(int threads, const std::vector<Run>& runs, BakeRates& result) {
    const double all = threads * medianOver(runs, [](const Run& run) { return run.seconds; });
    double named = 0;
    const auto add = [&](const char* name, double seconds) {
        result.stages.push_back({threads, name, seconds, all > 0 ? seconds / all : 0});
        named += seconds;
    };
    add("set-up", medianOver(runs, [](const Run& run) { return run.stages.setUp; }));
    add("trace", medianOver(runs, [](const Run& run) { return run.stages.trace; }));
    add("project", medianOver(runs, [](const Run& run) { return run.stages.project; }));
    add("inside", medianOver(runs, [](const Run& run) { return run.stages.inside; }));
    add("other", std::max(0.0, all - named));
}

void compareBlocked(const std::vector<Method>& methods, const std::vector<std::vector<Run>>& runs,
                    BakeRates& result) {
    const auto stream = std::find_if(methods.begin(), methods.end(), [](const Method& method) {
        return method.name == rayArrangementName(RayArrangement::StreamDirectionMajor);
    });
    const std::vector<uint32_t>& expected = runs[size_t(stream - methods.begin())][0].blocked;
    result.blockedRays = 0;
    for (const uint32_t blocked : expected) result.blockedRays += blocked;
    for (size_t m = 0; m < methods.size(); ++m) {
        if (!methods[m].mayBeCeiling) continue;
        uint64_t difference = 0;
        for (size_t i = 0; i < expected.size(); ++i) {
            const uint32_t blocked = runs[m][0].blocked[i];
            difference += blocked > expected[i] ? blocked - expected[i] : expected[i] - blocked;
        }
        result.largestDifference = std::max(result.largestDifference, difference);
    }
}

void prepareAtlas(Scene& scene, int texels) {
    if (!scene.uv1.empty() && isValidAtlas(scene, texels)) return;
    AtlasOptions options;
    options.texels = texels;
    buildAtlas(scene, options);
}

}  // namespace

const BakeRate* BakeRates::find(int threads, const std::string& arrangement) const {
    for (const BakeRate& of : rates)
        if (of.threads == threads && of.arrangement == arrangement) return &of;
    return nullptr;
}

const BakeRate& BakeRates::ceiling(int threads) const {
    const BakeRate* best = nullptr;
    for (const RayArrangement arrangement : kRayArrangements) {
        const BakeRate* of = find(threads, rayArrangementName(arrangement));
        if (of && (!best || of->raysPerSecond > best->raysPerSecond)) best = of;
    }
    PRT_CHECK(best != nullptr);
    return *best;
}

BakeRates measureBake(Scene scene, const BakeStudy& study) {
    PRT_CHECK_LE(1, study.rounds);
    PRT_CHECK_LE(study.rays, 65535);
    prepareAtlas(scene, study.texels);
    const TexelSurface surface = rasterizeTexels(scene, study.texels, study.texels);
    if (surface.points.empty())
        throw InputError("atlas", "no texel of it lies on the mesh", "raise --texels");
    const RayCaster caster(scene.positions, scene.indices);
    const LoopPoints points(caster, surface.points, size_t(study.loopPoints));
    const std::vector<Vec3f> directions = neighbouringDirections(study.rays);
    const OcclusionLoop robust(caster, points.origins, points.normals, directions);
    const OcclusionLoop notRobust(caster, points.origins, points.normals, directions, false);
    const std::vector<Method> methods = makeMethods(caster, surface, robust, notRobust, study);

    BakeRates result;
    result.triangles = scene.triangleCount();
    result.points = surface.points.size();
    result.instructionSet = caster.instructionSet();
    for (const int threads : study.threadCounts) {
        const ScopedThreadCount scope(threads);
        std::vector<std::vector<Run>> runs(methods.size());
        for (int round = 0; round < study.rounds; ++round)
            for (size_t m = 0; m < methods.size(); ++m) runs[m].push_back(methods[m].run());
        addRates(threads, methods, runs, result);
        for (size_t m = 0; m < methods.size(); ++m)
            if (methods[m].name == "pipeline") addStages(threads, runs[m], result);
        compareBlocked(methods, runs, result);
    }
    return result;
}

Scene bumpySphere() {
    constexpr int kRows = 132, kColumns = 266;  // 2·columns·(rows − 1) triangles
    const auto point = [](double v, double u) {
        const double theta = std::numbers::pi * v / kRows, phi = 2 * std::numbers::pi * u / kColumns;
        const Vec3d d(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
        const double bumps = std::sin(11 * d.x() + 1) + std::sin(11 * d.y() + 2) + std::sin(11 * d.z() + 3);
        return Vec3f(((1 + 0.12 * bumps) * d).cast<float>());
    };
    Scene scene;
    scene.positions.push_back(point(0, 0));
    for (int v = 1; v < kRows; ++v)
        for (int u = 0; u < kColumns; ++u) scene.positions.push_back(point(v, u));
    scene.positions.push_back(point(kRows, 0));
    const uint32_t last = uint32_t(scene.positions.size()) - 1;
    const auto at = [&](int v, int u) {
        if (v == 0) return uint32_t(0);
        return v == kRows ? last : uint32_t(1 + (v - 1) * kColumns + u % kColumns);
    };
    const auto triangle = [&](uint32_t a, uint32_t b, uint32_t c) {
        for (const uint32_t i : {a, b, c}) scene.indices.push_back(i);
    };
    for (int v = 0; v < kRows; ++v)
        for (int u = 0; u < kColumns; ++u) {
            if (v + 1 < kRows) triangle(at(v, u), at(v + 1, u + 1), at(v + 1, u));
            if (v > 0) triangle(at(v, u), at(v, u + 1), at(v + 1, u + 1));
        }
    return prepareScene(std::move(scene), "bumpy sphere", {});
}

}  // namespace prt::tools
