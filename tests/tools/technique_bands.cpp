// Every technique at its expected distance from ray tracing, on the house and on a scanned room; and
// README.md says what is measured here. [IwanickiSloan2012, Sec. 5]
#include "tests/tools/technique_bands.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "compress/compress_job.h"
#include "precompute/base/atomic_file.h"
#include "precompute/base/log.h"
#include "precompute/visibility/precompute_job.h"
#include "runtime/renderer.h"
#include "tests/base/temporary_directory.h"
#include "tools/measure/technique_pictures.h"

namespace prt::tools {
namespace test {

std::map<std::pair<std::string, std::string>, double> errorTableOf(const std::string& markdown) {
    const std::string begin = "<!-- technique-errors -->", end = "<!-- /technique-errors -->";
    const size_t from = markdown.find(begin), to = markdown.find(end);
    if (from == std::string::npos || to == std::string::npos || to < from) return {};
    std::istringstream lines(markdown.substr(from + begin.size(), to - from - begin.size()));
    std::map<std::pair<std::string, std::string>, double> table;
    std::vector<std::string> titles;
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] != '|') continue;
        std::vector<std::string> cells;
        std::istringstream row(line.substr(1));
        for (std::string cell; std::getline(row, cell, '|');) {
            std::erase(cell, '`');
            const size_t first = cell.find_first_not_of(' '), last = cell.find_last_not_of(' ');
            cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
        }
        if (titles.empty()) titles = cells;
        for (size_t i = 1; i < std::min(cells.size(), titles.size()); ++i) {
            double value = 0;
            const auto [stop, error] =
                std::from_chars(cells[i].data(), cells[i].data() + cells[i].size(), value);
            if (error == std::errc() && stop == cells[i].data() + cells[i].size())
                table[{cells[0], titles[i]}] = value;
        }
    }
    return table;
}

std::string errorTableText(const std::map<std::pair<std::string, std::string>, double>& errors,
                           const std::vector<std::string>& columns,
                           const std::vector<std::string>& techniques) {
    std::string text = fmt::format("| | {} |\n|---|", fmt::join(columns, " | "));
    for (size_t i = 0; i < columns.size(); ++i) text += "---|";
    text += '\n';
    for (const std::string& technique : techniques) {
        text += technique == "floor" ? "| floor |" : fmt::format("| `{}` |", technique);
        for (const std::string& column : columns) {
            const auto found = errors.find({technique, column});
            text += found == errors.end() ? " |" : fmt::format(" {:.3f} |", found->second);
        }
        text += '\n';
    }
    return text;
}

}  // namespace test

namespace {

using Errors = std::map<std::pair<std::string, std::string>, double>;

// README.md rounds to 0.001, and rare grazing rays differ between instruction sets.
constexpr double kBand = 0.005, kRelativeBand = 0.02;

// What is drawn, and what of it README.md prints. Rows of kPrinted, "floor" besides.
const std::vector<std::string> kDrawn = {"unc3",  "unc4",       "unc6",        "pca4", "pca8",
                                         "pca16", "vertex-pca", "pca-uniform", "sh2",  "preconvolved-ao"};
const std::vector<std::string> kPrinted = {"floor",      "unc6", "unc4",           "unc3",
                                           "pca16",      "pca8", "pca4",           "pca-uniform",
                                           "vertex-pca", "sh2",  "preconvolved-ao"};

RelightArguments argumentsFor(const std::string& bundle, const std::vector<std::string>& environments) {
    RelightArguments arguments;
    arguments.bundlePath = bundle;
    arguments.environmentTexts = environments;
    arguments.techniqueNames = kDrawn;
    arguments.sizeText = "240x150";
    arguments.referenceRays = 1024;
    arguments.compareReference = true;
    return arguments;
}

class TechniqueBands : public testing::Test {
  protected:
    void SetUp() override { setQuiet(true); }
    void TearDown() override { setQuiet(false); }

