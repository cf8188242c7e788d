// What prt export writes, read back with nothing but the files themselves.
#include "compress/export_bundle.h"

#include <cmath>

#include "compress/export_textures.h"
#include "precompute/base/error.h"
#include "precompute/io/dds.h"
#include "precompute/io/ktx2.h"
#include "tests/compress/export_fixture.h"

namespace prt {
namespace {

// Channel k of a texel of a four-channel texture, by the format's definition.
double channel(const TextureImage& image, size_t texel, size_t k) {
    const size_t index = texel * 4 + k;
    const auto word = [&](size_t bytes) {
        uint32_t value = 0;
        for (size_t i = 0; i < bytes; ++i) value |= uint32_t(image.bytes[index * bytes + i]) << (8 * i);
        return value;
    };
    switch (image.format) {
        case TexelFormat::Rgba8Unorm:
            return word(1) / 255.0;
        case TexelFormat::Rgba16Unorm:
            return word(2) / 65535.0;
        case TexelFormat::Rgba16Float:
            return double(floatFromHalf(uint16_t(word(2))));
        default:
            EXPECT_EQ(image.format, TexelFormat::Rgba32Float);
            return double(std::bit_cast<float>(word(4)));
    }
}

TEST_F(Export, DefaultsFitTwentyBytesPerTexelAndStayTrue) {
    writeBundle(bakedVisibility(kAtlas, 6), 16);
    tabulate("triple-product");
    const ExportReport report = runExport(settings());
    ASSERT_EQ(report.rows.size(), 3u);
    EXPECT_EQ(report.rows[0].part, "weights");
    EXPECT_EQ(report.rows[0].format, "R8G8B8A8_UNORM");
    EXPECT_EQ(report.rows[0].layers, 4);
    EXPECT_EQ(report.rows[0].bytesPerTexel, 16);
    EXPECT_EQ(report.rows[1].part, "validity");
    EXPECT_EQ(report.rows[1].bytesPerTexel, 1);
    EXPECT_LE(report.bytesPerPointTexel, 20);
    EXPECT_EQ(report.rows[2].bytes, size_t(13 * 6 * 64 * 8));
    EXPECT_DOUBLE_EQ(report.bytesPerTexel, 17 + double(report.rows[2].bytes) / 480);
    EXPECT_EQ(report.bytes, 17 * 480 + report.rows[2].bytes);
    EXPECT_EQ(report.points, 480u);
    ASSERT_EQ(report.errors.size(), 1u);
    EXPECT_GT(report.errors[0].irradianceRelativeRmse, 0);
    EXPECT_LT(report.errors[0].irradianceRelativeRmse, 0.005);
    EXPECT_GT(report.weightsRelativeRmse, 0);
    EXPECT_LT(report.weightsRelativeRmse, 0.005);
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(out())) files.push_back(entry.path().filename());
    EXPECT_THAT(files,
                testing::UnorderedElementsAre("weights.ktx2", "validity.ktx2", "clear.triple-product.ktx2",
                                              "thing.json", "prt_shade.glsl", "prt_shade.hlsl"));
}

TEST_F(Export, WeightsComeBackThroughTheDescription) {
    writeBundle(bakedVisibility(kAtlas, 4), 6);
    const PcaMap pca = readPcaFile(bundle() + "/pca.exr");
    const VisibilityMap map = readVisibilityFile(bundle() + "/visibility.exr");
    double before = 1;
    for (const char* format : {"unorm8", "half", "unorm16", "float"}) {
        ExportSettings one = settings();
        one.weights = format;
        const ExportReport report = runExport(one);
        // An 8-bit step is 1/255 of a range, half floats have 11 bits, then come 16 bits.
        EXPECT_LT(report.weightsRelativeRmse, before) << format;
        before = report.weightsRelativeRmse;
        const json text = description();
        const TextureImage image = readKtx2(out() / text["weights"]["file"].get<std::string>());
        EXPECT_EQ(image.layers, 2);
        double worst = 0, sum = 0, total = 0;
        for (size_t i = 0; i < 480; ++i)
            for (size_t m = 0; m < 6; ++m) {
                double value = channel(image, m / 4 * 480 + i, m % 4);
                if (text["weights"].contains("scale"))
                    value = double(text["weights"]["bias"][m]) + double(text["weights"]["scale"][m]) * value;
                const double error = value - double(pca.weights[i * 6 + m]);
                if (map.validity[i] != Validity::Empty) worst = std::max(worst, std::abs(error));
                if (map.validity[i] == Validity::Valid) sum += error * error;
            }
        for (size_t i = 0; i < 480; ++i) {
            if (map.validity[i] != Validity::Valid) continue;
            for (size_t k = 0; k < 16; ++k) {
                double value = double(pca.mean[k]);
                for (size_t m = 0; m < 6; ++m)
                    value += double(pca.weights[i * 6 + m]) * double(pca.basis[m * 16 + k]);
                total += value * value;
            }
        }
        EXPECT_NEAR(report.weightsRelativeRmse, std::sqrt(sum / total), 1e-6 + 1e-3 * std::sqrt(sum / total));
        EXPECT_EQ(text["weights"]["relative_rmse"].get<double>(), report.weightsRelativeRmse);
        // Weights lie within ±1: steps of at most 2/255 or of 2^-11, clipping of outliers at most doubles
        // that.
        EXPECT_LT(worst, std::string(format) == "unorm8" ? 0.02 : 0.0005) << format;
        EXPECT_TRUE(std::string(format) != "float" || worst == 0);
        // Behind the last component there is nothing.
        EXPECT_EQ(channel(image, 480, 2), 0);
        EXPECT_EQ(channel(image, 480, 3), 0);
    }
    const json text = description();
    EXPECT_EQ(text["format"], "prt-export");
    EXPECT_EQ(text["domain"], "texel");
    EXPECT_EQ(text["mean"].get<std::vector<float>>(), pca.mean);
    for (size_t m = 0; m < 6; ++m)
        EXPECT_EQ(text["basis"][m].get<std::vector<float>>(),
                  std::vector<float>(pca.basis.begin() + long(m) * 16, pca.basis.begin() + long(m + 1) * 16));
    EXPECT_EQ(text["projection"]["projection"], "plain");
    EXPECT_TRUE(text["conventions"].contains("shConvention"));
    const TextureImage validity = readKtx2(out() / "validity.ktx2");
    for (size_t i = 0; i < 480; ++i) EXPECT_EQ(validity.bytes[i], uint8_t(map.validity[i]));
    EXPECT_EQ(text["validity"]["codes"]["gutter_filled"], 2);
}

TEST_F(Export, DdsHoldsTheTexelsOfKtx2) {
    writeBundle(bakedVisibility(kAtlas, 3), 5);
    tabulate("triple-product");
    tabulate("light-cosine");
    runExport(settings());
    ExportSettings dds = settings();
    dds.container = "dds";
    const ExportReport report = runExport(dds);
    ASSERT_EQ(report.rows.size(), 5u);  // visibility too: light-cosine tables need it
    EXPECT_EQ(report.rows[2].part, "visibility");
    EXPECT_EQ(report.rows[2].format, "R16G16B16A16_SFLOAT");
    for (const ExportRow& row : report.rows) {
        EXPECT_TRUE(row.file.ends_with(".dds"));
        const TextureImage image = readDds(out() / row.file);
        KtxMetadata metadata;
        EXPECT_EQ(image, readKtx2((out() / row.file).replace_extension(".ktx2"), &metadata)) << row.file;
        EXPECT_EQ(metadata["prtPart"], row.part);
        EXPECT_EQ(image.isCube, row.part == "table");
        EXPECT_EQ(image.bytes.size(), row.bytes);
    }
    EXPECT_EQ(description()["weights"]["file"], "weights.dds");
}

TEST_F(Export, EveryFormatOfTablesIsAsExactAsItsBits) {
    writeBundle(bakedVisibility(kAtlas, 4), 7);
    tabulate("triple-product");
    tabulate("light-cosine");
    const std::vector<std::pair<const char*, double>> limits = {
        // Shares of the range of a function: r11f has 5 or 6 bits of mantissa, rgb9e5 9, half floats 11.
        {"r11f", 0.02},
        {"rgb9e5", 0.003},
        {"half", 0.0005},
        {"float", 1e-12}};
    for (const auto& [format, limit] : limits) {
        ExportSettings one = settings();
        one.tables = format;
        one.weights = one.visibility = "float";
        const ExportReport report = runExport(one);
        ASSERT_EQ(report.errors.size(), 2u);
        for (const ExportError& error : report.errors) {
            EXPECT_LT(error.irradianceRelativeRmse, limit) << format << " " << error.table;
            if (limit > 1e-6) {
                EXPECT_GT(error.irradianceRelativeRmse, limit / 100) << format << " " << error.table;
            }
        }
        const json text = description();
        for (const json& table : text["tables"]) {
            const bool isTriple = table["kind"] == "triple-product";
            const bool isPacked = table["packing"] == "rgb-per-layer";
            EXPECT_EQ(isPacked, std::string(format) == "r11f" || std::string(format) == "rgb9e5");
            EXPECT_EQ(table["layers"], isTriple ? (isPacked ? 8 : 7) : (isPacked ? 16 : 12));
            EXPECT_EQ(table.contains("range"), isPacked);
        }
    }
}

TEST_F(Export, WithoutCompressionVisibilityIsExported) {
    writeBundle(bakedVisibility(kAtlas, 3), 0);
    const ExportReport report = runExport(settings());
    ASSERT_EQ(report.rows.size(), 2u);
    EXPECT_EQ(report.rows[1].part, "visibility");
    EXPECT_EQ(report.rows[1].layers, 3);
    EXPECT_EQ(report.bytesPerPointTexel, 1 + 24);
    const TextureImage image = readKtx2(out() / "visibility.ktx2");
    const VisibilityMap map = readVisibilityFile(bundle() + "/visibility.exr");
    for (size_t i = 0; i < 480; ++i)
        for (size_t k = 0; k < 9; ++k)
            EXPECT_EQ(channel(image, k / 4 * 480 + i, k % 4),
                      double(floatFromHalf(halfFromFloat(map.coefficients[i * 9 + k]))));
    ExportSettings none = settings();
    none.visibility = "none";
    EXPECT_EQ(runExport(none).rows.size(), 1u);
}

TEST_F(Export, SunsComeWithTheirShadows) {
    writeBundle(bakedVisibility(kAtlas, 3), 4);
    const SunShadowMap sun = addSun(kAtlas);
    const ExportReport report = runExport(settings());
    EXPECT_EQ(report.notExported.size(), 0u);
    EXPECT_EQ(report.bytesPerPointTexel, 1 + 4);
    const json text = description();
    ASSERT_EQ(text["suns"].size(), 1u);
    EXPECT_EQ(text["suns"][0]["file"], "noon.sun.ktx2");
    EXPECT_EQ(text["suns"][0]["attributes"]["environmentName"], "noon");
    for (size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(text["suns"][0]["direction"][k].get<float>(), sun.direction[int(k)]);
        EXPECT_EQ(text["suns"][0]["irradiance"][k].get<float>(), sun.irradiance[k]);
    }
    const TextureImage image = readKtx2(out() / "noon.sun.ktx2");
    ASSERT_EQ(image.bytes.size(), kAtlas.count);
    for (size_t i = 0; i < kAtlas.count; ++i) EXPECT_EQ(int(image.bytes[i]), int(i % 256));
    EXPECT_THAT(readFile(out() / "prt_shade.hlsl"), testing::HasSubstr("float3 prtSunIrradiance("));
}

TEST_F(Export, PerVertexFollowsTheGridOfTheFile) {
    writeBundle(bakedVisibility(vertexGrid(1500), 3), 4);
    const ExportReport report = runExport(settings());
    EXPECT_EQ(report.points, 1500u);
    const json text = description();
    EXPECT_EQ(text["domain"], "vertex");
    EXPECT_EQ(text["weights"]["width"], 1024);
    EXPECT_EQ(text["weights"]["height"], 2);
    EXPECT_THAT(readFile(out() / "prt_shade.glsl"), testing::HasSubstr("#define PRT_ROW_LENGTH 1024"));
    const PcaMap pca = readPcaFile(bundle() + "/pca.exr");
    const TextureImage image = readKtx2(out() / "weights.ktx2");
    const float scale = text["weights"]["scale"][0], bias = text["weights"]["bias"][0];
    for (const size_t vertex : {1u, 1023u, 1024u, 1499u})
        EXPECT_NEAR(double(bias) + double(scale) * channel(image, vertex, 0), double(pca.weights[vertex * 4]),
                    0.01);
}

TEST_F(Export, RefusesWhatItCannotUse) {
    EXPECT_THROW(runExport(settings()), InputError);
    writeBundle(bakedVisibility(kAtlas, 3), 4);
    tabulate("triple-product");
    const auto refused = [&](std::string ExportSettings::*member, const char* option) {
        ExportSettings bad = settings();
        bad.*member = "nonsense";
        EXPECT_THAT([&] { runExport(bad); }, testing::ThrowsMessage<UsageError>(testing::HasSubstr(option)));
    };
    refused(&ExportSettings::container, "--container");
    refused(&ExportSettings::weights, "--weights");
    refused(&ExportSettings::tables, "--tables");
    refused(&ExportSettings::visibility, "--visibility");
    rewriteFile(directory_.file("file"), "x");
    ExportSettings file = settings();
    file.folder = directory_.file("file");
    EXPECT_THROW(runExport(file), OutputError);
    writeBundle(bakedVisibility(kAtlas, 4), 0);
    EXPECT_THAT([&] { runExport(settings()); },
                testing::ThrowsMessage<InputError>(
                    testing::AllOf(testing::HasSubstr("pca.exr"), testing::HasSubstr("prt compress"))));
    EXPECT_FALSE(fs::exists(out()));
}

TEST(EncodeTable, HalvesAreScaledWhereTheyWouldOverflow) {
    NormalTable table = randomTable(TableKind::TripleProduct, 2, 3, 6);
    table.layer(1, 4)[7] = 200000;  // green of the second group of functions
    const TableTexture texture = encodeTable(table, "half");
    ASSERT_EQ(texture.ranges.size(), 7u);
    for (size_t group = 0; group < 7; ++group) EXPECT_EQ(texture.ranges[group][3], group == 3 ? 4 : 1);
    for (size_t i = 0; i < table.values.size(); ++i)
        EXPECT_NEAR(texture.decoded[i], table.values[i],
                    4 * 0x1p-11 * std::abs(double(table.values[i])) + 1e-6);
    EXPECT_TRUE(encodeTable(table, "float").ranges.empty());
    EXPECT_EQ(encodeTable(table, "float").decoded, table.values);
}

TEST(EncodeTable, PackedFormatsKeepSigns) {
    const NormalTable table = randomTable(TableKind::LightCosine, 4, 3, 9);
    for (const auto& [format, share] : {std::pair("rgb9e5", 1.0 / 512), std::pair("r11f", 1.0 / 32)}) {
        const TableTexture texture = encodeTable(table, format);
        EXPECT_EQ(texture.image.layers, 9);
        EXPECT_EQ(texture.image.bytes.size(), 9 * table.texels() * 4);
        bool isNegative = false;
        for (int c = 0; c < 3; ++c)
            for (int layer = 0; layer < 9; ++layer)
                for (size_t i = 0; i < table.texels(); ++i) {
                    const size_t index = (size_t(c) * 9 + size_t(layer)) * table.texels() + i;
                    EXPECT_NEAR(texture.decoded[index], table.values[index],
                                share / 2 * 1.01 * double(texture.ranges[size_t(layer)][3]));
                    isNegative = isNegative || texture.decoded[index] < -0.5f;
                }
        EXPECT_TRUE(isNegative);
    }
}

}  // namespace
}  // namespace prt
