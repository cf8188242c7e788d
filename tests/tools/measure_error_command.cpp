// prt measure error: what it writes, and what it refuses.
#include <fstream>
#include <sstream>

#include "precompute/base/error.h"
#include "precompute/io/exr_file.h"
#include "precompute/io/image.h"
#include "tests/tools/error_fixture.h"
#include "tests/tools/run_command.h"
#include "tools/measure/commands.h"

namespace prt::tools {
namespace {

std::string readFile(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    return bytes.str();
}

void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "error");
    test::runCommand(runMeasureError, arguments);
}

std::string runOn(const TemporaryDirectory& folder, const std::string& bundle,
                  const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {bundle,
                                          "--points",
                                          "20",
                                          "--rays",
                                          "512",
                                          "--plot",
                                          "none",
                                          "-o",
                                          folder.file("error"),
                                          "--json",
                                          folder.file("error.json"),
                                          "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    run(arguments);
    return readFile(folder.file("error.json"));
}

TEST(MeasureErrorCommand, WritesTablesJsonAndHeatMaps) {
    const TemporaryDirectory folder;
    const std::string bundle = makeBundle(folder, {.components = 4}), images = folder.file("maps");
    const std::string json =
        runOn(folder, bundle, {"--env", "sky:clear", "--env", "sky:overcast", "--images", images});
    for (const char* key : {"\"rows\": [",
                            "\"parts\": [",
                            "\"stage\": \"total\"",
                            "\"stage\": \"sampling\"",
                            "\"stage\": \"truncation\"",
                            "\"stage\": \"projection\"",
                            "\"stage\": \"pca\"",
                            "\"stage\": \"quantisation\"",
                            "\"stage\": \"tables\"",
                            "\"environment\": \"mean\"",
                            "\"relative_rmse\": ",
                            "\"psnr_db\": ",
                            "\"noise\": ",
                            "\"gain\": ",
                            "\"truth_noise\": ",
                            "\"components\": 4",
                            "\"compressed\": true",
                            "\"points\": 20",
                            "\"knobs\": [",
                            "\"command\": \"prt ",
                            "\"scale\": \"logarithmic\"",
                            "\"low\": ",
                            "\"high\": ",
                            "\"weights\": \"unorm8\""})
        EXPECT_NE(json.find(key), std::string::npos) << key;
    std::istringstream csv(readFile(folder.file("error.csv")));
    std::vector<std::string> lines;
    for (std::string line; std::getline(csv, line);) lines.push_back(line);
    ASSERT_EQ(lines.size(), 1 + 3 * 7u);  // two environments and their mean
    EXPECT_TRUE(lines[0].starts_with("environment,stage,relative_rmse,psnr_db,")) << lines[0];
    EXPECT_TRUE(lines[1].starts_with("clear,total,")) << lines[1];

    const std::string png = readFile(images + "/clear.total.png");
    const ByteImage image =
        decodeImage({reinterpret_cast<const uint8_t*>(png.data()), png.size()}, "clear.total.png");
    EXPECT_EQ(image.width, 32);
    EXPECT_EQ(image.height, 32);
    const ExrReader reader(images + "/overcast.error.exr");
    ASSERT_EQ(reader.parts().size(), 1u);
    EXPECT_EQ(reader.parts()[0].channels.count("projection"), 0u) << "weighted already";
    ASSERT_EQ(reader.parts()[0].channels.count("total"), 1u);
    std::vector<float> total(32 * 32);
    std::vector<uint32_t> measured(total.size());
    reader.read(0, {{"total", ExrType::Float, total.data(), 4, 128},
                    {"measured", ExrType::Uint, measured.data(), 4, 128}});
    size_t judged = 0, shown = 0;
    for (size_t t = 0; t < total.size(); ++t) {
        judged += measured[t];
        shown += total[t] > 0;
    }
    EXPECT_EQ(judged, 20u);
    EXPECT_GT(shown, 200u);  // charts are filled from the judged texels
}

TEST(MeasureErrorCommand, TakesBundlesWithoutPcaAndPerVertex) {
    const TemporaryDirectory folder;
    const std::string json =
        runOn(folder, makeBundle(folder, {}), {"--env", "sky:overcast", "--layout", "octahedral"});
    EXPECT_NE(json.find("\"compressed\": false"), std::string::npos);
    EXPECT_EQ(json.find("\"environment\": \"mean\""), std::string::npos) << "of one";

    const TemporaryDirectory other;
    BundleKind kind;
    kind.perVertex = true;
    testing::internal::CaptureStderr();
    const std::string images = other.file("maps");
    const std::string vertices =
        runOn(other, makeBundle(other, kind), {"--env", "sky:overcast", "--images", images});
    EXPECT_NE(testing::internal::GetCapturedStderr().find("--images"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(images));
    EXPECT_NE(vertices.find("\"domain\": \"vertex\""), std::string::npos);
    EXPECT_NE(vertices.find("\"images\": []"), std::string::npos);
}

TEST(MeasureErrorCommand, RefusesWhatItCannotMeasure) {
    const TemporaryDirectory folder;
    EXPECT_THROW(run({folder.file("none.prt")}), InputError);
    EXPECT_THROW(run({}), UsageError);
    EXPECT_THROW(run({"a.prt", "--weights", "unorm4"}), UsageError);
    EXPECT_THROW(run({"a.prt", "--tables", "bc7"}), UsageError);
    EXPECT_THROW(run({"a.prt", "--layout", "mercator"}), UsageError);
    EXPECT_THROW(run({"a.prt", "--size", "1", "--layout", "dual-paraboloid"}), UsageError);
    EXPECT_THROW(run({"a.prt", "--size", "0"}), UsageError);
    EXPECT_THROW(run({"a.prt", "--rays", "255"}), UsageError);
    EXPECT_THROW(run({"a.prt", "--points", "-1"}), UsageError);
    EXPECT_THROW(run({"a.prt", "--tilt", "61"}), UsageError);
    EXPECT_THROW(run({"a.prt", "--variant", "both"}), UsageError);
    EXPECT_THROW(run({"a.prt", "--window", "hamming"}), UsageError);
    const std::string bundle = makeBundle(folder, {.components = 2});
    EXPECT_THROW(runOn(folder, bundle, {"--env", "sky:green"}), InputError);
    EXPECT_THROW(runOn(folder, bundle, {"--layout", "octahedral", "--tables", "rgb9e5"}), UsageError);
    EXPECT_THROW(runOn(folder, bundle, {"--extract-sun"}), UsageError);
    EXPECT_THROW(runOn(folder, bundle, {"--size", "512"}), UsageError);
    EXPECT_THROW(run({bundle, "-o", folder.file("no/such/folder/x")}), OutputError);
}

}  // namespace
}  // namespace prt::tools
