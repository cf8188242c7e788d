// prt tabulate on real bundles: what it writes, what it refuses, and that a failure changes nothing.
#include "compress/tabulate_job.h"

#include <algorithm>
#include <cmath>

#include "compress/compress_job.h"
#include "compress/tables/normal_tables.h"
#include "precompute/base/error.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/table_file.h"
#include "precompute/math/directions.h"
#include "tests/compress/job_fixture.h"

namespace prt {
namespace {

TEST_F(Jobs, LightCosineTablesOfUniformLight) {
    writeBundle(testVisibility(3, 6));
    const std::string day = writeEnvironment("day.exr", 1), dusk = writeEnvironment("dusk light.exr", 0.25f);
    const std::vector<TabulateRow> rows = runTabulate(tabulate({day, dusk}, "light-cosine"));
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0].environment, "day");
    EXPECT_EQ(rows[0].file, "tables/day.light-cosine.cube.exr");
    EXPECT_EQ(rows[1].file, "tables/dusk_light.light-cosine.cube.exr");
    const Bundle bundle = Bundle::open(bundle_);
    for (size_t k = 0; k < 2; ++k) {
        EXPECT_EQ(rows[k].bytes, fs::file_size(fs::path(bundle_) / rows[k].file));
        EXPECT_EQ(bundle.staleReason(rows[k].file, true), "");
        const NormalTable table = readTableFile((fs::path(bundle_) / rows[k].file).string());
        EXPECT_EQ(table.kind, TableKind::LightCosine);
        EXPECT_EQ(table.size, 8);
        EXPECT_EQ(table.shOrder, 3);
        EXPECT_EQ(table.layers, 9);
        EXPECT_EQ(table.attributes.at("environmentName"), rows[k].environment);
        EXPECT_EQ(table.attributes.at("environmentHash"), loadEnvironment(k ? dusk : day).contentHash);
        // An open point: irradiance π times the radiance; 16×8 texels project a constant to 1 %.
        for (size_t t = 0; t < table.texels(); ++t)
            EXPECT_NEAR(std::sqrt(4 * M_PI) * double(table.layer(2, 0)[t]), M_PI * (k ? 0.25 : 1.0),
                        0.01 * M_PI);
    }
}

TEST_F(Jobs, TripleProductTablesFollowTheBasisOfTheBundle) {
    writeBundle(testVisibility(4, 7));
    runCompress({bundle_, 6});
    const std::vector<TabulateRow> rows =
        runTabulate({bundle_, {"sky:clear", "sky:overcast"}, "triple-product", {"cube", 5}});
    ASSERT_EQ(rows.size(), 2u);
    const PcaMap pca = readPcaFile(bundle_ + "/pca.exr");
    const Environment sky = loadEnvironment("sky:clear");
    const std::vector<float> lightCosine =
        buildLightCosineTable(projectEnvironment(sky.view(), tableEnvironmentShOrder(4)), 4, 5);
    const NormalTable table = readTableFile((fs::path(bundle_) / rows[0].file).string());
    EXPECT_EQ(table.kind, TableKind::TripleProduct);
    EXPECT_EQ(table.layers, 7);
    const std::vector<float> expected = buildTripleProductTable(lightCosine, 4, 5, pca.mean, pca.basis);
    const float largest = std::abs(*std::max_element(
        expected.begin(), expected.end(), [](float a, float b) { return std::abs(a) < std::abs(b); }));
    for (size_t i = 0; i < expected.size(); ++i)
        ASSERT_NEAR(table.values[i], expected[i], 1e-5f * largest) << i;
    const Bundle bundle = Bundle::open(bundle_);
    EXPECT_EQ(bundle.find(rows[0].file)->madeFrom.at("pca.exr"), bundle.find("pca.exr")->xxh3);
    EXPECT_THAT(bundle.find(rows[1].file)->madeBy, testing::HasSubstr("sky:overcast"));
}

