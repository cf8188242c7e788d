// prt measure frame-time: what is made of samples, where the camera goes, and what the command writes.
#include "tools/measure/frame_time.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "tests/base/temporary_directory.h"
#include "tests/tools/measure_compression_box.h"
#include "tests/tools/run_command.h"
#include "tools/measure/commands.h"

namespace prt::tools {
namespace {

TEST(FrameTime, SpreadInterpolatesBetweenSortedValues) {
    const Spread odd = spreadOf({5, 1, 3, 2, 4});
    EXPECT_EQ(odd.median, 3);
    EXPECT_EQ(odd.low, 2);
    EXPECT_EQ(odd.high, 4);
    const Spread even = spreadOf({4, 1, 3, 2});
    EXPECT_DOUBLE_EQ(even.median, 2.5);
    EXPECT_DOUBLE_EQ(even.low, 1.75);
    EXPECT_DOUBLE_EQ(even.high, 3.25);
    EXPECT_EQ(spreadOf({7}).high, 7);
}

// A machine that is half as fast in some rounds: times differ by two, ratios do not.
TEST(FrameTime, RatiosDoNotSeeASlowMachine) {
    FrameSamples samples{{{}, {}}, {{}, {}}};
    for (const double slow : {1.0, 2.0, 1.0, 2.0, 2.0}) {
        for (std::vector<double>& base : samples.base) base.push_back(10 * slow);
        samples.techniques[0].push_back(14 * slow);
        samples.techniques[1].push_back(26 * slow);
    }
    const FrameTimes times = summarizeFrames(samples, 1);
    EXPECT_EQ(times.baseMs.median, 20);
    ASSERT_EQ(times.techniques.size(), 2u);
    EXPECT_EQ(times.techniques[0].frameMs, 28);
    EXPECT_EQ(times.techniques[0].lightMs.median, 8);
    EXPECT_EQ(times.techniques[0].lightMs.low, 4);
    for (const double ratio : {times.techniques[0].ratio.low, times.techniques[0].ratio.high})
        EXPECT_DOUBLE_EQ(ratio, 0.25);
    EXPECT_DOUBLE_EQ(times.techniques[1].ratio.median, 1);
    EXPECT_TRUE(std::isnan(summarizeFrames(samples, std::nullopt).techniques[0].ratio.median));
}

TEST(FrameTime, CameraComesNearerUntilEnoughIsCovered) {
    const auto square = [](double distance) { return std::min(1.0, 0.25 / (distance * distance)); };
    const double distance = coveringDistance(square, 0.6);
    EXPECT_GE(square(distance), 0.6);
    EXPECT_LT(square(distance * 1.1), 0.6);
    EXPECT_EQ(coveringDistance([](double) { return 0.7; }, 0.6), 1);
    // Nothing is enough: the best there is.
    const auto hill = [](double d) { return 0.5 - std::abs(d - 0.4); };
    EXPECT_NEAR(coveringDistance(hill, 0.6), 0.4, 0.4 * 0.05);
}

TEST(FrameTime, PaperRatiosAreThoseOfItsText) {
    EXPECT_NEAR(paperMilliseconds("unc6") / paperMilliseconds("pca16"), 2.3, 0.05);
    EXPECT_NEAR(paperMilliseconds("unc6") / paperMilliseconds("pca4"), 5.9, 0.06);
    EXPECT_TRUE(std::isnan(paperMilliseconds("pca12")));
}

class FrameTimeCommand : public testing::Test {
  protected:
    void SetUp() override {
        setQuiet(true);
        bundle_ = test::compressedBoxBundle(folder_, false);
    }
    void TearDown() override { setQuiet(false); }
    nlohmann::json run(std::vector<std::string> more) {
        std::vector<std::string> arguments = {"frame-time",  bundle_,
                                              "--size",      "64x40",
                                              "--plot",      "none",
                                              "-o",          folder_.file("times"),
                                              "--json",      folder_.file("times.json"),
                                              "--elevation", "45",
                                              "--quiet"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        test::runCommand(runMeasureFrameTime, arguments);
        return nlohmann::json::parse(readFile(folder_.file("times.json")));
    }
    TemporaryDirectory folder_;
    std::string bundle_;
};

TEST_F(FrameTimeCommand, TimesWhatTheBundleCanDraw) {
    const auto json = run({});
    EXPECT_EQ(json["context"], "osmesa");
    EXPECT_FALSE(json["gpu"].get<std::string>().empty());
    EXPECT_GE(json["covered_percent"], 60);  // the camera came nearer
    EXPECT_LT(json["distance"], 1);
    EXPECT_GT(json["base_ms"], 0);
    EXPECT_EQ(json["frames"], 20);
    std::vector<std::string> names;
    for (const auto& row : json["rows"]) {
        names.push_back(row["technique"]);
        EXPECT_GT(row["median_ms"], 0);
        EXPECT_EQ(row["bytes_per_pixel"], 16 * row["fetches"].get<int>());
        EXPECT_TRUE(row["ratio_to_unc6"].is_null());  // four bands only
    }
    // Of unc and unc4, pca and pca8 one each.
    for (const char* name : {"unc3", "unc4", "pca4", "pca8", "pca-uniform", "sh2", "preconvolved-ao"})
        EXPECT_EQ(std::ranges::count(names, name), 1) << name;
    EXPECT_EQ(std::ranges::count(names, "unc"), 0);
    EXPECT_EQ(std::ranges::count(names, "pca"), 0);
    EXPECT_TRUE(std::filesystem::exists(folder_.file("times.csv")));
}

TEST_F(FrameTimeCommand, TakesTheCameraAndTechniquesThatAreNamed) {
    const auto json = run({"--technique", "pca4", "--technique", "sh2", "--distance", "3", "--frames", "21",
                           "--no-normal-map"});
    EXPECT_EQ(json["distance"], 3);
    EXPECT_LT(json["covered_percent"], 60);
    EXPECT_EQ(json["frames"], 21);
    EXPECT_EQ(json["normal_map"], false);
    ASSERT_EQ(json["rows"].size(), 2u);
    EXPECT_EQ(json["rows"][0]["technique"], "pca4");
    EXPECT_EQ(json["rows"][0]["fetches"], 5);
    EXPECT_EQ(json["rows"][1]["technique"], "sh2");
}

TEST_F(FrameTimeCommand, RefusesWhatCannotBeTimed) {
    EXPECT_THROW(run({"--technique", "reference"}), UsageError);
    EXPECT_THROW(run({"--technique", "unc6"}), InputError);
    EXPECT_THROW(run({"--frames", "19"}), UsageError);
    EXPECT_THROW(run({"--context", "gdi"}), UsageError);
}

}  // namespace
}  // namespace prt::tools
