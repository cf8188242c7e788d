// Help, version, no arguments, JSON and quiet, for every subcommand.
#include <nlohmann/json.hpp>

#include "tests/tools/prt_process.h"

namespace prt::test {
namespace {

const std::vector<std::string> kCommands = {"precompute", "compress", "tabulate", "relight", "info"};

TEST(Options, NoArgumentsPrintsUsageAndFails) {
    Folder folder;
    const ProcessResult result = runPrt(folder, {});
    EXPECT_EQ(result.exitCode, 2);
    for (const std::string& command : kCommands) EXPECT_NE(result.err.find(command), std::string::npos);
}

TEST(Options, HelpAndVersion) {
    Folder folder;
    for (const char* word : {"--help", "-h", "help"}) EXPECT_EQ(runPrt(folder, {word}).exitCode, 0);
    const ProcessResult version = runPrt(folder, {"--version"});
    EXPECT_EQ(version.exitCode, 0);
    EXPECT_TRUE(version.out.starts_with("prt 0.")) << version.out;
}

TEST(Options, EverySubcommandHasHelpWithDefaultsAndRanges) {
    Folder folder;
    for (const std::string& command : kCommands) {
        const ProcessResult result = runPrt(folder, {command, "--help"});
        EXPECT_EQ(result.exitCode, 0) << command;
        EXPECT_TRUE(result.err.empty()) << result.err;
        for (const char* option : {"--json", "--threads", "--quiet", "[0..1024, default 0]"})
            EXPECT_NE(result.out.find(option), std::string::npos) << command << " " << option;
    }
    const std::string help = runPrt(folder, {"precompute", "--help"}).out;
    for (const char* text : {"[16..8192, default 512]", "[1..10, default 6]", "[1..262144, default 1024]"})
        EXPECT_NE(help.find(text), std::string::npos) << text << " in\n" << help;
}

TEST(Options, SubcommandsWithoutArgumentsAreUsageErrors) {
    Folder folder;
    for (const std::string& command : kCommands) {
        const ProcessResult result = runPrt(folder, {command});
        EXPECT_EQ(result.exitCode, 2) << command;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
}

TEST(Options, JsonOnStandardOutputIsNothingButJson) {
    Folder folder;
    folder.write("box.obj", openBoxObj());
    const std::vector<std::vector<std::string>> commands = {
        {"precompute", "box.obj", "-o", "box.prt", "--texels", "32", "--rays", "64", "--order", "3"},
        {"compress", "box.prt", "--components", "4"},
        {"tabulate", "box.prt", "sky:clear", "--size", "8"},
        {"relight", "box.prt", "-o", "a.png", "--size", "32x20", "--compare-reference"},
        {"info", "box.prt"}};
    const std::vector<std::vector<std::string>> keys = {
        {"points", "rays", "rays_per_s", "seconds", "peak_rss_bytes", "validity"},
        {"components", "explained_variance", "relative_rmse", "seconds"},
        {"rows"},
        {"floor_rmse", "rows"},
        {"format_version", "conventions", "files"}};
    for (size_t i = 0; i < commands.size(); ++i) {
        auto arguments = commands[i];
        arguments.insert(arguments.end(), {"--json", "-"});
        const ProcessResult result = runPrt(folder, arguments);
        ASSERT_EQ(result.exitCode, 0) << result.err;
        const auto json = nlohmann::json::parse(result.out, nullptr, false);
        ASSERT_TRUE(json.is_object()) << result.out;
        for (const std::string& key : keys[i])
            EXPECT_TRUE(json.contains(key)) << commands[i][0] << " " << key;
    }
}

TEST(Options, QuietSaysNothing) {
    Folder folder;
    folder.write("box.obj", openBoxObj());
    const ProcessResult result = runPrt(folder, {"precompute", "box.obj", "-o", "box.prt", "--texels", "32",
                                                 "--rays", "64", "--order", "3", "--quiet"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_EQ(result.err, "");
}

}  // namespace
}  // namespace prt::test
