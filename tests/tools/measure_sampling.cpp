// prt measure sampling: its estimator against the bake, its errors against what theory says of random
// directions, and what the command writes and refuses.
#include "tools/measure/sampling.h"

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <sstream>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/math/directions.h"
#include "precompute/math/sh.h"
#include "tests/base/temporary_directory.h"
#include "tests/math/random_input.h"
#include "tests/rays/shapes.h"
#include "tests/tools/run_command.h"
#include "tools/measure/commands.h"
#include "tools/measure/sampling_banding.h"
#include "tools/measure/surface_points.h"

namespace prt::tools {
namespace {

// A floor with a block and a ball on it: long silhouettes, straight and round, and contact.
Scene stage() {
    shapes::Mesh mesh = shapes::floorSquare(2);
    mesh.add(shapes::box({-1.2f, 0.01f, -1}, {-0.4f, 1.1f, 0.9f}));
    mesh.add(shapes::sphere(0.6, {0.7, 0.7, 0}, 3));
    Scene scene;
    scene.positions = std::move(mesh.positions);
    scene.indices = std::move(mesh.indices);
    return scene;
}

SamplingStudy smallStudy() {
    SamplingStudy study;
    study.points = 80;
    study.counts = {64, 256, 1024};
    study.seeds = 3;
    study.truth = 16384;
    study.errors = {0.02, 0.005};
    return study;
}

TEST(VisibilityEstimator, IsTheOneOfTheBake) {
    const Scene scene = stage();
    const RayCaster caster(scene.positions, scene.indices);
    const std::vector<SurfacePoint> points = randomSurfacePoints(scene, 60, 3);
    for (const Projection& projection : {Projection{}, kPlainProjection})
        for (const int shOrder : {1, 6}) {
            BakeOptions options;
            options.shOrder = shOrder;
            options.rays = 300;
            options.projection = projection;
            const BakeResult baked = bakeVisibility(caster, points, options);
            const VisibilityEstimator estimator(shOrder, projection);
            const IrradianceNorm norm(shOrder);
            const std::vector<Vec3f> directions = sphericalFibonacci(300);
            std::vector<float> c(size_t(shCount(shOrder)));
            size_t rays = 0;
            for (size_t p = 0; p < points.size(); ++p) {
                const VisibilityEstimator::Estimate estimate =
                    estimator.estimate(caster, points[p], directions, c);
                rays += estimate.rays;
                EXPECT_NEAR(estimate.ao, double(baked.ao[p]), 1e-5);
                // As irradiance shows it: the weighted solve amplifies rounding where irradiance does not
                // look.
                for (size_t i = 0; i < c.size(); ++i) c[i] -= baked.coefficients[p * c.size() + i];
                EXPECT_LT(norm.evaluate(points[p].normal, c), 1e-5);
            }
            EXPECT_EQ(rays, baked.rays);
        }
}

TEST(TruthDirections, AreUniformAndShareNoneWithABake) {
    const std::vector<Vec3f> truth = truthDirections(4096), bake = sphericalFibonacci(4096);
    Vec3d mean = Vec3d::Zero();
    float nearest = 4;
    for (const Vec3f& t : truth) {
        mean += t.cast<double>() / 4096;
        EXPECT_NEAR(t.norm(), 1, 2e-7f);
        for (const Vec3f& b : bake) nearest = std::min(nearest, (t - b).norm());
    }
    EXPECT_LT(mean.norm(), 1e-4);
    EXPECT_GT(nearest, 1e-5f);
}

// Rows of one set.
std::vector<SamplingRow> rowsOf(const SamplingResult& result, const std::string& set) {
    std::vector<SamplingRow> rows;
    for (const SamplingRow& row : result.rows)
        if (row.set == set) rows.push_back(row);
    return rows;
}

TEST(StudySampling, ErrorsFallAsTheoryHasItAndTheEstimateHolds) {
    const SamplingResult result = studySampling(stage(), smallStudy());
    EXPECT_GT(result.points, 60);
    EXPECT_GT(result.meanAo, 0.4);
    EXPECT_LT(result.meanAo, 0.95);
    for (const char* set : {"random", "random-rotated"}) {
        const std::vector<SamplingRow> rows = rowsOf(result, set);
        ASSERT_EQ(rows.size(), 3u);
        for (size_t i = 0; i < 3; ++i) {
            EXPECT_NEAR(rows[i].rays / rows[i].directions, 0.5, 0.05);
            EXPECT_TRUE(std::isnan(rows[i].estimated));
            EXPECT_GT(rows[i].rms, rows[i].rmsOpen) << "open points receive most";
        }
        // 1/√N over 16 times as many. Shared sets are three samples of the mesh's mean square error.
        EXPECT_NEAR(rows[0].rms / rows[2].rms, 4, set == std::string("random") ? 1.6 : 0.8);
    }
    for (size_t i = 0; i < 3; ++i) {
        const double random = rowsOf(result, "random-rotated")[i].rms,
                     stratified = rowsOf(result, "stratified-rotated")[i].rms,
                     sobol = rowsOf(result, "sobol-owen-rotated")[i].rms,
                     shared = rowsOf(result, "fibonacci")[i].rms,
                     fibonacci = rowsOf(result, "fibonacci-rotated")[i].rms;
        EXPECT_LT(std::max(stratified, sobol), 0.7 * random);
        EXPECT_LT(fibonacci, 0.8 * std::min(stratified, sobol));
        EXPECT_NEAR(shared / fibonacci, 1, 0.25);
    }
    const std::vector<SamplingRow> adaptive = rowsOf(result, "adaptive-fibonacci");
    ASSERT_EQ(adaptive.size(), 2u);
    for (const SamplingRow& row : adaptive) {
        EXPECT_TRUE(std::isnan(row.directions));
        EXPECT_NEAR(row.rmsOpen / row.estimated, 1, 0.45);
        EXPECT_GE(row.belowTwiceEstimate, 0.88);  // nine of ten, of 80 points
        EXPECT_GE(row.belowError, 0.85);
        EXPECT_LT(row.rays, effortAt(result.rows, "fibonacci", row.rms).rays);
    }
    EXPECT_EQ(adaptive[0].error, 0.02);
    for (const SamplingRow& row : rowsOf(result, "fibonacci")) {
        // Measured .34, .74, .94 here: halves of few directions exaggerate.
        EXPECT_LT(row.rmsOpen / row.estimated, 1.45) << row.directions;
        EXPECT_GT(row.rmsOpen / row.estimated, row.directions < 100 ? 0.2 : 0.5) << row.directions;
        EXPECT_TRUE(std::isnan(row.error));
    }
    EXPECT_EQ(rowsOf(result, "fibonacci").back().rms <= adaptive.back().rms ||
                  rowsOf(result, "fibonacci").back().directions == 4096,
              true)
        << "the curve goes on to the best adaptive bake";
}

TEST(StudySampling, RepeatsAndTakesWhatItIsAsked) {
    SamplingStudy study = smallStudy();
    study.points = 10;
    study.counts = {16};
    study.sets = {DirectionSetKind::Stratified, DirectionSetKind::Fibonacci};
    study.errors.clear();
    study.truth = 1024;
    study.projection = kPlainProjection;
    const SamplingResult a = studySampling(stage(), study), b = studySampling(stage(), study);
    ASSERT_EQ(a.rows.size(), 4u);
    const char* names[] = {"stratified", "stratified-rotated", "fibonacci", "fibonacci-rotated"};
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(a.rows[i].set, names[i]);
        EXPECT_EQ(a.rows[i].directions, 16);
        EXPECT_EQ(a.rows[i].rms, b.rows[i].rms);
    }
    study.rotated = false;
    study.seed = 2;
    const SamplingResult other = studySampling(stage(), study);
    ASSERT_EQ(other.rows.size(), 2u);
    EXPECT_NE(other.rows[0].rms, a.rows[0].rms);
    requestInterrupt();
    EXPECT_THROW(studySampling(stage(), study), Interrupted);
    clearInterrupt();
}

TEST(SamplingEffort, LiesBetweenTheLogarithms) {
    std::vector<SamplingRow> rows;
    for (const double n : {10.0, 100.0, 1000.0}) {
        rows.push_back({"a", n, n / 2, 2 / n, 0, 0, 0, 0, 0});
        rows.push_back({"b", n, n / 2, 1 / std::sqrt(n), 0, 0, 0, 0, 0});
    }
    EXPECT_NEAR(effortAt(rows, "a", 2 / 30.0).directions, 30, 1e-9);
    EXPECT_NEAR(effortAt(rows, "a", 2 / 30.0).rays, 15, 1e-9);
    EXPECT_NEAR(effortAt(rows, "a", 2 / 400.0).directions, 400, 1e-9);
    EXPECT_NEAR(rmsAt(rows, "b", 25), 0.2, 1e-12);
    EXPECT_NEAR(rmsAt(rows, "b", 1000), std::sqrt(1e-3), 1e-12);
    EXPECT_TRUE(std::isnan(effortAt(rows, "a", 0.3).rays));
    EXPECT_TRUE(std::isnan(effortAt(rows, "a", 0.001).rays));
    EXPECT_TRUE(std::isnan(effortAt(rows, "c", 0.1).rays));
    EXPECT_TRUE(std::isnan(rmsAt(rows, "b", 1001)));
}

TEST(PowerSpectrum, KeepsPowerAndPlacesWaves) {
    constexpr size_t kCount = 1024;
    std::vector<double> wave, noise;
    prt::test::RandomInput random(4);
    for (size_t k = 0; k < kCount; ++k) {
        wave.push_back(3 + std::cos(2 * std::numbers::pi * 100 * double(k) / kCount + 0.7));
        noise.push_back(random.uniform(-1, 1));
    }
    const std::vector<double> ofWave = powerSpectrum(wave), ofNoise = powerSpectrum(noise);
    ASSERT_EQ(ofWave.size(), kCount / 2 + 1);
    // A Hann window spreads a wave over three frequencies; cos² has mean 1/2; the constant is taken off.
    EXPECT_NEAR(ofWave[99] + ofWave[100] + ofWave[101], 0.5, 1e-9);
    EXPECT_NEAR(std::accumulate(ofWave.begin(), ofWave.end(), 0.0), 0.5, 1e-9);
    // Mean square 1/3; the window leaves about 2/3 of 1024 independent samples: 3 % of scatter.
    EXPECT_NEAR(std::accumulate(ofNoise.begin(), ofNoise.end(), 0.0), 1 / 3.0, 0.1 / 3);
    const double upper = std::accumulate(ofNoise.begin() + kCount / 4, ofNoise.end(), 0.0);
    EXPECT_NEAR(upper, 1 / 6.0, 0.15 / 6);
}

TEST(TurnedBakes, FirstIsTheBakeItselfAndOthersAgreeWithIt) {
    const Scene scene = stage();
    const std::vector<SurfacePoint> points = randomSurfacePoints(scene, 30, 2);
    BakeOptions options;
    options.shOrder = 4;
    options.rays = 2048;
    options.findInside = false;
    const TurnedBakes bakes(scene, 3, 5);
    const RayCaster caster(scene.positions, scene.indices);
    const BakeResult plain = bakeVisibility(caster, points, options);
    EXPECT_EQ(bakes.bake(points, std::vector<int>(30, 0), options).coefficients, plain.coefficients);
    std::vector<int> dealt(30);
    for (size_t p = 0; p < 30; ++p) dealt[p] = int(p % 3);
    const BakeResult turned = bakes.bake(points, dealt, options);
    const IrradianceNorm norm(4);
    std::vector<float> difference(16);
    for (size_t p = 0; p < 30; ++p) {
        for (size_t i = 0; i < 16; ++i)
            difference[i] = turned.coefficients[p * 16 + i] - plain.coefficients[p * 16 + i];
        const double length = norm.evaluate(points[p].normal, difference);
        EXPECT_LT(length, 0.02) << "two sets of 2048 directions err by less than 0.01 each";
        EXPECT_EQ(length == 0, p % 3 == 0) << "and differently";
        EXPECT_NEAR(turned.ao[p], plain.ao[p], 0.02f);
    }
    EXPECT_NEAR(double(turned.rays), double(plain.rays), 0.01 * double(plain.rays));
}

TEST(TurnedBakesDeathTest, OrientationsThatThereAreNot) {
    const TurnedBakes bakes(stage(), 1, 5);
    const std::vector<SurfacePoint> points(2, SurfacePoint{Vec3f(0, 0, 0), Vec3f(0, 1, 0), 0});
    EXPECT_DEATH(bakes.bake(points, std::vector<int>{0, 1}, {}), "");
    EXPECT_DEATH(bakes.bake(points, std::vector<int>{0}, {}), "");
}

TEST(BandingScene, FacesOutwards) {
    const Scene scene = bandingScene();
    for (size_t t = 0; t < scene.triangleCount(); ++t) {
        std::array<Vec3d, 3> p;
        for (size_t k = 0; k < 3; ++k) p[k] = scene.positions[scene.indices[3 * t + k]].cast<double>();
        const Vec3d centre = (p[0] + p[1] + p[2]) / 3, cross = (p[1] - p[0]).cross(p[2] - p[0]);
        if (cross.norm() < 1e-6) continue;  // half of the triangles at the poles have no area
        const Vec3d normal = cross.normalized();
        if (t < 2) {
            EXPECT_EQ(normal, Vec3d(0, 1, 0));
        } else if (centre.x() < 0) {  // the block
            EXPECT_GT(normal.dot(centre - Vec3d(-0.8, 0.555, -0.05)), 0.3) << t;
        } else {
            EXPECT_GT(normal.dot(centre - Vec3d(0.7, 0.7, 0)), 0.59) << t;
        }
    }
}

void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "sampling");
    test::runCommand(runMeasureSampling, arguments);
}

