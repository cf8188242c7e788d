#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "precompute/mesh/texel_raster.h"

namespace prt {
namespace {

double distance2(uint32_t a, uint32_t b, int width) {
    const double dx = double(a % uint32_t(width)) - double(b % uint32_t(width));
    const double dy = double(a / uint32_t(width)) - double(b / uint32_t(width));
    return dx * dx + dy * dy;
}

void compareWithSearch(const std::vector<uint8_t>& has, const std::vector<uint32_t>& group, int width,
                       int height, int reach) {
    const auto source = nearestFilledTexel(has, group, width, height, reach);
    ASSERT_EQ(source.size(), has.size());
    for (uint32_t i = 0; i < has.size(); ++i) {
        double best = 1e300;
        for (uint32_t j = 0; j < has.size(); ++j)
            if (has[j] && (group.empty() || group[i] == group[j]))
                best = std::min(best, distance2(i, j, width));
        if (has[i]) {
            ASSERT_EQ(source[i], i);
        } else if (best > double(reach) * reach) {
            ASSERT_EQ(source[i], kNoPoint);
        } else {
            ASSERT_NE(source[i], kNoPoint);
            ASSERT_TRUE(has[source[i]]);
            if (!group.empty()) {
                ASSERT_EQ(group[source[i]], group[i]);
            }
            ASSERT_EQ(distance2(i, source[i], width), best);
        }
    }
}

TEST(NearestTexel, AgreesWithASearchOverAllTexels) {
    std::mt19937 random(5);
    for (int trial = 0; trial < 60; ++trial) {
        const int width = 1 + int(random() % 24), height = 1 + int(random() % 24),
                  reach = 1 + int(random() % 30);
        const uint32_t sparse = 2 + random() % 60, groups = 1 + random() % 4;
        std::vector<uint8_t> has(size_t(width) * size_t(height));
        std::vector<uint32_t> group(has.size());
        for (auto& h : has) h = random() % sparse == 0;
        for (auto& g : group) g = random() % groups == 0 ? kNoPoint : random() % groups;
        compareWithSearch(has, {}, width, height, reach);
        compareWithSearch(has, group, width, height, reach);
    }
}

TEST(NearestTexel, NothingToFillFrom) {
    const auto source = nearestFilledTexel(std::vector<uint8_t>(12, 0), {}, 4, 3, 100);
    EXPECT_EQ(source, std::vector<uint32_t>(12, kNoPoint));
}

TEST(NearestTexel, ReachIsEuclideanAndInclusive) {
    std::vector<uint8_t> has(100, 0);
    has[0] = 1;
    const auto source = nearestFilledTexel(has, {}, 10, 10, 5);
    EXPECT_EQ(source[5], 0u);
    EXPECT_EQ(source[4 * 10 + 3], 0u) << "3-4-5";
    EXPECT_EQ(source[4 * 10 + 4], kNoPoint);
    EXPECT_EQ(source[6], kNoPoint);
}

}  // namespace
}  // namespace prt
