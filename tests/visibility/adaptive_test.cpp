// Adaptive bakes against a slow one that treats every point and direction by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "precompute/math/irradiance_norm.h"
#include "precompute/math/irradiance_projection.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/bake.h"
#include "precompute/visibility/block_projection.h"
#include "precompute/visibility/direction_levels.h"
#include "precompute/visibility/level_masks.h"
#include "precompute/visibility/orientations.h"
#include "precompute/visibility/trace_blocks.h"
#include "tests/rays/shapes.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<uint64_t> randomWords(size_t count) {
    std::mt19937_64 random(5);
    std::vector<uint64_t> words = {0, ~uint64_t(0), 1, uint64_t(1) << 63};
    while (words.size() < count) words.push_back(random() & (words.size() % 2 ? random() : ~uint64_t(0)));
    return words;
}

TEST(BitCompressor, KeepsChosenBitsInOrder) {
    const std::vector<uint64_t> words = randomWords(60);
    for (const uint64_t chosen : words) {
        const BitCompressor compressor(chosen);
        EXPECT_EQ(compressor.count(), std::popcount(chosen));
        for (const uint64_t word : words) {
            uint64_t expected = 0;
            for (int bit = 0, place = 0; bit < 64; ++bit)
                if (chosen >> bit & 1) expected |= (word >> bit & 1) << place++;
            ASSERT_EQ(compressor(word), expected);
        }
    }
}

TEST(TransposeBits, SwapsWordsAndBits) {
    const std::vector<uint64_t> random = randomWords(64);
    std::array<uint64_t, 64> words;
    std::copy(random.begin(), random.end(), words.begin());
    std::array<uint64_t, 64> turned = words;
    transposeBits(turned);
    for (size_t i = 0; i < 64; ++i)
        for (size_t j = 0; j < 64; ++j) EXPECT_EQ(turned[j] >> i & 1, words[i] >> j & 1);
    transposeBits(turned);
    EXPECT_EQ(turned, words);
}

TEST(MaskGather, PutsChosenPointsOfSeveralBlocksInARow) {
    std::mt19937_64 random(9);
    constexpr size_t kDirections = 5;
    std::vector<LevelMasks> blocks(4);
    std::vector<PointMask> chosen(4);
    for (size_t b = 0; b < blocks.size(); ++b) {
        for (auto* answers : {&blocks[b].above, &blocks[b].visible}) {
            answers->resize(kDirections);
            for (PointMask& mask : *answers)
                for (uint64_t& word : mask.words) word = random();
        }
        while (chosen[b].count() < 64) chosen[b].set(random() % kMostBlockPoints);
    }
    MaskGather gather;
    for (size_t b = 0; b < blocks.size(); ++b) gather.add(blocks[b], chosen[b]);
    const LevelMasks together = gather.gather();
    for (size_t k = 0; k < kDirections; ++k) {
        size_t place = 0;
        for (size_t b = 0; b < blocks.size(); ++b)
            chosen[b].forEach([&](size_t i) {
                EXPECT_EQ(together.above[k].test(place), blocks[b].above[k].test(i));
                EXPECT_EQ(together.visible[k].test(place), blocks[b].visible[k].test(i));
                ++place;
            });
        EXPECT_EQ(place, kMostBlockPoints);
    }
}

template <size_t K>
std::vector<uint32_t> slowNearest(const std::vector<Vec3f>& set, const Vec3f& direction, uint32_t skip) {
    std::vector<uint32_t> order(set.size());
    for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::erase(order, skip);
    std::partial_sort(order.begin(), order.begin() + K, order.end(), [&](uint32_t a, uint32_t b) {
        const float cosineA = set[a].dot(direction), cosineB = set[b].dot(direction);
        return cosineA != cosineB ? cosineA > cosineB : a < b;
    });
    order.resize(K);
    return order;
}

