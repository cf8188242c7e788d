// PCA of 262,144 rows of 36 coefficients to 16 vectors, one thread. Counters: `median_ms`, and `copies`, the
// ratio to a copy of as many bytes as are read and written, both timed in turns in one run.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <vector>

#include "compress/leading_vectors.h"
#include "compress/pca.h"
#include "precompute/base/parallel.h"

namespace prt {
namespace {

constexpr int kDimension = 36, kComponents = 16;
constexpr size_t kRows = 262144;

// Falling deviations about a mean, mixed by sums of neighbours so that axes are not the vectors.
std::vector<float> randomRows(size_t rows, int dimension) {
    std::mt19937 random(1);
    std::normal_distribution<float> normal;
    std::vector<float> values(rows * size_t(dimension));
    for (size_t i = 0; i < rows; ++i) {
        float before = 0;
        for (size_t k = 0; k < size_t(dimension); ++k) {
            const float value = normal(random) / float(k + 1);
            values[i * size_t(dimension) + k] = value + 0.5f * before + 0.3f;
            before = value;
        }
    }
    return values;
}

/// Times the body as the benchmark, and copies of as many bytes in turns with it.
template <typename Body>
void compare(benchmark::State& state, size_t readBytes, size_t writtenBytes, const Body& body) {
    const ScopedThreadCount one(1);
    // Of this thread, so that others on the machine matter less.
    const auto seconds = [](const auto& run) {
        const auto now = [] {
            timespec time{};
            ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
            return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
        };
        const double start = now();
        run();
        return now() - start;
    };
    // A copy reads and writes one byte each per byte.
    const size_t copied = (readBytes + writtenBytes) / 2;
    std::vector<char> from(copied, 1), to(copied, 2);
    std::vector<double> times, copies;
    for (auto _ : state) {
        times.push_back(seconds(body));
        state.SetIterationTime(times.back());
        copies.push_back(seconds([&] {
            std::memcpy(to.data(), from.data(), copied);
            benchmark::DoNotOptimize(to.data());
            benchmark::ClobberMemory();
        }));
    }
    const auto median = [](std::vector<double>& values) {
        if (values.empty()) return 0.0;
        std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
        return values[values.size() / 2];
    };
    const double time = median(times);
    state.counters["median_ms"] = 1e3 * time;
    state.counters["copies"] = time / median(copies);
}

void solve(benchmark::State& state) {
    const int dimension = int(state.range(0));
    const std::vector<float> rows = randomRows(size_t(state.range(1)), dimension);
    compare(state, rows.size() * sizeof(float), 0,
            [&] { benchmark::DoNotOptimize(computePca(rows, {}, dimension, kComponents).basis.data()); });
}
BENCHMARK(solve)
    ->Args({kDimension, kRows})
    ->Args({100, 65536})
    ->Args({400, 16384})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

// The same vectors without a covariance: products of the centred rows with a vector and back.
void solveByProducts(benchmark::State& state) {
    const int dimension = int(state.range(0));
    const size_t d = size_t(dimension);
    std::vector<float> rows = randomRows(size_t(state.range(1)), dimension);
    const PcaResult pca = computePca(rows, {}, dimension, 1);
    for (size_t i = 0; i < rows.size(); ++i) rows[i] -= pca.mean[i % d];
    const size_t count = rows.size() / d;
    const auto product = [&](std::span<const double> x, std::span<double> y) {
        std::fill(y.begin(), y.end(), 0.0);
        std::vector<float> in(x.begin(), x.end()), out(d);
        for (size_t block = 0; block < count; block += 1024) {
            std::fill(out.begin(), out.end(), 0.0f);
            for (size_t i = block; i < std::min(count, block + 1024); ++i) {
                const float* row = &rows[i * d];
                float partial[8] = {};
                size_t k = 0;
                for (; k + 8 <= d; k += 8)
                    for (size_t lane = 0; lane < 8; ++lane) partial[lane] += row[k + lane] * in[k + lane];
                float dot = 0;
                for (; k < d; ++k) dot += row[k] * in[k];
                for (const float one : partial) dot += one;
                for (k = 0; k < d; ++k) out[k] += dot * row[k];
            }
            for (size_t k = 0; k < d; ++k) y[k] += double(out[k]) / double(count);
        }
    };
    compare(state, rows.size() * sizeof(float), 0, [&] {
        benchmark::DoNotOptimize(
            leadingVectors(product, pca.totalVariance, dimension, kComponents).vectors.data());
    });
}
BENCHMARK(solveByProducts)
    ->Args({kDimension, kRows})
    ->Args({100, 65536})
    ->Args({400, 16384})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

void project(benchmark::State& state) {
    const std::vector<float> rows = randomRows(kRows, kDimension);
    const PcaResult pca = computePca(rows, {}, kDimension, kComponents);
    std::vector<float> weights(kRows * kComponents);
    compare(state, rows.size() * sizeof(float), weights.size() * sizeof(float), [&] {
        projectPca(pca, rows, kDimension, weights);
        benchmark::DoNotOptimize(weights.data());
        benchmark::ClobberMemory();
    });
}
BENCHMARK(project)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace prt
