// Time per rotation of hemispherical harmonics by every method, n = 3…10; counter ns.
#include <benchmark/benchmark.h>

#include "precompute/math/hsh_rotation.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

template <typename Function>
void timeRotations(benchmark::State& state, const Function& rotate) {
    test::RandomInput random(92);
    std::vector<Mat3d> rotations(256);
    for (Mat3d& r : rotations)
        r = rotationFromZyz({random.uniform(-3, 3), random.uniform(0, 0.5), random.uniform(-3, 3)});
    const std::vector<float> in = random.coefficients<float>(shCount(int(state.range(0))));
    std::vector<float> out = in;
    size_t k = 0;
    for (auto _ : state) {
        rotate(rotations[k], in, out);
        k = (k + 1) % rotations.size();
        benchmark::ClobberMemory();
    }
    state.counters["ns"] =
        benchmark::Counter(1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// @param extra  orders of the intermediate harmonics above those of the hemisphere
void hshThroughSh(benchmark::State& state, int extra) {
    const HshRotationThroughSh through(int(state.range(0)), int(state.range(0)) + extra);
    timeRotations(state, [&](const Mat3d& r, std::span<const float> in, std::span<float> out) {
        through.rotate(r, in, out);
    });
}
void hshDigonRemovalTable(benchmark::State& state) {
    const HshRotationTable table(int(state.range(0)), 37);
    timeRotations(state, [&](const Mat3d& r, std::span<const float> in, std::span<float> out) {
        table.rotateByDigonRemoval(r, in, out);
    });
}
void hshTable(benchmark::State& state) {
    const HshRotationTable table(int(state.range(0)), 37);
    timeRotations(state, [&](const Mat3d& r, std::span<const float> in, std::span<float> out) {
        table.rotateByTable(r, in, out);
    });
}
void hshTurnMatrix(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(hshYRotation(int(state.range(0)), 0.5));
}

BENCHMARK_CAPTURE(hshThroughSh, extra4, 4)->DenseRange(3, 10);
BENCHMARK_CAPTURE(hshThroughSh, extra10, 10)->DenseRange(3, 10);
BENCHMARK(hshDigonRemovalTable)->DenseRange(3, 10);
BENCHMARK(hshTable)->DenseRange(3, 10);
BENCHMARK(hshTurnMatrix)->DenseRange(3, 10);

}  // namespace
}  // namespace prt
