// Speed of evaluation and products, by number of bands. Counter each: time per direction or product.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/math/directions.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_product.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

// In the first cache with results of up to 10 bands; rows that share no sets of the cache.
constexpr size_t kCount = 64, kStride = 80;
constexpr size_t kLine = 16;  // floats of a cache line

/// Memory that begins with a cache line.
class AlignedFloats {
  public:
    explicit AlignedFloats(size_t count) : memory_(count + kLine) {}
    std::span<float> span() const {
        const size_t skip =
            (kLine - reinterpret_cast<uintptr_t>(memory_.data()) / sizeof(float) % kLine) % kLine;
        return std::span(memory_).subspan(skip, memory_.size() - kLine);
    }

  private:
    mutable std::vector<float> memory_;
};

/// Time of one of the `perIteration` results of an iteration.
void countEach(benchmark::State& state, size_t perIteration) {
    state.counters["each"] = benchmark::Counter(
        double(perIteration), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
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
    countEach(state, kCount);
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
    countEach(state, kCount);
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
    countEach(state, kCount);
}
BENCHMARK(evalSoa)->DenseRange(3, 10);

/// Two factors and a place for their product.
struct Factors {
    explicit Factors(size_t size) : f(size), g(size), out(size) {
        test::RandomInput random(1);
        for (AlignedFloats* factor : {&f, &g})
            for (float& c : factor->span()) c = float(random.uniform(-1, 1));
    }
    AlignedFloats f, g, out;
};

void productTable(benchmark::State& state) {
    const int n = int(state.range(0));
    const Factors x{size_t(shCount(n))};
    for (auto _ : state)
        benchmark::DoNotOptimize(shProduct(x.f.span(), x.g.span(), n));  // allocates its result
    countEach(state, 1);
}
BENCHMARK(productTable)->DenseRange(3, 6);

void productSingle(benchmark::State& state) {
    const int n = int(state.range(0));
    const Factors x{size_t(shCount(n))};
    for (auto _ : state) {
        shProduct(n, x.f.span(), x.g.span(), x.out.span());
        benchmark::ClobberMemory();
    }
    countEach(state, 1);
}
BENCHMARK(productSingle)->DenseRange(3, 6);

void productSoa(benchmark::State& state) {
    const int n = int(state.range(0));
    const Factors x{kStride * size_t(shCount(n))};
    for (auto _ : state) {
        shProductSoa(n, x.f.span(), x.g.span(), x.out.span(), kCount, kStride);
        benchmark::ClobberMemory();
    }
    countEach(state, kCount);
}
BENCHMARK(productSoa)->DenseRange(3, 6);

void productByMatrix(benchmark::State& state) {
    const int n = int(state.range(0));
    const Factors x{size_t(shCount(n))};
    const std::vector<float> matrix = productMatrix(x.f.span(), n, n);
    for (auto _ : state) {
        applyProductMatrix(matrix, x.g.span(), x.out.span());
        benchmark::ClobberMemory();
    }
    countEach(state, 1);
}
BENCHMARK(productByMatrix)->DenseRange(3, 6);

void productByMatrixSoa(benchmark::State& state) {
    const int n = int(state.range(0));
    const Factors x{kStride * size_t(shCount(n))};
    const std::vector<float> matrix = productMatrix(x.f.span().first(size_t(shCount(n))), n, n);
    for (auto _ : state) {
        applyProductMatrixSoa(matrix, n, n, x.g.span(), x.out.span(), kCount, kStride);
        benchmark::ClobberMemory();
    }
    countEach(state, kCount);
}
BENCHMARK(productByMatrixSoa)->DenseRange(3, 6);

void productMatrixBuild(benchmark::State& state) {
    const int n = int(state.range(0));
    const Factors x{size_t(shCount(n))};
    for (auto _ : state) benchmark::DoNotOptimize(productMatrix(x.f.span(), n, n));
    countEach(state, 1);
}
BENCHMARK(productMatrixBuild)->DenseRange(3, 6);

}  // namespace
}  // namespace prt
