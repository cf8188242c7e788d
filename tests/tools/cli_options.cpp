// Help, version, no arguments, JSON and quiet, for every subcommand.
#include <nlohmann/json.hpp>

#include "tests/tools/prt_process.h"

namespace prt::test {
namespace {

const std::vector<std::string> kCommands = {"precompute", "compress", "tabulate", "lightmap",
                                            "relight",    "export",   "info"};
const std::vector<std::string> kMeasurements = {
    "bake",    "basis",      "compression", "error",    "frame-time", "parameterization",
    "product", "projection", "rotation",    "sampling", "tables",     "techniques"};

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

TEST(Options, EveryMeasurementIsListedAndHasHelp) {
    Folder folder;
    const ProcessResult list = runPrt(folder, {"measure", "--help"});
    EXPECT_EQ(list.exitCode, 0) << list.err;
    const ProcessResult bare = runPrt(folder, {"measure"});
    EXPECT_EQ(bare.exitCode, 2);
    EXPECT_EQ(std::count(bare.err.begin(), bare.err.end(), '\n'), 1) << bare.err;
    for (const std::string& name : kMeasurements) {
        EXPECT_NE(list.out.find("\n  " + name + " "), std::string::npos) << name;
        const ProcessResult result = runPrt(folder, {"measure", name, "--help"});
        EXPECT_EQ(result.exitCode, 0) << name;
        EXPECT_TRUE(result.err.empty()) << result.err;
        for (const char* option : {"--output", "--plot", "--json", "--quiet", "[0..1024, default 0]"})
            EXPECT_NE(result.out.find(option), std::string::npos) << name << " " << option;
    }
    EXPECT_TRUE(folder.files().empty());
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
        {"export", "box.prt", "-o", "ship"},
        {"measure", "tables", "--env", "sky:clear", "--sizes", "8", "--layouts", "cube", "--points", "50",
         "--rounds", "1", "--order", "3", "--plot", "none"},
        {"info", "box.prt"},
        {"measure", "basis", "--signal", "functions", "--bases", "h", "--plot", "none"},
        {"measure", "parameterization", "--orders", "2", "--points", "1000", "--max-samples", "100", "--plot",
         "none"},
        {"measure", "product", "--orders", "3", "--rounds", "1", "--plot", "none"},
        {"measure", "rotation", "--orders", "3", "--rounds", "1", "--error-orders", "3", "--hsh-orders", "2",
         "--table-angles", "5", "--plot", "none"},
        {"measure", "projection", "box.obj", "--points", "2", "--population", "20", "--rays", "64",
         "--orders", "3", "--tilts", "0", "--env", "sky:overcast", "--plot", "none"},
        {"measure", "bake", "box.obj", "--texels", "32", "--rays", "32", "--rounds", "1", "--plot", "none"},
        {"measure", "sampling", "box.obj", "--points", "8", "--counts", "32,64", "--truth", "512", "--sets",
         "fibonacci", "--errors", "0.1", "--compare", "64", "--plot", "none"}};
    const std::vector<std::vector<std::string>> keys = {
        {"points", "rays", "rays_per_s", "seconds", "peak_rss_bytes", "validity"},
        {"components", "explained_variance", "relative_rmse", "seconds"},
        {"rows"},
        {"floor_rmse", "rows"},
        {"rows", "bytes", "bytes_per_texel"},
        {"measure", "rows"},
        {"format_version", "conventions", "files"},
        {"measure", "rows"},
        {"measure", "points", "rows"},
        {"measure", "cpu", "rows"},
        {"measure", "cpu", "rows", "errors", "hsh_errors", "hsh_tables", "paper_times"},
        {"measure", "rows", "summary", "meshes", "cone_deg"},
        {"measure", "rows", "threads", "ceiling_rays_per_s", "pipeline_rays_per_s", "ratio", "embree_isa"},
        {"measure", "rows", "equal_error", "adaptive", "meshes"}};
    for (size_t i = 0; i < commands.size(); ++i) {
        auto arguments = commands[i];
        arguments.insert(arguments.end(), {"--json", "-"});
        const ProcessResult result = runPrt(folder, arguments);
        ASSERT_EQ(result.exitCode, 0) << result.err;
        const auto json = nlohmann::json::parse(result.out, nullptr, false);
        ASSERT_TRUE(json.is_object()) << result.out;
        for (const std::string& key : keys[i])
            EXPECT_TRUE(json.contains(key)) << commands[i][0] << " " << commands[i][1] << " " << key;
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
