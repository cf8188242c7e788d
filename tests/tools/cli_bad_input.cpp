// What cannot be used is refused with the right exit code and one clear line, and nothing half-written stays.
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>

#include "tests/tools/prt_process.h"

namespace prt::test {
namespace {
namespace fs = std::filesystem;

constexpr int kUsage = 2, kInput = 3, kOutput = 4;

/// One line, of the shape `prt COMMAND: error: …`, naming what is wrong; no stack trace, no temporary, no new
/// file.
void expectRefused(const Folder& folder, const std::vector<std::string>& arguments, int exitCode,
                   const std::vector<std::string>& mentions) {
    const std::vector<std::string> before = folder.files();
    const ProcessResult result = runPrt(folder, arguments);
    EXPECT_EQ(result.exitCode, exitCode) << result.err;
    std::istringstream lines(result.err);
    int errors = 0;
    for (std::string line; std::getline(lines, line);) {
        if (line.find(": error: ") != std::string::npos) ++errors;
        EXPECT_TRUE(line.starts_with("prt")) << "not a line of ours: " << line;
    }
    EXPECT_EQ(errors, 1) << result.err;
    for (const std::string& word : mentions)
        EXPECT_NE(result.err.find(word), std::string::npos) << word << " in " << result.err;
    EXPECT_EQ(folder.files(), before);
}

std::vector<std::string> precompute(const std::string& mesh) {
    return {"precompute", mesh, "-o", "out.prt", "--texels", "32", "--rays", "16", "--order", "2", "--quiet"};
}

/// A small finished bundle `box.prt` in the folder.
void bakeBox(const Folder& folder) {
    folder.write("box.obj", openBoxObj());
    const ProcessResult result = runPrt(folder, {"precompute", "box.obj", "-o", "box.prt", "--texels", "32",
                                                 "--rays", "16", "--order", "2", "--quiet"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
}

std::string glb(std::string json, std::string binary) {
    while (json.size() % 4) json += ' ';
    while (binary.size() % 4) binary += '\0';
    const auto word = [](uint32_t value) {
        std::string bytes(4, '\0');
        std::memcpy(bytes.data(), &value, 4);
        return bytes;
    };
    const uint32_t total = uint32_t(12 + 8 + json.size() + 8 + binary.size());
    return "glTF" + word(2) + word(total) + word(uint32_t(json.size())) + "JSON" + json +
           word(uint32_t(binary.size())) + std::string("BIN\0", 4) + binary;
}

TEST(BadInput, MissingFile) {
    Folder folder;
    expectRefused(folder, precompute("missing.obj"), kInput, {"missing.obj"});
}

TEST(BadInput, EmptyMesh) {
    Folder folder;
    folder.write("empty.obj", "# nothing\n");
    expectRefused(folder, precompute("empty.obj"), kInput, {"empty.obj"});
    folder.write("empty.ply", "");
    expectRefused(folder, precompute("empty.ply"), kInput, {"empty.ply"});
}

TEST(BadInput, FaceIndexOutOfRangeNamesTheLine) {
    Folder folder;
    folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9999\n");
    expectRefused(folder, precompute("bad.obj"), kInput, {"bad.obj:5", "9999"});
}

TEST(BadInput, NanPosition) {
    Folder folder;
    folder.write("nan.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n");
    expectRefused(folder, precompute("nan.obj"), kInput, {"nan.obj"});
    folder.write(
        "inf.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 inf 0\n0 1 0\n3 0 1 "
        "2\n");
    expectRefused(folder, precompute("inf.ply"), kInput, {"inf.ply"});
}

TEST(BadInput, ZeroAreaMesh) {
    Folder folder;
    folder.write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    expectRefused(folder, precompute("line.obj"), kInput, {"line.obj"});
}

TEST(BadInput, UnknownMeshFormat) {
    Folder folder;
    folder.write("mesh.xyz", "0 0 0\n");
    expectRefused(folder, precompute("mesh.xyz"), kInput, {"mesh.xyz", ".obj"});
}

TEST(BadInput, TruncatedGlb) {
    Folder folder;
    bakeBox(folder);
    const std::string whole = slurp(folder / "box.prt/mesh.glb");
    for (const double share : {0.01, 0.3, 0.6, 0.95}) {
        folder.write("cut.glb", whole.substr(0, size_t(share * double(whole.size()))));
        expectRefused(folder, precompute("cut.glb"), kInput, {"cut.glb"});
    }
}

TEST(BadInput, AccessorOutOfBounds) {
    Folder folder;
    folder.write("bounds.glb",
                 glb(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":300000,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}]})",
                     std::string(36, '\0')));
    expectRefused(folder, precompute("bounds.glb"), kInput, {"bounds.glb", "POSITION", "300000"});
}

TEST(BadInput, TruncatedStl) {
    Folder folder;
    std::string stl(80, ' ');
    const uint32_t count = 12;
    stl.append(reinterpret_cast<const char*>(&count), 4);
    stl.append(50 * 3, '\0');
    folder.write("cut.stl", stl);
    expectRefused(folder, precompute("cut.stl"), kInput, {"cut.stl"});
}

TEST(BadInput, PlyWithAHugeCount) {
    Folder folder;
    folder.write(
        "huge.ply",
        "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float "
        "y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0123456789");
    expectRefused(folder, precompute("huge.ply"), kInput, {"huge.ply"});
}

TEST(BadInput, TruncatedExr) {
    Folder folder;
    bakeBox(folder);
    // A picture twice as wide as high is a valid environment; half of its file is not.
    ASSERT_EQ(runPrt(folder, {"relight", "box.prt", "-o", "sky.exr", "--size", "64x32", "--quiet"}).exitCode,
              0);
    ASSERT_EQ(
        runPrt(folder, {"relight", "box.prt", "--env", "sky.exr", "-o", "a.png", "--size", "8x8", "--quiet"})
            .exitCode,
        0);
    const std::string whole = slurp(folder / "sky.exr");
    for (const size_t length : {size_t(0), size_t(3), size_t(60), whole.size() / 2, whole.size() - 10}) {
        folder.write("cut.exr", whole.substr(0, length));
        expectRefused(folder, {"relight", "box.prt", "--env", "cut.exr", "-o", "b.png", "--quiet"}, kInput,
                      {"cut.exr"});
    }
}

TEST(BadInput, ExrWithoutRgb) {
    Folder folder;
    bakeBox(folder);
    expectRefused(folder, {"relight", "box.prt", "--env", "box.prt/visibility.exr", "-o", "b.png", "--quiet"},
                  kInput, {"visibility.exr", "R"});
}

TEST(BadInput, DamagedVisibility) {
    Folder folder;
    bakeBox(folder);
    const std::string whole = slurp(folder / "box.prt/visibility.exr");
    folder.write("box.prt/visibility.exr", whole.substr(0, whole.size() / 2));
    expectRefused(folder, {"compress", "box.prt", "--components", "2"}, kInput,
                  {"visibility.exr", "prt precompute"});
}

TEST(BadInput, WrongBundleVersion) {
    Folder folder;
    bakeBox(folder);
    std::string manifest = slurp(folder / "box.prt/manifest.json");
    const size_t at = manifest.find("\"formatVersion\"");
    ASSERT_NE(at, std::string::npos);
    const size_t digit = manifest.find_first_of("0123456789", at);
    manifest.replace(digit, 1, "999");
    folder.write("box.prt/manifest.json", manifest);
    expectRefused(folder, {"info", "box.prt"}, kInput, {"999"});
    expectRefused(folder, {"compress", "box.prt"}, kInput, {"999"});
}

TEST(BadInput, BundleOfOtherConventions) {
    Folder folder;
    bakeBox(folder);
    std::string manifest = slurp(folder / "box.prt/manifest.json");
    const size_t at = manifest.find("+Y up");
    ASSERT_NE(at, std::string::npos);
    manifest.replace(at, 5, "+Z up");
    folder.write("box.prt/manifest.json", manifest);
    expectRefused(folder, {"info", "box.prt"}, kInput, {"worldAxes", "+Z up"});
}

TEST(BadInput, NotABundle) {
    Folder folder;
    expectRefused(folder, {"info", "nothing.prt"}, kInput, {"nothing.prt"});
    fs::create_directory(folder / "empty.prt");
    expectRefused(folder, {"info", "empty.prt"}, kInput, {"empty.prt"});
    folder.write("empty.prt/manifest.json", "{ not json");
    expectRefused(folder, {"info", "empty.prt"}, kInput, {"empty.prt"});
}

TEST(BadInput, FolderThatIsNotABundleIsNotOverwritten) {
    Folder folder;
    folder.write("box.obj", openBoxObj());
    fs::create_directory(folder / "out.prt");
    folder.write("out.prt/letter.txt", "dear reader");
    const ProcessResult result = runPrt(folder, precompute("box.obj"));
    EXPECT_NE(result.exitCode, 0);
    EXPECT_EQ(slurp(folder / "out.prt/letter.txt"), "dear reader");
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"box.obj", "out.prt/letter.txt"}));
}

TEST(BadInput, UnwritableOutput) {
    Folder folder;
    folder.write("box.obj", openBoxObj());
    auto arguments = precompute("box.obj");
    arguments[3] = "/proc/out.prt";
    expectRefused(folder, arguments, kOutput, {"/proc/out.prt"});
    arguments[3] = "box.obj/out.prt";
    expectRefused(folder, arguments, kOutput, {"box.obj"});
    bakeBox(folder);
    expectRefused(folder, {"relight", "box.prt", "-o", "/proc/frame.png", "--size", "8x8", "--quiet"},
                  kOutput, {"/proc/frame.png"});
}

TEST(BadInput, OptionOutOfRange) {
    Folder folder;
    folder.write("box.obj", openBoxObj());
    const std::vector<std::pair<std::string, std::string>> bad = {
        {"--order", "0"},       {"--order", "11"},   {"--order", "six"},    {"--texels", "-5"},
        {"--texels", "100000"}, {"--rays", "0"},     {"--rays", "1e3"},     {"--error", "0"},
        {"--error", "2"},       {"--uv-scale", "0"}, {"--uv-scale", "nan"}, {"--threads", "-1"}};
    for (const auto& [option, value] : bad)
        expectRefused(folder, {"precompute", "box.obj", "-o", "out.prt", option, value}, kUsage, {option});
    expectRefused(folder, {"precompute", "box.obj", "-o", "out.prt", "--rays", "64", "--error", "0.1"},
                  kUsage, {"--rays", "--error"});
}

TEST(BadInput, UnknownOptionAndCommand) {
    Folder folder;
    folder.write("box.obj", openBoxObj());
    expectRefused(folder, {"precompute", "box.obj", "-o", "out.prt", "--frobnicate"}, kUsage,
                  {"--frobnicate"});
    expectRefused(folder, {"frobnicate"}, kUsage, {"frobnicate"});
    expectRefused(folder, {"precompute", "box.obj"}, kUsage, {"--output"});
    expectRefused(folder, {"precompute", "-o", "out.prt"}, kUsage, {"MESH"});
}

TEST(BadInput, ComponentsAboveTheLimitNameIt) {
    Folder folder;
    bakeBox(folder);
    expectRefused(folder, {"compress", "box.prt", "--components", "5"}, kUsage, {"--components", "4"});
}

TEST(BadInput, PcaBeforeCompressSaysWhatToRun) {
    Folder folder;
    bakeBox(folder);
    expectRefused(folder, {"relight", "box.prt", "--technique", "pca", "-o", "a.png", "--quiet"}, kInput,
                  {"pca.exr", "prt compress"});
    expectRefused(folder, {"tabulate", "box.prt", "sky:clear"}, kInput, {"pca.exr", "prt compress"});
}

TEST(BadInput, RelightOptions) {
    Folder folder;
    bakeBox(folder);
    const std::vector<std::vector<std::string>> bad = {
        {"--size", "12"},         {"--env", "sky:clear:-1"},
        {"--exposure", "bright"}, {"--technique", "magic"},
        {"-o", "frame.gif"},      {"--reference-output", "r.png"},
        {"--eye", "1,2"},         {"--each", "--env", "sky:clear", "--env", "sky:sunset"}};
    for (const auto& words : bad) {
        std::vector<std::string> arguments = {"relight", "box.prt", "-o", "a.png", "--quiet"};
        if (words[0] == "-o") arguments = {"relight", "box.prt", "--quiet"};
        arguments.insert(arguments.end(), words.begin(), words.end());
        expectRefused(folder, arguments, kUsage, {});
    }
    expectRefused(folder, {"relight", "box.prt", "--env", "sky:plaid", "-o", "a.png", "--quiet"}, kInput,
                  {"plaid", "clear"});
    expectRefused(folder, {"relight", "box.prt"}, kUsage, {"-o"});
}

TEST(BadInput, MeasureOptions) {
    Folder folder;
    const std::vector<std::vector<std::string>> bad = {
        {"bake", "--texels", "8"},
        {"bake", "--rounds", "0"},
        {"basis", "--signal", "sound"},
        {"basis", "--signals", "3"},
        {"basis", "--max-order", "17"},
        {"basis", "--env", "sky:clear", "--signal", "functions"},
        {"parameterization", "--layouts", "mercator"},
        {"parameterization", "--points", "999"},
        {"product", "--orders", "11"},
        {"product", "--orders", "six"},
        {"product", "--methods", "fourier"},
        {"product", "--rounds", "0"},
        {"projection", "--orders", "11", "box.obj"},
        {"projection", "--tilts", "90", "box.obj"},
        {"projection", "--points", "0", "box.obj"},
        {"projection", "--floor", "2", "box.obj"},
        {"projection", "--cone", "0", "box.obj"},
        {"rotation", "--orders", "0"},
        {"rotation", "--orders", "3-"},
        {"rotation", "--methods", "zxzxz,"},
        {"rotation", "--error-orders", "25"},
        {"rotation", "--hsh-orders", "11"},
        {"rotation", "--max-angle", "91"},
        {"rotation", "--table-angles", "1"},
        {"rotation", "--rounds", "-1"},
        {"rotation", "--table-angles", "many"},
        {"rotation", "--plot", "bmp"},
        {"sampling", "--sets", "halton", "box.obj"},
        {"sampling", "--points", "0", "box.obj"}};
    for (const auto& words : bad) {
        std::vector<std::string> arguments = {"measure", "--quiet"};
        arguments.insert(arguments.begin() + 1, words.begin(), words.end());
        expectRefused(folder, arguments, kUsage, {"prt measure " + words[0], words[1]});
    }
    for (const char* name : {"bake", "basis", "parameterization", "product", "rotation"})
        expectRefused(folder, {"measure", name, "--frobnicate"}, kUsage, {"--frobnicate"});
    for (const std::string name : {"projection", "sampling"}) {
        expectRefused(folder, {"measure", name, "box.obj", "--frobnicate"}, kUsage, {"--frobnicate"});
        expectRefused(folder, {"measure", name, "absent.obj", "--quiet"}, kInput, {"absent.obj"});
    }
    for (const std::string name : {"compression", "error"}) {
        expectRefused(folder, {"measure", name, "box.prt", "--frobnicate"}, kUsage, {"--frobnicate"});
        expectRefused(folder, {"measure", name, "absent.prt", "--quiet"}, kInput, {"absent.prt"});
        expectRefused(folder, {"measure", name}, kUsage, {"prt measure " + name, "BUNDLE"});
        expectRefused(folder, {"measure", name, "box.prt", "--points", "-1"}, kUsage, {"--points"});
        expectRefused(folder, {"measure", name, "box.prt", "--weights", "bc7"}, kUsage, {"--weights"});
    }
    for (const std::string command : {"tabulate", "relight"}) {
        const std::string prefix = command == "relight" ? "--table-" : "--";
        const std::string environment = command == "relight" ? "--quiet" : "sky:clear";
        expectRefused(folder, {command, "box.prt", environment, prefix + "layout", "sphere"}, kUsage,
                      {"layout"});
        expectRefused(folder, {command, "box.prt", environment, prefix + "variant", "best"}, kUsage,
                      {"variant"});
        expectRefused(folder, {command, "box.prt", environment, prefix + "size", "0"}, kUsage, {"size"});
        expectRefused(folder, {command, "box.prt", environment, "--window", "box"}, kUsage, {"--window"});
        expectRefused(
            folder,
            {command, "box.prt", environment, prefix + "layout", "dual-paraboloid", prefix + "size", "1"},
            kUsage, {prefix + "size"});
    }
    expectRefused(folder, {"measure", "projection"}, kUsage, {"prt measure projection", "MESH"});
    expectRefused(folder, {"measure", "weight"}, kUsage, {"weight", "prt measure --help"});
}

TEST(BadInput, MeasureIntoAFolderThatIsMissing) {
    Folder folder;
    expectRefused(folder,
                  {"measure", "basis", "--signal", "functions", "--bases", "h", "-o", "missing/x", "--quiet"},
                  kOutput, {"missing/x"});
    expectRefused(folder,
                  {"measure", "parameterization", "--orders", "2", "--points", "1000", "--max-samples", "100",
                   "-o", "missing/x", "--quiet"},
                  kOutput, {"missing/x"});
    expectRefused(folder,
                  {"measure", "product", "--orders", "3", "--rounds", "1", "-o", "missing/x", "--quiet"},
                  kOutput, {"missing/x"});
    expectRefused(folder,
                  {"measure", "rotation", "--orders", "3", "--rounds", "1", "--error-orders", "3",
                   "--hsh-orders", "2", "-o", "missing/x", "--quiet"},
                  kOutput, {"missing/x"});
}

}  // namespace
}  // namespace prt::test
