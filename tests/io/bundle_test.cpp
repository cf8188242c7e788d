// The bundle: all or nothing, stale files named with their remedy, crashes and concurrency survived.
#include "precompute/io/bundle.h"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/io/manifest.h"
#include "tests/base/small_disk.h"
#include "tests/base/temporary_directory.h"

namespace prt {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

void put(BundleTransaction& transaction, const std::string& name, const std::string& text,
         std::map<std::string, std::string> madeFrom = {}, const std::string& madeBy = "prt something") {
    std::ofstream(transaction.stage(name, std::move(madeFrom), madeBy)) << text;
}

/// visibility.exr ← pca.exr ← tables/a.exr, and a mesh beside them.
void writeChain(const fs::path& path) {
    BundleTransaction transaction(path, true);
    put(transaction, "mesh.glb", "mesh", {{"house.obj", "0123"}}, "prt precompute house.obj");
    put(transaction, "visibility.exr", "visibility", {{"mesh.glb", transaction.hashOfStaged("mesh.glb")}},
        "prt precompute house.obj");
    put(transaction, "pca.exr", "pca", {{"visibility.exr", transaction.hashOfStaged("visibility.exr")}},
        "prt compress house.prt");
    put(transaction, "tables/a.exr", "table", {{"pca.exr", transaction.hashOfStaged("pca.exr")}},
        "prt tabulate house.prt a.exr");
    transaction.setSection("precompute", R"({"rays": 1024, "name": "é"})");
    transaction.commit();
}

std::map<std::string, std::string> snapshot(const TemporaryDirectory& directory) {
    std::map<std::string, std::string> all;
    for (const std::string& name : directory.names())
        all[name] = fs::is_directory(directory.path() / name) ? "" : readFile(directory.path() / name);
    return all;
}

std::string messageOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

TEST(Xxh3, MatchesKnownValues) {
    // XXH3-128 of nothing and of "abc" with seed 0, as printed by xxhsum -H128.
    EXPECT_EQ(xxh3Hex("", 0), "99aa06d3014798d86001c324468d497f");
    EXPECT_EQ(xxh3Hex("abc", 3), "06b05ab6733a618578af5f94892f3950");
}

TEST(Xxh3, OfAFileEqualsThatOfItsBytes) {
    TemporaryDirectory directory;
    std::string bytes(3'000'001, '\0');
    for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = char(i * i);
    writeFileAtomically(directory.path() / "a", bytes);
    EXPECT_EQ(xxh3HexOfFile(directory.path() / "a"), xxh3Hex(bytes.data(), bytes.size()));
    EXPECT_THROW(xxh3HexOfFile(directory.path() / "absent"), InputError);
    EXPECT_THROW(xxh3HexOfFile(directory.path()), InputError);
}

TEST(Bundle, RoundTrip) {
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "out" / "house.prt";
    writeChain(path);
    const Bundle bundle = Bundle::open(path);
    EXPECT_EQ(bundle.directory(), path);
    ASSERT_EQ(bundle.files().size(), 4u);
    const BundleFile* pca = bundle.find("pca.exr");
    ASSERT_NE(pca, nullptr);
    EXPECT_EQ(pca->bytes, 3u);
    EXPECT_EQ(pca->xxh3, xxh3Hex("pca", 3));
    EXPECT_EQ(pca->madeBy, "prt compress house.prt");
    EXPECT_EQ(pca->madeFrom.at("visibility.exr"), xxh3Hex("visibility", 10));
    EXPECT_EQ(bundle.find("absent"), nullptr);
    EXPECT_EQ(readFile(bundle.pathOf("tables/a.exr")), "table");
    EXPECT_THAT(bundle.section("precompute"), HasSubstr("1024"));
    EXPECT_THAT(bundle.section("precompute"), HasSubstr("é"));
    EXPECT_EQ(bundle.section("absent"), "{}");
    EXPECT_THAT(bundle.sectionNames(), ElementsAre("precompute"));
    EXPECT_THAT(directory.names(),
                ElementsAre("out", "out/house.prt", "out/house.prt/manifest.json", "out/house.prt/mesh.glb",
                            "out/house.prt/pca.exr", "out/house.prt/tables", "out/house.prt/tables/a.exr",
                            "out/house.prt/visibility.exr"));
    for (const char* name : {"mesh.glb", "visibility.exr", "pca.exr", "tables/a.exr"}) {
        EXPECT_EQ(bundle.staleReason(name, true), "") << name;
        EXPECT_NO_THROW(bundle.require(name, "prt something"));
    }
}

TEST(Bundle, UpdatesKeepWhatTheyDoNotTouch) {
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "house.prt";
    writeChain(path);
    {
        BundleTransaction transaction(path, false);
        put(transaction, "tables/b.exr", "another");
        transaction.setSection("tabulate", "[1, 2]");
        transaction.commit();
    }
    const Bundle bundle = Bundle::open(path);
    EXPECT_EQ(bundle.files().size(), 5u);
    EXPECT_EQ(bundle.staleReason("tables/a.exr", true), "");
    EXPECT_THAT(bundle.sectionNames(), ElementsAre("precompute", "tabulate"));
    EXPECT_THAT(bundle.section("precompute"), HasSubstr("1024"));
}

TEST(Bundle, SameInputsGiveTheSameBytes) {
    TemporaryDirectory directory;
    writeChain(directory.path() / "a.prt");
    writeChain(directory.path() / "b.prt");
    EXPECT_EQ(readFile(directory.path() / "a.prt/manifest.json"),
              readFile(directory.path() / "b.prt/manifest.json"));
}

TEST(Bundle, StalenessFollowsTheInputs) {
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "house.prt";
    writeChain(path);
    {
        BundleTransaction transaction(path, false);
        put(transaction, "visibility.exr", "VISIBILITY", {}, "prt precompute house.obj");
        transaction.commit();
    }
    const Bundle bundle = Bundle::open(path);
    EXPECT_EQ(bundle.staleReason("visibility.exr", true), "");
    EXPECT_EQ(bundle.staleReason("pca.exr", true), "made from another visibility.exr");
    EXPECT_EQ(bundle.staleReason("tables/a.exr", true),
              "made from pca.exr, which is made from another visibility.exr");
    EXPECT_EQ(bundle.staleReason("mesh.glb", true), "");
    // The command is that of the file to renew first.
    EXPECT_THAT(messageOf([&] { bundle.require("tables/a.exr", "prt tabulate"); }),
                testing::AllOf(HasSubstr("tables/a.exr"), HasSubstr("made from another visibility.exr"),
                               HasSubstr("run prt compress house.prt")));
    EXPECT_THAT(messageOf([&] { bundle.require("absent.exr", "prt absent"); }), HasSubstr("run prt absent"));
}

TEST(Bundle, ChangedAndMissingFilesAreFound) {
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "house.prt";
    writeChain(path);
    const Bundle bundle = Bundle::open(path);
    // Same size, other bytes: only reading it tells.
    std::ofstream(path / "visibility.exr") << "visibilitY";
    EXPECT_EQ(bundle.staleReason("visibility.exr", false), "");
    EXPECT_EQ(bundle.staleReason("visibility.exr", true), "changed since it was written");
    EXPECT_THROW(bundle.require("pca.exr", "x"), InputError);
    std::ofstream(path / "visibility.exr") << "vis";
    EXPECT_EQ(bundle.staleReason("visibility.exr", false), "changed since it was written");
    fs::remove(path / "visibility.exr");
    EXPECT_EQ(bundle.staleReason("visibility.exr", false), "missing");
    EXPECT_EQ(bundle.staleReason("pca.exr", false), "made from visibility.exr, which is missing");
    EXPECT_EQ(bundle.staleReason("other", false), "not in the bundle");
}

TEST(Bundle, CircularInputsEnd) {
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "a.prt";
    {
        BundleTransaction transaction(path, true);
        put(transaction, "a", "1");
        put(transaction, "b", "2", {{"a", transaction.hashOfStaged("a")}});
        transaction.setMadeFrom("a", {{"b", transaction.hashOfStaged("b")}});
        transaction.commit();
    }
    EXPECT_EQ(Bundle::open(path).staleReason("a", true), "");
}

TEST(BundleTransaction, WithoutCommitNothingChanges) {
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "house.prt";
    writeChain(path);
    const auto before = snapshot(directory);
    {
        BundleTransaction transaction(path, false);
        put(transaction, "visibility.exr", "other");
        put(transaction, "new/deep/file", "new");
        transaction.setSection("precompute", "{}");
    }
    EXPECT_EQ(snapshot(directory), before);
}

TEST(BundleTransaction, WithoutCommitItsDirectoryGoes) {
    TemporaryDirectory directory;
    {
        BundleTransaction transaction(directory.path() / "out" / "house.prt/", true);
        put(transaction, "tables/a.exr", "a");
        EXPECT_TRUE(fs::is_directory(directory.path() / "out" / "house.prt" / "tables"));
    }
    EXPECT_THAT(directory.names(), ElementsAre());
}

TEST(BundleTransaction, AFileNeverWrittenFailsWhole) {
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "house.prt";
    writeChain(path);
    const auto before = snapshot(directory);
    {
        BundleTransaction transaction(path, false);
        put(transaction, "visibility.exr", "other");
        transaction.stage("pca.exr", {}, "");
        EXPECT_THROW(transaction.commit(), OutputError);
    }
    EXPECT_EQ(snapshot(directory), before);
}

TEST(BundleTransaction, AFailedRenameRollsAllBack) {
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "house.prt";
    writeChain(path);
    // A directory where the last file should go: its rename fails after the others'.
    fs::create_directories(path / "z.exr" / "full");
    const auto before = snapshot(directory);
    {
        BundleTransaction transaction(path, false);
        put(transaction, "visibility.exr", "other");
        put(transaction, "brand-new.exr", "new");
        put(transaction, "z.exr", "z");
        EXPECT_THROW(transaction.commit(), OutputError);
    }
    EXPECT_EQ(snapshot(directory), before);
    EXPECT_EQ(Bundle::open(path).staleReason("tables/a.exr", true), "");
}

TEST(BundleTransaction, AFullDiskAtTheManifestRollsAllBack) {
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "house.prt";
    writeChain(path);
    const auto before = snapshot(directory);
    {
        BundleTransaction transaction(path, false);
        put(transaction, "visibility.exr", "other");
        const SmallDisk disk(64);
        EXPECT_THROW(transaction.commit(), OutputError);
    }
    EXPECT_EQ(snapshot(directory), before);
}

TEST(BundleTransaction, AKilledRunLeavesTheBundleAndIsCleanedUp) {
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "house.prt";
    writeChain(path);
    const auto before = snapshot(directory);
    const pid_t child = ::fork();
    if (child == 0) {
        BundleTransaction transaction(path, false);
        put(transaction, "visibility.exr", "other");
        put(transaction, "tables/b.exr", "other");
        ::kill(::getpid(), SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(snapshot(directory).size(), before.size() + 2);
    EXPECT_EQ(Bundle::open(path).staleReason("tables/a.exr", true), "");
    { BundleTransaction next(path, false); }
    EXPECT_EQ(snapshot(directory), before);
}

TEST(BundleTransaction, AKillBetweenTheRenamesIsUndone) {
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "house.prt";
    writeChain(path);
    const auto before = snapshot(directory);
    // What such a kill leaves: the new file in place, the old one as a backup, the old manifest. No process
    // has a number beyond the kernel's limit of 2^22.
    fs::rename(path / "visibility.exr", path / "visibility.exr.prt-tmp-9999999-b0-backup");
    std::ofstream(path / "visibility.exr") << "half a commit";
    EXPECT_EQ(Bundle::open(path).staleReason("visibility.exr", true), "changed since it was written");
    testing::internal::CaptureStderr();
    { BundleTransaction next(path, false); }
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("restored"));
    EXPECT_EQ(snapshot(directory), before);
    // A backup of a commit that did end is only removed.
    std::ofstream(path / "visibility.exr.prt-tmp-9999999-b0-backup") << "older still";
    { BundleTransaction next(path, false); }
    EXPECT_EQ(snapshot(directory), before);
}

TEST(BundleTransaction, ManyProcessesAtOnceLeaveASoundBundle) {
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "house.prt";
    writeChain(path);
    std::vector<pid_t> children;
    for (int i = 0; i < 4; ++i) {
        const pid_t child = ::fork();
        if (child == 0) {
            int failures = 0;
            for (int round = 0; round < 10; ++round) try {
                    BundleTransaction transaction(path, true);
                    const std::string text(size_t(1000 + i * 10 + round), char('a' + i));
                    put(transaction, "visibility.exr", text);
                    put(transaction, "pca.exr", text,
                        {{"visibility.exr", transaction.hashOfStaged("visibility.exr")}});
                    put(transaction, "tables/" + std::to_string(i) + ".exr", text);
                    transaction.commit();
                } catch (const Error&) {
                    ++failures;
                }
            ::_exit(failures);
        }
        children.push_back(child);
    }
    for (pid_t child : children) {
        int status = 0;
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    const Bundle bundle = Bundle::open(path);
    for (const char* name :
         {"visibility.exr", "pca.exr", "tables/0.exr", "tables/1.exr", "tables/2.exr", "tables/3.exr"})
        EXPECT_EQ(bundle.staleReason(name, true), "") << name;
    for (const std::string& name : directory.names()) EXPECT_THAT(name, testing::Not(HasSubstr("prt-tmp")));
}

TEST(BundleTransaction, RefusesOtherPlaces) {
    TemporaryDirectory directory;
    EXPECT_THROW(BundleTransaction(directory.path() / "absent.prt", false), InputError);
    std::ofstream(directory.path() / "file") << "x";
    EXPECT_THROW(BundleTransaction(directory.path() / "file", true), OutputError);
    EXPECT_THROW(BundleTransaction(directory.path() / "file" / "a.prt", true), OutputError);
    EXPECT_THROW(BundleTransaction("/proc/none/a.prt", true), OutputError);
    const auto before = snapshot(directory);
    EXPECT_THAT(messageOf([&] { BundleTransaction(directory.path(), true); }), HasSubstr("holds file"));
    EXPECT_EQ(snapshot(directory), before);
    fs::create_directory(directory.path() / "empty");
    EXPECT_THROW(BundleTransaction(directory.path() / "empty", false), InputError);
    EXPECT_NO_THROW(BundleTransaction(directory.path() / "empty", true));
    EXPECT_TRUE(fs::exists(directory.path() / "empty")) << "it did not make this one";
}

TEST(BundleTransaction, AnUnwritableDirectoryIsAnOutputError) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "house.prt";
    writeChain(path);
    fs::permissions(path, fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_THROW(BundleTransaction(path, false), OutputError);
    fs::permissions(path, fs::perms::owner_all);
}

TEST(Manifest, NamesStayInside) {
    for (const char* name : {"../a", "/a", "", "manifest.json", "a/../../b", "a/", "./a", "a.prt-tmp-1-0"})
        EXPECT_FALSE(isBundleFileName(name)) << name;
    for (const char* name : {"mesh.glb", "tables/a.exr", "a..b", "tables/deep/a"})
        EXPECT_TRUE(isBundleFileName(name)) << name;
}

class DamagedManifest : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(DamagedManifest, IsRefused) {
    TemporaryDirectory directory;
    const fs::path path = directory.path() / "house.prt";
    writeChain(path);
    std::string text = readFile(path / "manifest.json");
    const auto& [from, to] = GetParam();
    const size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, std::string(from).size(), to);
    std::ofstream(path / "manifest.json") << text;
    EXPECT_THAT(messageOf([&] { Bundle::open(path); }), HasSubstr("manifest.json"));
    EXPECT_THROW(Bundle::open(path), InputError);
    EXPECT_THROW(BundleTransaction(path, true), InputError);
}

INSTANTIATE_TEST_SUITE_P(
    Each, DamagedManifest,
    testing::Values(std::pair{"\"prt-bundle\"", "\"zip\""}, std::pair{"\"prt-bundle\"", "1"},
                    std::pair{"\"formatVersion\": 1", "\"formatVersion\": 2"},
                    std::pair{"\"formatVersion\": 1", "\"formatVersion\": \"1\""},
                    std::pair{"\"formatVersion\": 1,", ""},
                    std::pair{"\"files\": [",
                              "\"files\": ["
                              "7,"},
                    std::pair{"\"files\"", "\"Files\""}, std::pair{"\"mesh.glb\"", "\"../mesh\""},
                    std::pair{"\"mesh.glb\"", "\"pca.exr\""}, std::pair{"\"bytes\": 4", "\"bytes\": -4"},
                    std::pair{"\"xxh3_128\": \"", "\"xxh3_128\": \"x"},
                    std::pair{"\"made_from\": {", "\"made_from\": {\"a\": 1,"},
                    std::pair{"\"sections\": {", "\"sections\": [{}], \"x\": {"}, std::pair{"{", "["},
                    std::pair{"{", ""}));

TEST(Manifest, WrongVersionSaysBoth) {
    TemporaryDirectory directory;
    writeChain(directory.path() / "a.prt");
    const std::string path = directory.file("a.prt/manifest.json");
    std::string text = readFile(path);
    text.replace(text.find("\"formatVersion\": 1"), 18, "\"formatVersion\": 7");
    rewriteFile(path, text);
    EXPECT_THAT(messageOf([&] { Bundle::open(directory.path() / "a.prt"); }),
                testing::AllOf(HasSubstr("version 7"), HasSubstr("reads 1")));
}

TEST(Manifest, TruncationAndNestingNeverCrash) {
    TemporaryDirectory directory;
    writeChain(directory.path() / "a.prt");
    const std::string path = directory.file("a.prt/manifest.json"), text = readFile(path);
    // All but the last line break is needed.
    for (size_t length = 0; length + 1 < text.size(); length += 3) {
        rewriteFile(path, text.substr(0, length));
        EXPECT_THROW(Bundle::open(directory.path() / "a.prt"), InputError) << length;
    }
    rewriteFile(path, std::string(1'000'000, '['));
    EXPECT_THROW(Bundle::open(directory.path() / "a.prt"), InputError);
    rewriteFile(path, "{\"x\":" + std::string(1'000'000, '[') + std::string(1'000'000, ']') + "}");
    EXPECT_THROW(Bundle::open(directory.path() / "a.prt"), InputError);
}

}  // namespace
}  // namespace prt
