// The pipeline as a user runs it, on small input: what comes out is right, reproducible and never stale
// unnoticed.
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "precompute/io/environment_file.h"
#include "precompute/io/exr_file.h"
#include "precompute/io/image.h"
#include "tests/tools/prt_process.h"

namespace prt::test {
namespace {
namespace fs = std::filesystem;

nlohmann::json runJson(const Folder& folder, std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--json", "-"});
    const ProcessResult result = runPrt(folder, arguments);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
}

/// The open box baked per texel and compressed with all components.
class Pipeline : public testing::Test {
  protected:
    void SetUp() override {
        folder_.write("box.obj", openBoxObj());
        ASSERT_EQ(run({"precompute", "box.obj", "-o", "box.prt", "--texels", "96", "--rays", "512", "--order",
                       "4"}),
                  0);
        ASSERT_EQ(run({"compress", "box.prt", "--components", "16"}), 0);
    }
    int run(std::vector<std::string> arguments) {
        arguments.push_back("--quiet");
        const ProcessResult result = runPrt(folder_, arguments);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return result.exitCode;
    }
    /// Linear pixels of one rendering.
    FloatImage relight(std::vector<std::string> options) {
        options.insert(options.begin(),
                       {"relight", "box.prt", "--size", "96x60", "--no-background", "-o", "frame.exr"});
        run(options);
        return loadExr("frame.exr");
    }
    FloatImage loadExr(const std::string& name) {
        const ExrReader reader(folder_ / name);
        FloatImage image{reader.parts()[0].width, reader.parts()[0].height, 3, {}};
        image.pixels.resize(size_t(image.width) * size_t(image.height) * 3);
        std::vector<ExrChannelIn> channels;
        for (const char* channel : {"R", "G", "B"})
            channels.push_back({channel, ExrType::Float, image.pixels.data() + channels.size(), 12,
                                size_t(image.width) * 12});
        reader.read(0, channels);
        return image;
    }
    Folder folder_;
};

double maxDifference(const FloatImage& a, const FloatImage& b) {
    EXPECT_EQ(a.pixels.size(), b.pixels.size());
    double largest = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i)
        largest = std::max(largest, std::abs(double(a.pixels[i]) - double(b.pixels[i])));
    return largest;
}

double maxValue(const FloatImage& a) { return *std::max_element(a.pixels.begin(), a.pixels.end()); }

TEST_F(Pipeline, AllComponentsEqualUncompressed) {
    const FloatImage unc = relight({"--technique", "unc"}), pca = relight({"--technique", "pca"});
    EXPECT_GT(maxValue(unc), 0.05);
    EXPECT_LE(maxDifference(unc, pca), 1e-3 * maxValue(unc));
}

TEST_F(Pipeline, ErrorIsNearTheFloor) {
    const auto json = runJson(
        folder_, {"relight", "box.prt", "--env", "sky:overcast", "--compare-reference", "--size", "96x60"});
    const double floor = json.at("floor_rmse");
    EXPECT_GT(floor, 0);
    for (const auto& row : json.at("rows")) {
        EXPECT_LE(double(row.at("relative_rmse")), floor + 0.03) << row;
        EXPECT_GE(double(row.at("psnr_db")), 20);
    }
    EXPECT_EQ(json.at("rows").size(), 2u);
}

/// Rows of a comparison by technique.
std::map<std::string, double> errorsOf(const nlohmann::json& json) {
    std::map<std::string, double> errors;
    for (const auto& row : json.at("rows"))
        errors[row.at("technique").get<std::string>()] = row.at("relative_rmse").get<double>();
    return errors;
}

const std::vector<std::string> kSideLight = {"--env",     "sky:sunset", "--size",      "96x60",
                                             "--azimuth", "30",         "--elevation", "50"};

/// Every technique the bundle can do is compared; the paper's cheap ones lose what it says they lose.
TEST_F(Pipeline, AllTechniquesAreCompared) {
    std::vector<std::string> arguments = {"relight", "box.prt", "--technique", "all", "--compare-reference"};
    arguments.insert(arguments.end(), kSideLight.begin(), kSideLight.end());
    const auto errors = errorsOf(runJson(folder_, arguments));
    const std::vector<std::string> names = {"unc",        "unc3",        "unc4",  "pca",
                                            "pca4",       "pca8",        "pca12", "pca16",
                                            "vertex-pca", "pca-uniform", "sh2",   "preconvolved-ao"};
    EXPECT_EQ(errors.size(), names.size());  // neither unc6 nor pca20 of four bands
    for (const std::string& name : names) ASSERT_TRUE(errors.contains(name)) << name;
    EXPECT_EQ(errors.at("unc4"), errors.at("unc"));
    EXPECT_EQ(errors.at("pca16"), errors.at("pca"));
    EXPECT_NEAR(errors.at("pca-uniform"), errors.at("pca"), 1.3e-3);
    EXPECT_LT(errors.at("unc"), errors.at("unc3"));
    EXPECT_LT(errors.at("pca8"), errors.at("pca4") + 0.01);
}

/// Fewer bands are those of a bake with fewer, however visibility was projected; two bands and ambient
/// occlusion miss what six bands have under light from the side.
TEST_F(Pipeline, FewerBandsEqualABakeWithFewer) {
    for (const char* projection : {"plain", "irradiance"}) {
        for (const char* order : {"6", "3"})
            run({"precompute", "box.obj", "-o", std::string("order") + order + ".prt", "--texels", "96",
                 "--rays", "512", "--order", order, "--projection", projection});
        const auto picture = [&](const std::string& bundle, const std::string& technique) {
            run({"relight", bundle, "--technique", technique, "--env", "sky:sunset", "--size", "96x60",
                 "--no-background", "-o", "order.exr"});
            return loadExr("order.exr");
        };
        const FloatImage baked = picture("order3.prt", "unc"), reduced = picture("order6.prt", "unc3");
        EXPECT_LE(maxDifference(baked, reduced), 1e-3 * maxValue(baked)) << projection;
        EXPECT_GE(maxDifference(baked, picture("order6.prt", "unc")), 0.02 * maxValue(baked)) << projection;
    }
    std::vector<std::string> arguments = {"relight",     "order6.prt",      "--technique",        "sh2",
                                          "--technique", "preconvolved-ao", "--compare-reference"};
    arguments.insert(arguments.end(), kSideLight.begin(), kSideLight.end());
    const auto errors = errorsOf(runJson(folder_, arguments));
    EXPECT_GE(errors.at("sh2"), 1.5 * errors.at("unc"));
    EXPECT_GE(errors.at("preconvolved-ao"), 1.5 * errors.at("unc"));
}

TEST_F(Pipeline, TechniquesAreNamedByHelpAndErrors) {
    const std::string help = runPrt(folder_, {"relight", "--help"}).out;
    const ProcessResult unknown =
        runPrt(folder_, {"relight", "box.prt", "--technique", "magic", "-o", "a.png", "--quiet"});
    EXPECT_EQ(unknown.exitCode, 2);
    for (const char* name : {"unc,", "unc3", "unc4", "unc6", "pca,", "pca4", "pca8", "pca12", "pca16",
                             "pca20", "pca24", "pca-uniform", "sh2", "preconvolved-ao", "reference", "all"}) {
        EXPECT_NE(help.find(name), std::string::npos) << name;
        EXPECT_NE(unknown.err.find(name), std::string::npos) << name;
    }
    const ProcessResult bands =
        runPrt(folder_, {"relight", "box.prt", "--technique", "unc6", "-o", "a.png", "--quiet"});
    EXPECT_EQ(bands.exitCode, 3);
    EXPECT_NE(bands.err.find("--order 6"), std::string::npos) << bands.err;
    const ProcessResult vectors =
        runPrt(folder_, {"relight", "box.prt", "--technique", "pca24", "-o", "a.png", "--quiet"});
    EXPECT_EQ(vectors.exitCode, 3);
    EXPECT_NE(vectors.err.find("--components 24"), std::string::npos) << vectors.err;
    EXPECT_EQ(runPrt(folder_, {"relight", "box.prt", "--technique", "sh2", "--technique", "unc", "-o",
                               "a.png", "--quiet"})
                  .exitCode,
              2);
    run({"relight", "box.prt", "--technique", "sh2", "--technique", "unc", "--size", "32x20", "-o",
         "{technique}.exr"});
    EXPECT_GT(maxDifference(loadExr("sh2.exr"), loadExr("unc.exr")), 0);
}

TEST_F(Pipeline, BlendingIsLinear) {
    for (const char* technique : {"unc", "pca"}) {
        const FloatImage a = relight({"--technique", technique, "--env", "sky:clear"});
        const FloatImage b = relight({"--technique", technique, "--env", "sky:overcast"});
        const FloatImage blend =
            relight({"--technique", technique, "--env", "sky:clear:0.7", "--env", "sky:overcast:0.3"});
        double worst = 0;
        for (size_t i = 0; i < a.pixels.size(); ++i)
            worst = std::max(worst, std::abs(0.7 * double(a.pixels[i]) + 0.3 * double(b.pixels[i]) -
                                             double(blend.pixels[i])));
        EXPECT_LE(worst, 1e-3 * maxValue(blend)) << technique;
    }
}

/// Turning the light by whole columns equals relighting under the rolled image.
TEST_F(Pipeline, RotationEqualsARolledImage) {
    const Environment sky = loadEnvironment("sky:sunset");
    const int columns = 77, width = sky.image.width;
    FloatImage rolled = sky.image;
    // math/environment.h: turning by +2πk/width moves the light of column x to column x − k.
    for (int y = 0; y < sky.image.height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                rolled.at((x - columns + width) % width, y)[c] = sky.image.at(x, y)[c];
    writeExrImage((folder_ / "sky.exr").string(), sky.image);
    writeExrImage((folder_ / "rolled.exr").string(), rolled);
    const std::string degrees = std::to_string(360.0 * columns / width);
    for (const char* technique : {"unc", "pca", "reference"}) {
        const FloatImage turned =
            relight({"--technique", technique, "--env", "sky.exr", "--rotate", degrees});
        const FloatImage expected = relight({"--technique", technique, "--env", "rolled.exr"});
        const FloatImage unturned = relight({"--technique", technique, "--env", "sky.exr"});
        EXPECT_LE(maxDifference(turned, expected), 1e-3 * maxValue(expected)) << technique;
        EXPECT_GE(maxDifference(turned, unturned), 0.05 * maxValue(expected)) << technique;
    }
}

TEST_F(Pipeline, BackgroundIsTheSameInEveryTechnique) {
    run({"relight", "box.prt", "--size", "96x60", "--distance", "2", "--rotate", "50", "--env", "sky:sunset",
         "-o", "a.exr"});
    run({"relight", "box.prt", "--size", "96x60", "--distance", "2", "--rotate", "50", "--env", "sky:sunset",
         "-o", "b.exr", "--technique", "reference"});
    const FloatImage a = loadExr("a.exr"), b = loadExr("b.exr");
    for (int x = 0; x < 96; ++x)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(a.at(x, 0)[c], b.at(x, 0)[c], 0.02f + 0.02f * b.at(x, 0)[c]) << x;
}

TEST_F(Pipeline, StoredTablesGiveThePictureOfBuiltOnes) {
    const FloatImage built = relight({"--technique", "pca", "--env", "sky:clear"});
    run({"tabulate", "box.prt", "sky:clear", "sky:sunset", "--kind", "triple-product"});
    run({"tabulate", "box.prt", "sky:clear", "--kind", "light-cosine"});
    const auto json = runJson(folder_, {"relight", "box.prt", "--technique", "pca", "--env", "sky:clear",
                                        "--size", "96x60", "--no-background", "-o", "stored.exr"});
    EXPECT_EQ(json.at("tables"), "bundle");
    EXPECT_LE(maxDifference(built, loadExr("stored.exr")), 1e-5 * maxValue(built));
}

/// Tables of every layout give one picture, to the error of their bilinear lookups: of 32 texels .003 of the
/// brightest pixel at most, and less than half of it with 64.
TEST_F(Pipeline, LayoutsGiveOnePicture) {
    for (const char* technique : {"unc", "pca"}) {
        const auto picture = [&](const std::string& layout, const std::string& size) {
            return relight({"--technique", technique, "--env", "sky:sunset", "--table-layout", layout,
                            "--table-size", size});
        };
        const FloatImage fine = picture("cube", "256");
        for (const char* layout : {"cube", "dual-paraboloid", "octahedral"}) {
            const double coarse = maxDifference(picture(layout, "32"), fine) / maxValue(fine);
            EXPECT_LE(coarse, 0.003) << layout;
            EXPECT_LE(maxDifference(picture(layout, "64"), fine) / maxValue(fine), 0.5 * coarse + 1e-5)
                << layout;
        }
    }
}

TEST_F(Pipeline, StoredTablesOfEveryKindAreUsedWhereTheyFit) {
    run({"compress", "box.prt", "--components", "4"});
    const auto origin = [&](std::vector<std::string> options) {
        std::vector<std::string> arguments = {"relight",    "box.prt", "--technique", "pca", "--env",
                                              "sky:sunset", "--size",  "32x20",       "-o",  "o.exr"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return runJson(folder_, arguments).at("tables").get<std::string>();
    };
    run({"tabulate", "box.prt", "sky:sunset", "--layout", "dual-paraboloid"});
    EXPECT_EQ(origin({"--table-layout", "dual-paraboloid"}), "bundle");
    EXPECT_EQ(origin({"--table-layout", "dual-paraboloid", "--table-size", "16"}), "built");
    EXPECT_EQ(origin({}), "built");
    const auto paper = runJson(folder_, {"tabulate", "box.prt", "sky:sunset", "--layout", "octahedral",
                                         "--variant", "paper", "--window", "lanczos"});
    EXPECT_GT(paper.at("rows")[0].at("relative_difference_from_exact").get<double>(), 1e-4);
    EXPECT_LT(paper.at("rows")[0].at("relative_difference_from_exact").get<double>(), 0.1);
    EXPECT_EQ(origin({"--table-layout", "octahedral"}), "built");
    EXPECT_EQ(origin({"--table-layout", "octahedral", "--table-variant", "paper"}), "built");
    EXPECT_EQ(origin({"--table-layout", "octahedral", "--table-variant", "paper", "--window", "lanczos"}),
              "bundle");
}

/// With its sun extracted, a sky casts sharp shadows: much nearer to ray tracing than bands of V can be.
TEST_F(Pipeline, AnExtractedSunHasItsOwnShadow) {
    const auto errorOf = [&](std::vector<std::string> options) {
        std::vector<std::string> arguments = {"relight",
                                              "box.prt",
                                              "--env",
                                              "sky:sunset",
                                              "--size",
                                              "96x60",
                                              "--azimuth",
                                              "30",
                                              "--elevation",
                                              "50",
                                              "--technique",
                                              "unc",
                                              "--compare-reference"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return runJson(folder_, arguments).at("rows")[0].at("relative_rmse").get<double>();
    };
    const double joined = errorOf({}), traced = errorOf({"--extract-sun"});
    EXPECT_LT(traced, 0.6 * joined);
    EXPECT_LT(errorOf({"--extract-sun", "--rotate", "100"}), 0.7 * errorOf({"--rotate", "100"}));

    const auto made = runJson(folder_, {"tabulate", "box.prt", "sky:sunset", "sky:uniform", "--kind",
                                        "light-cosine", "--extract-sun"});
    ASSERT_EQ(made.at("suns").size(), 1u);
    EXPECT_EQ(made.at("suns")[0].at("file"), "tables/sunset.sun.exr");
    EXPECT_FALSE(made.at("suns")[0].at("up_to_date").get<bool>());
    const auto again = runJson(folder_, {"tabulate", "box.prt", "sky:sunset", "sky:uniform", "--kind",
                                         "light-cosine", "--extract-sun"});
    EXPECT_TRUE(again.at("suns")[0].at("up_to_date").get<bool>());
    const auto stored =
        runJson(folder_, {"relight", "box.prt", "--env", "sky:sunset", "--size", "96x60", "--azimuth", "30",
                          "--elevation", "50", "--extract-sun", "-o", "s.exr"});
    EXPECT_EQ(stored.at("tables"), "bundle");
    EXPECT_EQ(stored.at("suns"), 1);
    EXPECT_NEAR(errorOf({"--extract-sun"}), traced, 1e-3);
    // Without the option neither the table nor the sun of that bundle is taken.
    EXPECT_NEAR(errorOf({}), joined, 1e-6);
}

TEST_F(Pipeline, InfoGivesBytesAsShipped) {
    const auto rows = runJson(folder_, {"info", "box.prt"}).at("shipped_bytes");
    ASSERT_EQ(rows.size(), 4u);  // coefficients and weights, each with its table
    EXPECT_EQ(rows[0].at("per"), "texel");
    EXPECT_EQ(rows[0].at("bytes").at("half"), 32);
    EXPECT_FALSE(rows[0].at("bytes").contains("unorm8"));
    EXPECT_EQ(rows[2].at("values"), 16);
    EXPECT_EQ(rows[2].at("bytes").at("unorm8"), 16);
    EXPECT_EQ(rows[3].at("per"), "normal");
    EXPECT_EQ(rows[3].at("bytes").at("half"), 13 * 8);
    EXPECT_EQ(rows[3].at("bytes").at("rgb9e5"), 17 * 4);
}

TEST_F(Pipeline, StaleFilesAreNamedWithTheirCommand) {
    run({"tabulate", "box.prt", "sky:clear", "--kind", "triple-product"});
    ASSERT_EQ(
        run({"precompute", "box.obj", "-o", "box.prt", "--texels", "96", "--rays", "256", "--order", "4"}),
        0);
    const auto info = runJson(folder_, {"info", "box.prt"});
    int stale = 0;
    for (const auto& file : info.at("files")) stale += bool(file.at("stale"));
    EXPECT_EQ(stale, 2) << info.dump(2);  // pca.exr, and the table made from it
    const ProcessResult result = runPrt(folder_, {"relight", "box.prt", "--technique", "pca", "-o", "a.png"});
    EXPECT_EQ(result.exitCode, 3);
    EXPECT_NE(result.err.find("prt compress"), std::string::npos) << result.err;
    ASSERT_EQ(run({"compress", "box.prt", "--components", "16"}), 0);
    EXPECT_EQ(
        runPrt(folder_, {"relight", "box.prt", "--technique", "pca", "-o", "a.png", "--quiet"}).exitCode, 0);
}

TEST_F(Pipeline, ThreadsDoNotChangeABit) {
    for (const char* threads : {"1", "2"})
        run({"precompute", "box.obj", "-o", std::string("threads") + threads + ".prt", "--texels", "96",
             "--rays", "300", "--order", "5", "--threads", threads});
    EXPECT_EQ(slurp(folder_ / "threads1.prt/visibility.exr"), slurp(folder_ / "threads2.prt/visibility.exr"));
    EXPECT_EQ(slurp(folder_ / "threads1.prt/mesh.glb"), slurp(folder_ / "threads2.prt/mesh.glb"));
}

TEST_F(Pipeline, PerVertexWorksToo) {
    run({"precompute", "box.obj", "-o", "v.prt", "--per-vertex", "--order", "4", "--rays", "256"});
    run({"compress", "v.prt", "--components", "4"});
    const auto json = runJson(folder_, {"relight", "v.prt", "--compare-reference", "--size", "96x60"});
    EXPECT_EQ(json.at("rows").size(), 2u);
    for (const auto& row : json.at("rows")) EXPECT_LT(double(row.at("relative_rmse")), 0.5);
}

}  // namespace
}  // namespace prt::test