TEST_F(Jobs, CompressingAgainMakesTripleProductTablesStaleButNotLightCosine) {
    writeBundle(testVisibility(3, 8));
    runCompress({bundle_, 4});
    const std::string triple = runTabulate(tabulate({"sky:clear"}, "triple-product"))[0].file;
    const std::string cosine = runTabulate(tabulate({"sky:clear"}, "light-cosine"))[0].file;
    EXPECT_THAT(Bundle::open(bundle_).section("tabulate"),
                testing::AllOf(testing::HasSubstr(triple), testing::HasSubstr(cosine)));
    runCompress({bundle_, 4});
    EXPECT_EQ(Bundle::open(bundle_).staleReason(triple, false), "");
    runCompress({bundle_, 3});
    EXPECT_NE(Bundle::open(bundle_).staleReason(triple, false), "");
    EXPECT_EQ(Bundle::open(bundle_).staleReason(cosine, false), "");
    writeBundle(testVisibility(3, 9));
    EXPECT_NE(Bundle::open(bundle_).staleReason("pca.exr", false), "");
    expectRefused<InputError>([&] { runTabulate(tabulate({"sky:clear"}, "triple-product")); },
                              {"pca.exr", "prt compress"});
}

TEST_F(Jobs, TabulateRefusesBadSettings) {
    writeBundle(testVisibility(3, 10));
    const auto refused = [&](TabulateSettings settings, const std::vector<std::string>& words) {
        expectRefused<UsageError>([&] { runTabulate(settings); }, words);
    };
    TabulateSettings good = tabulate({"sky:clear"}, "light-cosine"), bad = good;
    bad.table.layout = "sphere";
    refused(bad, {"--layout", "sphere", "cube, dual-paraboloid, octahedral"});
    bad = good;
    bad.kind = "wavelet";
    refused(bad, {"--kind", "wavelet", "light-cosine", "triple-product"});
    for (const int size : {0, -1, 1025}) {
        bad = good;
        bad.table.size = size;
        refused(bad, {"--size", std::to_string(size), "1 to 1024"});
    }
    bad = good;
    bad.environments.clear();
    refused(bad, {"environment"});
    bad.environments = {"sky:clear", "sky:overcast", "sky:clear"};
    refused(bad, {"sky:clear"});
}

TEST_F(Jobs, EnvironmentsOfOneNameAreRefusedAndNothingIsWritten) {
    writeBundle(testVisibility(3, 11));
    const std::string a = writeEnvironment("a/light.exr", 1), b = writeEnvironment("b/light.exr", 2),
                      c = writeEnvironment("b/sun+sky.exr", 2), d = writeEnvironment("b/sun sky.exr", 2);
    expectRefused<UsageError>([&] { runTabulate(tabulate({a, "sky:clear", b}, "light-cosine")); }, {a, b});
    expectRefused<UsageError>([&] { runTabulate(tabulate({c, d}, "light-cosine")); }, {c, d});
    const fs::path broken = directory_ / "broken.exr";
    std::ofstream(broken) << "not an image";
    expectRefused<InputError>(
        [&] {
            runTabulate(tabulate({a, broken.string()}, "light-cosine"));
        },
        {"broken.exr"});
    expectRefused<InputError>(
        [&] {
            runTabulate(tabulate({a, (directory_ / "absent.exr").string()}, "light-cosine"));
        },
        {"absent.exr"});
    EXPECT_EQ(runTabulate(tabulate({a}, "light-cosine")).size(), 1u);
}

TEST_F(Jobs, TripleProductNeedsCompressedVisibility) {
    writeBundle(testVisibility(3, 12));
    expectRefused<InputError>([&] { runTabulate(tabulate({"sky:clear"}, "triple-product")); },
                              {"pca.exr", "prt compress"});
}

TEST(TableFileName, KeepsOnlyHarmlessCharacters) {
    EXPECT_EQ(tableFileName("night_2-b", "light-cosine", "cube"), "tables/night_2-b.light-cosine.cube.exr");
    EXPECT_EQ(tableFileName("../a b.c:ü", "triple-product", "cube"),
              "tables/___a_b_c___.triple-product.cube.exr");
}

}  // namespace
}  // namespace prt