    void bake(PrecomputeSettings settings) {
        settings.bundlePath = bundle_;
        runPrecompute(settings);
        CompressSettings compress;
        compress.bundlePath = bundle_;
        compress.components = 16;
        runCompress(compress);
    }
    void draw(RelightArguments arguments) {
        arguments.finish();
        const RelightData data = loadRelightData(arguments);
        figures_ = drawTechniqueFigures(context_, arguments, data, folder_.path());
    }
    /// By technique ("floor" among them) and environment.
    Errors errors(bool normalMap, const std::string& scene = "") const {
        Errors errors;
        for (const TechniqueError& row : figures_.errors) {
            if (row.normalMap != normalMap) continue;
            const std::string column = scene.empty() ? row.environment : scene + ", " + row.environment;
            errors[{techniqueName(row.technique), column}] = row.error.relativeRmse;
            errors[{"floor", column}] = row.floorRmse;
        }
        return errors;
    }
    std::vector<std::string> environments() const {
        std::vector<std::string> names;
        for (const TechniqueError& row : figures_.errors)
            if (std::ranges::find(names, row.environment) == names.end()) names.push_back(row.environment);
        return names;
    }
    /// What holds on every scene, with and without normal maps.
    /// @param sideLight  the environment with a strong light from the side
    void checkOrder(const std::string& sideLight) const {
        for (const bool normalMap : {true, false}) {
            const Errors e = errors(normalMap);
            for (const std::string& environment : environments()) {
                SCOPED_TRACE(fmt::format("{}, normal map {}", environment, normalMap));
                const auto at = [&](const char* technique) { return e.at({technique, environment}); };
                EXPECT_LE(at("unc6"), at("floor") + 0.02);
                EXPECT_LE(at("pca16"), at("unc6") + 0.02);
                EXPECT_NEAR(at("pca-uniform"), at("pca16"), 1.5e-3);
                EXPECT_LT(at("unc6"), at("unc4"));
                EXPECT_LT(at("unc4"), at("unc3"));
                EXPECT_LT(at("pca16"), at("pca8"));
                EXPECT_LT(at("pca8"), at("pca4"));
                if (environment != sideLight) continue;
                EXPECT_GE(at("sh2"), 1.5 * at("unc6"));
                EXPECT_GE(at("preconvolved-ao"), 1.5 * at("unc6"));
            }
        }
    }
    /// README.md has all of these numbers, and they are what was measured; prints them as they belong there.
    void checkReadme(const std::string& scene) const {
        const Errors measured = errors(true, scene);
        const Errors printed =
            test::errorTableOf(readFile(std::filesystem::path(PRT_SOURCE_DIR) / "README.md"));
        std::vector<std::string> columns;
        for (const std::string& environment : environments())
            columns.push_back(fmt::format("{}, {}", scene, environment));
        for (const std::string& technique : kPrinted)
            for (const std::string& column : columns) {
                const auto found = printed.find({technique, column});
                const auto value = measured.find({technique, column});
                ASSERT_NE(value, measured.end()) << technique << " " << column;
                if (found == printed.end()) {
                    ADD_FAILURE() << "README.md has no " << technique << " of " << column;
                    continue;
                }
                EXPECT_NEAR(found->second, value->second, kBand + kRelativeBand * value->second)
                    << technique << " " << column;
            }
        if (HasFailure()) fmt::print("measured:\n{}", test::errorTableText(measured, columns, kPrinted));
    }
    /// Relative RMSE between pictures of pca and pca-uniform.
    double tableError(RelightArguments arguments, const std::string& layout, int size) {
        arguments.tables.layout = layout;
        arguments.tables.size = size;
        arguments.techniqueNames = {"pca", "pca-uniform"};
        arguments.finish();
        const RelightData data = loadRelightData(arguments);
        RelightTechniques techniques(arguments, data);
        Renderer renderer(context_, data.scene, nullptr, nullptr);
        techniques.addTo(renderer);
        const Camera camera = arguments.camera(sceneBounds(data.scene));
        const RenderOptions options{arguments.width, arguments.height, true};
        const SurfaceImage surface = renderer.surface(camera, options);
        std::vector<float> irradiance[2];
        for (const bool uniform : {false, true}) {
            const Technique technique = uniform ? Technique::PcaUniform : Technique::Pca;
            techniques.setLight(renderer, technique, data.weights, 0);
            irradiance[uniform] = renderer.render(camera, technique, options).irradiance.pixels;
        }
        return compareIrradiance(irradiance[0], irradiance[1], surface).relativeRmse;
    }

