// The parts of the bake that have a contract of their own: sums of rows, order of points, dealing of
// directions.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "precompute/math/directions.h"
#include "precompute/visibility/accumulate.h"
#include "precompute/visibility/trace_blocks.h"

namespace prt {
namespace {

TEST(AddTableRows, SumsInTheOrderOfRows) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(-1, 1);
    for (size_t columns = 1; columns <= 100; ++columns) {
        const size_t stride = paddedColumns(columns);
        ASSERT_GE(stride, columns);
        ASSERT_LT(stride, columns + 4);
        std::vector<float> table(200 * stride);
        for (float& value : table) value = uniform(random);
        for (const size_t count : {0, 1, 7, 150}) {
            std::vector<uint16_t> rows(count);
            for (uint16_t& row : rows) row = uint16_t(random() % 200);
            std::vector<float> sum(stride, 0.5f);
            addTableRows(table.data(), stride, rows.data(), count, sum.data());
            for (size_t c = 0; c < stride; ++c) {
                float expected = 0;
                for (const uint16_t row : rows) expected += table[row * stride + c];
                EXPECT_EQ(sum[c], 0.5f + expected);  // to the bit
            }
        }
    }
}

TEST(MortonOrder, IsAPermutationOfNeighbours) {
    std::mt19937 random(2);
    std::uniform_real_distribution<float> uniform(-5, 5);
    std::vector<Vec3f> positions(20000);
    for (Vec3f& p : positions) p = {uniform(random), uniform(random), uniform(random)};
    positions[7] = positions[3];  // equal keys stay in order
    const std::vector<uint32_t> order = mortonOrder(positions);
    std::vector<uint32_t> sorted = order, all(positions.size());
    std::iota(all.begin(), all.end(), 0u);
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, all);
    double step = 0, given = 0;
    for (size_t i = 1; i < order.size(); ++i) {
        step += double((positions[order[i]] - positions[order[i - 1]]).norm());
        given += double((positions[i] - positions[i - 1]).norm());
    }
    EXPECT_LT(step, 0.1 * given);
    const auto place = [&](uint32_t v) { return std::find(order.begin(), order.end(), v) - order.begin(); };
    EXPECT_EQ(place(7), place(3) + 1);
    EXPECT_TRUE(mortonOrder({}).empty());
    EXPECT_EQ(mortonOrder(std::vector<Vec3f>(5, Vec3f(1, 1, 1))), (std::vector<uint32_t>{0, 1, 2, 3, 4}));
}

// Each sub-point gets its share of the directions, and those are spread over the sphere as evenly as all of
// them.
TEST(DealingOfDirections, SharesAreEvenOverTheSphere) {
    const int rays = 2048;
    const std::vector<Vec3f> directions = sphericalFibonacci(rays);
    const std::vector<SurfacePoint> points(9, SurfacePoint{{0, 0, 0}, {0, 1, 0}, 0});
    const std::vector<double> shares = {0.1, 0.3, 0.25, 0.35, 1.0, 0.2, 0.2, 0.2, 0.4};
    const std::vector<uint32_t> first = {0, 4, 5, 9};
    std::vector<uint32_t> shareEnd;
    for (size_t item = 0; item < 3; ++item) {
        double passed = 0;
        for (uint32_t p = first[item]; p < first[item + 1]; ++p)
            shareEnd.push_back(uint32_t(std::min((passed += shares[p]) * 4294967296.0, 4294967295.0)));
    }
    const BakeItems items{points, first, shareEnd};
    for (uint32_t item = 0; item < 3; ++item) {
        std::vector<int> count(9, 0);
        std::vector<Vec3d> sum(9, Vec3d::Zero());
        std::vector<std::array<int, 8>> octants(9, std::array<int, 8>{});
        for (int k = 0; k < rays; ++k) {
            const uint32_t point = subPointOfDirection(items, item, uint32_t(k));
            ASSERT_GE(point, first[item]);
            ASSERT_LT(point, first[item + 1]);
            const Vec3f& d = directions[size_t(k)];
            ++count[point];
            sum[point] += d.cast<double>();
            ++octants[point][size_t((d.x() > 0) + 2 * (d.y() > 0) + 4 * (d.z() > 0))];
        }
        for (uint32_t p = first[item]; p < first[item + 1]; ++p) {
            EXPECT_NEAR(count[p], shares[p] * rays, 4);
            // Random dealing would leave about 1/sqrt(count).
            EXPECT_LT((sum[p] / count[p]).norm(), 1.0 / std::sqrt(count[p]));
            for (const int octant : octants[p]) EXPECT_NEAR(octant, count[p] / 8.0, 3 + 0.1 * count[p] / 8.0);
        }
    }
}

}  // namespace
}  // namespace prt
