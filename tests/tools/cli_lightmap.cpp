// prt lightmap as a user runs it.
#include <nlohmann/json.hpp>

#include "precompute/base/error.h"
#include "precompute/io/bundle.h"
#include "precompute/io/exr_file.h"
#include "precompute/io/image.h"
#include "precompute/io/lightmap_file.h"
#include "tests/tools/prt_process.h"

namespace prt::test {
namespace {

/// The open box baked per texel.
class LightmapCommand : public testing::Test {
  protected:
    void SetUp() override {
        folder_.write("box.obj", openBoxObj());
        ASSERT_EQ(run({"precompute", "box.obj", "-o", "box.prt", "--texels", "48", "--rays", "64"}).exitCode,
                  0);
    }
    ProcessResult run(std::vector<std::string> arguments) const {
        arguments.push_back("--quiet");
        return runPrt(folder_, arguments);
    }
    nlohmann::json lightmap(std::vector<std::string> options) const {
        options.insert(options.begin(), {"lightmap", "box.prt"});
        options.insert(options.end(), {"--json", "-"});
        const ProcessResult result = run(options);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return nlohmann::json::parse(result.out, nullptr, false);
    }
    Folder folder_;
};

TEST(LightmapHelp, HasDefaultsAndRanges) {
    const Folder folder;
    const ProcessResult result = runPrt(folder, {"lightmap", "--help"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    for (const char* text : {"--env", "--json", "--threads", "--quiet", "--force", "[0..64, default 2]",
                             "[16..65536, default 1024]"})
        EXPECT_NE(result.out.find(text), std::string::npos) << text << " in\n" << result.out;
}

TEST_F(LightmapCommand, WritesWhatItSaysAndDoesNothingTwice) {
    const std::vector<std::string> options = {"--env", "sky:sunset", "--rotate", "30", "--rays", "32"};
    const nlohmann::json first = lightmap(options);
    EXPECT_EQ(first.at("file"), "lightmaps/sunset.exr");
    EXPECT_EQ(first.at("up_to_date"), false);
    EXPECT_EQ(first.at("bounces"), 2);
    EXPECT_EQ(first.at("rotation_deg"), 30.0);
    EXPECT_GT(first.at("rays").get<double>(), 1000);
    EXPECT_GT(first.at("relative_error").get<double>(), 0.001);
    EXPECT_LT(first.at("relative_error").get<double>(), 0.5);
    const Lightmap map = readLightmapFile(folder_ / "box.prt/lightmaps/sunset.exr");
    EXPECT_EQ(map.bounces, 2);
    EXPECT_EQ(map.rotationDeg, 30);
    EXPECT_EQ(map.grid.width, 48);
    EXPECT_EQ(map.attributes.at("environmentName"), "sunset");
    EXPECT_EQ(first.at("bytes"), std::filesystem::file_size(folder_ / "box.prt/lightmaps/sunset.exr"));

    const std::string bytes = slurp(folder_ / "box.prt/lightmaps/sunset.exr");
    const nlohmann::json again = lightmap(options);
    EXPECT_EQ(again.at("up_to_date"), true);
    EXPECT_EQ(again.at("relative_error"), first.at("relative_error"));
    std::vector<std::string> forced = options;
    forced.push_back("--force");
    EXPECT_EQ(lightmap(forced).at("up_to_date"), false);
    EXPECT_EQ(slurp(folder_ / "box.prt/lightmaps/sunset.exr"), bytes);  // the same, to the byte
}

TEST_F(LightmapCommand, OtherSettingsReplaceIt) {
    lightmap({"--env", "sky:sunset", "--rays", "32"});
    for (const std::vector<std::string>& other :
         {std::vector<std::string>{"--env", "sky:sunset", "--rays", "32", "--rotate", "5"},
          {"--env", "sky:sunset", "--rays", "32", "--bounces", "0"},
          {"--env", "sky:sunset", "--rays", "16"},
          {"--env", "sky:sunset", "--rays", "16", "--projection", "plain"}})
        EXPECT_EQ(lightmap(other).at("up_to_date"), false);
    lightmap({"--env", "sky:clear", "--rays", "16"});
    EXPECT_EQ(lightmap({"--env", "sky:sunset", "--rays", "16", "--projection", "plain"}).at("up_to_date"),
              true);
}

// A new bake of the visibility leaves a lightmap behind that says so, with the command that renews it.
TEST_F(LightmapCommand, StaleAfterANewBake) {
    lightmap({"--env", "sky:sunset", "--rays", "32", "--rotate", "12.5"});
    ASSERT_EQ(run({"precompute", "box.obj", "-o", "box.prt", "--texels", "64", "--rays", "64"}).exitCode, 0);
    const Bundle bundle = Bundle::open(folder_ / "box.prt");
    EXPECT_NE(bundle.staleReason("lightmaps/sunset.exr", true), "");
    try {
        bundle.require("lightmaps/sunset.exr", "prt lightmap");
        FAIL();
    } catch (const InputError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("prt lightmap box.prt --env sky:sunset --rotate 12.5 --bounces 2 --rays 32"),
                  std::string::npos)
            << text;
    }
    EXPECT_EQ(lightmap({"--env", "sky:sunset", "--rays", "32", "--rotate", "12.5"}).at("up_to_date"), false);
    EXPECT_EQ(Bundle::open(folder_ / "box.prt").staleReason("lightmaps/sunset.exr", true), "");
}

TEST_F(LightmapCommand, PerVertex) {
    ASSERT_EQ(run({"precompute", "box.obj", "-o", "box.prt", "--per-vertex", "--rays", "64"}).exitCode, 0);
    lightmap({"--env", "sky:overcast", "--rays", "64"});
    EXPECT_EQ(readLightmapFile(folder_ / "box.prt/lightmaps/overcast.exr").grid.domain, PointDomain::Vertex);
}

// The picture is drawn of a lightmap that is there already, too.
TEST_F(LightmapCommand, Image) {
    lightmap({"--env", "sky:uniform", "--rays", "32", "--bounces", "0", "--image", "e.exr"});
    EXPECT_EQ(lightmap({"--env", "sky:uniform", "--rays", "32", "--bounces", "0", "--image", "e.png"})
                  .at("up_to_date"),
              true);
    const std::string png = slurp(folder_ / "e.png");
    const ByteImage drawn = decodeImage({reinterpret_cast<const uint8_t*>(png.data()), png.size()}, "e.png");
    ASSERT_EQ(drawn.width, 48);
    ASSERT_EQ(drawn.height, 48);
    const ExrReader exr(folder_ / "e.exr");
    std::vector<float> green(48 * 48);
    exr.read(0, {{"G", ExrType::Float, green.data(), 4, 48 * 4}});
    float largest = 0;
    for (size_t i = 0; i < green.size(); ++i) {
        largest = std::max(largest, green[i]);
        // The curve of sRGB: within a step of 8 bits.
        EXPECT_NEAR(toDisplay({1, 1, 3, {green[i], green[i], green[i]}}, 0).pixels[1],
                    drawn.pixels[4 * i + 1], 1);
    }
    // The middle of the floor sees 0.55 of the sky, the upper rims of the walls half of it and more.
    EXPECT_NEAR(largest, 0.58, 0.08);
    EXPECT_EQ(run({"lightmap", "box.prt", "--env", "sky:uniform", "--image", "e.bmp"}).exitCode, 2);
}

TEST_F(LightmapCommand, BadInput) {
    const auto exitCode = [&](const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {"lightmap"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const ProcessResult result = run(arguments);
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        return result.exitCode;
    };
    const std::vector<std::string> before = folder_.files();
    EXPECT_EQ(exitCode({"box.prt"}), 2);
    EXPECT_EQ(exitCode({"box.prt", "--env", "sky:sunset", "--bounces", "-1"}), 2);
    EXPECT_EQ(exitCode({"box.prt", "--env", "sky:sunset", "--rays", "3"}), 2);
    EXPECT_EQ(exitCode({"box.prt", "--env", "sky:sunset", "--rotate", "nan"}), 2);
    EXPECT_EQ(exitCode({"box.prt", "--env", "sky:nowhere"}), 3);
    EXPECT_EQ(exitCode({"box.prt", "--env", "none.exr"}), 3);
    EXPECT_EQ(exitCode({"none.prt", "--env", "sky:sunset"}), 3);
    EXPECT_EQ(folder_.files(), before);
}

TEST_F(LightmapCommand, InterruptLeavesTheBundleAsItWas) {
    const std::vector<std::string> before = folder_.files();
    const ProcessResult result =
        runPrt(folder_,
               {"lightmap", "box.prt", "--env", "sky:sunset", "--rays", "65536", "--bounces", "8", "--quiet"},
               "( sleep 1.5; kill -INT $$ ) & exec");
    EXPECT_EQ(result.exitCode, 130) << result.err;
    EXPECT_EQ(folder_.files(), before);
}

}  // namespace
}  // namespace prt::test
