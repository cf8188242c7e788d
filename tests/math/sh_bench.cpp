// Speed of evaluation, by number of bands: one direction, rows of many, structure of arrays of many.
// Counter ns: nanoseconds per direction.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/math/directions.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

// In the first cache with results of up to 10 bands; rows that share no sets of the cache.
constexpr size_t kCount = 64, kStride = 80;
constexpr size_t kLine = 16;  // floats of a cache line

/// Memory that begins with a cache line.
class AlignedFloats {
  public:
    explicit AlignedFloats(size_t count) : memory_(count + kLine) {}
    std::span<float> span() {
        const size_t skip =
            (kLine - reinterpret_cast<uintptr_t>(memory_.data()) / sizeof(float) % kLine) % kLine;
        return std::span(memory_).subspan(skip, memory_.size() - kLine);
    }

  private:
    std::vector<float> memory_;
};

void countNanoseconds(benchmark::State& state, size_t perIteration) {
    state.counters["ns"] =
        benchmark::Counter(double(perIteration) * 1e-9,
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void evalSingle(benchmark::State& state) {
    const int n = int(state.range(0));
    const std::vector<Vec3f> directions = randomDirections(int(kCount), 1);
    std::vector<float> out(size_t(shCount(n)));
    for (auto _ : state)
        for (const Vec3f& d : directions) {
            evalSh(n, d, std::span<float>(out));
            benchmark::DoNotOptimize(out.data());
            benchmark::ClobberMemory();
        }
    countNanoseconds(state, kCount);
}
BENCHMARK(evalSingle)->DenseRange(3, 10);

void evalRows(benchmark::State& state) {
    const int n = int(state.range(0));
    const std::vector<Vec3f> directions = randomDirections(int(kCount), 1);
    std::vector<float> out(kCount * size_t(shCount(n)));
    for (auto _ : state) {
        evalShBatch(n, directions, out);
        benchmark::ClobberMemory();
    }
    countNanoseconds(state, kCount);
}
BENCHMARK(evalRows)->DenseRange(3, 10);

void evalSoa(benchmark::State& state) {
    const int n = int(state.range(0));
    std::vector<float> x, y, z;
    for (const Vec3f& d : randomDirections(int(kCount), 1)) {
        x.push_back(d.x());
        y.push_back(d.y());
        z.push_back(d.z());
    }
    AlignedFloats out(kStride * size_t(shCount(n)));
    for (auto _ : state) {
        evalShSoa(n, x, y, z, out.span(), kStride);
        benchmark::ClobberMemory();
    }
    countNanoseconds(state, kCount);
}
BENCHMARK(evalSoa)->DenseRange(3, 10);

}  // namespace
}  // namespace prt
