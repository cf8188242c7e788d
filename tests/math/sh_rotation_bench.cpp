// Time per rotation of every method, n = 3…10. Single rotations take another matrix each time; batches fit
// the second-level cache.
#include <benchmark/benchmark.h>

#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation.h"
#include "precompute/math/sh_rotation_matrix.h"
#include "precompute/math/sh_rotation_soa.h"
#include "precompute/math/sh_rotation_taylor.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

// In the first cache with 10 bands or few more; rows that share no sets of it.
constexpr size_t kBatch = 64, kStride = 80;
constexpr size_t kRotations = 1024;

/// Rotations with β up to maxBeta, their matrices as a structure of arrays, and vectors to turn.
struct Input {
    int shOrder;
    std::vector<Mat3d> rotations;
    std::vector<float> soaRotations, vectors, turned;

    explicit Input(const benchmark::State& state, double maxBeta = 3)
        : shOrder(int(state.range(0))), soaRotations(9 * kStride) {
        test::RandomInput random(91);
        for (size_t k = 0; k < kRotations; ++k)
            rotations.push_back(
                rotationFromZyz({random.uniform(-3, 3), random.uniform(0, maxBeta), random.uniform(-3, 3)}));
        for (size_t k = 0; k < kBatch; ++k)
            for (size_t i = 0; i < 9; ++i)
                soaRotations[i * kStride + k] = float(rotations[k](Eigen::Index(i / 3), Eigen::Index(i % 3)));
        vectors = random.coefficients<float>(shCount(shOrder) * int(kStride));
        turned = vectors;
    }
    std::span<const float> in() const {
        return std::span<const float>(vectors).first(size_t(shCount(shOrder)));
    }
    std::span<float> out() { return std::span<float>(turned).first(size_t(shCount(shOrder))); }
};

void countNanoseconds(benchmark::State& state, size_t perIteration) {
    state.counters["ns"] =
        benchmark::Counter(double(perIteration) * 1e-9,
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

template <typename Function>
void timeSingle(benchmark::State& state, const Input& input, const Function& function) {
    size_t k = 0;
    for (auto _ : state) {
        function(input.rotations[k]);
        k = (k + 1) % kRotations;
        benchmark::ClobberMemory();
    }
    countNanoseconds(state, 1);
}

template <typename Function>
void timeBatch(benchmark::State& state, const Function& function) {
    for (auto _ : state) {
        function();
        benchmark::ClobberMemory();
    }
    countNanoseconds(state, kBatch);
}

void zxzxz(benchmark::State& state) {
    Input input(state);
    timeSingle(state, input, [&](const Mat3d& r) { rotateSh(r, input.shOrder, input.in(), input.out()); });
}
void taylor(benchmark::State& state, ShTaylorOrder order) {
    Input input(state, 0.2);
    timeSingle(state, input,
               [&](const Mat3d& r) { rotateShTaylor(r, order, input.shOrder, input.in(), input.out()); });
}
void ivanic(benchmark::State& state) {
    Input input(state);
    timeSingle(state, input,
               [&](const Mat3d& r) { ShRotationMatrix(r, input.shOrder).apply(input.in(), input.out()); });
}
void ivanicApply(benchmark::State& state) {
    Input input(state);
    const ShRotationMatrix matrix(input.rotations[0], input.shOrder);
    timeSingle(state, input, [&](const Mat3d&) { matrix.apply(input.in(), input.out()); });
}
void zxzxzSoa(benchmark::State& state) {
    Input input(state);
    timeBatch(state, [&] {
        rotateShSoa(input.soaRotations, input.shOrder, kBatch, kStride, input.vectors, input.turned);
    });
}
void zxzxzSoaOneRotation(benchmark::State& state) {
    Input input(state);
    timeBatch(state, [&] {
        rotateShSoa(input.rotations[0], input.shOrder, kBatch, kStride, input.vectors, input.turned);
    });
}
void matrixSoaOneRotation(benchmark::State& state) {
    Input input(state);
    const ShRotationMatrix matrix(input.rotations[0], input.shOrder);
    timeBatch(state, [&] { matrix.applySoa(kBatch, kStride, input.vectors, input.turned); });
}
void taylorSoa(benchmark::State& state, ShTaylorOrder order) {
    Input input(state, 0.2);
    timeBatch(state, [&] {
        rotateShTaylorSoa(input.soaRotations, order, input.shOrder, kBatch, kStride, input.vectors,
                          input.turned);
    });
}

BENCHMARK(zxzxz)->DenseRange(3, 10);
BENCHMARK(zxzxzSoa)->DenseRange(3, 10);
BENCHMARK(zxzxzSoaOneRotation)->DenseRange(3, 10);
BENCHMARK(matrixSoaOneRotation)->DenseRange(3, 10);
BENCHMARK_CAPTURE(taylor, 1, ShTaylorOrder::One)->DenseRange(3, 10);
BENCHMARK_CAPTURE(taylor, 1.5, ShTaylorOrder::OneAndHalf)->DenseRange(3, 10);
BENCHMARK_CAPTURE(taylor, 2, ShTaylorOrder::Two)->DenseRange(3, 10);
BENCHMARK_CAPTURE(taylorSoa, 1, ShTaylorOrder::One)->DenseRange(3, 10);
BENCHMARK_CAPTURE(taylorSoa, 1.5, ShTaylorOrder::OneAndHalf)->DenseRange(3, 10);
BENCHMARK_CAPTURE(taylorSoa, 2, ShTaylorOrder::Two)->DenseRange(3, 10);
BENCHMARK(ivanic)->DenseRange(3, 10);
BENCHMARK(ivanicApply)->DenseRange(3, 10);

}  // namespace
}  // namespace prt
