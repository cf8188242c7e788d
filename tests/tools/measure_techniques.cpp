// prt measure techniques: sheets, fields, rows.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "tests/base/temporary_directory.h"
#include "tests/tools/measure_compression_box.h"
#include "tests/tools/run_command.h"
#include "tools/measure/commands.h"
#include "tools/measure/compression_sheet.h"
#include "tools/measure/technique_fields.h"
#include "tools/picture.h"

namespace prt::tools {
namespace {

ByteImage uniform(int width, int height, uint8_t value) {
    return {width, height, 3, std::vector<uint8_t>(size_t(width) * size_t(height) * 3, value)};
}

TEST(TechniqueSheet, NotesStandBelowPictures) {
    const ByteImage bare = composeSheet("Title", {{{"label", uniform(60, 20, 200)}}});
    const ByteImage noted = composeSheet("Title", {{{"label", uniform(60, 20, 200), "note"}}});
    ASSERT_EQ(noted.width, bare.width);
    ASSERT_GT(noted.height, bare.height);
    // Everything above the note is as it was, and there is ink below the picture.
    const size_t above = size_t(bare.width) * size_t(bare.height - 8) * 3;
    EXPECT_TRUE(
        std::equal(bare.pixels.begin(), bare.pixels.begin() + ptrdiff_t(above), noted.pixels.begin()));
    EXPECT_GT(std::count(noted.pixels.begin() + ptrdiff_t(above), noted.pixels.end(), 240), 3 * 4 * 4);
}

TEST(TechniqueSheet, RowsBreakTogether) {
    std::vector<SheetCell> above(5), below(5);
    for (size_t i = 0; i < 5; ++i) {
        above[i].label = fmt::format("a{}", i);
        below[i].label = fmt::format("b{}", i);
    }
    const auto rows = inColumns({above, below}, 3);
    ASSERT_EQ(rows.size(), 4u);
    EXPECT_EQ(rows[0].size(), 3u);
    EXPECT_EQ(rows[1][2].label, "b2");
    EXPECT_EQ(rows[2].size(), 2u);
    EXPECT_EQ(rows[2][0].label, "a3");
    EXPECT_EQ(rows[3][1].label, "b4");
}

TEST(TechniquePicture, DifferencesAreOfWhatIsShown) {
    SurfaceImage surface;
    surface.width = 3;
    surface.height = 1;
    surface.triangle = {0, 0, kNoTriangle};
    surface.albedo.assign(3, Vec3f(0.5f, 1, 0.25f));
    const FloatImage a{3, 1, 3, {1, 2, 3, -1, -2, 4, 9, 9, 9}}, b{3, 1, 3, {3, 2, 1, -4, 1, 4, 0, 0, 0}};
    EXPECT_EQ(scaledDifference(a, b, surface).pixels, (std::vector<float>{8, 0, 8, 0, 4, 0, 0, 0, 0}));
    const float pi = 3.14159265f;
    const FloatImage radiance = radianceOf({pi, pi, pi, 2 * pi, 0, 4 * pi, pi, pi, pi}, surface);
    const std::vector<float> expected = {0.5f, 1, 0.25f, 1, 0, 1, 0, 0, 0};
    for (size_t i = 0; i < 9; ++i) EXPECT_NEAR(radiance.pixels[i], expected[i], 1e-6) << i;
}

using Values = std::map<std::pair<std::string, std::string>, double>;  // by technique and normal map

class TechniquesCommand : public testing::TestWithParam<bool> {
  protected:
    void SetUp() override {
        setQuiet(true);
        bundle_ = test::compressedBoxBundle(folder_, GetParam());
    }
    void TearDown() override { setQuiet(false); }
    nlohmann::json run(std::vector<std::string> more) {
        std::vector<std::string> arguments = {"techniques",
                                              bundle_,
                                              "--size",
                                              "64x40",
                                              "--elevation",
                                              "45",
                                              "--reference-rays",
                                              "256",
                                              "--plot",
                                              "none",
                                              "-o",
                                              folder_.file("figures"),
                                              "--json",
                                              folder_.file("t.json"),
                                              "--quiet"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        test::runCommand(runMeasureTechniques, arguments);
        return nlohmann::json::parse(readFile(folder_.file("t.json")));
    }
    ByteImage sheet(const std::string& name) const {
        const std::string png = readFile(folder_.file("figures/" + name));
        return decodeImage({reinterpret_cast<const uint8_t*>(png.data()), png.size()}, name);
    }
    TemporaryDirectory folder_;
    std::string bundle_;
};

TEST_P(TechniquesCommand, DrawsEveryFigureAndSaysEveryError) {
    const auto json = run({"--env", "sky:overcast", "--env", "sky:sunset"});
    EXPECT_EQ(json["context"], "osmesa");
    Values error, toUnc;
    std::set<std::string> environments;
    for (const auto& row : json["rows"]) {
        environments.insert(row["environment"]);
        EXPECT_GE(row["relative_rmse"], 0.5 * row["floor"].get<double>());
        EXPECT_GT(row["psnr_db"], 0);
        if (row["environment"] != "overcast") continue;
        const std::pair key{row["technique"].get<std::string>(), row["normal_map"].get<std::string>()};
        error[key] = row["relative_rmse"];
        toUnc[key] = row["rmse_to_unc"];
    }
    EXPECT_EQ(environments, (std::set<std::string>{"overcast", "sunset"}));
    for (const char* map : {"yes", "no"}) {
        for (const char* name : {"unc3", "unc4", "pca4", "pca8", "pca-uniform", "sh2", "preconvolved-ao"})
            EXPECT_TRUE(error.contains({name, map})) << name;
        EXPECT_EQ((toUnc[{"unc4", map}]), 0);
        EXPECT_GT((toUnc[{"pca4", map}]), (toUnc[{"pca8", map}]));
        EXPECT_LT((error[{"unc4", map}]), (error[{"sh2", map}]));
    }
    // The box has no normal maps: both surfaces are the same.
    EXPECT_EQ((error[{"unc4", "yes"}]), (error[{"unc4", "no"}]));

    const int wide = 4 * 64 + 5 * 8;
    for (const char* environment : {"overcast", "sunset"})
        for (const char* figure : {"figure4", "difference", "figure7"}) {
            const std::string name = fmt::format("{}-{}.png", figure, environment);
            const ByteImage image = sheet(name);
            EXPECT_EQ(image.width, wide) << name;
            EXPECT_GT((std::set<uint8_t>(image.pixels.begin(), image.pixels.end()).size()), 20u) << name;
        }
    EXPECT_EQ(sheet("figure5-sunset.png").width, 3 * 64 + 4 * 8);  // pca4, pca8, unc4
    EXPECT_EQ(sheet("figure6-sunset.png").width, 2 * 64 + 3 * 8);  // unc3, unc4
    const int edge = GetParam() ? 256 : 48;                        // of a picture of the mesh, or the atlas
    EXPECT_EQ(sheet("figure3-visibility.png").width, 7 * edge + 8 * 8);
    EXPECT_EQ(sheet("figure3-weights.png").width, 6 * edge + 7 * 8);
}

INSTANTIATE_TEST_SUITE_P(Domains, TechniquesCommand, testing::Bool());

class TechniquesCommandAlone : public TechniquesCommand {};

TEST_P(TechniquesCommandAlone, RefusesWhatCannotBeDrawn) {
    EXPECT_THROW(run({"--technique", "reference"}), UsageError);
    EXPECT_THROW(run({"--technique", "unc6"}), InputError);
    EXPECT_THROW(run({"--eye", "9,9,9", "--target", "19,9,9"}), InputError);
    std::filesystem::remove_all(folder_.file("figures"));
    rewriteFile(folder_.file("figures"), "no folder");
    EXPECT_THROW(run({}), OutputError);
}

INSTANTIATE_TEST_SUITE_P(Texel, TechniquesCommandAlone, testing::Values(false));

// One texel is far off: it does not take the others' colours, and what has no surface is black.
TEST(TechniqueFields, StraysDoNotSetTheScale) {
    GlContext context;
    Scene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    scene.normals.assign(3, Vec3f::UnitZ());
    scene.indices = {0, 1, 2};
    scene.primitives.push_back({0, 1, 0});
    scene.materials.emplace_back();
    Renderer renderer(context, scene, nullptr, nullptr);
    const PointGrid grid{PointDomain::Texel, 32, 32, 1024};
    std::vector<float> values(1024);
    for (size_t i = 0; i < 1024; ++i) values[i] = i % 2 ? 1.0f : -0.5f;
    values[7] = 1000;
    std::vector<Validity> validity(1024, Validity::Valid);
    validity[4] = Validity::Empty;
    const auto cells = fieldPictures(renderer, Camera{}, grid, values, validity, {"v"}, 256);
    ASSERT_EQ(cells.size(), 1u);
    EXPECT_EQ(cells[0].note, "<= -1 to >= 1");
    const ByteImage& image = cells[0].image;
    ASSERT_EQ(image.width, 32);
    for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(image.pixels[4 * 3 + size_t(c)], 0);
        EXPECT_EQ(image.pixels[7 * 3 + size_t(c)], image.pixels[9 * 3 + size_t(c)]);
    }
    EXPECT_GT(image.pixels[9 * 3], image.pixels[9 * 3 + 2]);  // red
    EXPECT_LT(image.pixels[8 * 3], image.pixels[8 * 3 + 2]);  // blue
    // Smaller pictures are means: here of two of each.
    const auto small = fieldPictures(renderer, Camera{}, grid, values, validity, {"v"}, 16);
    EXPECT_EQ(small[0].image.width, 16);
}

}  // namespace
}  // namespace prt::tools
