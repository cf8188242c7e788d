// What is said on stderr, and when.
#include "precompute/base/log.h"

#include <thread>

#include "precompute/base/error.h"

namespace prt {
namespace {

using testing::HasSubstr;
using testing::internal::CaptureStderr;
using testing::internal::GetCapturedStderr;

class Log : public testing::Test {
  protected:
    void SetUp() override {
        clearInterrupt();
        setQuiet(false);
        setProgramName("prt test");
    }
    void TearDown() override {
        clearInterrupt();
        setQuiet(false);
        setProgramName("prt");
    }
};

TEST_F(Log, QuietSilencesNotesButNotWarnings) {
    CaptureStderr();
    logNote("a note");
    logWarning("a warning");
    EXPECT_EQ(GetCapturedStderr(), "prt test: a note\nprt test: warning: a warning\n");
    setQuiet(true);
    CaptureStderr();
    logNote("a note");
    logWarning("a warning");
    EXPECT_EQ(GetCapturedStderr(), "prt test: warning: a warning\n");
}

TEST_F(Log, ProgressCountsFromManyThreads) {
    CaptureStderr();
    {
        Progress progress("tracing", 4000, "texels");
        std::vector<std::thread> threads;
        for (int t = 0; t < 4; ++t)
            threads.emplace_back([&] {
                for (int i = 0; i < 1000; ++i) progress.advance(1);
            });
        for (std::thread& thread : threads) thread.join();
    }
    // Not a terminal, and over in less than the interval: no line at all.
    EXPECT_EQ(GetCapturedStderr(), "");
}

TEST_F(Log, ProgressHearsInterrupts) {
    Progress progress("tracing", 10, "texels");
    progress.advance(1);
    requestInterrupt();
    EXPECT_THROW(progress.advance(1), Interrupted);
}

TEST_F(Log, ProgressOfNothingIsHarmless) {
    Progress progress("tracing", 0, "texels");
    EXPECT_NO_THROW(progress.advance(0));
    EXPECT_NO_THROW(progress.advance(5));
}

TEST_F(Log, StopwatchRunsForward) {
    const Stopwatch watch;
    const double first = watch.seconds();
    EXPECT_GE(first, 0);
    EXPECT_GE(watch.seconds(), first);
}

}  // namespace
}  // namespace prt
