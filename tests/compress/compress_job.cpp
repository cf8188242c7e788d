// prt compress on real bundles: what it writes, what it refuses, and that a failure changes nothing.
#include "compress/compress_job.h"

#include <cmath>
#include <functional>

#include "compress/choose_components.h"
#include "compress/irradiance_weights.h"
#include "compress/pca.h"
#include "compress/point_areas.h"
#include "compress/relit_error.h"
#include "compress/tables/normal_tables.h"
#include "precompute/base/error.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/glb.h"
#include "precompute/math/directions.h"
#include "tests/base/small_disk.h"
#include "tests/compress/job_fixture.h"

namespace prt {
namespace {

class JobsWeights : public Jobs, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Kinds, JobsWeights, testing::Values("irradiance", "plain"));

TEST_P(JobsWeights, CompressWritesWhatTheAlgorithmSays) {
    const bool isPlain = std::string(GetParam()) == "plain";
    const VisibilityMap map = testVisibility(4, 1);
    writeBundle(map);
    const CompressReport report = runCompress({bundle_, 5, GetParam()});
    std::vector<uint8_t> valid;
    for (const Validity validity : map.validity) valid.push_back(validity == Validity::Valid);
    const CompressedVisibility compressed =
        compressVisibility(map.coefficients, valid, map.normals, 4, map.projection, 5,
                           isPlain ? WeightsFit::Plain : WeightsFit::Irradiance);
    const PcaResult& pca = compressed.pca;
    const std::vector<float>& weights = compressed.weights;

    EXPECT_EQ(report.components, 5);
    EXPECT_EQ(report.points, map.grid.count / 5);
    EXPECT_EQ(report.explainedVariance, pca.explainedVariance);
    EXPECT_EQ(report.relativeRmse, pcaRelativeRmse(pca, map.coefficients, weights, valid, 16));
    EXPECT_GT(report.rmse, 0);
    EXPECT_EQ(report.irradianceRelativeRmse,
              irradianceRelativeRmse(pca, map.coefficients, weights, map.normals, valid, 4));
    EXPECT_EQ(report.bytes, fs::file_size(fs::path(bundle_) / "pca.exr"));

    const PcaMap read = readPcaFile(bundle_ + "/pca.exr");
    EXPECT_EQ(read.shOrder, 4);
    EXPECT_EQ(read.components, 5);
    EXPECT_EQ(read.mean, pca.mean);
    EXPECT_EQ(read.basis, pca.basis);
    EXPECT_EQ(read.variance, pca.variance);
    EXPECT_EQ(read.projection, kPlainProjection);
    EXPECT_EQ(read.attributes.at("rays"), "1024");
    EXPECT_EQ(read.attributes.at("weightsFit"), GetParam());
    EXPECT_EQ(read.attributes.count("weightsFloor"), isPlain ? 0u : 1u);
    for (size_t i = 0; i < map.grid.count; ++i)
        for (size_t m = 0; m < 5; ++m) {
            const float expected = map.validity[i] == Validity::Empty ? 0.0f : weights[i * 5 + m];
            ASSERT_EQ(read.weights[i * 5 + m], expected) << "point " << i;
        }

    const Bundle bundle = Bundle::open(bundle_);
    EXPECT_EQ(bundle.staleReason("pca.exr", true), "");
    EXPECT_EQ(bundle.find("pca.exr")->madeFrom.at("visibility.exr"), bundle.find("visibility.exr")->xxh3);
    EXPECT_THAT(bundle.find("pca.exr")->madeBy, testing::HasSubstr("--components 5"));
    EXPECT_THAT(bundle.find("pca.exr")->madeBy, testing::HasSubstr(std::string("--weights ") + GetParam()));
    EXPECT_THAT(bundle.section("compress"), testing::HasSubstr("explained_variance"));
    EXPECT_THAT(bundle.section("compress"), testing::HasSubstr("irradiance_relative_rmse"));
    EXPECT_THAT(bundle.section("compress"), testing::HasSubstr(GetParam()));
}

TEST_F(Jobs, WeightsForIrradianceAreTheDefaultAndTradeOneErrorForTheOther) {
    writeBundle(testVisibility(5, 14));
    const CompressReport plain = runCompress({bundle_, 6, "plain"});
    const auto plainBytes = contents().at("pca.exr");
    const CompressReport fitted = runCompress({bundle_, 6});
    EXPECT_NE(contents().at("pca.exr"), plainBytes);
    EXPECT_EQ(runCompress({bundle_, 6, "irradiance"}).irradianceRelativeRmse, fitted.irradianceRelativeRmse);
    EXPECT_LT(fitted.irradianceRelativeRmse, plain.irradianceRelativeRmse);
    EXPECT_GT(fitted.relativeRmse, plain.relativeRmse);
    EXPECT_LE(fitted.explainedVariance, plain.explainedVariance);
    expectRefused<UsageError>(
        [&] {
            runCompress({bundle_, 6, "best"});
        },
        {"--weights", "best", "irradiance"});
}

TEST_F(Jobs, CompressGivesTheSameBytesAgain) {
    writeBundle(testVisibility(3, 2));
    runCompress({bundle_, 4});
    const auto first = contents().at("pca.exr");
    CompressSettings again{bundle_, 4};
    again.force = true;
    EXPECT_FALSE(runCompress(again).upToDate);
    EXPECT_EQ(contents().at("pca.exr"), first);
}

TEST_F(Jobs, CompressDoesNothingWhereNothingChanged) {
    writeBundle(testVisibility(3, 2));
    const CompressReport first = runCompress({bundle_, 4});
    EXPECT_FALSE(first.upToDate);
    const auto before = contents();
    const CompressReport second = runCompress({bundle_, 4});
    EXPECT_TRUE(second.upToDate);
    EXPECT_EQ(contents(), before);
    EXPECT_EQ(second.components, 4);
    EXPECT_EQ(second.points, first.points);
    EXPECT_EQ(second.bytes, first.bytes);
    EXPECT_DOUBLE_EQ(second.relativeRmse, first.relativeRmse);
    EXPECT_DOUBLE_EQ(second.irradianceRelativeRmse, first.irradianceRelativeRmse);
    // Other settings, another visibility, a damaged file: made again.
    EXPECT_FALSE(runCompress({bundle_, 5}).upToDate);
    EXPECT_FALSE(runCompress({bundle_, 5, "plain"}).upToDate);
    EXPECT_TRUE(runCompress({bundle_, 5, "plain"}).upToDate);
    writeBundle(testVisibility(3, 7));
    EXPECT_FALSE(runCompress({bundle_, 5, "plain"}).upToDate);
    {
        std::fstream file(bundle_ + "/pca.exr", std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(-4, std::ios::end);
        file.write("oops", 4);
    }
    EXPECT_FALSE(runCompress({bundle_, 5, "plain"}).upToDate);
    EXPECT_EQ(Bundle::open(bundle_).staleReason("pca.exr", true), "");
}

TEST_F(Jobs, RenewalCommandsAreGoodForAShell) {
    writeBundle(testVisibility(3, 2));
    runTabulate({bundle_, {"sky:constant?r=1&g=2&b=3"}, "light-cosine", {"cube", 4}});
    const Bundle bundle = Bundle::open(bundle_);
    for (const BundleFile& file : bundle.files())
        if (file.name.starts_with("tables/")) {
            EXPECT_THAT(file.madeBy, testing::HasSubstr(" 'sky:constant?r=1&g=2&b=3' "));
        }
    EXPECT_EQ(bundle.files().size(), 2u);
}

TEST_F(Jobs, TargetErrorTakesAsFewVectorsAsReachIt) {
    writeBundle(testVisibility(4, 12, 40, 50));
    const std::vector<std::string> environments = {"sky:clear", "sky:uniform"};
    int before = 17;
    for (const double target : {0.001, 0.05, 0.2, 0.6}) {
        CompressSettings settings{bundle_};
        settings.targetError = target;
        settings.environments = environments;
        const CompressReport report = runCompress(settings);
        EXPECT_LE(report.components, before);
        before = report.components;
        ASSERT_EQ(report.relitErrors.size(), 2u);
        double largest = 0;
        for (const RelitError& error : report.relitErrors) largest = std::max(largest, error.relativeRmse);
        EXPECT_LE(largest, report.components == 16 ? 1e-3 : target);
        EXPECT_EQ(readPcaFile(bundle_ + "/pca.exr").components, report.components);
        EXPECT_TRUE(runCompress(settings).upToDate);
        if (report.components == 1) continue;
        // One vector fewer does not reach it.
        const VisibilityMap map = readVisibilityFile(bundle_ + "/visibility.exr");
        std::vector<uint8_t> valid;
        for (const Validity validity : map.validity) valid.push_back(validity == Validity::Valid);
        std::vector<EnvironmentSh> light;
        for (const std::string& name : environments)
            light.push_back(projectEnvironment(loadEnvironment(name).view(), tableEnvironmentShOrder(4)));
        const CompressedVisibility fewer =
            compressVisibility(map.coefficients, valid, map.normals, 4, map.projection, report.components - 1,
                               WeightsFit::Irradiance);
        const std::vector<double> errors = relitErrors(fewer, map.coefficients, valid, map.normals, 4, light);
        EXPECT_GT(std::max(errors[0], errors[1]), target);
    }
    EXPECT_LT(before, 16);
    for (const double target : {-1.0, 2.0, 1e-9})
        expectRefused<UsageError>(
            [&] {
                CompressSettings settings{bundle_};
                settings.targetError = target;
                runCompress(settings);
            },
            {"--target-error"});
}

// Light times cosine times visibility by the definition, one normal and point at a time.
TEST(RelitProbe, IsTheErrorOfIrradiance) {
    std::mt19937 random(5);
    std::normal_distribution<float> gauss;
    constexpr size_t kPoints = 9, kColumns = 9;
    std::vector<Vec3f> normals;
    std::vector<float> rows, others;
    for (size_t i = 0; i < kPoints; ++i)
        normals.push_back(Vec3f(gauss(random), gauss(random), gauss(random)).normalized());
    normals[4] = Vec3f::Zero();
    const std::vector<uint8_t> use = {1, 1, 0, 1, 1, 1, 1, 1, 1};
    const EnvironmentSh light =
        projectEnvironment(loadEnvironment("sky:clear").view(), tableEnvironmentShOrder(3));
    const RelitProbe probe(3, normals, use, std::span(&light, 1));
    EXPECT_EQ(probe.points(), (std::vector<uint32_t>{0, 1, 3, 5, 6, 7, 8}));
    for (size_t k = 0; k < probe.points().size() * kColumns; ++k) {
        rows.push_back(gauss(random));
        others.push_back(rows.back() + 0.1f * gauss(random));
    }
    double error = 0, square = 0;
    for (size_t p = 0; p < probe.points().size(); ++p) {
        const Vec3f n = normals[probe.points()[p]];
        const Frame frame = frameAround(n);
        const float c = float(std::cos(20 * M_PI / 180)), s = float(std::sin(20 * M_PI / 180));
        for (const Vec3f& shading :
             {n, Vec3f(c * n + s * frame.tangent), Vec3f(c * n - s * frame.tangent),
              Vec3f(c * n + s * frame.bitangent), Vec3f(c * n - s * frame.bitangent)}) {
            const std::vector<float> r = evalLightCosine(light, 3, std::span(&shading, 1));
            for (size_t colour = 0; colour < 3; ++colour) {
                double a = 0, b = 0;
                for (size_t k = 0; k < kColumns; ++k) {
                    a += double(r[colour * kColumns + k]) * double(rows[p * kColumns + k]);
                    b += double(r[colour * kColumns + k]) * double(others[p * kColumns + k]);
                }
                error += (b - a) * (b - a);
                square += a * a;
            }
        }
    }
    const std::vector<double> errors = probe.relativeRmse(rows, others);
    ASSERT_EQ(errors.size(), 1u);
    EXPECT_NEAR(errors[0], std::sqrt(error / square), 1e-6);
    EXPECT_EQ(probe.relativeRmse(rows, rows)[0], 0);
}

TEST_F(Jobs, CompressPerVertex) {
    VisibilityMap map = testVisibility(3, 3, 1024, 2);
    map.grid = vertexGrid(1500);
    map.coefficients.resize(1500 * 9);
    map.validity.resize(1500);
    map.ao.resize(1500);
    map.normals.resize(1500);
    writeBundle(map);
    EXPECT_EQ(runCompress({bundle_, 9}).points, 300u);
    const PcaMap read = readPcaFile(bundle_ + "/pca.exr");
    EXPECT_EQ(read.grid.domain, PointDomain::Vertex);
    EXPECT_EQ(read.grid.count, 1500u);
    EXPECT_EQ(read.weights.size(), 1500u * 9u);
}

TEST_F(Jobs, ComponentsOutOfRangeNameTheLimit) {
    writeBundle(testVisibility(4, 4));
    expectRefused<UsageError>(
        [&] {
            runCompress({bundle_, 24});
        },
        {"--components", "24", "16 coefficients of order 4", "at most 16"});
    expectRefused<UsageError>([&] { runCompress({bundle_, 17}); }, {"--components", "17"});
    expectRefused<UsageError>([&] { runCompress({bundle_, 0}); }, {"--components", "0", "16"});
    expectRefused<UsageError>([&] { runCompress({bundle_, -3}); }, {"--components", "-3"});
    EXPECT_NO_THROW(runCompress({bundle_, 16}));
}

TEST_F(Jobs, CompressRefusesWhatItCannotUse) {
    EXPECT_THROW(runCompress({(directory_ / "none.prt").string(), 4}), InputError);
    VisibilityMap map = testVisibility(3, 5);
    std::fill(map.validity.begin(), map.validity.end(), Validity::Empty);
    writeBundle(map);
    expectRefused<InputError>([&] { runCompress({bundle_, 4}); }, {"valid"});
    map = testVisibility(3, 5);
    map.coefficients[9 * 6 + 2] = NAN;  // point 6 is valid
    writeBundle(map);
    expectRefused<InputError>([&] { runCompress({bundle_, 4}); }, {"point 6"});
    fs::resize_file(fs::path(bundle_) / "visibility.exr", 100);
    expectRefused<InputError>([&] { runCompress({bundle_, 4}); }, {"visibility.exr"});
}

TEST_F(Jobs, CovarianceIsChosenRecordedAndMadeAgainWhenItChanges) {
    VisibilityMap map = testVisibility(4, 21, 50, 40);
    map.projection = Projection{};
    writeBundle(map);
    CompressSettings settings{bundle_, 5};
    const CompressReport irradiance = runCompress(settings);
    const PcaMap first = readPcaFile(bundle_ + "/pca.exr");
    EXPECT_EQ(first.attributes.at("covariance"), "irradiance");
    EXPECT_THAT(Bundle::open(bundle_).find("pca.exr")->madeBy, testing::HasSubstr("--covariance irradiance"));
    settings.covariance = "plain";
    const CompressReport plain = runCompress(settings);
    EXPECT_FALSE(plain.upToDate);
    EXPECT_TRUE(runCompress(settings).upToDate);
    const PcaMap second = readPcaFile(bundle_ + "/pca.exr");
    EXPECT_EQ(second.attributes.at("covariance"), "plain");
    EXPECT_NE(first.basis, second.basis);
    EXPECT_LT(irradiance.irradianceRelativeRmse, plain.irradianceRelativeRmse);
    // Plain vectors are those that explain most.
    EXPECT_GE(plain.explainedVariance, irradiance.explainedVariance);
    settings.covariance = "best";
    expectRefused<UsageError>([&] { runCompress(settings); }, {"--covariance", "best", "irradiance"});
}

// A square of two triangles, of which the one in the lower left has nine times the density.
Scene unevenSquare() {
    Scene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0, 1}, {1, 0, -17}};
    scene.uv1 = {{0, 0}, {1, 0}, {0, 1}, {1, 0}, {0, 1}, {1, 1}};
    scene.normals.assign(6, Vec3f(0, 1, 0));
    scene.indices = {0, 2, 1, 3, 4, 5};
    scene.materials.emplace_back();
    scene.primitives = {{0, 6, 0, 6, 0}};
    return scene;
}

