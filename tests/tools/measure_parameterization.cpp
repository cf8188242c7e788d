// prt measure parameterization: against a slow reference, and what the command writes and refuses.
#include "tools/measure/parameterization.h"

#include <cmath>
#include <sstream>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "precompute/math/sh.h"
#include "precompute/math/sphere_map.h"
#include "tests/base/temporary_directory.h"
#include "tests/tools/run_command.h"
#include "tools/measure/commands.h"

namespace prt::tools {
namespace {

std::vector<std::string> allLayouts() {
    std::vector<std::string> names;
    for (const SphereMapFamily& family : sphereMapFamilies()) names.push_back(family.name);
    return names;
}

/// To the nearest number with 11 significant bits and at least 2^-24 apart, ties to even.
double nearestHalf(double value) {
    if (value == 0) return 0;
    int exponent;
    std::frexp(value, &exponent);
    const double step = std::ldexp(1.0, std::max(exponent - 11, -24));
    return std::nearbyint(value / step) * step;
}

/// One function after the other, in double.
double slowMse(const ParameterizationRow& row, int points, uint64_t seed) {
    const auto map = makeSphereMap(row.layout, row.size);
    const size_t count = size_t(shCount(row.shOrder));
    std::vector<std::vector<double>> table(size_t(map->texelCount()), std::vector<double>(count));
    for (int texel = 0; texel < map->texelCount(); ++texel) {
        evalSh(row.shOrder, map->texelDirection(texel), table[size_t(texel)]);
        if (row.table == "half")
            for (double& value : table[size_t(texel)]) value = nearestHalf(double(float(value)));
    }
    double sum = 0;
    std::vector<double> exact(count);
    for (const Vec3f& direction : randomDirections(points, seed)) {
        const Vec3d d = direction.cast<double>();
        evalSh(row.shOrder, d, exact);
        for (size_t i = 0; i < count; ++i) {
            double value = 0;
            for (const SphereTap& tap : map->taps(d))
                value += double(tap.weight) * table[size_t(tap.texel)][i];
            sum += (value - exact[i]) * (value - exact[i]);
        }
    }
    return sum / (points * double(count));
}

ParameterizationSettings smallSettings() {
    ParameterizationSettings settings;
    settings.shOrders = {2, 4};
    settings.layouts = allLayouts();
    settings.points = 5001;  // no multiple of any block
    settings.maxSamples = 250;
    settings.half = true;
    return settings;
}

TEST(MeasureParameterization, AgreesWithTheSlowReference) {
    setQuiet(true);
    const ParameterizationSettings settings = smallSettings();
    const std::vector<ParameterizationRow> rows = measureParameterization(settings);
    ASSERT_EQ(rows.size(), 8 * 3 * 2 * 2u);
    for (const ParameterizationRow& row : rows) {
        EXPECT_EQ(row.samples, makeSphereMap(row.layout, row.size)->texelCount());
        // A value rounded in float before it is rounded to half may end in the neighbouring half.
        EXPECT_NEAR(row.mse / slowMse(row, settings.points, settings.seed), 1, 2e-5)
            << row.layout << ' ' << row.size << ' ' << row.shOrder << ' ' << row.table;
    }
}

TEST(MeasureParameterization, RowsAreOrderedAndComplete) {
    setQuiet(true);
    ParameterizationSettings settings = smallSettings();
    settings.points = 10;
    size_t k = 0;
    const std::vector<ParameterizationRow> rows = measureParameterization(settings);
    for (const int n : settings.shOrders)
        for (const std::string& layout : settings.layouts)
            for (const std::string table : {"float", "half"})
                for (const int size : parameterizationSizes(layout, settings.maxSamples)) {
                    ASSERT_LT(k, rows.size());
                    EXPECT_EQ(rows[k].shOrder, n);
                    EXPECT_EQ(rows[k].layout, layout);
                    EXPECT_EQ(rows[k].table, table);
                    EXPECT_EQ(rows[k].size, size);
                    ++k;
                }
    EXPECT_EQ(k, rows.size());
}

TEST(MeasureParameterization, ThreadsDoNotChangeTheResult) {
    setQuiet(true);
    ParameterizationSettings settings = smallSettings();
    settings.layouts = {"dual-paraboloid", "healpix"};
    settings.points = 20000;
    setThreadCount(1);
    const auto one = measureParameterization(settings);
    setThreadCount(3);
    const auto three = measureParameterization(settings);
    setThreadCount(0);
    ASSERT_EQ(one.size(), three.size());
    for (size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].mse, three[i].mse);
}

TEST(MeasureParameterization, SizesFollowTheCubes) {
    EXPECT_THAT(parameterizationSizes("cube", 25000),
                testing::ElementsAre(3, 4, 6, 8, 11, 16, 23, 32, 45, 64));
    EXPECT_THAT(parameterizationSizes("dual-paraboloid", 400), testing::ElementsAre(5, 7, 10, 14));
    EXPECT_THAT(parameterizationSizes("octahedral", 400), testing::ElementsAre(8, 10, 14, 20));
    EXPECT_THAT(parameterizationSizes("healpix", 47), testing::IsEmpty());
    for (const std::string& layout : allLayouts()) {
        const std::vector<int> sizes = parameterizationSizes(layout, 25000);
        ASSERT_EQ(sizes.size(), 10u) << layout;
        EXPECT_LE(makeSphereMap(layout, sizes.back())->texelCount(), 25000);
        for (size_t i = 0; i < 10; ++i) {
            const int cubeEdge = parameterizationSizes("cube", 25000)[i];
            EXPECT_NEAR(std::log(makeSphereMap(layout, sizes[i])->texelCount() / (6.0 * cubeEdge * cubeEdge)),
                        0, 0.2)
                << layout;
        }
    }
    EXPECT_THROW(parameterizationSizes("mercator", 1000), InputError);
}

TEST(MeasureParameterization, StopsWhenInterrupted) {
    setQuiet(true);
    requestInterrupt();
    EXPECT_THROW(measureParameterization(smallSettings()), Interrupted);
    clearInterrupt();
}

void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "parameterization");
    test::runCommand(runMeasureParameterization, arguments);
}

