// prt measure tables: its points, its errors against what is known of them, and what the command writes.
#include "tools/measure/tables.h"

#include <cmath>
#include <sstream>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/math/sh.h"
#include "tests/base/temporary_directory.h"
#include "tests/tools/run_command.h"
#include "tools/measure/commands.h"

namespace prt::tools {
namespace {

TableStudy smallStudy() {
    TableStudy study;
    study.shOrder = 4;
    study.sizes = {8, 16};
    study.layouts = {"cube", "dual-paraboloid"};
    study.variants = tableVariants();
    study.points = 500;
    study.rounds = 0;
    return study;
}

TEST(MeasureTables, PointsSeeAtMostTheirHalfSpace) {
    TableStudy study = smallStudy();
    study.coneDeg = 20;
    const TablePoints points = makeTablePoints(study);
    ASSERT_EQ(points.normals.size(), 500u);
    ASSERT_EQ(points.visibility.size(), 500u * 16);
    double mean = 0, least = 1;
    for (size_t k = 0; k < 500; ++k) {
        EXPECT_NEAR(points.normals[k].norm(), 1, 1e-5);
        // Coefficient 0 is √4π times the share of the sphere that is seen.
        const double seen = double(points.visibility[k * 16]) / std::sqrt(4 * std::numbers::pi);
        EXPECT_LE(seen, 0.5 + 5e-3);  // 3.5e-3: ten of 2048 directions
        EXPECT_GE(seen, 0);
        mean += seen / 500;
        least = std::min(least, seen);
        // Band 1 points into what is seen: the shading normal lies near it where nothing blocks.
        if (seen > 0.499) {
            const float* band = &points.visibility[k * 16 + 1];
            const Vec3f bent = -Vec3f(band[2], band[0], -band[1]).normalized();
            EXPECT_GT(bent.dot(points.normals[k]), std::cos(20.5 * std::numbers::pi / 180));
        }
    }
    EXPECT_LT(mean, 0.48);
    EXPECT_LT(least, 0.35);
    EXPECT_EQ(makeTablePoints(study).visibility, points.visibility);
    study.seed = 2;
    EXPECT_NE(makeTablePoints(study).visibility, points.visibility);
}

TEST(MeasureTables, ErrorsFallWithSizeAndWithBandsOfTheCosine) {
    const TableResult result = studyTables({loadEnvironment("sky:clear")}, smallStudy());
    ASSERT_EQ(result.variants.size(), 1u);
    ASSERT_EQ(result.errors.size(), 8u);
    ASSERT_EQ(result.costs.size(), 8u);
    // A sun is what three bands of cosine get wrong: 3 to 5 % (papers.md); twelve, below 0.7 %.
    EXPECT_GT(result.variants[0].paper, 0.02);
    EXPECT_LT(result.variants[0].paper, 0.08);
    EXPECT_LT(result.variants[0].exact, 0.01);
    for (size_t k = 0; k < 8; k += 2) {
        const TableErrorRow &small = result.errors[k], &large = result.errors[k + 1];
        EXPECT_EQ(small.size, 8);
        EXPECT_EQ(large.size, 16);
        EXPECT_EQ(small.layout, large.layout);
        // Bilinear interpolation: a quarter.
        EXPECT_GT(small.interpolation / large.interpolation, 3);
        EXPECT_LT(small.interpolation / large.interpolation, 5);
        EXPECT_GT(large.worst, large.interpolation);
        // The two errors add up at most.
        const double variant = small.variant == "paper" ? result.variants[0].paper : result.variants[0].exact;
        EXPECT_LT(large.total, 1.01 * (variant + large.interpolation));
        EXPECT_GT(large.total, 0.99 * std::abs(variant - large.interpolation));
    }
    EXPECT_LT(result.errors[1].interpolation, 3e-3) << "16 texels of a cube";
    EXPECT_EQ(result.costs[0].bytes, uint64_t(3 * 16 * 6 * 64 * 4));
    EXPECT_EQ(result.costs[3].texels, uint64_t(2 * 16 * 16));
    EXPECT_TRUE(std::isnan(result.costs[0].lightCosineMs));
}

TEST(MeasureTables, UniformLightHasNoBandsToLose) {
    // R_i is the cosine's own coefficient: of four bands the last is zero, and three are all there is.
    const TableResult result = studyTables({loadEnvironment("sky:uniform")}, smallStudy());
    EXPECT_LT(result.variants[0].exact, 1e-5);
    EXPECT_LT(result.variants[0].paper, 1e-5);
    // Of six bands the fifth is not: π/24 of π.
    TableStudy study = smallStudy();
    study.shOrder = 6;
    study.layouts = {"cube"};
    const TableResult wide = studyTables({loadEnvironment("sky:uniform")}, study);
    EXPECT_LT(wide.variants[0].exact, 1e-5);
    EXPECT_GT(wide.variants[0].paper, 1e-3);
}

TEST(MeasureTables, StopsWhenInterrupted) {
    requestInterrupt();
    EXPECT_THROW(studyTables({loadEnvironment("sky:uniform")}, smallStudy()), Interrupted);
    clearInterrupt();
}

void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "tables");
    test::runCommand(runMeasureTables, arguments);
}

TEST(MeasureTablesCommand, WritesCsvAndJson) {
    const TemporaryDirectory folder;
    const std::string prefix = folder.file("tables"), json = folder.file("tables.json");
    run({"--env",           "sky:clear", "--order", "3",        "--sizes", "4,8",      "--layouts",
         "octahedral,cube", "--variant", "both",    "--points", "50",      "--rounds", "1",
         "--plot",          "none",      "-o",      prefix,     "--json",  json,       "--quiet"});
    std::istringstream csv(readFile(prefix + ".csv"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(csv, line);) lines.push_back(line);
    ASSERT_EQ(lines.size(), 1 + 2 * 2 * 2u);
    EXPECT_EQ(lines[0],
              "variant,layout,size,relative_rmse,relative_rmse_highest,relative_worst,relative_rmse_total,"
              "texels,bytes,light_cosine_ms,triple_product_ms\r");
    EXPECT_TRUE(lines[1].starts_with("paper,octahedral,4,")) << lines[1];
    EXPECT_TRUE(lines.back().starts_with("exact,cube,8,")) << lines.back();
    const std::string text = readFile(json);
    for (const char* key : {"\"rows\": [", "\"environments\": [", "\"variants\": [", "\"size\": 8",
                            "\"relative_rmse\": ", "\"bytes\": ", "\"environment_count\": 1"})
        EXPECT_NE(text.find(key), std::string::npos) << key;
    EXPECT_TRUE(readFile(prefix + "-variants.csv").starts_with("environment,paper,exact\r\nclear,"));
}

TEST(MeasureTablesCommand, RefusesWhatItCannotMeasure) {
    EXPECT_THROW(run({"--sizes", "1", "--layouts", "dual-paraboloid"}), UsageError);
    EXPECT_THROW(run({"--sizes", "2000"}), UsageError);
    EXPECT_THROW(run({"--layouts", "mercator"}), UsageError);
    EXPECT_THROW(run({"--variant", "neither"}), UsageError);
    EXPECT_THROW(run({"--order", "11"}), UsageError);
    EXPECT_THROW(run({"--env", "sky:green"}), InputError);
    EXPECT_THROW(run({"--env", "missing.exr"}), InputError);
}

}  // namespace
}  // namespace prt::tools
