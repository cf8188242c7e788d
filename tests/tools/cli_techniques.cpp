// Techniques that need more than a bundle's visibility, and light that bounces, as a user runs them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "precompute/io/exr_file.h"
#include "tests/tools/prt_process.h"

namespace prt::test {
namespace {

using testing::HasSubstr;

/// The open box baked per texel, with a lightmap of the sunset turned by 30 degrees and one of the overcast
/// sky.
class TechniqueCommand : public testing::Test {
  protected:
    void SetUp() override {
        folder_.write("box.obj", openBoxObj());
        ASSERT_EQ(run({"precompute", "box.obj", "-o", "box.prt", "--texels", "48", "--rays", "64"}).exitCode,
                  0);
        for (const char* sky : {"sky:sunset", "sky:overcast"})
            ASSERT_EQ(run({"lightmap", "box.prt", "--env", sky, "--rotate", "30", "--rays", "32"}).exitCode,
                      0);
    }
    ProcessResult run(std::vector<std::string> arguments) const {
        arguments.push_back("--quiet");
        return runPrt(folder_, arguments);
    }
    ProcessResult relight(std::vector<std::string> options) const {
        options.insert(options.begin(), {"relight", "box.prt", "--size", "64x48", "--elevation", "60",
                                         "--reference-rays", "256"});
        return run(options);
    }
    Folder folder_;
};

// Mean of the green channel.
double meanOf(const std::filesystem::path& file) {
    const ExrReader reader(file);
    std::vector<float> green(64 * 48);
    reader.read(0, {{"G", ExrType::Float, green.data()}});
    return std::accumulate(green.begin(), green.end(), 0.0) / double(green.size());
}

TEST_F(TechniqueCommand, LightmapsBlendAndAreNearTheBouncedReference) {
    const ProcessResult result = relight({"--technique", "sh-lightmap", "--env", "sky:sunset:0.5", "--env",
                                          "sky:overcast:2", "--rotate", "30", "--compare-reference",
                                          "--bounces", "2", "--reference-paths", "64", "--json", "-"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.err, "");
    const nlohmann::json report = nlohmann::json::parse(result.out);
    EXPECT_EQ(report.at("bounces"), 2);
    EXPECT_EQ(report.at("reference_paths"), 64);
    EXPECT_GT(report.at("reference_noise").get<double>(), 0);
    EXPECT_LT(report.at("reference_noise").get<double>(), 0.2);
    double unc = 0, lightmap = 0;
    for (const nlohmann::json& row : report.at("rows")) {
        const bool isLightmap = row.at("technique") == "sh-lightmap";
        EXPECT_EQ(row.at("bounces"), isLightmap ? 2 : 0);
        (isLightmap ? lightmap : unc) = row.at("relative_rmse");
    }
    // Measured 0.09, of which 0.1 of the reference's bounced part is noise; unc, without the light from wall
    // to wall, 0.36.
    EXPECT_LT(lightmap, 0.15);
    EXPECT_GT(lightmap, 0.001);
    EXPECT_GT(unc, 2 * lightmap);
}

TEST_F(TechniqueCommand, LightmapsOfAnotherLightAreRefused) {
    const auto refused = [&](std::vector<std::string> options, const std::string& problem) {
        options.insert(options.begin(), {"--technique", "sh-lightmap", "-o", "no.png"});
        const ProcessResult result = relight(options);
        EXPECT_EQ(result.exitCode, 3) << result.err;
        EXPECT_THAT(result.err, HasSubstr(problem));
        EXPECT_THAT(result.err, HasSubstr("make it with: prt lightmap box.prt --env sky:"));
        EXPECT_FALSE(std::filesystem::exists(folder_ / "no.png"));
    };
    refused({"--env", "sky:sunset"}, "turned by 30 degrees, not 0");
    refused({"--env", "sky:clear", "--rotate", "30"}, "the bundle has no lightmaps/clear.exr");
    refused({"--env", "sky:sunset", "--env", "sky:clear:0.1", "--rotate", "30"}, "no lightmaps/clear.exr");
    // Whole turns do not matter, nor does what has no weight.
    EXPECT_EQ(relight({"--technique", "sh-lightmap", "-o", "yes.png", "--env", "sky:sunset", "--env",
                       "sky:clear:0", "--rotate", "-330"})
                  .exitCode,
              0);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "yes.png"));
    ASSERT_EQ(run({"precompute", "box.obj", "-o", "box.prt", "--texels", "32", "--rays", "64"}).exitCode, 0);
    refused({"--env", "sky:sunset", "--rotate", "30"}, "lightmaps/sunset.exr is stale");
}

TEST_F(TechniqueCommand, AllHasLightmapsWhereTheyAre) {
    const auto names = [&](const std::string& turn) {
        const ProcessResult result = relight(
            {"--technique", "all", "-o", turn + "_{technique}.png", "--env", "sky:sunset", "--rotate", turn});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return std::filesystem::exists(folder_ / (turn + "_sh-lightmap.png"));
    };
    EXPECT_TRUE(names("30"));
    EXPECT_FALSE(names("31"));
}

TEST_F(TechniqueCommand, ErrorsOfLightmapsWithOtherBouncesComeWithAWarning) {
    const ProcessResult result = relight({"--technique", "sh-lightmap", "--env", "sky:sunset", "--rotate",
                                          "30", "--compare-reference", "--json", "e.json"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.err,
                HasSubstr("sh-lightmap holds 2 bounces, the reference 0; compare with --bounces 2"));
    EXPECT_THAT(slurp(folder_ / "e.json"), HasSubstr("sh-lightmap"));
}

TEST_F(TechniqueCommand, BouncesBrightenTheReferenceAndAreTheSameEveryTime) {
    const auto mean = [&](const std::string& bounces, const std::string& name) {
        const ProcessResult result =
            relight({"--technique", "reference", "--env", "sky:overcast", "--no-background", "--bounces",
                     bounces, "--reference-paths", "16", "-o", name});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return meanOf(folder_ / name);
    };
    const double direct = mean("0", "0.exr"), one = mean("1", "1.exr"), three = mean("3", "3.exr");
    EXPECT_LT(direct, one);
    EXPECT_LT(one, three);
    mean("3", "again.exr");
    EXPECT_EQ(slurp(folder_ / "again.exr"), slurp(folder_ / "3.exr"));
}

TEST_F(TechniqueCommand, OptionsOfBouncesAreChecked) {
    const auto refused = [&](const std::vector<std::string>& options, const char* problem) {
        const ProcessResult result = relight(options);
        EXPECT_EQ(result.exitCode, 2) << result.err;
        EXPECT_THAT(result.err, HasSubstr(problem));
    };
    refused({"-o", "a.png", "--bounces", "2"}, "is of the reference, which was not asked for");
    refused({"-o", "a.png", "--bounces", "9", "--technique", "reference"}, "--bounces");
    refused({"-o", "a.png", "--reference-paths", "3", "--technique", "reference"}, "3 is not even");
}

}  // namespace
}  // namespace prt::test