TEST(MeasureParameterizationCommand, WritesCsvAndJson) {
    const TemporaryDirectory folder;
    const std::string prefix = folder.file("fig8");
    const std::string json = folder.file("fig8.json");
    run({"--orders", "2-3", "--layouts", "cube,octahedral", "--points", "1000", "--max-samples", "100",
         "--half", "--plot", "none", "-o", prefix, "--json", json, "--quiet"});
    std::istringstream csv(readFile(prefix + ".csv"));
    std::string line;
    std::getline(csv, line);
    EXPECT_EQ(line, "order,layout,table,size,samples,mse\r");
    std::vector<std::string> lines;
    while (std::getline(csv, line)) lines.push_back(line);
    ASSERT_EQ(lines.size(), 2 * 2 * 2 * 2u);
    EXPECT_TRUE(lines[0].starts_with("2,cube,float,3,54,0.")) << lines[0];
    EXPECT_TRUE(lines.back().starts_with("3,octahedral,half,10,100,")) << lines.back();
    const std::string text = readFile(json);
    for (const char* key : {"\"points\": 1000", "\"rows\": [", "\"order\": 2", "\"layout\": \"octahedral\"",
                            "\"samples\": 96", "\"mse\": ", "\"table\": \"half\""})
        EXPECT_NE(text.find(key), std::string::npos) << key;
}

TEST(MeasureParameterizationCommand, RefusesWhatItCannotMeasure) {
    EXPECT_THROW(run({"--orders", "11"}), UsageError);
    EXPECT_THROW(run({"--orders", "three"}), UsageError);
    EXPECT_THROW(run({"--layouts", "cube,mercator"}), UsageError);
    EXPECT_THROW(run({"--points", "0"}), UsageError);
    EXPECT_THROW(run({"--max-samples", "10"}), UsageError);
    EXPECT_THROW(run({"--plot", "bmp"}), UsageError);
}

}  // namespace
}  // namespace prt::tools
