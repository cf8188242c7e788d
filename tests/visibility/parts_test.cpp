// The parts of the bake that have a contract of their own: sums of rows, order of points, dealing of
// directions.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "precompute/math/directions.h"
#include "precompute/math/irradiance_projection.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/accumulate.h"
#include "precompute/visibility/trace_blocks.h"
#include "tests/rays/shapes.h"

namespace prt {
namespace {

TEST(AddTableRows, SumsInTheOrderOfRows) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(-1, 1);
    for (size_t columns = 1; columns <= 100; ++columns) {
        const size_t stride = paddedColumns(columns);
        ASSERT_GE(stride, columns);
        ASSERT_LT(stride, columns + 16);
        ASSERT_EQ(stride % 16, 0u);
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

TEST(AddWeightedTableRows, MultipliesAndAddsWithoutFusing) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-1, 1);
    for (size_t columns = 1; columns <= 100; columns += 3) {
        const size_t stride = paddedColumns(columns);
        std::vector<float> table(200 * stride);
        for (float& value : table) value = uniform(random);
        for (const size_t count : {0, 1, 7, 150}) {
            std::vector<uint16_t> rows(count);
            std::vector<float> weights(count);
            for (uint16_t& row : rows) row = uint16_t(random() % 200);
            for (float& weight : weights) weight = uniform(random);
            std::vector<float> sum(stride, 0.5f);
            addWeightedTableRows(table.data(), stride, rows.data(), weights.data(), count, sum.data());
            for (size_t c = 0; c < stride; ++c) {
                float expected = 0;
                for (size_t j = 0; j < count; ++j) {
                    const volatile float product = weights[j] * table[rows[j] * stride + c];
                    expected += product;
                }
                EXPECT_EQ(sum[c], 0.5f + expected);  // to the bit
            }
        }
    }
}

TEST(WeighRows, InterpolatesTheTableAtTheCosine) {
    const std::vector<Vec3f> directions = sphericalFibonacci(500);
    std::vector<float> x, y, z;
    for (const Vec3f& d : directions) {
        x.push_back(d.x());
        y.push_back(d.y());
        z.push_back(d.z());
    }
    std::vector<uint16_t> rows(directions.size());
    std::iota(rows.begin(), rows.end(), uint16_t(0));
    std::reverse(rows.begin(), rows.end());
    const CosineTable square(1024, [](double c) { return c * c; });
    std::vector<float> cosines(rows.size() + 12), weights(rows.size());  // a multiple of 16
    // The last two are directions of the set: cosines of ±1, or beyond by rounding.
    for (const Vec3f& normal :
         {Vec3f(0, 0, 1), Vec3f(0.6f, -0.48f, 0.64f), directions[17], Vec3f(-directions[17])}) {
        const std::array<CosineSum, 2> open =
            cosinesAbout({x.data(), y.data(), z.data()}, x.size(), normal.data(), cosines.data());
        weighRows(square, cosines.data(), rows.data(), rows.size(), weights.data());
        std::array<double, 2> sums{};
        double ofRows = 0;
        for (size_t k = 0; k < x.size(); ++k) sums[k % 2] += std::max(0.0, double(normal.dot(directions[k])));
        for (size_t half = 0; half < 2; ++half) EXPECT_NEAR(open[half].sum, sums[half], 1e-4);
        for (size_t j = 0; j < 99; ++j) ofRows += std::max(0.0, double(normal.dot(directions[rows[j]])));
        EXPECT_NEAR(sumOfCosines(cosines.data(), rows.data(), 99).sum, ofRows, 1e-4);
        const CosineSum all = sumOfCosines(cosines.data(), rows.data(), rows.size());
        EXPECT_EQ(all.positive, open[0].positive + open[1].positive);
        EXPECT_EQ(seenShare(all, open[0] + open[1]), 1.0f);
        EXPECT_LT(seenShare(sumOfCosines(cosines.data(), &rows[200], 100), open[0] + open[1]), 0.9f);
        for (size_t j = 0; j < rows.size(); ++j) {
            const double cosine = normal.cast<double>().dot(directions[rows[j]].cast<double>());
            EXPECT_NEAR(cosines[rows[j]], cosine, 2e-7);
            EXPECT_LE(std::abs(cosines[rows[j]]), 1);
            EXPECT_NEAR(weights[j], cosine * cosine, 2e-6);
        }
    }
}

// An item whose parts face three ways: the weight and the constraint are about the item's own normal, each
// part keeps its own horizon.
TEST(BakeItems, PartsOfSeveralNormalsAreWeightedAboutTheItems) {
    const shapes::Mesh box = shapes::box({-1, -1, -1}, {1, 1, 1});
    const RayCaster caster(box.positions, box.indices);
    std::vector<SurfacePoint> points;
    for (uint32_t t = 0; t < 12; ++t)
        if (box.normal(t).minCoeff() > -0.5f && t % 2 == 0)
            points.push_back({box.point(t, 0.3, 0.3), box.normal(t), t});
    ASSERT_EQ(points.size(), 3u);
    const std::vector<uint32_t> first = {0, 3}, shareEnd = {0x55000000u, 0xaa000000u, 0xffffffffu};
    const std::vector<Vec3f> normals = {Vec3f(1, 1, 1).normalized()};
    BakeItems items;
    items.points = points;
    items.firstPoint = first;
    items.shareEnd = shareEnd;
    items.normals = normals;
    BakeOptions options;
    options.rays = 900;
    const std::vector<Vec3f> directions = sphericalFibonacci(options.rays);
    for (const int shOrder : {1, 3, 6}) {
        options.shOrder = shOrder;
        const BakeResult result = bakeItems(caster, items, options, "items");
        const size_t columns = size_t(shCount(shOrder));
        std::vector<double> sum(columns, 0.0), basis(columns);
        double seen = 0, above = 0;
        for (uint32_t k = 0; k < directions.size(); ++k) {
            const double cosine = double(normals[0].dot(directions[k]));
            if (!(points[subPointOfDirection(items, 0, k)].normal.dot(directions[k]) > 0)) continue;
            above += std::max(0.0, cosine);
            seen += std::max(0.0, cosine);
            evalSh(shOrder, directions[k].cast<double>(), basis);
            for (size_t c = 0; c < columns; ++c)
                sum[c] += irradianceWeight(cosine) * basis[c] * 4 * std::numbers::pi / options.rays;
        }
        const std::vector<float> b(sum.begin(), sum.end());
        std::vector<float> expected(columns);
        IrradianceProjection(shOrder).solve(
            normals[0], b, float(std::numbers::pi * 0.5 * (1 + 1 / std::sqrt(3.0)) * seen / above), expected);
        for (size_t c = 0; c < columns; ++c) EXPECT_NEAR(result.coefficients[c], expected[c], 2e-3) << c;
        EXPECT_EQ(result.ao[0], 1.0f);
        EXPECT_NEAR(items.openShare(0), 0.5 * (1 + 1 / std::sqrt(3.0)), 1e-6);
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
        ShareEnds ends(1);
        for (uint32_t p = first[item]; p < first[item + 1]; ++p) shareEnd.push_back(ends.next(shares[p]));
    }
    const BakeItems items{points, first, shareEnd, {}, {}, {}};
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
            EXPECT_NEAR(count[p], shares[p] * rays, 4 + rays / 256.0);  // shares are kept in steps of 1/256
            // Random dealing would leave about 1/sqrt(count).
            EXPECT_LT((sum[p] / count[p]).norm(), 1.0 / std::sqrt(count[p]));
            for (const int octant : octants[p]) EXPECT_NEAR(octant, count[p] / 8.0, 3 + 0.1 * count[p] / 8.0);
        }
    }
}

}  // namespace
}  // namespace prt
