// Speed of projecting environments, beside reading their pixels once.
#include "precompute/math/environment.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

constexpr int kWidth = 2048, kHeight = 1024;

std::vector<float> randomPixels() {
    test::RandomInput random(1);
    std::vector<float> pixels(size_t(kWidth) * kHeight * 3);
    for (float& value : pixels) value = float(random.uniform(0, 2));
    return pixels;
}

/// Arguments: shOrder, threads.
void project(benchmark::State& state) {
    const std::vector<float> pixels = randomPixels();
    const ScopedThreadCount threads(int(state.range(1)));
    for (auto _ : state)
        benchmark::DoNotOptimize(projectEnvironment({kWidth, kHeight, pixels}, int(state.range(0))));
}
BENCHMARK(project)->Args({6, 1})->Args({6, 2})->Args({10, 1})->Args({10, 2})->UseRealTime()->Unit(
    benchmark::kMillisecond);

void readPixels(benchmark::State& state) {
    const std::vector<float> pixels = randomPixels();
    for (auto _ : state) {
        float sums[16] = {};
        for (size_t i = 0; i < pixels.size(); i += 16)
            for (size_t k = 0; k < 16; ++k) sums[k] += pixels[i + k];
        benchmark::DoNotOptimize(sums);
    }
}
BENCHMARK(readPixels)->UseRealTime()->Unit(benchmark::kMillisecond);

/// Texel by texel, one row of the image.
void projectRowPlainly(benchmark::State& state) {
    const std::vector<float> pixels = randomPixels();
    std::vector<float> basis(100), sums(300);
    for (auto _ : state) {
        for (int x = 0; x < kWidth; ++x) {
            evalSh(10, latLongDirection(x + 0.5, 300.5, kWidth, kHeight).cast<float>(),
                   std::span<float>(basis));
            for (size_t c = 0; c < 3; ++c)
                for (size_t i = 0; i < 100; ++i) sums[c * 100 + i] += basis[i] * pixels[size_t(x) * 3 + c];
        }
        benchmark::DoNotOptimize(sums.data());
    }
}
BENCHMARK(projectRowPlainly)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace prt