    TemporaryDirectory folder_;
    std::string bundle_ = folder_.file("scene.prt");
    GlContext context_;
    TechniqueFigures figures_;
};

TEST(TechniqueErrorTable, IsReadBackAsItIsWritten) {
    const Errors errors = {{{"floor", "a, b"}, 0.125}, {{"pca4", "a, b"}, 0.5}, {{"pca4", "c"}, 1.25}};
    const std::string text = test::errorTableText(errors, {"a, b", "c"}, {"floor", "pca4"});
    const Errors back = test::errorTableOf("# x\n| y | 7 |\n<!-- technique-errors -->\n" + text +
                                           "<!-- /technique-errors -->\n| z | 8 |\n");
    EXPECT_EQ(back, errors);
    EXPECT_TRUE(test::errorTableOf(text).empty());
}

TEST_F(TechniqueBands, OfTheHouse) {
    PrecomputeSettings settings;
    settings.meshPath = PRT_SOURCE_DIR "/meshes/house/house.obj";
    settings.texels = 1024;
    settings.rays = 256;
    bake(settings);
    RelightArguments arguments = argumentsFor(bundle_, {"sky:sunset", "sky:clear", "sky:overcast"});
    arguments.distance = 0.7;
    draw(arguments);
    checkOrder("sunset");
    checkReadme("house");
}

TEST_F(TechniqueBands, OfAScannedRoom) {
    const std::filesystem::path assets = PRT_SOURCE_DIR "/assets";
    PrecomputeSettings settings;
    settings.meshPath = (assets / "rooms/music.ply").string();
    settings.load.normalMap = (assets / "normals/0005.webp").string();
    settings.load.uvScale = 0.5;
    settings.perVertex = true;
    std::vector<std::string> needed = {settings.meshPath, settings.load.normalMap};
    RelightArguments arguments = argumentsFor(bundle_, {});
    for (const char* environment : {"studio", "city", "venice"})
        arguments.environmentTexts.push_back((assets / "hdri" / environment).string() + ".exr");
    needed.insert(needed.end(), arguments.environmentTexts.begin(), arguments.environmentTexts.end());
    for (const std::string& file : needed)
        if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there; run tools/fetch-assets";
    bake(settings);
    arguments.eyeText = "0,8.5,5";
    arguments.targetText = "0,0.3,0.4";
    arguments.fovDeg = 45;
    draw(arguments);
    checkOrder("studio");
    checkReadme("room");
}

// Tables interpolate between texels: to the second order of their distance, far enough.
TEST_F(TechniqueBands, OfUniformsAreThoseOfTables) {
    PrecomputeSettings settings;
    settings.meshPath = PRT_SOURCE_DIR "/meshes/house/house.obj";
    settings.perVertex = true;
    settings.rays = 64;
    bake(settings);
    RelightArguments arguments = argumentsFor(bundle_, {"sky:sunset"});
    arguments.distance = 0.7;
    arguments.compareReference = false;
    arguments.output = folder_.file("{technique}.png");
    const double cube8 = tableError(arguments, "cube", 8), cube16 = tableError(arguments, "cube", 16),
                 cube32 = tableError(arguments, "cube", 32),
                 paraboloids32 = tableError(arguments, "dual-paraboloid", 32);
    EXPECT_LT(cube32, 2e-3);
    EXPECT_LT(paraboloids32, 6e-3);
    EXPECT_LT(cube16, 0.5 * cube8);
    EXPECT_LT(cube32, 0.5 * cube16);
    RecordProperty("cube32", fmt::format("{:.5f}", cube32));
    RecordProperty("paraboloids32", fmt::format("{:.5f}", paraboloids32));
}

}  // namespace
}  // namespace prt::tools
