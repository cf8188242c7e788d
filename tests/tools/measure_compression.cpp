// prt measure compression: bytes and work in closed form, errors on a small box, what the command writes.
#include "tools/measure/compression.h"

#include <cmath>

#include "compress/export_textures.h"
#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/math/sh.h"
#include "tests/base/temporary_directory.h"
#include "tests/tools/measure_compression_box.h"
#include "tests/tools/run_command.h"
#include "tools/measure/commands.h"
#include "tools/measure/compression_tables.h"
#include "tools/measure/surface_points.h"

namespace prt::tools {
namespace {

TEST(CompressionCost, BytesAreThoseOfTextures) {
    for (const std::string& encoding : pointEncodings())
        for (const int values : {1, 4, 9, 16, 36}) {
            const PointGrid grid{PointDomain::Texel, 3, 2, 6};
            const std::vector<float> zeros(grid.count * size_t(values), 0.0f);
            const PointTexture texture = encodePoints(zeros, size_t(values), grid, encoding, {});
            EXPECT_EQ(shippedBytes(values, encoding), texture.image.bytes.size() / grid.count)
                << values << " " << encoding;
        }
    EXPECT_EQ(shippedBytes(16, "unorm8"), 16u);
    EXPECT_EQ(shippedBytes(36, "half"), 72u);
    NormalTable table;
    table.kind = TableKind::TripleProduct;
    table.size = 2;
    table.shOrder = 3;
    table.layers = 10;
    table.values.assign(3 * 10 * table.texels(), 0.0f);
    for (const std::string& encoding : tableEncodings())
        EXPECT_EQ(shippedTableBytes(9, true, encoding) * 24, encodeTable(table, encoding).image.bytes.size())
            << encoding;
    EXPECT_EQ(tableBytes(9, true, 2), encodeTable(table, "half").image.bytes.size());
    table.kind = TableKind::LightCosine;
    EXPECT_EQ(tableBytes(10, false, 2), encodeTable(table, "half").image.bytes.size());
}

TEST(CompressionCost, WorkIsThatOfTheShader) {
    // "unc4 is as fast as pca16": one fetch apart.
    EXPECT_EQ(pixelCost(16, false, PointDomain::Texel).fetches, 16);
    EXPECT_EQ(pixelCost(16, true, PointDomain::Texel).fetches, 17);
    EXPECT_EQ(pixelCost(36, false, PointDomain::Texel).fetches, 36);
    EXPECT_EQ(pixelCost(36, false, PointDomain::Texel).multiplyAdds, 9 * 12);
    EXPECT_EQ(pixelCost(9, false, PointDomain::Vertex).fetches, 3 * (3 + 3));
    const std::vector<TransferStorage> transfer = transferStorage(6);
    ASSERT_EQ(transfer.size(), 3u);
    EXPECT_EQ(transfer[0].bytes, 216u);
    EXPECT_EQ(transfer[1].bytes, 648u);
    EXPECT_EQ(transfer[2].bytes, 2592u);
}

TEST(CompressionStudy, TakesTheVectorsAnOrderHas) {
    EXPECT_EQ(componentsOf({4, 8, 12}, 3), (std::vector<int>{4, 8, 9}));
    EXPECT_EQ(componentsOf({9}, 3), (std::vector<int>{9}));
    EXPECT_EQ(componentsOf({2}, 1), (std::vector<int>{1}));
}

class MeasureCompression : public testing::TestWithParam<bool> {
  protected:
    void SetUp() override {
        setQuiet(true);
        bundle_ = test::boxBundle(folder_, GetParam(), ProjectionKind::Irradiance);
    }
    void TearDown() override { setQuiet(false); }
    TemporaryDirectory folder_;
    std::string bundle_;
};

TEST_P(MeasureCompression, ErrorsFallToThoseOfUncompressedVisibility) {
    CompressionScene scene(bundle_, false, 4);
    CompressionStudy study;
    study.orders = {3, 4};
    study.components = {1, 4, 12};
    study.lightOrders = {1, 3, 12};
    study.points = 40;
    const CompressionResult result = studyCompression(scene, {loadEnvironment("sky:overcast")}, study);
    EXPECT_EQ(result.domain, GetParam() ? PointDomain::Vertex : PointDomain::Texel);
    ASSERT_EQ(result.rows.size(), 4u + 5u);  // unc, 1, 4, 9; unc, 1, 4, 12, 16
    ASSERT_EQ(result.orders.size(), 2u);
    size_t r = 0;
    for (const int shOrder : {3, 4}) {
        const CompressionOrder& order = result.orders[size_t(shOrder - 3)];
        EXPECT_GT(order.truncation, 0.005);
        EXPECT_LT(order.truncation, 0.3);
        const CompressionRow& uncompressed = result.rows[r++];
        EXPECT_EQ(uncompressed.components, 0);
        EXPECT_EQ(uncompressed.compression, 0);
        EXPECT_LT(uncompressed.shipped, 5e-3);  // half floats
        EXPECT_NEAR(uncompressed.truth, order.uncompressed, 5e-3);
        double last = 1;
        for (; r < result.rows.size() && result.rows[r].shOrder == shOrder; ++r) {
            const CompressionRow& row = result.rows[r];
            EXPECT_LE(row.compression, last + 1e-4) << shOrder << " " << row.components;
            last = row.compression;
            // Errors of the parts add up at most.
            EXPECT_LE(row.truth, 1.1 * (order.uncompressed + row.shipped) + 1e-3);
        }
        EXPECT_EQ(result.rows[r - 1].components, shCount(shOrder));
        EXPECT_LT(result.rows[r - 1].compression, 2e-3);
        EXPECT_LT(result.rows[r - 1].coefficients, 2e-2);
    }
    ASSERT_EQ(result.lights.size(), 3u * 3u + 4u * 3u);
    EXPECT_EQ(result.lights[1].lightOrder, 3);
    EXPECT_EQ(result.lights[3].components, 4);
}

TEST_P(MeasureCompression, BakesOtherOrdersAsTheBundleWas) {
    CompressionScene scene(bundle_, false, 5);
    const VisibilityMap& own = scene.visibility(4);
    const VisibilityMap& other = scene.visibility(5);
    EXPECT_EQ(scene.fit(), WeightsFit::Irradiance);
    EXPECT_EQ(own.grid.count, other.grid.count);
    EXPECT_EQ(own.validity, other.validity);
    EXPECT_EQ(own.ao, other.ao);  // the same rays
    EXPECT_EQ(other.coefficients.size(), own.grid.count * 25);
    EXPECT_EQ(&scene.visibility(5), &other);

    // Plain expansions: of fewer bands the same.
    CompressionScene plain(bundle_, true, 4);
    EXPECT_EQ(plain.fit(), WeightsFit::Plain);
    const VisibilityMap& four = plain.visibility(4);
    const VisibilityMap& two = plain.visibility(2);
    for (size_t i = 0; i < four.grid.count; ++i)
        for (size_t k = 0; k < 4; ++k) ASSERT_EQ(two.coefficients[i * 4 + k], four.coefficients[i * 16 + k]);
}

// Interpolated values of a map that is linear in the position.
TEST_P(MeasureCompression, InterpolatesAsTheShaderDoes) {
    CompressionScene scene(bundle_, false, 4);
    const PointGrid& grid = scene.visibility(4).grid;
    const std::vector<SurfacePoint> points = randomSurfacePoints(scene.scene(), 200, 3);
    if (GetParam()) {
        std::vector<float> values;
        for (const Vec3f& position : scene.scene().positions)
            for (int k = 0; k < 3; ++k) values.push_back(position[k]);
        const std::vector<float> found = interpolate(scene.scene(), grid, points, values, 3);
        for (size_t p = 0; p < points.size(); ++p)
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[3 * p + size_t(k)], points[p].position[k], 1e-5);
        return;
    }
    // Texel centres' own coordinates come back as the point's.
    std::vector<float> values;
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) {
            values.push_back((float(x) + 0.5f) / float(grid.width));
            values.push_back((float(y) + 0.5f) / float(grid.height));
        }
    const std::vector<float> found = interpolate(scene.scene(), grid, points, values, 2);
    const TexelSurface surface = rasterizeTexels(scene.scene(), grid.width, grid.height);
    for (size_t p = 0; p < points.size(); ++p) {
        // The texel under the point stands for a point of the mesh near it.
        const size_t x = size_t(found[2 * p] * float(grid.width)),
                     y = size_t(found[2 * p + 1] * float(grid.height));
        const uint32_t texel = surface.pointOfTexel[y * size_t(grid.width) + x];
        ASSERT_NE(texel, kNoPoint);
        EXPECT_LT((surface.points[texel].position - points[p].position).norm(), 0.2f);
    }
}