// A pit, as OBJ: occludes itself.
void writePit(const std::string& path) {
    writeFileAtomically(path,
                        "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 1 -1\nv 1 1 -1\nv 1 1 1\nv -1 1 1\n"
                        "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
}

TEST(MeasureSamplingCommand, WritesTablesAndJson) {
    const TemporaryDirectory folder;
    const std::string mesh = folder.file("pit.obj"), prefix = folder.file("s"), json = folder.file("s.json");
    writePit(mesh);
    run({mesh,      "--points", "20",       "--counts",  "32,128",    "--truth", "2048",
         "--seeds", "2",        "--errors", "0.01,0.05", "--compare", "100",     "--plot",
         "none",    "-o",       prefix,     "--json",    json,        "--quiet"});
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"pit.obj", "s-adaptive.csv", "s-equal_error.csv",
                                                        "s-meshes.csv", "s.csv", "s.json"}));
    std::istringstream csv(readFile(prefix + ".csv"));
    std::string line;
    std::getline(csv, line);
    EXPECT_EQ(line,
              "mesh,set,directions,rays,rms,rms_open,error,estimated,below_error,below_twice_estimate\r");
    std::getline(csv, line);
    EXPECT_TRUE(line.starts_with("pit,random,32,")) << line;
    const std::string text = readFile(json);
    for (const char* key :
         {"\"rows\": [", "\"mesh\": \"pit\"", "\"set\": \"sobol-owen-rotated\"",
          "\"rms\": ", "\"rays\": ", "\"set\": \"adaptive-fibonacci\"", "\"directions\": null",
          "\"equal_error\": [", "\"adaptive\": [", "\"rays_to_uniform\": ", "\"directions_to_random\": ",
          "\"mean_ao\": ", "\"projection\": \"irradiance\"", "\"truth_directions\": 2048"})
        EXPECT_NE(text.find(key), std::string::npos) << key;
    run({mesh,        "--points", "4",    "--counts",    "16",     "--truth",      "64",    "--sets",
         "fibonacci", "--errors", "none", "--placement", "shared", "--projection", "plain", "--order",
         "3",         "--plot",   "none", "-o",          prefix,   "--quiet"});
    const std::string rows = readFile(prefix + ".csv");
    EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 2);
}