TEST(NearestDirections, AreThoseOfAnExhaustiveSearch) {
    const std::vector<Vec3f> fine = sphericalFibonacci(1024);
    for (const int size : {16, 64, 256, 1024}) {
        const std::vector<Vec3f> set = sphericalFibonacci(size);
        for (uint32_t k = 0; k < fine.size(); k += 3) {
            const auto near = nearestDirections<4>(set, fine[k], UINT32_MAX);
            EXPECT_EQ(std::vector<uint32_t>(near.begin(), near.end()),
                      slowNearest<4>(set, fine[k], UINT32_MAX));
            if (size != 1024) continue;
            const auto others = nearestDirections<6>(set, fine[k], k);
            EXPECT_EQ(std::vector<uint32_t>(others.begin(), others.end()), slowNearest<6>(set, fine[k], k));
        }
    }
}

TEST(DirectionLevels, AreAuditedWhereTheFirstSetIsSparse) {
    const DirectionLevels levels({kAdaptiveSets.begin(), kAdaptiveSets.end()}, 2);
    ASSERT_EQ(levels.count(), 4u);
    EXPECT_TRUE(levels[0].near.empty());
    for (size_t level = 1; level < 4; ++level) {
        EXPECT_EQ(levels[level].auditStep, level == 3 ? 16u : 0u);
        EXPECT_EQ(levels[level].near.size(), size_t(kAdaptiveSets[level]));
        EXPECT_EQ(levels[level].coarser.size(), size_t(kAdaptiveSets[level]));
    }
}

// One point, one ray at a time.
struct SlowBake {
    const RayCaster& caster;
    int shOrder;
    double error;
    IrradianceProjection projection{shOrder};
    IrradianceNorm norm{shOrder};

    struct Answer {
        bool above, visible, traced;
    };
    struct Result {
        std::vector<float> coefficients;
        double error = 0, nearestDecision = 1e9;
        uint64_t rays = 0;
    };

    bool traced(const SurfacePoint& point, const Vec3f& direction) const {
        uint8_t blocked = 0;
        caster.occluded(caster.offsetOrigin(point.position, point.normal), std::span(&direction, 1),
                        std::span(&blocked, 1));
        return !blocked;
    }

    std::vector<float> expansion(const SurfacePoint& point, const std::vector<Vec3f>& directions,
                                 const std::vector<Answer>& answers, size_t step) const {
        const size_t columns = size_t(shCount(shOrder));
        std::vector<double> sum(columns, 0.0), basis(columns);
        double seen = 0, open = 0;
        for (size_t k = 0; k < directions.size(); k += step) {
            const double cosine = point.normal.cast<double>().dot(directions[k].cast<double>());
            open += std::max(0.0, cosine);
            if (!answers[k].visible) continue;
            seen += std::max(0.0, cosine);
            evalSh(shOrder, directions[k].cast<double>(), basis);
            for (size_t c = 0; c < columns; ++c)
                sum[c] +=
                    irradianceWeight(cosine) * basis[c] * 4 * kPi * double(step) / double(directions.size());
        }
        const std::vector<float> b(sum.begin(), sum.end());
        std::vector<float> out(columns);
        projection.solve(point.normal, b, float(kPi * seen / open), out);
        return out;
    }
    double distance(const SurfacePoint& point, const std::vector<float>& a,
                    const std::vector<float>& b) const {
        std::vector<float> difference(a.size());
        for (size_t c = 0; c < a.size(); ++c) difference[c] = a[c] - b[c];
        return norm.evaluate(point.normal, difference);
    }

