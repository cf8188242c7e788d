// prt measure product: its counts, and what the command writes and refuses.
#include "tools/measure/product.h"

#include <cmath>
#include <sstream>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "tests/base/temporary_directory.h"
#include "tests/tools/run_command.h"
#include "tools/measure/commands.h"

namespace prt::tools {
namespace {

TEST(MeasureProductCosts, CountsAreKnown) {
    const std::vector<ProductCost> costs =
        productCosts({.shOrders = {3, 4, 5, 6, 7}, .methods = productMethods(), .rounds = 0});
    ASSERT_EQ(costs.size(), 4 * 6 + 4u) << "no straight-line code for 7 bands";
    constexpr int64_t kNonZeros[] = {83, 353, 1158, 2907};
    for (size_t i = 0; i < costs.size(); ++i) {
        const ProductCost& row = costs[i];
        if (row.shOrder <= 6) {
            EXPECT_EQ(row.nonZeros, kNonZeros[row.shOrder - 3]);
            EXPECT_EQ(row.method, productMethods()[i % 6]);
        } else {
            EXPECT_FALSE(row.method.starts_with("straight-line"));
        }
        if (row.method == "table") {
            EXPECT_EQ(row.multiplications, 2 * row.nonZeros);
        }
        if (row.method.starts_with("straight-line")) {
            EXPECT_LT(row.multiplications, 2 * row.nonZeros);
        }
        if (row.method == "matrix-batch") {
            EXPECT_EQ(row.multiplications, std::pow(row.shOrder, 4));
        }
        EXPECT_TRUE(std::isnan(row.ns));
    }
}

TEST(MeasureProductCosts, RatiosAreToTheStraightLine) {
    const std::vector<ProductCost> costs =
        productCosts({.shOrders = {3}, .methods = {"table", "straight-line"}, .rounds = 1});
    ASSERT_EQ(costs.size(), 2u);
    EXPECT_DOUBLE_EQ(costs[0].ratioToSingle, costs[0].ns / costs[1].ns);
    EXPECT_EQ(costs[1].ratioToSingle, 1);
    EXPECT_TRUE(
        std::isnan(productCosts({.shOrders = {2}, .methods = {"table"}, .rounds = 1})[0].ratioToSingle));
}

TEST(MeasureProductCosts, StopsWhenInterrupted) {
    requestInterrupt();
    EXPECT_THROW(productCosts({.shOrders = {2}, .methods = {"table"}}), Interrupted);
    clearInterrupt();
}

void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "product");
    test::runCommand(runMeasureProduct, arguments);
}

TEST(MeasureProductCommand, WritesCsvAndJson) {
    const TemporaryDirectory folder;
    const std::string prefix = folder.file("times"), json = folder.file("times.json");
    run({"--orders", "3,7", "--rounds", "1", "--plot", "none", "-o", prefix, "--json", json, "--quiet"});
    std::istringstream csv(readFile(prefix + ".csv"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(csv, line);) lines.push_back(line);
    ASSERT_EQ(lines.size(), 1 + 6 + 4u);
    EXPECT_EQ(lines[0], "order,method,ns,ratio_to_single,non_zeros,multiplications,additions\r");
    EXPECT_TRUE(lines[1].starts_with("3,table,")) << lines[1];
    EXPECT_TRUE(lines[1].ends_with(",83,166,74\r")) << lines[1];
    EXPECT_TRUE(lines.back().starts_with("7,matrix-batch,")) << lines.back();
    const std::string text = readFile(json);
    for (const char* key : {"\"rows\": [", "\"order\": 7", "\"method\": \"straight-line-batch\"", "\"ns\": ",
                            "\"non_zeros\": 83", "\"multiplications\": 166", "\"ratio_to_single\": null"})
        EXPECT_NE(text.find(key), std::string::npos) << key;
}

TEST(MeasureProductCommand, RefusesWhatItCannotMeasure) {
    EXPECT_THROW(run({"--orders", "11"}), UsageError);
    EXPECT_THROW(run({"--orders", ""}), UsageError);
    EXPECT_THROW(run({"--methods", "fourier"}), UsageError);
    EXPECT_THROW(run({"--rounds", "0"}), UsageError);
    EXPECT_THROW(run({"--plot", "bmp"}), UsageError);
}

}  // namespace
}  // namespace prt::tools
