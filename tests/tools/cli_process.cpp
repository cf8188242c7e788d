// Interrupts, kills and full disks: the previous bundle stays as it was, and nothing half-written stays.
#include <fstream>
#include <map>
#include <sstream>

#include "tests/tools/prt_process.h"

namespace prt::test {
namespace {
namespace fs = std::filesystem;

std::map<std::string, std::string> contents(const Folder& folder) {
    std::map<std::string, std::string> all;
    for (const std::string& name : folder.files()) all[name] = slurp(folder / name);
    return all;
}

class Process : public testing::Test {
  protected:
    void SetUp() override {
        folder_.write("box.obj", openBoxObj());
        ASSERT_EQ(runPrt(folder_, {"precompute", "box.obj", "-o", "box.prt", "--texels", "64", "--rays", "64",
                                   "--order", "3", "--quiet"})
                      .exitCode,
                  0);
        before_ = contents(folder_);
    }
    /// Enough work for an interrupt to fall into it.
    const std::vector<std::string> longBake_ = {"precompute", "box.obj", "-o",     "box.prt",
                                                "--texels",   "1024",    "--rays", "200000",
                                                "--order",    "6",       "--quiet"};
    /// Runs prt under `timeout`, which sends the signal after `seconds`.
    ProcessResult signalled(const std::string& signal, const std::string& seconds) {
        return runPrt(folder_, longBake_, "timeout --preserve-status -s " + signal + " " + seconds);
    }
    Folder folder_;
    std::map<std::string, std::string> before_;
};

TEST_F(Process, InterruptLeavesThePreviousBundle) {
    const ProcessResult result = signalled("INT", "1.5");
    EXPECT_EQ(result.exitCode, 130) << result.err;
    EXPECT_NE(result.err.find("interrupted"), std::string::npos);
    EXPECT_EQ(contents(folder_), before_);
}

TEST_F(Process, TerminateToo) {
    EXPECT_EQ(signalled("TERM", "1.5").exitCode, 130);
    EXPECT_EQ(contents(folder_), before_);
}

TEST_F(Process, InterruptOfANewBundleLeavesNone) {
    fs::remove_all(folder_ / "box.prt");
    EXPECT_EQ(signalled("INT", "1.5").exitCode, 130);
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"box.obj"}));
    EXPECT_FALSE(fs::exists(folder_ / "box.prt"));
}

TEST_F(Process, TheNextRunRemovesWhatAKillLeft) {
    // A temporary of a process that is gone: the largest process id there is belongs to nobody.
    folder_.write("box.prt/visibility.exr.prt-tmp-4194399-0", "half");
    ASSERT_EQ(runPrt(folder_, {"compress", "box.prt", "--components", "3", "--quiet"}).exitCode, 0);
    for (const std::string& name : folder_.files())
        EXPECT_EQ(name.find("prt-tmp"), std::string::npos) << name;
}

TEST_F(Process, KilledRunLeavesThePreviousBundleUsable) {
    EXPECT_NE(signalled("KILL", "1.5").exitCode, 0);
    auto after = contents(folder_);
    for (const auto& [name, bytes] : before_) EXPECT_EQ(after.at(name), bytes) << name;
    EXPECT_EQ(runPrt(folder_, {"info", "box.prt"}).exitCode, 0);
}

TEST_F(Process, FullDiskIsAnOutputError) {
    // A file-size limit of 8 blocks of 512 bytes stands for the disk that fills up.
    const ProcessResult result = runPrt(folder_,
                                        {"precompute", "box.obj", "-o", "box.prt", "--texels", "128",
                                         "--rays", "64", "--order", "6", "--quiet"},
                                        "ulimit -f 8;");
    EXPECT_EQ(result.exitCode, 4) << result.err;
    EXPECT_EQ(contents(folder_), before_);
    const ProcessResult picture = runPrt(
        folder_, {"relight", "box.prt", "-o", "big.exr", "--size", "256x256", "--quiet"}, "ulimit -f 8;");
    EXPECT_EQ(picture.exitCode, 4) << picture.err;
    EXPECT_EQ(contents(folder_), before_);
}

TEST_F(Process, ClosedStandardOutputIsAnOutputError) {
    const ProcessResult result = runPrt(folder_, {"info", "box.prt", "--json", "/dev/full"});
    EXPECT_EQ(result.exitCode, 4) << result.err;
}

}  // namespace
}  // namespace prt::test