    void refine(const SurfacePoint& point, const std::vector<Vec3f>& coarse,
                const std::vector<Answer>& before, const std::vector<Vec3f>& fine, bool audit,
                std::vector<Answer>& answers, uint64_t& rays) const {
        for (size_t k = 0; k < fine.size(); ++k) {
            Answer& answer = answers[k];
            answer.above = point.normal.x() * fine[k].x() + point.normal.y() * fine[k].y() +
                               point.normal.z() * fine[k].z() >
                           0;
            if (!answer.above) continue;
            int open = 0, closed = 0;
            for (const uint32_t q : slowNearest<4>(coarse, fine[k], UINT32_MAX)) {
                open += before[q].above && before[q].visible;
                closed += before[q].above && !before[q].visible;
            }
            answer.visible = open > 0;
            answer.traced = (open > 0) == (closed > 0) || (audit && k % 16 == 8);
            if (answer.traced) answer.visible = traced(point, fine[k]);
            rays += answer.traced;
        }
        for (int round = 0; round < 4; ++round)
            for (uint32_t step = 0; step < fine.size(); ++step) {
                const uint32_t k = round % 2 == 0 ? step : uint32_t(fine.size()) - 1 - step;
                if (!answers[k].above || answers[k].traced) continue;
                bool doubt = false;
                for (const uint32_t q : slowNearest<6>(fine, fine[k], k))
                    doubt |= answers[q].traced && answers[q].visible != answers[k].visible;
                if (!doubt) continue;
                answers[k].traced = true;
                answers[k].visible = traced(point, fine[k]);
                ++rays;
            }
    }

    Result bake(const SurfacePoint& point, const std::vector<int>& sizes) const {
        Result result;
        std::vector<Vec3f> before;
        std::vector<Answer> answersBefore;
        for (size_t level = 0; level < sizes.size(); ++level) {
            const std::vector<Vec3f> directions = sphericalFibonacci(sizes[level]);
            std::vector<Answer> answers(directions.size(), Answer{});
            if (level == 0)
                for (size_t k = 0; k < directions.size(); ++k) {
                    answers[k].above = point.normal.dot(directions[k]) > 0;
                    answers[k].visible = answers[k].above && traced(point, directions[k]);
                    result.rays += answers[k].above;
                }
            else
                refine(point, before, answersBefore, directions, sizes[level] > 16 * sizes[0], answers,
                       result.rays);
            const std::vector<float> c = expansion(point, directions, answers, 1);
            result.error = kHalfSetShare * distance(point, c, expansion(point, directions, answers, 2));
            if (level > 0)
                result.error =
                    std::max(result.error, kCoarserSetShare * distance(point, c, result.coefficients));
            result.coefficients = c;
            if (level + 1 == sizes.size()) break;
            result.nearestDecision = std::min(result.nearestDecision, std::abs(result.error / error - 1));
            if (result.error <= error) break;
            before = directions;
            answersBefore = answers;
        }
        return result;
    }
};

// A floor with boxes, and a pole that from most points is thinner than the first set's spacing.
shapes::Mesh clutter(bool withPole = true) {
    shapes::Mesh mesh = shapes::floorSquare(3);
    mesh.add(shapes::box({-1, 0.01f, -1}, {-0.4f, 0.9f, -0.3f}));
    mesh.add(shapes::box({0.3f, 0.01f, 0.2f}, {0.5f, 1.7f, 0.4f}));
    if (withPole) mesh.add(shapes::box({-0.2f, 0.01f, 0.9f}, {-0.15f, 2, 0.95f}));
    return mesh;
}

std::vector<SurfacePoint> floorPoints(int side) {
    std::vector<SurfacePoint> points;
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j)
            points.push_back(
                {{3 * (float(i) + 0.5f) / float(side) - 1.5f, 0, 3 * (float(j) + 0.5f) / float(side) - 1.5f},
                 {0, 1, 0},
                 0});
    return points;
}

BakeResult bakeAdaptive(const shapes::Mesh& mesh, std::span<const SurfacePoint> points, double error,
                        int finestSet = 16384, int blockPoints = 256) {
    const RayCaster caster(mesh.positions, mesh.indices);
    BakeOptions options;
    options.shOrder = 4;
    options.error = error;
    options.finestSet = finestSet;
    options.blockPoints = blockPoints;
    options.findInside = false;
    return bakeVisibility(caster, points, options);
}

