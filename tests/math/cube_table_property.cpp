// Functions tabulated in cube maps and looked up as the hardware does it: error by size, and seams.
#include <cmath>
#include <cstdio>

#include "precompute/math/directions.h"
#include "precompute/math/sh.h"
#include "precompute/math/sphere_map.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

constexpr int kSizes[] = {4, 8, 16, 32, 64};

/// Every SH function of the order at every texel: [6·size·size][n²].
std::vector<float> tabulate(int shOrder, int size) {
    std::vector<Vec3f> directions;
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) directions.push_back(cubeTexelDirection(face, x, y, size));
    std::vector<float> table(directions.size() * size_t(shCount(shOrder)));
    evalShBatch(shOrder, directions, table);
    return table;
}

void lookUp(const std::vector<float>& table, int shOrder, int size, const Vec3d& direction, float* out) {
    const size_t width = size_t(shCount(shOrder));
    std::fill(out, out + width, 0.0f);
    for (const CubeTap& tap : cubeSeamlessTaps(direction, size)) {
        const float* texel = table.data() + size_t((tap.face * size + tap.y) * size + tap.x) * width;
        for (size_t i = 0; i < width; ++i) out[i] += tap.weight * texel[i];
    }
}

class CubeTable : public testing::TestWithParam<int> {};

TEST_P(CubeTable, ErrorAtAMillionDirectionsFallsWithTheSize) {
    const int n = GetParam();
    const size_t width = size_t(shCount(n));
    const std::vector<Vec3f> directions = randomDirections(1'000'000, 2012);
    constexpr size_t kSizeCount = std::size(kSizes);
    std::vector<std::vector<float>> tables;
    for (const int size : kSizes) tables.push_back(tabulate(n, size));
    std::vector<double> squares(kSizeCount, 0.0), worst(kSizeCount, 0.0);
    std::vector<float> exact(1000 * width), value(width);
    for (size_t first = 0; first < directions.size(); first += 1000) {
        evalShBatch(n, std::span(directions).subspan(first, 1000), exact);
        for (size_t s = 0; s < kSizeCount; ++s)
            for (size_t k = 0; k < 1000; ++k) {
                lookUp(tables[s], n, kSizes[s], directions[first + k].cast<double>(), value.data());
                for (size_t i = 0; i < width; ++i) {
                    const double e = double(value[i]) - double(exact[k * width + i]);
                    squares[s] += e * e;
                    worst[s] = std::max(worst[s], std::abs(e));
                }
            }
    }
    std::vector<double> mse;
    for (size_t s = 0; s < kSizeCount; ++s) {
        mse.push_back(squares[s] / double(directions.size() * width));
        std::printf("cube table, order %d, %2d² x 6 = %5d samples: mse %.3g, largest error %.3g\n", n,
                    kSizes[s], 6 * kSizes[s] * kSizes[s], mse[s], worst[s]);
    }
    // Bilinear interpolation errs by h², squared h⁴; along edges and at corners, where the surface of the
    // cube is bent, by h on a strip of width h, squared h³, which shows at large sizes.
    for (size_t s = 1; s < kSizeCount; ++s) {
        const double exponent = std::log2(mse[s - 1] / mse[s]);
        EXPECT_GT(exponent, 3.5) << kSizes[s];
        EXPECT_LT(exponent, 4.2) << kSizes[s];
    }
    // the figure known for order 3 in 384 samples
    if (n == 3) {
        EXPECT_NEAR(mse[1], 2.4e-5, 0.1e-5);
    }
}

TEST_P(CubeTable, DoesNotJumpAcrossEdges) {
    const int n = GetParam();
    const size_t width = size_t(shCount(n));
    test::RandomInput random(91);
    std::vector<float> here(width), there(width);
    for (const int size : kSizes) {
        const std::vector<float> table = tabulate(n, size);
        double worst = 0;
        for (int k = 0; k < 20000; ++k) {
            const int free = k % 3, i = (free + 1) % 3, j = (free + 2) % 3;
            const double si = k & 8 ? 1 : -1, sj = k & 16 ? 1 : -1;
            Vec3d a, b;
            a[free] = b[free] = random.uniform(-1, 1);
            a[i] = si;
            a[j] = sj * (1 - 1e-7);
            b[i] = si * (1 - 1e-7);
            b[j] = sj;
            ASSERT_NE(cubePointFromDirection(a, size).face, cubePointFromDirection(b, size).face);
            lookUp(table, n, size, a, here.data());
            lookUp(table, n, size, b, there.data());
            for (size_t c = 0; c < width; ++c)
                worst = std::max(worst, std::abs(double(here[c]) - double(there[c])));
        }
        std::printf("cube table, order %d, size %2d: largest jump across an edge %.2g\n", n, size, worst);
        EXPECT_LT(worst, 1e-4) << size;
    }
}

INSTANTIATE_TEST_SUITE_P(Orders, CubeTable, testing::Values(3, 6));

}  // namespace
}  // namespace prt