TEST_F(Jobs, AreaWeightedPointsCountAsTheirSurface) {
    const VisibilityMap map = testVisibility(3, 22);
    writeBundle(map);
    CompressSettings settings{bundle_, 4};
    settings.covariance = "plain";
    settings.areaWeighted = true;
    expectRefused<InputError>([&] { runCompress(settings); }, {"mesh.glb"});
    {
        BundleTransaction transaction(bundle_, false);
        writeGlb(unevenSquare(), transaction.stage("mesh.glb", {}, "prt precompute thing.obj").string());
        transaction.commit();
    }
    const CompressReport report = runCompress(settings);
    EXPECT_TRUE(runCompress(settings).upToDate);
    const PcaMap pca = readPcaFile(bundle_ + "/pca.exr");
    EXPECT_EQ(pca.attributes.at("pointsCount"), "area");
    const Bundle bundle = Bundle::open(bundle_);
    EXPECT_EQ(bundle.find("pca.exr")->madeFrom.at("mesh.glb"), bundle.find("mesh.glb")->xxh3);
    EXPECT_THAT(bundle.find("pca.exr")->madeBy, testing::HasSubstr("--area-weighted"));

    std::vector<float> areas;
    PointAreas(unevenSquare(), map.grid).evaluate(0, map.grid.height, areas);
    std::vector<uint8_t> valid;
    for (const Validity validity : map.validity) valid.push_back(validity == Validity::Valid);
    const PcaResult expected = computePca(map.coefficients, valid, 9, 4, areas);
    EXPECT_EQ(pca.mean, expected.mean);
    EXPECT_EQ(pca.basis, expected.basis);
    EXPECT_EQ(report.explainedVariance, expected.explainedVariance);
    settings.areaWeighted = false;
    EXPECT_FALSE(runCompress(settings).upToDate);
    EXPECT_NE(readPcaFile(bundle_ + "/pca.exr").basis, pca.basis);
    EXPECT_EQ(Bundle::open(bundle_).find("pca.exr")->madeFrom.count("mesh.glb"), 0u);
}

