// prt measure bake: what it casts, compares and reports on a small surface, what the command writes and
// refuses.
#include "tools/measure/bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/mesh/load_mesh.h"
#include "tests/base/temporary_directory.h"
#include "tests/rays/shapes.h"
#include "tests/tools/run_command.h"
#include "tools/measure/commands.h"

namespace prt::tools {
namespace {

const std::vector<std::string> kLoops = {"single-random", "single-direction-major", "packet-point-major",
                                         "packet-direction-major", "stream-direction-major"};

Scene waves() {
    const shapes::Mesh mesh =
        shapes::heightField(12, [](double x, double z) { return 0.3 * std::sin(5 * x) * std::cos(4 * z); });
    Scene scene;
    scene.positions = mesh.positions;
    scene.indices = mesh.indices;
    return prepareScene(std::move(scene), "waves", {});
}

TEST(MeasureBake, MeasuresEveryLoopAndEveryBake) {
    BakeStudy study;
    study.texels = 32;
    study.rays = 64;
    study.shOrder = 3;
    study.threadCounts = {1, 2};
    study.rounds = 3;
    study.loopPoints = 0;
    const BakeRates rates = measureBake(waves(), study);
    EXPECT_EQ(rates.triangles, 288u);
    EXPECT_GT(rates.points, 400u);
    // 10 ways each for one thread and two.
    ASSERT_EQ(rates.rates.size(), 20u);
    for (const int threads : {1, 2}) {
        std::set<uint64_t> rays;
        const BakeRate& ceiling = rates.ceiling(threads);
        EXPECT_EQ(ceiling.ratio, 1);
        EXPECT_EQ(std::count(kLoops.begin(), kLoops.end(), ceiling.arrangement), 1) << ceiling.arrangement;
        for (const std::string& name : kLoops) {
            const BakeRate* row = rates.find(threads, name);
            ASSERT_TRUE(row) << name;
            rays.insert(row->rays);
            EXPECT_EQ(row->points, rates.points);
            EXPECT_LE(row->raysPerSecond, ceiling.raysPerSecond);
        }
        EXPECT_EQ(rays.size(), 1u);
        // On average half of the directions lie above a horizon.
        EXPECT_NEAR(double(*rays.begin()), 32.0 * double(rates.points), 2.0 * double(rates.points));
        for (const char* name : {"pipeline", "pipeline-no-inside", "adaptive"}) {
            const BakeRate* row = rates.find(threads, name);
            ASSERT_TRUE(row) << name;
            EXPECT_EQ(row->points, rates.points);
            EXPECT_GT(row->rays, 25 * rates.points) << name;
            EXPECT_GT(row->raysPerSecond, 0) << name;
            EXPECT_DOUBLE_EQ(row->ratio, row->raysPerSecond / ceiling.raysPerSecond);
            EXPECT_LE(row->lowest, row->highest);
        }
        for (const char* name : {"packet-direction-major-not-robust", "stream-direction-major-not-robust"}) {
            ASSERT_TRUE(rates.find(threads, name)) << name;
            EXPECT_EQ(rates.find(threads, name)->rays, *rays.begin());
        }
    }
    EXPECT_EQ(rates.find(3, "pipeline"), nullptr);
    EXPECT_GT(rates.blockedRays, rates.points);
    EXPECT_LE(rates.largestDifference, 2u);
    std::map<int, double> shares;
    for (const BakeStageTime& stage : rates.stages) shares[stage.threads] += stage.share;
    ASSERT_EQ(shares.size(), 2u);
    // What no stage names is "other".
    for (const auto& [threads, share] : shares) EXPECT_GE(share, 1 - 1e-9) << threads;
}

TEST(MeasureBake, LoopsTakeRunsOfPointsSpreadOverTheSurface) {
    BakeStudy study;
    study.texels = 64;
    study.rays = 16;
    study.shOrder = 2;
    study.rounds = 1;
    study.error = 0;
    study.loopPoints = 512;
    const BakeRates rates = measureBake(waves(), study);
    EXPECT_GT(rates.points, 2000u);
    EXPECT_EQ(rates.find(1, "stream-direction-major")->points, 512u);
    EXPECT_EQ(rates.find(1, "pipeline")->points, rates.points);
    EXPECT_EQ(rates.find(1, "adaptive"), nullptr);
}

// Every edge belongs to two triangles that run through it in opposite directions.
TEST(MeasureBake, TheBumpySphereIsClosedAndFacesOutwards) {
    const Scene scene = bumpySphere();
    EXPECT_EQ(scene.triangleCount(), 69692u);
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    // Vertices may be split for normals or tangents: edges by position.
    std::map<std::array<float, 3>, uint32_t> places;
    std::vector<uint32_t> place;
    for (const Vec3f& p : scene.positions)
        place.push_back(places.try_emplace({p.x(), p.y(), p.z()}, uint32_t(places.size())).first->second);
    double volume = 0;
    for (size_t i = 0; i < scene.indices.size(); i += 3) {
        const uint32_t* corner = &scene.indices[i];
        for (int k = 0; k < 3; ++k) {
            const uint32_t a = place[corner[k]], b = place[corner[(k + 1) % 3]];
            edges[std::minmax(a, b)] += a < b ? 1 : 1 << 16;
        }
        volume += double(scene.positions[corner[0]].dot(
                      scene.positions[corner[1]].cross(scene.positions[corner[2]]))) /
                  6;
    }
    EXPECT_TRUE(std::all_of(edges.begin(), edges.end(),
                            [](const auto& edge) { return edge.second == (1 << 16) + 1; }));
    EXPECT_EQ(edges.size(), 69692u * 3 / 2);
    EXPECT_GT(volume, 2);
}

void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "bake");
    test::runCommand(runMeasureBake, arguments);
}

