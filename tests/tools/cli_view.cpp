// prt view, played by scripts: its pictures are those of prt relight, what is not understood is said, and
// nothing is drawn without need.
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <sstream>

#include "precompute/io/image.h"
#include "tests/tools/prt_process.h"

namespace prt::test {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kNoWindow =
    "no window: needs a build with PRT_WITH_VIEWER and a display (xvfb-run -s -noreset)";

bool mayHaveWindow() {
#ifdef PRT_WITH_VIEWER
    return std::getenv("DISPLAY") != nullptr;
#else
    return false;
#endif
}

std::string bumpyPng() {
    ByteImage image{16, 16, 3, {}};
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            for (const double value : {128 + 60 * std::sin(x), 128 + 60 * std::cos(y), 220.0})
                image.pixels.push_back(uint8_t(value));
    const std::vector<uint8_t> png = encodePng(image);
    return {png.begin(), png.end()};
}

/// The open box, with a normal map, baked and compressed.
class View : public testing::Test {
  protected:
    void SetUp() override {
        if (!mayHaveWindow()) GTEST_SKIP() << kNoWindow;
        folder_.write("bumpy.png", bumpyPng());
        folder_.write("box.mtl", "newmtl bumpy\nKd 0.6 0.7 0.5\nnorm bumpy.png\n");
        folder_.write("box.obj",
                      "mtllib box.mtl\nusemtl bumpy\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                      "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 1 -1\nv 1 1 -1\nv 1 1 1\nv -1 1 1\n"
                      "f 4/1 3/2 2/3 1/4\nf 1/1 2/2 6/3 5/4\nf 2/1 3/2 7/3 6/4\nf 3/1 4/2 8/3 7/4\nf 4/1 1/2 "
                      "5/3 8/4\n");
        prt({"precompute", "box.obj", "-o", "box.prt", "--texels", "64", "--rays", "64", "--order", "3",
             "--projection", "plain"});
        prt({"compress", "box.prt", "--components", "4"});
    }
    void prt(std::vector<std::string> arguments) {
        arguments.push_back("--quiet");
        const ProcessResult result = runPrt(folder_, arguments);
        ASSERT_EQ(result.exitCode, 0) << result.err;
    }
    ProcessResult view(const std::string& script, std::vector<std::string> options = {},
                       const std::string& prelude = "") {
        folder_.write("input.txt", script);
        options.insert(options.begin(), {"view", "box.prt", "--script", "input.txt"});
        for (const std::vector<std::string>& always : {kCamera, kLight})
            options.insert(options.end(), always.begin(), always.end());
        return runPrt(folder_, options, prelude);
    }
    /// The values of `report` lines.
    std::vector<nlohmann::json> play(const std::string& script,
                                     const std::vector<std::string>& options = {}) {
        const ProcessResult result = view(script, options);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        std::vector<nlohmann::json> reports;
        std::istringstream lines(result.out);
        for (std::string line; std::getline(lines, line);) reports.push_back(nlohmann::json::parse(line));
        return reports;
    }
    ByteImage load(const std::string& name) {
        const std::string bytes = slurp(folder_ / name);
        EXPECT_FALSE(bytes.empty()) << name;
        return decodeImage({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()}, name);
    }
    ByteImage relight(const std::string& name, const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {"relight", "box.prt", "-o", name};
        for (const std::vector<std::string>& always : {kLight, options})
            arguments.insert(arguments.end(), always.begin(), always.end());
        prt(arguments);
        return load(name);
    }
    /// `relight` with the camera of the first frame.
    ByteImage relightFirst(const std::string& name, std::vector<std::string> options) {
        options.insert(options.end(), kCamera.begin(), kCamera.end());
        return relight(name, options);
    }