TEST_F(Jobs, FullDisksLeaveTheBundleAsItWas) {
    writeBundle(testVisibility(4, 23));
    runCompress({bundle_, 3});
    // Nowhere to write, room for the head of the file, room for some rows.
    for (const rlim_t bytes : {0, 600, 5000}) {
        const SmallDisk disk(bytes);
        expectRefused<OutputError>([&] { runCompress({bundle_, 16}); }, {});
    }
    EXPECT_EQ(runCompress({bundle_, 16}).components, 16);
}

TEST_F(Jobs, FilesCutOrDamagedAmongTheirRowsAreRefused) {
    const VisibilityMap map = testVisibility(4, 24, 40, 70);  // five chunks
    const auto stageDamaged = [&](const std::function<void(const fs::path&)>& damage) {
        fs::remove_all(bundle_);
        BundleTransaction transaction(bundle_, true);
        const fs::path staged = transaction.stage("visibility.exr", {}, "prt precompute thing.obj");
        writeVisibilityFile(staged.string(), map);
        damage(staged);
        transaction.commit();
    };
    stageDamaged([](const fs::path&) {});
    const size_t bytes = fs::file_size(fs::path(bundle_) / "visibility.exr");
    for (const double share : {0.3, 0.6, 0.9, 0.999}) {
        stageDamaged([&](const fs::path& path) { fs::resize_file(path, size_t(share * double(bytes))); });
        expectRefused<InputError>([&] { runCompress({bundle_, 4}); }, {"visibility.exr", "damaged"});
        EXPECT_FALSE(fs::exists(fs::path(bundle_) / "pca.exr"));
    }
    stageDamaged([&](const fs::path& path) {  // the last chunk does not decompress
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(std::streamoff(bytes) - 400);
        file.write(std::string(300, 'x').data(), 300);
    });
    expectRefused<InputError>([&] { runCompress({bundle_, 4}); }, {"visibility.exr", "damaged"});
}

}  // namespace
}  // namespace prt
