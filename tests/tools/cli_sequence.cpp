// Sequences of frames and videos as a user makes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "precompute/io/image.h"
#include "tests/tools/prt_process.h"

namespace prt::test {
namespace {

using testing::HasSubstr;
using Words = std::vector<std::string>;

/// The open box, baked per vertex.
class SequenceCommand : public testing::Test {
  protected:
    void SetUp() override {
        folder_.write("box.obj", openBoxObj());
        ASSERT_EQ(runPrt(folder_, {"precompute", "box.obj", "-o", "box.prt", "--per-vertex", "--rays", "64",
                                   "--quiet"})
                      .exitCode,
                  0);
    }
    ProcessResult relight(const Words& options, const std::string& prelude = "") const {
        Words arguments = {"relight", "box.prt", "--elevation", "50", "--quiet"};
        if (std::ranges::find(options, "--size") == options.end())
            arguments.insert(arguments.end(), {"--size", "64x48"});
        arguments.insert(arguments.end(), options.begin(), options.end());
        return runPrt(folder_, arguments, prelude);
    }
    // Draws what must work, and says nothing.
    void draw(const Words& options, const std::string& prelude = "") const {
        const ProcessResult result = relight(options, prelude);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        EXPECT_EQ(result.err, "");
    }
    ByteImage picture(const std::string& name) const {
        const std::string bytes = slurp(folder_ / name);
        EXPECT_FALSE(bytes.empty()) << name;
        return decodeImage({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()}, name);
    }
    // Share of bytes that differ by more than rounding.
    double difference(const std::string& a, const std::string& b) const {
        const ByteImage x = picture(a), y = picture(b);
        EXPECT_EQ(x.pixels.size(), y.pixels.size());
        size_t count = 0;
        for (size_t i = 0; i < std::min(x.pixels.size(), y.pixels.size()); ++i)
            count += std::abs(int(x.pixels[i]) - int(y.pixels[i])) > 2;
        return double(count) / double(x.pixels.size());
    }
    Folder folder_;
};

// Edges of the box fall differently where the eye is a rounding away: a few pixels of 3072.
constexpr double kSame = 0.01, kOther = 0.05;

TEST_F(SequenceCommand, TurntableGoesAroundTheTarget) {
    draw({"--turntable", "4", "-o", "new/turn_{frame}.png"});
    const Words files = folder_.files();
    EXPECT_EQ(std::ranges::count_if(files, [](const std::string& f) { return f.starts_with("new/"); }), 4);
    draw({"-o", "0.png"});
    draw({"--azimuth", "125", "-o", "1.png"});
    draw({"--azimuth", "-55", "-o", "3.png"});
    EXPECT_EQ(slurp(folder_ / "new/turn_0000.png"), slurp(folder_ / "0.png"));
    EXPECT_LT(difference("new/turn_0001.png", "1.png"), kSame);
    EXPECT_LT(difference("new/turn_0003.png", "3.png"), kSame);
    EXPECT_GT(difference("1.png", "0.png"), kOther);
}

TEST_F(SequenceCommand, LightTurnsAndMotionsRunTogether) {
    draw({"--env", "sky:sunset", "--rotate", "10", "--rotate-light", "3", "--technique", "unc", "--technique",
          "sh2", "-o", "{technique}.{frame}.png"});
    draw({"--env", "sky:sunset", "--rotate", "130", "--technique", "sh2", "-o", "1.png"});
    EXPECT_LT(difference("sh2.0001.png", "1.png"), kSame);
    draw({"--env", "sky:sunset", "--rotate-light", "3", "--turntable", "3", "-o", "both{frame}.png"});
    draw({"--env", "sky:sunset", "--rotate", "120", "--azimuth", "155", "-o", "both.png"});
    EXPECT_LT(difference("both0001.png", "both.png"), kSame);
    EXPECT_GT(difference("both0000.png", "both.png"), kOther);
}

TEST_F(SequenceCommand, TransitionsGoFromOneToTheOther) {
    const Words environments = {"--env", "sky:sunset:0.5", "--env", "sky:uniform", "--env", "sky:clear"};
    const auto with = [&](Words options) {
        options.insert(options.begin(), environments.begin(), environments.end());
        return options;
    };
    draw(with({"--transition", "clear:1:3", "-o", "t{frame}.png"}));
    draw({"--env", "sky:clear", "-o", "a.png"});
    draw({"--env", "sky:clear:0.5", "--env", "sky:sunset:0.25", "-o", "b.png"});
    draw({"--env", "sky:sunset:0.5", "-o", "c.png"});
    EXPECT_LT(difference("t0000.png", "a.png"), kSame);
    EXPECT_LT(difference("t0001.png", "b.png"), kSame);
    EXPECT_LT(difference("t0002.png", "c.png"), kSame);
    EXPECT_GT(difference("a.png", "c.png"), kOther);
    draw(with({"--transition", "clear:1:3", "-o", "g{frame}.png", "--blend", "gpu"}));
    EXPECT_LT(difference("t0001.png", "g0001.png"), 0.001);
    for (const char* wrong : {"clear:dawn:3", "1:4:3", "0:1:3", "clear:3:3"}) {
        const ProcessResult result = relight(with({"--transition", wrong, "-o", "no{frame}.png"}));
        EXPECT_EQ(result.exitCode, 2) << wrong;
        EXPECT_THAT(result.err, HasSubstr("--transition")) << wrong;
    }
}

TEST_F(SequenceCommand, ExposureStaysThatOfTheFirstFrame) {
    const ProcessResult result =
        relight({"--env", "sky:sunset", "--env", "sky:uniform:5", "--transition", "1:2:2", "--exposure",
                 "auto", "-o", "e{frame}.png", "--json", "-"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const nlohmann::json report = nlohmann::json::parse(result.out);
    EXPECT_EQ(report.at("frames"), 2);
    const double stops = report.at("exposure_stops");
    draw({"--env", "sky:sunset", "--exposure", "auto", "-o", "first.png"});
    draw({"--env", "sky:uniform:5", "--exposure", "auto", "-o", "own.png"});
    draw({"--env", "sky:uniform:5", "--exposure", std::to_string(stops), "-o", "last.png"});
    EXPECT_LT(difference("e0000.png", "first.png"), kSame);
    EXPECT_LT(difference("e0001.png", "last.png"), kSame);
    EXPECT_GT(difference("e0001.png", "own.png"), kOther);
}

// A white box under a bright sky, so that both show: edges are between, and bright colours are drawn in.
TEST_F(SequenceCommand, SamplesAndTonesAreThoseOfSinglePictures) {
    const Words bright = {"--env", "sky:uniform", "--exposure", "2", "--no-background"};
    const auto with = [&](Words options) {
        options.insert(options.begin(), bright.begin(), bright.end());
        return options;
    };
    draw(with({"-o", "plain.png"}));
    draw(with({"--samples", "4", "-o", "smooth.png"}));
    draw(with({"--tone", "filmic", "-o", "filmic.png"}));
    draw(with({"--tone", "neutral", "--samples", "4", "-o", "both.png"}));
    draw(with({"--tone", "neutral", "--samples", "4", "--turntable", "2", "-o", "both{frame}.png"}));
    EXPECT_GT(difference("smooth.png", "plain.png"), 0.003);
    EXPECT_LT(difference("smooth.png", "plain.png"), 0.2);
    EXPECT_GT(difference("filmic.png", "plain.png"), kOther);
    EXPECT_GT(difference("both.png", "smooth.png"), kOther);
    EXPECT_EQ(slurp(folder_ / "both0000.png"), slurp(folder_ / "both.png"));
    EXPECT_EQ(relight({"--samples", "2", "-o", "no.png"}).exitCode, 2);
    EXPECT_EQ(relight({"--samples", "4", "--technique", "reference", "-o", "no.png"}).exitCode, 2);
    EXPECT_EQ(relight({"--tone", "sepia", "-o", "no.png"}).exitCode, 2);
}

TEST_F(SequenceCommand, LinearFrames) {
    draw({"--turntable", "2", "-o", "{frame}.exr"});
    draw({"-o", "single.exr"});
    EXPECT_EQ(slurp(folder_ / "0000.exr"), slurp(folder_ / "single.exr"));
}

TEST_F(SequenceCommand, WhatCannotBeIsSaidBeforeAnythingIsDrawn) {
    const Words before = folder_.files();
    const auto refused = [&](const Words& options, const std::string& problem) {
        const ProcessResult result = relight(options);
        EXPECT_EQ(result.exitCode, 2) << problem << ": " << result.err;
        EXPECT_THAT(result.err, HasSubstr(problem));
        EXPECT_EQ(std::ranges::count(result.err, '\n'), 1);
    };
    refused({"--turntable", "4", "-o", "one.png"}, "would be written once per frame");
    refused({"--turntable", "4"}, "--output");
    refused({"-o", "a{frame}.png"}, "is for several frames");
    refused({"-o", "a.mp4"}, "is for several frames");
    refused({"--turntable", "4", "-o", "a.avi"}, "put {frame} into the name");
    refused({"--turntable", "4", "--rotate-light", "5", "-o", "a{frame}.png"},
            "has 4 frames, another motion 5");
    refused({"--turntable", "-1", "-o", "a{frame}.png"}, "--turntable");
    refused({"--transition", "1:2", "-o", "a{frame}.png"}, "--transition");
    refused({"--transition", "1:2:1", "-o", "a{frame}.png"}, "at least 2 frames");
    refused({"--turntable", "4", "--each", "-o", "{env}{frame}.png"}, "--each");
    refused({"--turntable", "4", "--compare-reference", "-o", "a{frame}.png"}, "--compare-reference");
    refused({"--turntable", "4", "--technique", "reference", "-o", "a{frame}.png"}, "--technique reference");
    refused({"--turntable", "4", "--technique", "all", "-o", "a{frame}.png"},
            "put {technique} into the name");
    refused({"--rotate-light", "4", "--technique", "sh-lightmap", "-o", "a{frame}.png"},
            "holds light of one turn");
    refused({"--turntable", "4", "--size", "63x48", "-o", "a.mp4"}, "63x48 is odd");
    EXPECT_EQ(folder_.files(), before);
}

/// A program of that name in the folder's bin, first in PATH.
void writeProgram(const Folder& folder, const std::string& name, const std::string& script) {
    std::filesystem::create_directories(folder / "bin");
    folder.write("bin/" + name, "#!/bin/sh\n" + script);
    std::filesystem::permissions(folder / ("bin/" + name), std::filesystem::perms::owner_all);
}
const std::string kOwnPath = "PATH=$PWD/bin:$PATH;";

TEST_F(SequenceCommand, WithoutFfmpegThereAreNoVideos) {
    const Words before = folder_.files();
    const ProcessResult result = relight({"--turntable", "4", "-o", "a.mp4"}, "PATH=/nowhere;");
    EXPECT_EQ(result.exitCode, 3);
    EXPECT_THAT(result.err, HasSubstr("install the package ffmpeg"));
    EXPECT_EQ(folder_.files(), before);
}

TEST_F(SequenceCommand, WhatFfmpegSaysLastIsReported) {
    writeProgram(folder_, "ffmpeg", "echo first >&2; echo 'Unknown encoder libx264' >&2; exit 1\n");
    const Words before = folder_.files();
    folder_.write("b.mkv.prt-tmp-4194399-0", "what a killed run left");
    const ProcessResult result = relight({"--turntable", "40", "-o", "a.mkv"}, kOwnPath);
    EXPECT_EQ(result.exitCode, 4);
    EXPECT_THAT(result.err, HasSubstr("a.mkv: ffmpeg: Unknown encoder libx264"));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1);
    EXPECT_EQ(folder_.files(), before);
}

// It takes frames, and fails only when it should write what belongs behind the last.
TEST_F(SequenceCommand, AVideoThatFailsAtTheEndDoesNotAppear) {
    writeProgram(folder_, "ffmpeg", "cat > /dev/null; echo 'No space left on device' >&2; exit 1\n");
    folder_.write("a.webm", "the one before");
    const ProcessResult result = relight({"--turntable", "4", "-o", "a.webm"}, kOwnPath);
    EXPECT_EQ(result.exitCode, 4);
    EXPECT_THAT(result.err, HasSubstr("No space left"));
    EXPECT_EQ(slurp(folder_ / "a.webm"), "the one before");
}

TEST_F(SequenceCommand, InterruptLeavesNoVideoAndNoProcess) {
    // It never reads a frame, so that the writer stands still until it is interrupted.
    writeProgram(folder_, "ffmpeg", "echo $$ > bin/pid; exec sleep 60\n");
    folder_.write("bin/pid", "");
    const Words before = folder_.files();
    const ProcessResult result =
        relight({"--turntable", "1000", "--size", "640x480", "-o", "a.mp4"},
                kOwnPath + "( while ! [ -s bin/pid ]; do sleep 0.1; done; kill -INT $$ ) & exec");
    EXPECT_EQ(result.exitCode, 130) << result.err;
    EXPECT_EQ(folder_.files(), before);
    const std::string pid = slurp(folder_ / "bin/pid");
    ASSERT_GT(std::atoi(pid.c_str()), 1);
    EXPECT_FALSE(std::filesystem::exists("/proc/" + std::to_string(std::atoi(pid.c_str()))));
}

class Videos : public SequenceCommand, public testing::WithParamInterface<const char*> {};

TEST_P(Videos, HoldEveryFrame) {
    if (std::system("ffmpeg -version > /dev/null 2>&1") != 0) GTEST_SKIP() << "ffmpeg is not installed";
    const std::string name = std::string("film") + GetParam();
    draw({"--env", "sky:sunset", "--rotate-light", "5", "--fps", "10", "-o", name, "--tone", "filmic"});
    draw({"--env", "sky:sunset", "-o", "first.png", "--tone", "filmic"});
    const std::string decode = "cd '" + folder_.path().string() + "' && ffmpeg -loglevel error -i " + name +
                               " -f rawvideo -pix_fmt rgba frames.raw";
    ASSERT_EQ(std::system(decode.c_str()), 0);
    const std::string frames = slurp(folder_ / "frames.raw");
    ASSERT_EQ(frames.size(), size_t(5 * 64 * 48 * 4));
    // Compression leaves less than 5 of 255 in the mean; another frame is another picture.
    const ByteImage first = picture("first.png");
    double same = 0, other = 0;
    for (size_t i = 0; i < first.pixels.size(); ++i) {
        const int wanted = first.pixels[i];
        same += std::abs(wanted - int(uint8_t(frames[i])));
        other += std::abs(wanted - int(uint8_t(frames[2 * first.pixels.size() + i])));
    }
    EXPECT_LT(same / double(first.pixels.size()), 5);
    EXPECT_GT(other, 2 * same);
}

INSTANTIATE_TEST_SUITE_P(Formats, Videos, testing::Values(".mp4", ".mkv", ".webm", ".gif"),
                         [](const auto& format) { return std::string(format.param + 1); });

}  // namespace
}  // namespace prt::test
