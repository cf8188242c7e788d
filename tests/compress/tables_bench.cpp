// Time from a projected environment to finished tables, one thread, cube of 32² texels a face, order 6, three
// colours. Counters: `ratio` to the straightforward implementation and `stores` to plain stores of as many
// bytes, both timed in turns with the builder in one run.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <vector>

#include "compress/tables/fast_tables.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

constexpr int kShOrder = 6, kSize = 32, kComponents = 16;

EnvironmentSh randomLight(int shOrder) {
    std::mt19937 random(1);
    std::normal_distribution<float> normal;
    EnvironmentSh light{shOrder, {}};
    for (std::vector<float>& colour : light.rgb)
        for (int i = 0; i < shCount(shOrder); ++i) colour.push_back(normal(random));
    return light;
}

std::vector<Vec3f> texelNormals(const TableLayout& layout) {
    std::vector<Vec3f> normals;
    for (int t = 0; t < layout.texelCount(); ++t) normals.push_back(layout.normal(t).cast<float>());
    return normals;
}

/// Times the builder as the benchmark, and now and then the reference and the stores.
template <typename Build, typename Reference>
void compare(benchmark::State& state, std::vector<float>& out, const Build& build,
             const Reference& reference) {
    const ScopedThreadCount one(1);
    const auto seconds = [](const auto& body) {
        const auto start = std::chrono::steady_clock::now();
        body();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    std::vector<double> fast, slow, stores;
    for (auto _ : state) {
        fast.push_back(seconds(build));
        state.SetIterationTime(fast.back());
        if (fast.size() % 8 == 0) slow.push_back(seconds(reference));
        stores.push_back(seconds([&] {
            std::fill(out.begin(), out.end(), float(fast.size()));
            benchmark::DoNotOptimize(out.data());
            benchmark::ClobberMemory();
        }));
    }
    const auto median = [](std::vector<double>& values) {
        if (values.empty()) return 0.0;
        std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
        return values[values.size() / 2];
    };
    const double time = median(fast);
    state.counters["median_ms"] = 1e3 * time;
    state.counters["bytes"] = double(out.size() * sizeof(float));
    state.counters["ratio"] = median(slow) / time;
    state.counters["stores"] = time / median(stores);
}

void lightCosine(benchmark::State& state, const std::string& layout) {
    LightTableBuilder builder(TableLayout(layout, kSize), kShOrder, int(state.range(0)));
    const EnvironmentSh light = randomLight(builder.environmentShOrder());
    const std::vector<Vec3f> normals = texelNormals(builder.layout());
    std::vector<float> out(size_t(3 * kShOrder * kShOrder) * builder.texelCount());
    compare(
        state, out, [&] { builder.buildLightCosine(light, out); },
        [&] {
            benchmark::DoNotOptimize(evalLightCosine(light, kShOrder, normals, builder.cosineBands()).data());
        });
}
BENCHMARK_CAPTURE(lightCosine, cube, "cube")
    ->Arg(kPaperCosineBands)
    ->Arg(kTableCosineBands)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lightCosine, dualParaboloid, "dual-paraboloid")
    ->Arg(kTableCosineBands)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lightCosine, octahedral, "octahedral")
    ->Arg(kTableCosineBands)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

void tripleProduct(benchmark::State& state) {
    LightTableBuilder builder(TableLayout("cube", kSize), kShOrder, int(state.range(0)));
    const EnvironmentSh light = randomLight(builder.environmentShOrder());
    const std::vector<Vec3f> normals = texelNormals(builder.layout());
    std::mt19937 random(2);
    std::normal_distribution<float> normal;
    std::vector<float> mean(size_t(kShOrder * kShOrder)), basis(mean.size() * kComponents);
    for (float& value : mean) value = normal(random);
    for (float& value : basis) value = normal(random);
    std::vector<float> out(3 * (kComponents + 1) * builder.texelCount());
    compare(
        state, out, [&] { builder.buildTripleProduct(light, mean, basis, out); },
        [&] {
            const std::vector<float> table = evalLightCosine(light, kShOrder, normals, builder.cosineBands());
            benchmark::DoNotOptimize(buildTripleProductTable(table, kShOrder, kSize, mean, basis).data());
        });
}
BENCHMARK(tripleProduct)
    ->Arg(kPaperCosineBands)
    ->Arg(kTableCosineBands)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace prt
