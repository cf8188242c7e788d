// OpenEXR files written and read some rows at a time.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "precompute/base/error.h"
#include "precompute/io/exr_file.h"
#include "tests/base/temporary_directory.h"

namespace prt {
namespace {

constexpr int kWidth = 11, kHeight = 53;

float valueAt(int part, int x, int y) { return float(part * 4096 + y * 32 + x) / 8; }

// Parts of float, half and unsigned channels.
std::vector<ExrPartOut> description(ExrCompression compression) {
    std::vector<ExrPartOut> parts(2);
    for (size_t k = 0; k < 2; ++k) {
        parts[k].name = k == 0 ? "first" : "second";
        parts[k].width = kWidth;
        parts[k].height = k == 0 ? kHeight : 7;
        parts[k].compression = compression;
        for (const ExrType type : {ExrType::Float, ExrType::Half, ExrType::Uint})
            parts[k].channels.push_back({fmt::format("c{}", int(type)), type, nullptr, 4, 4 * kWidth});
    }
    return parts;
}

void writeRows(ExrWriter& writer, const std::vector<ExrPartOut>& parts, size_t part, int firstRow, int rows) {
    std::vector<float> values;
    std::vector<uint32_t> numbers;
    for (int y = firstRow; y < firstRow + rows; ++y)
        for (int x = 0; x < kWidth; ++x) {
            values.push_back(valueAt(int(part), x, y));
            numbers.push_back(uint32_t(8 * values.back()));
        }
    std::vector<ExrChannelOut> channels = parts[part].channels;
    for (ExrChannelOut& channel : channels)
        channel.data =
            channel.type == ExrType::Uint ? static_cast<const void*>(numbers.data()) : values.data();
    writer.writeRows(part, rows, channels);
}

class ExrRows : public testing::TestWithParam<ExrCompression> {};
INSTANTIATE_TEST_SUITE_P(Compressions, ExrRows, testing::Values(ExrCompression::Zip, ExrCompression::None));

TEST_P(ExrRows, AreWhatWasWrittenWhateverTheBands) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("rows.exr");
    const std::vector<ExrPartOut> parts = description(GetParam());
    ExrWriter writer(path, parts);
    writeRows(writer, parts, 0, 0, 5);  // no multiple of a chunk
    writeRows(writer, parts, 1, 0, 4);
    writeRows(writer, parts, 0, 5, 40);
    writeRows(writer, parts, 0, 45, 8);
    writeRows(writer, parts, 1, 4, 3);
    EXPECT_FALSE(std::filesystem::exists(path));
    writer.commit();

    const ExrReader reader(path);
    for (const auto& [part, first, rows] :
         {std::tuple{0, 0, 53}, {0, 0, 1}, {0, 52, 1}, {0, 15, 2}, {0, 17, 30}, {1, 0, 7}, {1, 3, 2}}) {
        std::vector<float> values(size_t(rows * kWidth)), halves(values);
        std::vector<uint32_t> numbers(values.size());
        reader.readRows(
            size_t(part), first, rows,
            {{fmt::format("c{}", int(ExrType::Float)), ExrType::Float, values.data(), 4, 4 * kWidth},
             {fmt::format("c{}", int(ExrType::Half)), ExrType::Float, halves.data(), 4, 4 * kWidth},
             {fmt::format("c{}", int(ExrType::Uint)), ExrType::Uint, numbers.data(), 4, 4 * kWidth}});
        for (int k = 0; k < rows * kWidth; ++k) {
            const float expected = valueAt(part, k % kWidth, first + k / kWidth);
            ASSERT_EQ(values[size_t(k)], expected);
            ASSERT_EQ(numbers[size_t(k)], uint32_t(8 * expected));
            ASSERT_NEAR(halves[size_t(k)], expected, std::abs(expected) / 2048);  // half of a half's step
        }
    }
}

TEST_P(ExrRows, OfAFileThatIsNotCommittedLeaveNothing) {
    const TemporaryDirectory directory;
    {
        const std::vector<ExrPartOut> parts = description(GetParam());
        ExrWriter writer(directory.file("rows.exr"), parts);
        writeRows(writer, parts, 0, 0, 20);
    }
    EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(ExrWriterDeathTest, RowsBeyondTheImageOrMissing) {
    const TemporaryDirectory directory;
    const std::vector<ExrPartOut> parts = description(ExrCompression::Zip);
    EXPECT_DEATH(
        {
            ExrWriter writer(directory.file("a.exr"), parts);
            writeRows(writer, parts, 1, 0, 8);
        },
        "rows");
    EXPECT_DEATH(
        {
            ExrWriter writer(directory.file("b.exr"), parts);
            writeRows(writer, parts, 1, 0, 7);
            writer.commit();
        },
        "height");
}

}  // namespace
}  // namespace prt