INSTANTIATE_TEST_SUITE_P(Domains, MeasureCompression, testing::Values(false, true));

CompressionResult madeUp() {
    CompressionResult result;
    result.orders = {{4, 0.05, 0.06}, {6, 0.03, 0.04}};
    for (const auto& [shOrder, components, compression] :
         {std::tuple{4, 0, 0.0}, {4, 8, 0.04}, {4, 12, 0.01}, {6, 0, 0.0}, {6, 16, 0.035}, {6, 24, 0.031}}) {
        CompressionRow row;
        row.shOrder = shOrder;
        row.components = components;
        row.bytes = shippedBytes(components ? components : shCount(shOrder), "unorm8");
        row.compression = row.shipped = compression;
        row.truth = 0.06;
        result.rows.push_back(row);
    }
    result.lights = {
        {4, 12, 1, 0.9}, {4, 12, 3, 0.01}, {4, 12, 12, 0.012}, {6, 16, 3, 0.01}, {6, 16, 4, 0.02}};
    return result;
}

TEST(CompressionClaims, HoldWhereCompressionLosesLessThanTruncation) {
    const std::vector<CompressionClaim> claims = checkClaims(madeUp());
    ASSERT_EQ(claims.size(), 3u);
    EXPECT_TRUE(claims[0].isEnough);
    EXPECT_TRUE(claims[0].isFaithful);
    EXPECT_EQ(claims[0].leastEnough, 8);
    EXPECT_EQ(claims[0].leastFaithful, 8);
    EXPECT_EQ(claims[0].uncompressed, 0.06);
    EXPECT_FALSE(claims[1].isEnough);
    EXPECT_FALSE(claims[2].isEnough);
    EXPECT_FALSE(claims[2].isFaithful);  // half as much again
    EXPECT_EQ(claims[2].leastEnough, 0);
    EXPECT_EQ(claims[2].leastFaithful, 0);
    const std::vector<LightSensitivity> lights = lightSensitivity(madeUp());
    ASSERT_EQ(lights.size(), 2u);
    EXPECT_EQ(lights[0].lowest, 0.01);  // light of one band does not count
    EXPECT_EQ(lights[0].highest, 0.012);
    EXPECT_EQ(lights[0].lowestSeen, 0.012);  // 3 bands are fewer than 4 + 2
    EXPECT_EQ(lights[0].highestSeen, 0.012);
    EXPECT_TRUE(std::isnan(lights[1].highestSeen));
    const std::string text = verdictText(madeUp());
    EXPECT_NE(text.find("12 vectors for order 4: enough"), std::string::npos) << text;
    EXPECT_NE(text.find("24 vectors for order 6: not enough"), std::string::npos) << text;
    EXPECT_NE(text.find("Order 4, 12 vectors, by bands of the light: 0.0100 to 0.0120, not sensitive (ratio "
                        "1.20; from 6 bands on 1.00)"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("Order 6, 16 vectors, by bands of the light: 0.0100 to 0.0200, sensitive"),
              std::string::npos)
        << text;
    CompressionResult other = madeUp();
    other.orders = {{3, 0.05, 0.06}};
    EXPECT_TRUE(checkClaims(other).empty());
}

TEST(CompressionTables, PutTransferMatricesBeside) {
    const Table table = storageTable(madeUp(), "unorm8");
    ASSERT_EQ(table.rowCount(), 6u + 2 * 3u);
    EXPECT_EQ(std::get<std::string>(table.cell(3, "method")), "transfer-half-life-2");
    EXPECT_EQ(std::get<uint64_t>(table.cell(3, "bytes_per_point")), 96u);
    const Figure figure = compressionFigure(madeUp());
    ASSERT_EQ(figure.panels.size(), 6u);
    EXPECT_EQ(figure.panels[0].series.size(), 4u);
    EXPECT_EQ(figure.panels[0].series[0].points.size(), 2u);
    EXPECT_EQ(figure.panels[0].series[1].points.size(), 1u);
    EXPECT_FALSE(figure.panels[5].bars.empty());
}

void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "compression");
    test::runCommand(runMeasureCompression, arguments);
}