TEST(AdaptiveBake, IsTheSlowOnePointByPoint) {
    const shapes::Mesh mesh = clutter();
    const RayCaster caster(mesh.positions, mesh.indices);
    const std::vector<SurfacePoint> points = floorPoints(4);
    const double error = 0.006;
    const SlowBake slow{caster, 4, error};
    const BakeResult fast = bakeAdaptive(mesh, points, error, 4096);
    uint64_t rays = 0;
    size_t compared = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        const SlowBake::Result one = slow.bake(points[i], {256, 1024, 4096});
        rays += one.rays;
        if (one.nearestDecision < 1e-3) continue;  // rounding decides where it stops
        ++compared;
        EXPECT_NEAR(fast.error[i], one.error, 2e-4 * one.error + 1e-6) << i;
        for (size_t c = 0; c < 16; ++c)
            EXPECT_NEAR(fast.coefficients[i * 16 + c], one.coefficients[c], 1e-3)
                << i;  // the weight is tabulated
    }
    EXPECT_EQ(compared, points.size());
    EXPECT_EQ(fast.rays, rays);
}

TEST(AdaptiveBake, BitsDoNotDependOnThreadsBlocksOrOtherPoints) {
    const shapes::Mesh mesh = clutter();
    const std::vector<SurfacePoint> points = floorPoints(40);
    setThreadCount(1);
    const BakeResult one = bakeAdaptive(mesh, points, 0.003);
    setThreadCount(2);
    const BakeResult two = bakeAdaptive(mesh, points, 0.003);
    setThreadCount(0);
    EXPECT_EQ(one.coefficients, two.coefficients);
    EXPECT_EQ(one.error, two.error);
    EXPECT_EQ(one.rays, two.rays);
    for (const int block : {64, 128, 192}) {
        const BakeResult other = bakeAdaptive(mesh, points, 0.003, 16384, block);
        EXPECT_EQ(one.coefficients, other.coefficients) << block;
        EXPECT_EQ(one.ao, other.ao) << block;
        EXPECT_EQ(one.error, other.error) << block;
        EXPECT_EQ(one.rays, other.rays) << block;
    }
    std::vector<SurfacePoint> some;
    for (size_t i = 0; i < points.size(); i += 41) some.push_back(points[i]);
    const BakeResult alone = bakeAdaptive(mesh, some, 0.003);
    for (size_t i = 0; i < some.size(); ++i) EXPECT_EQ(alone.error[i], one.error[41 * i]);
}

// The estimate against the same estimator with many directions.
TEST(AdaptiveBake, ErrorsAreWhatWasAskedForAndKnown) {
    const shapes::Mesh mesh = clutter(false);
    const RayCaster caster(mesh.positions, mesh.indices);
    const std::vector<SurfacePoint> points = floorPoints(16);
    BakeOptions options;
    options.shOrder = 4;
    options.rays = 60000;
    const BakeResult truth = bakeVisibility(caster, points, options);
    const IrradianceNorm norm(4);
    const auto trueError = [&](const BakeResult& bake, size_t i) {
        std::vector<float> difference(16);
        for (size_t c = 0; c < 16; ++c)
            difference[c] = bake.coefficients[i * 16 + c] - truth.coefficients[i * 16 + c];
        return norm.evaluate(points[i].normal, difference);
    };
    const auto judge = [&](const BakeResult& bake, double asked) {
        double sum = 0, estimated = 0;
        size_t below = 0, covered = 0;
        for (size_t i = 0; i < points.size(); ++i) {
            const double error = trueError(bake, i);
            sum += error * error;
            estimated += double(bake.error[i]) * double(bake.error[i]);
            below += error <= asked;
            covered += error <= 2 * double(bake.error[i]);
        }
        const double count = double(points.size());
        EXPECT_GT(double(below), 0.9 * count) << asked;
        EXPECT_GT(double(covered), 0.85 * count) << asked;
        EXPECT_GT(estimated, 0.4 * sum) << asked;
        EXPECT_LT(estimated, 4 * sum) << asked;
        return std::sqrt(sum / count);
    };
    options.rays = 1024;
    const BakeResult uniform = bakeVisibility(caster, points, options);
    const double uniformError = judge(uniform, 1);
    uint64_t before = 0;
    for (const double asked : {0.02, 0.01, 0.005}) {
        options.error = asked;
        const BakeResult adaptive = bakeVisibility(caster, points, options);
        const double error = judge(adaptive, asked);
        EXPECT_LT(error, asked);
        EXPECT_GE(adaptive.rays, before);
        before = adaptive.rays;
        // The error of 1024 directions for all, for fewer rays.
        if (asked == 0.01) {
            EXPECT_LT(error, 1.1 * uniformError);
            EXPECT_LT(double(adaptive.rays), 0.65 * double(uniform.rays));
        }
    }
}

