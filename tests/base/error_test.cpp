// Errors are one line: where, what, and what to do.
#include "precompute/base/error.h"

#include "precompute/base/check.h"

namespace prt {
namespace {

TEST(Error, OneLineOfThreeParts) {
    const InputError error("bunny.obj:1042", "face uses vertex 9999 of 35947", "re-export the mesh");
    EXPECT_STREQ(error.what(), "bunny.obj:1042: face uses vertex 9999 of 35947; re-export the mesh");
    EXPECT_EQ(error.where(), "bunny.obj:1042");
    EXPECT_EQ(error.problem(), "face uses vertex 9999 of 35947");
    EXPECT_EQ(error.remedy(), "re-export the mesh");
}

TEST(Error, PartsMayBeEmpty) {
    EXPECT_STREQ(OutputError("a.exr", "disk full").what(), "a.exr: disk full");
    EXPECT_STREQ(UsageError("", "no command").what(), "no command");
}

TEST(Error, LineBreaksOfOthersAreTakenOut) {
    EXPECT_STREQ(InputError("a", "first\nsecond\r\n").what(), "a: first second");
}

TEST(Error, KindsAreToldApart) {
    EXPECT_THROW(throw InputError("a", "b"), Error);
    bool output = false;
    try {
        throw OutputError("a", "b");
    } catch (const InputError&) {
    } catch (const OutputError&) {
        output = true;
    }
    EXPECT_TRUE(output);
}

TEST(Interrupt, IsRememberedUntilCleared) {
    clearInterrupt();
    EXPECT_NO_THROW(throwIfInterrupted());
    requestInterrupt();
    EXPECT_TRUE(interruptRequested());
    EXPECT_THROW(throwIfInterrupted(), Interrupted);
    EXPECT_THROW(throwIfInterrupted(), Interrupted);
    clearInterrupt();
    EXPECT_NO_THROW(throwIfInterrupted());
}

TEST(CheckDeathTest, PrintsBothValuesAndAborts) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";
    const int two = 2;
    EXPECT_DEATH(PRT_CHECK_EQ(two, 3), "two == 3: 2 against 3");
    EXPECT_DEATH(PRT_CHECK_LT(3, two), "3 against 2");
    EXPECT_DEATH(PRT_CHECK(two == 3), "check failed: two == 3");
    PRT_CHECK_LE(two, 2);
    PRT_CHECK(two == 2);
}

}  // namespace
}  // namespace prt
