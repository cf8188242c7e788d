// Pictures and frame times of prt measure compression.
#include "tools/measure/compression_images.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "tests/base/temporary_directory.h"
#include "tests/tools/measure_compression_box.h"
#include "tools/measure/commands.h"
#include "tools/measure/compression_sheet.h"

namespace prt::tools {
namespace {

size_t differentValues(const ByteImage& image) {
    return std::set<uint8_t>(image.pixels.begin(), image.pixels.end()).size();
}

ByteImage uniform(int width, int height, uint8_t value) {
    return {width, height, 3, std::vector<uint8_t>(size_t(width) * size_t(height) * 3, value)};
}

TEST(CompressionSheet, LaysPicturesOutAndWritesLabels) {
    const std::vector<std::vector<SheetCell>> rows = {
        {{"left", uniform(60, 20, 200)}, {"right", uniform(60, 20, 100)}},
        {{"", {}}, {"low", uniform(60, 20, 50)}}};
    const ByteImage sheet = composeSheet("Title", rows);
    EXPECT_EQ(sheet.width, 2 * 60 + 3 * 8);
    EXPECT_EQ(sheet.channels, 3);
    EXPECT_EQ(sheet.pixels.size(), size_t(sheet.width) * size_t(sheet.height) * 3);
    const auto count = [&](uint8_t value) {
        return std::count(sheet.pixels.begin(), sheet.pixels.end(), value);
    };
    for (const uint8_t value : {200, 100, 50}) EXPECT_EQ(count(value), 60 * 20 * 3) << int(value);
    const auto ink = count(240);
    EXPECT_GT(ink, 3 * 4 * 30);  // of 17 letters
    // Text stays in its place, however long it is.
    std::vector<std::vector<SheetCell>> longer = rows;
    longer[0][0].label = std::string(200, 'W');
    const ByteImage other = composeSheet("Title", longer);
    EXPECT_EQ(other.width, sheet.width);
    for (int y = 0; y < sheet.height; ++y)
        for (int x = 8 + 60; x < sheet.width; ++x) {
            const size_t at = 3 * (size_t(y) * size_t(sheet.width) + size_t(x));
            ASSERT_EQ(other.pixels[at], sheet.pixels[at]) << x << " " << y;
        }
}

class CompressionImages : public testing::TestWithParam<bool> {
  protected:
    void SetUp() override {
        setQuiet(true);
        bundle_ = test::boxBundle(folder_, GetParam(), ProjectionKind::Irradiance);
        view_.camera.eye = Vec3f(2, 3, 3);
        view_.camera.target = Vec3f(0, 0.3f, 0);
        view_.width = 48;
        view_.height = 32;
        view_.tableSize = 8;
        view_.referenceRays = 256;
    }
    void TearDown() override { setQuiet(false); }
    TemporaryDirectory folder_;
    std::string bundle_;
    CompressionView view_;
};

TEST_P(CompressionImages, DrawsBothFigures) {
    CompressionScene scene(bundle_, false, 4);
    const std::filesystem::path images = folder_.path() / "images";
    checkCompressionFigures(images);
    const std::vector<PictureRow> rows =
        drawCompressionFigures(scene, {2, 4}, "unorm8", loadEnvironment("sky:overcast"), view_, images);
    // 4 and 12 vectors of 16, uncompressed; two orders, the reference.
    ASSERT_EQ(rows.size(), 3u + 3u);
    EXPECT_EQ(rows[0].picture, "pca4");
    EXPECT_EQ(rows[1].picture, "pca12");
    EXPECT_EQ(rows[2].picture, "uncompressed");
    EXPECT_EQ(rows[3].picture, "order2");
    EXPECT_EQ(rows[5].picture, "reference");
    EXPECT_LT(rows[1].relativeRmse, rows[0].relativeRmse);
    EXPECT_GT(rows[1].relativeRmse, 0);
    EXPECT_LT(rows[4].relativeRmse, rows[3].relativeRmse);
    for (const PictureRow& row : rows) {
        const std::string png = readFile((images / row.file).string());
        const ByteImage image =
            decodeImage({reinterpret_cast<const uint8_t*>(png.data()), png.size()}, row.file);
        EXPECT_EQ(image.width, 48);
        EXPECT_EQ(image.height, 32);
        EXPECT_GT(differentValues(image), 20u) << row.file;
        EXPECT_EQ(row.differenceFile.empty(), row.picture == "uncompressed" || row.picture == "reference");
        if (row.differenceFile.empty()) continue;
        const std::string other = readFile((images / row.differenceFile).string());
        EXPECT_GT(differentValues(decodeImage({reinterpret_cast<const uint8_t*>(other.data()), other.size()},
                                              row.differenceFile)),
                  3u)
            << row.differenceFile;
    }
    for (const char* sheet : {"figure5.png", "figure6.png"}) {
        const std::string png = readFile((images / sheet).string());
        const ByteImage image =
            decodeImage({reinterpret_cast<const uint8_t*>(png.data()), png.size()}, sheet);
        EXPECT_EQ(image.width, 3 * 48 + 4 * 8);
        EXPECT_GT(differentValues(image), 20u);
    }
}

TEST_P(CompressionImages, TimesEveryTechniqueBesideTheHighestOrder) {
    CompressionScene scene(bundle_, false, 4);
    const std::vector<FrameTime> times =
        timeCompressionFrames(scene, {2, 4}, {4, 16, 17}, loadEnvironment("sky:overcast"), view_, 1);
    ASSERT_EQ(times.size(), 4u);
    EXPECT_EQ(times[1].shOrder, 4);
    EXPECT_EQ(times[3].components, 16);
    for (const FrameTime& row : times) {
        EXPECT_GT(row.milliseconds, 0);
        EXPECT_GT(row.ratio, 0);
    }
}

INSTANTIATE_TEST_SUITE_P(Domains, CompressionImages, testing::Values(false, true));

TEST(CompressionImagesFolder, IsCheckedBeforeLongWork) {
    const TemporaryDirectory folder;
    checkCompressionFigures(folder.path() / "some" / "images");
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"some", "some/images"}));
    rewriteFile(folder.file("file"), "no folder");
    EXPECT_THROW(checkCompressionFigures(folder.file("file")), OutputError);
}

}  // namespace
}  // namespace prt::tools