TEST(MeasureSamplingCommand, RefusesWhatItCannotMeasure) {
    const TemporaryDirectory folder;
    const std::string mesh = folder.file("pit.obj");
    writePit(mesh);
    const std::vector<std::vector<std::string>> bad = {
        {"--counts", "0"},       {"--counts", "many"},     {"--counts", "32768"},  {"--sets", "halton"},
        {"--sets", ""},          {"--errors", ""},         {"--errors", "0.1,"},   {"--errors", "0"},
        {"--errors", "2"},       {"--errors", "nan"},      {"--errors", "0.1x"},   {"--points", "0"},
        {"--placement", "none"}, {"--order", "11"},        {"--projection", "sh"}, {"--seeds", "0"},
        {"--compare", "0"},      {"--picture-size", "-1"}, {"--truth", "12000"},   {"--plot", "bmp"},
        {"--frobnicate"}};
    for (std::vector<std::string> words : bad) {
        words.insert(words.begin(), mesh);
        words.insert(words.end(), {"-o", folder.file("x"), "--quiet"});
        EXPECT_THROW(run(words), UsageError) << words[1] << " " << words[2];
    }
    EXPECT_THROW(run({}), UsageError);
    EXPECT_THROW(run({folder.file("absent.obj"), "--quiet", "-o", folder.file("x")}), InputError);
    EXPECT_THROW(run({mesh, "--quiet", "-o", folder.file("missing/x")}), OutputError);
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"pit.obj"}));
}

}  // namespace
}  // namespace prt::tools