TEST(MeasureCompressionCommand, WritesCsvAndJson) {
    const TemporaryDirectory folder;
    const std::string bundle = test::boxBundle(folder, true, ProjectionKind::Plain);
    const std::string prefix = folder.file("out"), json = folder.file("out.json");
    run({bundle,
         "--env",
         "sky:overcast",
         "--orders",
         "4",
         "--components",
         "2,12",
         "--points",
         "10",
         "--light-orders",
         "3,4",
         "--weights",
         "half",
         "--images",
         folder.file("images"),
         "--size",
         "32x20",
         "--reference-rays",
         "64",
         "--time-frames",
         "1",
         "--plot",
         "none",
         "-o",
         prefix,
         "--json",
         json,
         "--quiet"});
    setQuiet(false);
    const std::string text = readFile(json);
    for (const char* part : {"\"domain\": \"vertex\"",
                             "\"weights\": \"half\"",
                             "\"environment_count\": 1",
                             "\"points\": 10",
                             "\"rows\": [",
                             "\"technique\": \"unc4\"",
                             "\"technique\": \"pca12\"",
                             "\"compression_rmse\": ",
                             "\"shipped_rmse\": ",
                             "\"truth_rmse\": ",
                             "\"bytes_per_point\": ",
                             "\"orders\": [",
                             "\"claims\": [",
                             "\"lights\": [",
                             "\"sensitivity\": [",
                             "\"storage\": [",
                             "\"frames\": [",
                             "\"ratio\": ",
                             "\"pictures\": [",
                             "\"file\": \"figure5-pca4.png\"",
                             "\"enough\": \"",
                             "\"seconds\": "})
        EXPECT_NE(text.find(part), std::string::npos) << part;
    EXPECT_TRUE(readFile(prefix + ".csv")
                    .starts_with("technique,order,components,format,bytes_per_point,table_bytes,fetches,"
                                 "multiply_adds,coefficient_rmse,compression_rmse,shipped_rmse,truth_rmse"
                                 "\r\nunc4,4,0,half,32,"));
    EXPECT_TRUE(readFile(prefix + "-lights.csv")
                    .starts_with("order,components,light_order,compression_rmse\r\n4,2,3,"));
}

