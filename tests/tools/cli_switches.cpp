// A long life under changing light: what one process draws late is what a fresh one draws.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/base/sanitized.h"
#include "tests/tools/prt_process.h"

namespace prt::test {
namespace {

using Words = std::vector<std::string>;

// Both motions at once: every frame has other weights, and another turn of the light.
constexpr int kFrames = kSanitized ? 100 : 1000;

TEST(SwitchCommand, LateFramesAreThoseOfAFreshProcess) {
    const Folder folder;
    folder.write("box.obj", openBoxObj());
    const auto run = [&](const Words& arguments) {
        const ProcessResult result = runPrt(folder, arguments);
        ASSERT_EQ(result.exitCode, 0) << result.err;
    };
    run({"precompute", "box.obj", "-o", "box.prt", "--per-vertex", "--rays", "64", "--quiet"});
    run({"compress", "box.prt", "--components", "6", "--quiet"});
    const auto relight = [&](Words options) {
        const Words common = {"relight", "box.prt",     "--elevation", "50",          "--size", "16x12",
                              "--quiet", "--technique", "unc",         "--technique", "pca"};
        options.insert(options.begin(), common.begin(), common.end());
        run(options);
    };
    relight({"--env", "sky:sunset", "--env", "sky:clear", "--transition", fmt::format("1:2:{}", kFrames),
             "--rotate-light", std::to_string(kFrames), "-o", "{technique}.{frame}.exr"});
    for (const int frame : {0, kFrames / 2, kFrames - 1}) {
        const double to = double(frame) / (kFrames - 1);
        relight({"--env", fmt::format("sky:sunset:{:.17g}", 1 - to), "--env",
                 fmt::format("sky:clear:{:.17g}", to), "--rotate",
                 fmt::format("{:.17g}", 360.0 * frame / kFrames), "-o", "{technique}.fresh.exr"});
        for (const char* technique : {"unc", "pca"}) {
            const std::string fresh = slurp(folder / fmt::format("{}.fresh.exr", technique));
            EXPECT_FALSE(fresh.empty());
            EXPECT_TRUE(fresh == slurp(folder / fmt::format("{}.{:04}.exr", technique, frame)))
                << technique << ", frame " << frame;
        }
    }
}

}  // namespace
}  // namespace prt::test