// Every orientation is the same bake in a scene turned the other way, with another sample of directions.
TEST(Orientations, AreRotationsAndBakeTheSame) {
    const shapes::Mesh mesh = clutter(false);
    const RayCaster caster(mesh.positions, mesh.indices);
    const std::vector<SurfacePoint> points = floorPoints(12);
    BakeOptions options;
    options.shOrder = 5;
    options.rays = 3000;
    std::vector<BakeResult> bakes;
    for (size_t o = 0; o < kOrientations; ++o) {
        const Mat3d& rotation = setOrientations()[o];
        EXPECT_LT((rotation * rotation.transpose() - Mat3d::Identity()).norm(), 1e-12);
        EXPECT_NEAR(rotation.determinant(), 1, 1e-12);
        const std::vector<uint8_t> orientations(points.size(), uint8_t(o));
        BakeItems items;
        items.points = points;
        items.orientations = orientations;
        bakes.push_back(bakeItems(caster, items, options, "points"));
    }
    EXPECT_EQ(bakes[0].coefficients, bakeVisibility(caster, points, options).coefficients);
    const IrradianceNorm norm(5);
    for (size_t o = 1; o < kOrientations; ++o) {
        double sum = 0, estimated = 0;
        for (size_t i = 0; i < points.size(); ++i) {
            std::vector<float> difference(25);
            for (size_t c = 0; c < 25; ++c)
                difference[c] = bakes[o].coefficients[25 * i + c] - bakes[0].coefficients[25 * i + c];
            sum += std::pow(norm.evaluate(points[i].normal, difference), 2);
            estimated += std::pow(double(bakes[o].error[i]), 2) + std::pow(double(bakes[0].error[i]), 2);
        }
        EXPECT_GT(sum, 0.2 * estimated) << o;
        EXPECT_LT(sum, 3 * estimated) << o;
    }
}

TEST(Orientations, AreDealtEvenly) {
    for (uint32_t y = 0; y < 4; ++y)
        for (uint32_t x = 0; x < 4; ++x) {
            int seen = 0;
            for (const auto& [dx, dy] : {std::pair{0u, 0u}, {1u, 0u}, {0u, 1u}, {1u, 1u}})
                seen |= 1 << texelOrientation(x + dx, y + dy);
            EXPECT_EQ(seen, 15);
        }
    std::array<int, 4> counts{};
    for (uint32_t v = 0; v < 400; ++v) ++counts[vertexOrientation(v)];
    for (const int count : counts) EXPECT_NEAR(count, 100, 3);
}

TEST(AdaptiveBake, OpenPointsNeedTheFirstSetOnly) {
    const shapes::Mesh mesh = shapes::box({-1, -1, -1}, {1, 1, 1});
    std::vector<SurfacePoint> points;
    for (uint32_t t = 0; t < 12; ++t) points.push_back({mesh.point(t, 0.2, 0.3), mesh.normal(t), t});
    const BakeResult bake = bakeAdaptive(mesh, points, 0.02);
    EXPECT_LT(double(bake.rays), 0.51 * 256 * 12);
    for (const float ao : bake.ao) EXPECT_EQ(ao, 1.0f);
}

TEST(AdaptiveBake, AnErrorOutOfRangeIsRefused) {
    const shapes::Mesh mesh = clutter();
    const std::vector<SurfacePoint> points = floorPoints(1);
    EXPECT_ANY_THROW(bakeAdaptive(mesh, points, -0.1));
    EXPECT_ANY_THROW(bakeAdaptive(mesh, points, std::nan("")));
}

}  // namespace
}  // namespace prt
