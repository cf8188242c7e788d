// prt measure rotation: what is known of the rotations of hemispherical harmonics with 10 bands.
#include <map>

#include "tools/measure/rotation_hsh.h"

namespace prt::tools {
namespace {

TEST(MeasureHshErrors, OfACos5LobeAtTenBands) {
    const std::map<double, double> digonRemoval = {{5, 0.08}, {10, 0.16}, {20, 0.32}};
    size_t known = 0;
    for (const HshError& row : hshErrors(10, 5)) {
        const bool coarse = row.tabulatedAngles != 0 && row.tabulatedAngles < 37;
        if (row.method == kHshDigonRemoval) {
            const auto expected = digonRemoval.find(row.betaDeg);
            if (expected == digonRemoval.end()) continue;
            EXPECT_NEAR(row.relativeError / expected->second, 1, 0.04);
            ++known;
        } else if (row.betaDeg >= 5 && row.shOrder != 10 && !coarse) {
            EXPECT_LT(row.relativeError, 0.01) << row.method << ' ' << row.shOrder << ' ' << row.betaDeg;
        }
    }
    EXPECT_EQ(known, digonRemoval.size());
}

TEST(MeasureHshErrors, MoreBandsInBetweenAreCloserToTheMatrix) {
    // the mean over angles; single ones may fall either way, because two errors add up
    double sums[4] = {};
    const std::vector<int> orders = hshIntermediateOrders(10);
    ASSERT_EQ(orders.size(), 4u);
    for (const HshError& row : hshErrors(10, 5))
        for (size_t i = 0; i < 4; ++i)
            if (row.shOrder == orders[i]) sums[i] += row.relativeError;
    EXPECT_LT(sums[1], 0.9 * sums[0]);
    EXPECT_LT(sums[2], 0.9 * sums[1]);
    EXPECT_LT(sums[3], sums[2]);
}

}  // namespace
}  // namespace prt::tools
