// Files appear whole or not at all: on success, on exceptions, on a full disk, after a kill.
#include "precompute/base/atomic_file.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "precompute/base/error.h"
#include "tests/base/small_disk.h"
#include "tests/base/temporary_directory.h"

namespace prt {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(AtomicFile, ReplacesTheDestinationOnCommitOnly) {
    TemporaryDirectory directory;
    const std::string path = directory.file("a.txt");
    writeFileAtomically(path, "old");
    {
        AtomicFile file(path);
        std::ofstream(file.temporaryPath()) << "new";
        EXPECT_EQ(readFile(path), "old");
        EXPECT_EQ(file.temporaryPath().parent_path(), directory.path());
        file.commit();
        EXPECT_EQ(readFile(path), "new");
    }
    EXPECT_THAT(directory.names(), ElementsAre("a.txt"));
}

TEST(AtomicFile, LeavesNothingWithoutCommit) {
    TemporaryDirectory directory;
    { AtomicFile file(directory.path() / "a.txt"); }
    EXPECT_THAT(directory.names(), ElementsAre());
}

TEST(AtomicFile, TwoOfOneDestinationDoNotMix) {
    TemporaryDirectory directory;
    const std::string path = directory.file("a.txt");
    AtomicFile first(path), second(path);
    std::ofstream(first.temporaryPath()) << "first";
    std::ofstream(second.temporaryPath()) << "second";
    second.commit();
    first.commit();
    EXPECT_EQ(readFile(path), "first");
}

TEST(AtomicFile, RefusesWhatIsNoFile) {
    TemporaryDirectory directory;
    fs::create_directory(directory.path() / "sub");
    EXPECT_THROW(AtomicFile(directory.path() / "sub"), OutputError);
    EXPECT_THROW(AtomicFile(directory.path() / "absent" / "a.txt"), OutputError);
    EXPECT_THROW(AtomicFile("/proc/a.txt"), OutputError);
    // Renamed over, the device would be gone.
    EXPECT_THROW(AtomicFile("/dev/null"), OutputError);
    EXPECT_THROW(writeFileAtomically("/dev/full", "text"), OutputError);
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST(AtomicFile, WritesThroughSymbolicLinks) {
    TemporaryDirectory directory;
    writeFileAtomically(directory.path() / "target", "old");
    fs::create_symlink("target", directory.path() / "link");
    writeFileAtomically(directory.path() / "link", "new");
    EXPECT_TRUE(fs::is_symlink(directory.path() / "link"));
    EXPECT_EQ(readFile(directory.path() / "target"), "new");
}

TEST(AtomicFile, FullDiskLeavesTheOldFile) {
    TemporaryDirectory directory;
    const std::string path = directory.file("a.bin");
    writeFileAtomically(path, "old");
    const std::string large(100000, 'x');
    try {
        const SmallDisk disk(4096);
        writeFileAtomically(path, large);
        FAIL() << "wrote 100000 bytes where 4096 fit";
    } catch (const OutputError& error) {
        EXPECT_THAT(error.what(), HasSubstr(path));
        EXPECT_THAT(error.what(), HasSubstr("cannot be written"));
    }
    EXPECT_EQ(readFile(path), "old");
    EXPECT_THAT(directory.names(), ElementsAre("a.bin"));
}

TEST(AtomicFile, EveryByteSurvives) {
    TemporaryDirectory directory;
    std::string all;
    for (int i = 0; i < 256 * 700; ++i) all.push_back(char(i % 256));
    writeFileAtomically(directory.path() / "a", all);
    EXPECT_EQ(readFile(directory.path() / "a"), all);
    writeFileAtomically(directory.path() / "a", "");
    EXPECT_EQ(readFile(directory.path() / "a"), "");
}

TEST(StaleTemporaries, ThoseOfKilledProcessesGo) {
    TemporaryDirectory directory;
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        AtomicFile file(directory.path() / "a.txt");
        ::kill(::getpid(), SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    ASSERT_EQ(directory.names().size(), 1u);
    writeFileAtomically(directory.path() / "kept.txt", "kept");

    EXPECT_EQ(removeStaleTemporaries(directory.path()), 1);
    EXPECT_THAT(directory.names(), ElementsAre("kept.txt"));
}

TEST(StaleTemporaries, ThoseOfLivingProcessesStay) {
    TemporaryDirectory directory;
    AtomicFile own(directory.path() / "own.txt");
    // The parent of this process lives; process 1 does too, and may be another user's.
    std::ofstream(directory.path() / ("parent.prt-tmp-" + std::to_string(::getppid()) + "-0")) << "x";
    std::ofstream(directory.path() / "init.prt-tmp-1-0") << "x";
    EXPECT_EQ(removeStaleTemporaries(directory.path()), 0);
    EXPECT_EQ(directory.names().size(), 3u);
    EXPECT_EQ(removeStaleTemporaries(directory.path() / "absent"), 0);
}

TEST(ReadFile, RefusesWhatItCannotRead) {
    TemporaryDirectory directory;
    EXPECT_THROW(readFile(directory.path()), InputError);
    try {
        readFile(directory.path() / "absent.txt");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("absent.txt"));
        EXPECT_THAT(error.what(), HasSubstr("No such file"));
    }
}

}  // namespace
}  // namespace prt