TEST(MeasureCompressionCommand, RefusesWhatItCannotMeasure) {
    const TemporaryDirectory folder;
    const std::string missing = folder.file("missing.prt"), prefix = folder.file("out");
    EXPECT_THROW(run({}), UsageError);
    EXPECT_THROW(run({missing, "--orders", "11"}), UsageError);
    EXPECT_THROW(run({missing, "--orders", "0"}), UsageError);
    EXPECT_THROW(run({missing, "--components", "4,x"}), UsageError);
    EXPECT_THROW(run({missing, "--components", "101"}), UsageError);
    EXPECT_THROW(run({missing, "--light-orders", "13"}), UsageError);
    EXPECT_THROW(run({missing, "--weights", "bc7"}), UsageError);
    EXPECT_THROW(run({missing, "--projection", "best"}), UsageError);
    EXPECT_THROW(run({missing, "--points", "0"}), UsageError);
    EXPECT_THROW(run({missing, "--size", "640"}), UsageError);
    EXPECT_THROW(run({missing, "--eye", "1,2"}), UsageError);
    EXPECT_THROW(run({missing, "--time-frames", "-1"}), UsageError);
    EXPECT_THROW(run({missing, "-o", prefix, "--quiet"}), InputError);
    rewriteFile(folder.file("file"), "no folder");
    EXPECT_THROW(run({missing, "-o", prefix, "--images", folder.file("file"), "--quiet"}), OutputError);
    setQuiet(false);
}

}  // namespace
}  // namespace prt::tools