// The first number under a key.
double numberOf(const std::string& json, const std::string& key) {
    const std::string sought = "\"" + key + "\": ";
    const size_t at = json.find(sought);
    return at == std::string::npos ? std::nan("") : std::stod(json.substr(at + sought.size()));
}

TEST(MeasureBakeCommand, WritesCsvAndJson) {
    const TemporaryDirectory folder;
    const std::string prefix = folder.file("bake"), json = folder.file("bake.json");
    const std::string mesh = std::string(PRT_SOURCE_DIR) + "/meshes/shapes/sphere.obj";
    run({mesh,    "--texels",      "64",  "--rays",          "16",   "--order",
         "2",     "--rounds",      "1",   "--thread-counts", "1-2",  "--projection",
         "plain", "--loop-points", "256", "--plot",          "none", "-o",
         prefix,  "--json",        json,  "--quiet"});
    const std::string text = readFile(json);
    for (const char* key :
         {"measure", "cpu", "ceiling_arrangement", "ratio_low", "ratio_high", "fast_scene_rays_per_s",
          "adaptive_rays_per_s", "adaptive_rays_per_point", "largest_difference", "blocked_rays", "triangles",
          "points", "embree_isa", "rows", "stages"})
        EXPECT_NE(text.find(fmt::format("\"{}\": ", key)), std::string::npos) << key;
    for (const char* pair :
         {"\"threads\": 2,", "\"mesh\": \"sphere\"", "\"projection\": \"plain\"", "\"from_threads\": 1",
          "\"to_threads\": 2", "\"arrangement\": \"single-random\"", "\"stage\": \"other\""})
        EXPECT_NE(text.find(pair), std::string::npos) << pair << " in\n" << text;
    EXPECT_NEAR(numberOf(text, "ratio"),
                numberOf(text, "pipeline_rays_per_s") / numberOf(text, "ceiling_rays_per_s"), 1e-6);
    EXPECT_TRUE(readFile(prefix + ".csv")
                    .starts_with("threads,arrangement,rays_per_s,ratio,ratio_low,ratio_high,seconds,rays,"
                                 "points\r\n1,single-random,"));
    EXPECT_TRUE(readFile(prefix + "-stages.csv").starts_with("threads,stage,seconds,share\r\n1,set-up,"));
}

TEST(MeasureBakeCommand, HelpListsEveryOption) {
    testing::internal::CaptureStdout();
    run({"--help"});
    const std::string text = testing::internal::GetCapturedStdout();
    for (const char* part :
         {"MESH", "--texels", "--rays", "--order", "--projection", "--error", "--thread-counts", "--rounds",
          "--loop-points", "--output", "--plot", "--json", "[16..8192, default 512]", "[0..1024, default 0]"})
        EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

TEST(MeasureBakeCommand, RefusesWhatItCannotMeasure) {
    const TemporaryDirectory folder;
    const std::string prefix = folder.file("bake");
    EXPECT_THROW(run({"--rays", "65536"}), UsageError);
    EXPECT_THROW(run({"--rays", "0"}), UsageError);
    EXPECT_THROW(run({"--texels", "15"}), UsageError);
    EXPECT_THROW(run({"--order", "11"}), UsageError);
    EXPECT_THROW(run({"--rounds", "0"}), UsageError);
    EXPECT_THROW(run({"--error", "1.5"}), UsageError);
    EXPECT_THROW(run({"--thread-counts", "0"}), UsageError);
    EXPECT_THROW(run({"--thread-counts", "two"}), UsageError);
    EXPECT_THROW(run({"--projection", "oblique"}), UsageError);
    EXPECT_THROW(run({"--loop-points", "-1"}), UsageError);
    EXPECT_THROW(run({"a.obj", "b.obj"}), UsageError);
    EXPECT_THROW(run({"--plot", "bmp"}), UsageError);
    EXPECT_THROW(run({folder.file("absent.obj"), "-o", prefix}), InputError);
    EXPECT_THROW(run({"-o", folder.file("missing/bake")}), OutputError);
}

TEST(MeasureBakeCommand, StopsWhenInterrupted) {
    BakeStudy study;
    study.texels = 32;
    study.rays = 16;
    requestInterrupt();
    EXPECT_THROW(measureBake(waves(), study), Interrupted);
    clearInterrupt();
}

}  // namespace
}  // namespace prt::tools