    const std::vector<std::string> kCamera = {"--size",      "160x120", "--azimuth",  "20",
                                              "--elevation", "50",      "--distance", "0.9"};
    const std::vector<std::string> kLight = {"--env",         "sky:sunset", "--env",
                                             "sky:clear:0.5", "--exposure", "-1"};
    Folder folder_;
};

int largestDifference(const ByteImage& a, const ByteImage& b) {
    EXPECT_EQ(a.pixels.size(), b.pixels.size());
    int largest = 0;
    for (size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i)
        largest = std::max(largest, std::abs(int(a.pixels[i]) - int(b.pixels[i])));
    return largest;
}

/// Pixels that differ by more than two steps.
size_t differing(const ByteImage& a, const ByteImage& b) {
    EXPECT_EQ(a.pixels.size(), b.pixels.size());
    size_t count = 0;
    for (size_t i = 0; i + 3 < a.pixels.size(); i += 4) {
        int largest = 0;
        for (size_t c = i; c < i + 3; ++c)
            largest = std::max(largest, std::abs(int(a.pixels[c]) - int(b.pixels[c])));
        count += largest > 2;
    }
    return count;
}

std::map<std::array<uint8_t, 3>, size_t> colours(const ByteImage& image) {
    std::map<std::array<uint8_t, 3>, size_t> counts;
    for (size_t i = 0; i + 3 < image.pixels.size(); i += 4)
        ++counts[{image.pixels[i], image.pixels[i + 1], image.pixels[i + 2]}];
    return counts;
}

std::string commas(const nlohmann::json& vector) {
    std::ostringstream text;
    text.precision(9);
    text << vector[0].get<double>() << ',' << vector[1].get<double>() << ',' << vector[2].get<double>();
    return text.str();
}

TEST_F(View, PicturesAreThoseOfRelight) {
    const auto reports = play(
        "screenshot first.png\n"
        "technique unc\nscreenshot unc.png\n"
        "key N\nscreenshot flat.png\nkey N\n"
        "key E\nscreenshot alone.png\nkey 0\n"
        "key B\nscreenshot black.png\nkey B\n"
        "key C\nkey =\nkey =\nkey =\nscreenshot film.png\nkey C\nkey C\nexposure -1\n"
        "screenshot again.png\nquit\n");
    const ByteImage first = load("first.png");
    EXPECT_LE(largestDifference(first, relightFirst("a.png", {"--technique", "pca"})), 2);
    const ByteImage unc = load("unc.png"), flat = load("flat.png"), alone = load("alone.png");
    EXPECT_LE(largestDifference(unc, relightFirst("b.png", {"--technique", "unc"})), 2);
    EXPECT_GT(differing(first, unc), 1000u);
    EXPECT_LE(largestDifference(flat, relightFirst("c.png", {"--technique", "unc", "--no-normal-map"})), 2);
    EXPECT_GT(differing(flat, unc), 1000u);
    EXPECT_LE(largestDifference(load("black.png"),
                                relightFirst("d.png", {"--technique", "unc", "--no-background"})),
              2);
    EXPECT_EQ(largestDifference(load("again.png"), unc), 0);
    EXPECT_GT(differing(load("film.png"), unc), 1000u);
    // kLight would blend a second environment into it.
    prt({"relight", "box.prt", "--env", "sky:sunset", "--exposure", "-1", "-o", "e.png", "--technique", "unc",
         "--size", "160x120", "--azimuth", "20", "--elevation", "50", "--distance", "0.9"});
    EXPECT_LE(largestDifference(alone, load("e.png")), 2);
}

TEST_F(View, DragsTurnCameraAndLight) {
    const auto reports = play(
        "key Tab\nreport\ndrag left 40 90 80 75\nscreenshot orbit.png\nreport\n"
        "drag right 80 60 50 60\nscreenshot light.png\nreport\n"
        "drag middle 40 40 60 50\nscroll 1\nscreenshot moved.png\nreport\nkey R\nreport\n"
        "doubleclick 80 75\nreport\nhold W 1\nreport\nquit\n",
        {"--technique", "unc"});
    ASSERT_EQ(reports.size(), 7u);
    // A drag over the height of the window, 120, is half a turn.
    const ByteImage orbit = relight("a.png", {"--technique", "unc", "--size", "160x120", "--azimuth", "-40",
                                              "--elevation", "27.5", "--distance", "0.9"});
    // The eye is the same up to rounding: at most an edge pixel or two may fall the other way.
    EXPECT_LE(differing(load("orbit.png"), orbit), 4u);
    EXPECT_EQ(reports[1]["target"], reports[0]["target"]);
    EXPECT_NEAR(reports[2]["rotate_deg"].get<double>(), -45, 1e-9);
    const std::vector<std::string> eye = {"--technique",
                                          "unc",
                                          "--size",
                                          "160x120",
                                          "--eye=" + commas(reports[2]["eye"]),
                                          "--target=" + commas(reports[2]["target"]),
                                          "--rotate=-45"};
    EXPECT_LE(differing(load("light.png"), relight("b.png", eye)), 4u);
    EXPECT_GT(differing(load("light.png"), load("orbit.png")), 1000u);
    const std::vector<std::string> moved = {"--technique",
                                            "unc",
                                            "--size",
                                            "160x120",
                                            "--eye=" + commas(reports[3]["eye"]),
                                            "--target=" + commas(reports[3]["target"]),
                                            "--rotate=-45"};
    EXPECT_LE(differing(load("moved.png"), relight("c.png", moved)), 4u);
    EXPECT_EQ(reports[4]["eye"], reports[0]["eye"]);
    EXPECT_EQ(reports[4]["rotate_deg"], 0.0);
    // A double click looks at what is there: the floor, or the inside of a wall.
    const auto of = [](const nlohmann::json& vector, size_t i) { return vector[i].get<double>(); };
    const nlohmann::json target = reports[5]["target"];
    const double away = std::min({std::abs(of(target, 1)), std::abs(std::abs(of(target, 0)) - 1),
                                  std::abs(std::abs(of(target, 2)) - 1)});
    EXPECT_LT(away, 1e-4) << target;
    EXPECT_NE(target, reports[4]["target"]);
    for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(of(reports[5]["eye"], i), of(reports[4]["eye"], i), 1e-4);
    // Flying takes eye and target along, level.
    double moved2 = 0;
    for (size_t i = 0; i < 3; ++i) {
        const double step = of(reports[6]["target"], i) - of(target, i);
        EXPECT_NEAR(of(reports[6]["eye"], i) - of(reports[5]["eye"], i), step, 1e-4);
        moved2 += step * step;
    }
    EXPECT_GT(moved2, 0.25);
    EXPECT_EQ(reports[6]["target"][1], target[1]);
}

TEST_F(View, StoredValuesAreShown) {
    play(
        "show ao\nscreenshot ao.png\nshow validity\nscreenshot validity.png\nshow charts\nscreenshot "
        "charts.png\n"
        "show coefficient 0\nscreenshot v0.png\nkey Right\nscreenshot v1.png\nshow coefficient 3\nscreenshot "
        "v3.png\nkey 2\nscreenshot w0.png\n"
        "key Right\nscreenshot w1.png\nquit\n");
    std::set<std::string> different;
    for (const char* name : {"ao", "validity", "charts", "v0", "v1", "v3", "w0", "w1"}) {
        const ByteImage image = load(std::string(name) + ".png");
        EXPECT_GT(colours(image).size(), name == std::string("validity") ? 1u : 4u) << name;
        different.insert({image.pixels.begin(), image.pixels.end()});
    }
    EXPECT_EQ(different.size(), 8u) << "each shows something of its own";

    // Ambient occlusion is grey, darker in the corners than in the middle of the floor.
    const ByteImage ao = load("ao.png");
    uint8_t darkest = 255, brightest = 0;
    for (const auto& [colour, count] : colours(ao)) {
        EXPECT_TRUE(colour[0] == colour[1] && colour[1] == colour[2]);
        if (colour[0] == 0) continue;  // nothing is there
        darkest = std::min(darkest, colour[0]);
        brightest = std::max(brightest, colour[0]);
    }
    EXPECT_LT(int(darkest) + 20, int(brightest));
    // Nothing lies inside the box's walls: what is seen has the colour of valid points, (0.35, 0.5, 0.35) as
    // sRGB.
    const auto seen = colours(load("validity.png"));
    EXPECT_GT(seen.at({160, 188, 160}), 5000u);
    // Coefficient 0 of a plain projection is the mean of visibility: nowhere negative, so nowhere blue.
    for (const auto& [colour, count] : colours(load("v0.png"))) EXPECT_GE(int(colour[0]) + 1, int(colour[2]));
    // Coefficient 1 is that of -y, and the box is open above: all blue. Coefficient 3 is that of -x, and
    // walls face either way.
    const auto count = [&](const char* name, size_t more, size_t less) {
        size_t number = 0;
        for (const auto& [colour, pixels] : colours(load(name)))
            if (colour[more] > colour[less] + 20) number += pixels;
        return number;
    };
    EXPECT_GT(count("v1.png", 2, 0), 3000u);
    EXPECT_EQ(count("v1.png", 0, 2), 0u);
    EXPECT_GT(count("v3.png", 2, 0), 300u);
    EXPECT_GT(count("v3.png", 0, 2), 300u);
    // Edges are black within coloured charts: five faces make at least two charts.
    EXPECT_GE(colours(load("charts.png")).size(), 3u);
}

TEST_F(View, ReferenceIsTracedBesides) {
    const auto reports = play(
        "show reference\nscreenshot before.png\nreport\nwait-reference\nscreenshot reference.png\nreport\n"
        "show difference\nscreenshot difference.png\ntechnique unc\nscreenshot other.png\nreport\n"
        "weight clear 2\nscreenshot brighter.png\nreport\nrotate 30\nscreenshot turned.png\nreport\n"
        "show lit\nscreenshot lit.png\nquit\n",
        {"--technique", "pca", "--reference-rays", "256"});
    ASSERT_EQ(reports.size(), 5u);
    std::vector<std::string> options = {"--technique",
                                        "pca",
                                        "--compare-reference",
                                        "--reference-rays",
                                        "256",
                                        "--reference-output",
                                        "r.png",
                                        "--json",
                                        "r.json"};
    const ByteImage pca = relightFirst("a.png", options);
    EXPECT_LE(largestDifference(load("before.png"), pca), 2) << "until it is there the technique is shown";
    EXPECT_FALSE(reports[0].contains("relative_rmse"));
    EXPECT_LE(largestDifference(load("reference.png"), load("r.png")), 2);
    std::map<std::string, double> errors;
    const nlohmann::json json = nlohmann::json::parse(slurp(folder_ / "r.json"));
    for (const auto& row : json.at("rows")) errors[row.at("technique")] = row.at("relative_rmse");
    EXPECT_NEAR(reports[1].at("relative_rmse").get<double>(), errors.at("pca"), 1e-4);
    EXPECT_NEAR(reports[2].at("relative_rmse").get<double>(), errors.at("unc"), 1e-4);
    EXPECT_GT(differing(load("difference.png"), load("other.png")), 100u);
    // Another blend of the same environments needs no new rays, another turn does.
    EXPECT_TRUE(reports[3].contains("relative_rmse"));
    EXPECT_GT(differing(load("brighter.png"), load("other.png")), 100u);
    EXPECT_FALSE(reports[4].contains("relative_rmse"));
    EXPECT_EQ(largestDifference(load("turned.png"), load("lit.png")), 0);
}

TEST_F(View, DrawsOnlyWhatChanged) {
    const auto reports = play(
        "window a.png\nreport\nmove 100 30\nmove 105 31\nwindow b.png\nreport\n"
        "drag left 100 16 60 60\nreport\nkey Tab\nwindow c.png\nreport\ndrag left 100 16 60 60\nreport\n"
        "key H\nwindow help.png\nkey H\nreport\nresize 200 140\nwindow large.png\nscreenshot "
        "scene.png\nreport\nquit\n");
    ASSERT_EQ(reports.size(), 7u);
    EXPECT_EQ(reports[0]["scene_frames"], 1);
    EXPECT_EQ(reports[1]["scene_frames"], 1) << "the panel alone was drawn anew";
    EXPECT_GT(reports[1]["window_frames"].get<int>(), reports[0]["window_frames"].get<int>());
    EXPECT_EQ(reports[2]["eye"], reports[0]["eye"]) << "a drag that begins in the panel is the panel's";
    EXPECT_EQ(reports[3]["scene_frames"], reports[2]["scene_frames"]);
    EXPECT_NE(reports[4]["eye"], reports[0]["eye"]) << "without panel it is the camera's";
    EXPECT_EQ(reports[5]["light_switches"], 1);
    EXPECT_GT(differing(load("a.png"), load("c.png")), 3000u) << "the panel was seen";
    EXPECT_GT(differing(load("help.png"), load("c.png")), 3000u);
    const ByteImage large = load("large.png");
    EXPECT_EQ(large.width, 200);
    EXPECT_EQ(large.height, 140);
    EXPECT_EQ(reports[6]["width"], 200);
    // Without panel the window shows just the scene.
    EXPECT_EQ(largestDifference(large, load("scene.png")), 0);
}

// Clicks down the panel's left column, wherever its parts are: switches switch, lists open and are chosen
// from.
TEST_F(View, PanelIsUsedWithTheMouse) {
    std::string script = "resize 640 560\nreport\n";
    for (int y = 60; y < 540; y += 12) script += "click 356 " + std::to_string(y) + "\nreport\n";
    script += "drag left 420 98 470 98\nreport\nquit\n";
    const auto reports = play(script, {"--technique", "unc"});
    ASSERT_GT(reports.size(), 40u);
    std::set<std::string> changed;
    for (size_t i = 1; i < reports.size(); ++i)
        for (const auto& [key, value] : reports[i].items())
            if (value != reports[i - 1][key]) changed.insert(key);
    for (const char* key : {"normal_map", "samples", "weights"}) EXPECT_TRUE(changed.contains(key)) << key;
}

TEST_F(View, LightThatIsNotThereIsSaid) {
    prt({"lightmap", "box.prt", "--env", "sky:sunset", "--bounces", "1", "--rays", "64"});
    prt({"lightmap", "box.prt", "--env", "sky:clear", "--bounces", "1", "--rays", "64"});
    const auto reports = play(
        "technique sh-lightmap\nscreenshot map.png\nreport\nrotate 10\nscreenshot turned.png\nreport\n"
        "technique unc\nscreenshot unc.png\nreport\nrotate 0\ntechnique sh-lightmap\nscreenshot "
        "again.png\nreport\nquit\n");
    ASSERT_EQ(reports.size(), 4u);
    EXPECT_FALSE(reports[0].contains("problem"));
    EXPECT_LE(largestDifference(load("map.png"), relightFirst("a.png", {"--technique", "sh-lightmap"})), 2);
    ASSERT_TRUE(reports[1].contains("problem"));
    EXPECT_THAT(reports[1]["problem"].get<std::string>(), HasSubstr("prt lightmap"));
    EXPECT_EQ(colours(load("turned.png")).size(), 1u) << "black";
    EXPECT_FALSE(reports[2].contains("problem"));
    EXPECT_GT(colours(load("unc.png")).size(), 100u);
    EXPECT_EQ(largestDifference(load("again.png"), load("map.png")), 0);
}

TEST_F(View, ScreenshotsAreNumberedAndNothingElseIsWritten) {
    fs::create_directory(folder_ / "shots");
    folder_.write("shots/prt-view-0002.png", "mine");
    const auto before = folder_.files();
    const ProcessResult result = view("key P\nkey P\nkey H\nkey P\nkey Escape\n", {"--screenshots", "shots"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(slurp(folder_ / "shots/prt-view-0002.png"), "mine");
    for (const char* name : {"shots/prt-view-0001.png", "shots/prt-view-0003.png", "shots/prt-view-0004.png"})
        EXPECT_EQ(load(name).width, 160) << name;
    EXPECT_EQ(largestDifference(load("shots/prt-view-0001.png"), load("shots/prt-view-0004.png")), 0)
        << "neither panel nor help are in them";
    EXPECT_EQ(folder_.files().size(), before.size() + 4) << "three pictures and the script";
    const ProcessResult missing = view("key P\nquit\n", {"--screenshots", "nowhere"});
    EXPECT_EQ(missing.exitCode, 0) << "the view goes on";
    EXPECT_THAT(missing.err, HasSubstr("warning: nowhere: is no folder"));
}

TEST_F(View, StaysOpenUntilItIsToldToEnd) {
    const ProcessResult interrupted = view("key N\n", {}, "timeout --preserve-status -s INT 2");
    EXPECT_EQ(interrupted.exitCode, 130) << interrupted.err;
    EXPECT_THAT(interrupted.err, HasSubstr("interrupted"));
    const ProcessResult wrong = view("key N\nshow weight 4\n");
    EXPECT_EQ(wrong.exitCode, 3);
    EXPECT_THAT(wrong.err, HasSubstr("input.txt:2: there is no number 4"));
    EXPECT_EQ(std::count(wrong.err.begin(), wrong.err.end(), '\n'), 1) << wrong.err;
    EXPECT_EQ(view("weight moon 1\n").exitCode, 3);
    EXPECT_EQ(view("technique pca24\n").exitCode, 3);
}

TEST(ViewCommand, SaysWhatIsMissing) {
    const Folder folder;
#ifdef PRT_WITH_VIEWER
    // A bundle that is not there is found before a window is asked for.
    const ProcessResult bundle = runPrt(folder, {"view", "none.prt"}, "unset DISPLAY;");
    EXPECT_EQ(bundle.exitCode, 3);
    EXPECT_THAT(bundle.err, HasSubstr("none.prt"));
    folder.write("box.obj", openBoxObj());
    ASSERT_EQ(runPrt(folder,
                     {"precompute", "box.obj", "-o", "box.prt", "--texels", "32", "--rays", "16", "--quiet"})
                  .exitCode,
              0);
    const ProcessResult result = runPrt(folder, {"view", "box.prt"}, "export DISPLAY=:nowhere;");
    EXPECT_THAT(result.err, HasSubstr("no window can be made"));
#else
    const ProcessResult result = runPrt(folder, {"view", "box.prt"});
    EXPECT_THAT(result.err, HasSubstr("PRT_WITH_VIEWER"));
#endif
    EXPECT_EQ(result.exitCode, 3);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

TEST(ViewCommand, ArgumentsAreChecked) {
    const Folder folder;
    folder.write("bad.txt", "jump\n");
    for (const auto& [arguments, code, words] :
         std::vector<std::tuple<std::vector<std::string>, int, std::string>>{
             {{"view"}, 2, "BUNDLE"},
             {{"view", "b.prt", "--technique", "pca16x"}, 2, "pca16x"},
             {{"view", "b.prt", "--samples", "3"}, 2, "neither 1 nor 4"},
             {{"view", "b.prt", "--tone", "loud"}, 2, "--tone"},
             {{"view", "b.prt", "--size", "big"}, 2, "--size"},
             {{"view", "b.prt", "--env", "a.exr:-1"}, 2, "--env"},
             {{"view", "b.prt", "--script", "none.txt"}, 3, "none.txt"},
             {{"view", "b.prt", "--script", "bad.txt"}, 3, "bad.txt:1: there is no command 'jump'"}}) {
        const ProcessResult result = runPrt(folder, arguments);
        EXPECT_EQ(result.exitCode, code) << result.err;
        EXPECT_THAT(result.err, HasSubstr(words));
    }
    const ProcessResult help = runPrt(folder, {"view", "--help"});
    EXPECT_EQ(help.exitCode, 0);
    for (const char* words : {"Shift+T", "right drag, L + left drag", "wait-reference", "--screenshots"})
        EXPECT_THAT(help.out, HasSubstr(words));
    EXPECT_THAT(runPrt(folder, {"--help"}).out, HasSubstr("view"));
}

/// tools/docs/view.md names every key and every command of scripts as the program has them.
TEST(ViewCommand, IsDocumented) {
    const std::string docs = slurp(fs::path(PRT_SOURCE_DIR) / "tools/docs/view.md");
    const Folder folder;
    std::istringstream help(runPrt(folder, {"view", "--help"}).out);
    int lines = 0;
    bool table = false;
    for (std::string line; std::getline(help, line);) {
        if (line.find("Mouse and keys:") != std::string::npos) table = true;
        if (line.find("Example:") != std::string::npos) break;
        const size_t begin = line.find_first_not_of(' ');
        if (!table || begin == std::string::npos || line.find("  ", begin) == std::string::npos) continue;
        const std::string words = line.substr(begin, line.find("  ", begin) - begin);
        std::string cell;  // where a bar ends a column
        for (const char c : words) cell += c == '|' ? std::string("\\|") : std::string(1, c);
        EXPECT_THAT(docs, HasSubstr("| `" + cell + "` |")) << line;
        ++lines;
    }
    EXPECT_GT(lines, 40);
}

}  // namespace
}  // namespace prt::test
