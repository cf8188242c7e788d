// A visibility.exr that does not fit into memory.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>

#include "compress/compress_visibility.h"
#include "precompute/io/bundle.h"
#include "precompute/io/exr_file.h"
#include "precompute/io/visibility_file.h"
#include "tests/base/temporary_directory.h"
#include "tests/compress/test_points.h"

namespace prt {
namespace {

constexpr int kOrder = 3, kWidth = 1024, kComponents = 2;
constexpr size_t kColumns = 9;

// Bands of an image of any height: 500 different points, all with noise of their own.
class Bands {
  public:
    Bands() : points_(testPoints(kOrder, 500, 3, 24, Projection{})) {}
    VisibilityMap rows(int firstRow, int rows) const {
        VisibilityMap map;
        map.shOrder = kOrder;
        map.projection = Projection{};
        map.grid = {PointDomain::Texel, kWidth, rows, size_t(kWidth) * size_t(rows)};
        map.ao.assign(map.grid.count, 0.5f);
        for (size_t k = 0; k < map.grid.count; ++k) {
            const size_t point = size_t(firstRow) * kWidth + k, of = point * 7 % 500;
            map.normals.push_back(points_.normals[of]);
            map.validity.push_back(Validity(point % 11 == 0 ? 0 : 1));
            const auto row = points_.rows.begin() + ptrdiff_t(of * kColumns);
            map.coefficients.insert(map.coefficients.end(), row, row + kColumns);
            map.coefficients[k * kColumns + point % kColumns] += 0.1f * float(std::sin(double(point)));
        }
        return map;
    }

  private:
    Points points_;
};

std::vector<ExrChannelOut> channelsOf(const VisibilityMap& map) {
    std::vector<ExrChannelOut> channels;
    const auto add = [&](const std::string& name, ExrType type, const void* data, size_t stride) {
        channels.push_back({name, type, data, 4 * stride, 4 * stride * kWidth});
    };
    for (size_t c = 0; c < kColumns; ++c)
        add("V." + std::to_string(c / 10) + std::to_string(c % 10), ExrType::Float, &map.coefficients[c],
            kColumns);
    add("ao", ExrType::Float, map.ao.data(), 1);
    for (int axis = 0; axis < 3; ++axis)
        add(std::string("normal.") + "XYZ"[axis], ExrType::Float, map.normals[0].data() + axis, 3);
    add("validity", ExrType::Uint, map.validity.data(), 1);
    return channels;
}

// Uncompressed, with the attributes of files of ours; never as a whole in memory.
void writeLargeFile(const std::string& path, const Bands& bands, int height) {
    constexpr int kBand = 64;
    const VisibilityMap first = bands.rows(0, kBand);
    writeVisibilityFile(path, first);
    ExrPartOut part;
    part.attributes = ExrReader(path).parts()[0].attributes;
    part.width = kWidth;
    part.height = height;
    part.channels = channelsOf(first);
    part.compression = ExrCompression::None;
    ExrWriter writer(path, {part});
    for (int row = 0; row < height; row += kBand) {
        const VisibilityMap band = bands.rows(row, std::min(kBand, height - row));
        writer.writeRows(0, band.grid.height, channelsOf(band));
    }
    writer.commit();
}

int compressLimited(const std::string& bundle, size_t bytes) {
    const std::string components = std::to_string(kComponents), limit = std::to_string(bytes);
    const pid_t child = ::fork();
    if (child == 0) {
        ::execl(PRT_LIMITED_COMPRESS, PRT_LIMITED_COMPRESS, bundle.c_str(), components.c_str(), limit.c_str(),
                static_cast<char*>(nullptr));
        ::_exit(127);
    }
    int status = 0;
    if (child < 0 || ::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
    return WEXITSTATUS(status);
}

double largestDifference(const std::vector<float>& a, const std::vector<float>& b) {
    if (a.size() != b.size()) return INFINITY;
    double largest = 0;
    for (size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(double(a[k]) - double(b[k])));
    return largest;
}

TEST(LimitedMemory, FileOfTenTimesTheMemoryGivesWhatMemoryGives) {
    constexpr size_t kAllowed = size_t(20) << 20;
    constexpr int kHeight = 3700;
    const TemporaryDirectory directory;
    const std::string bundle = directory.file("large.prt");
    const Bands bands;
    {
        BundleTransaction transaction(bundle, true);
        writeLargeFile(transaction.stage("visibility.exr", {}, "prt precompute large.obj").string(), bands,
                       kHeight);
        transaction.commit();
    }
    ASSERT_GE(std::filesystem::file_size(bundle + "/visibility.exr"), 10 * kAllowed);
    // The limit is one: a tenth of it is too little.
    EXPECT_EQ(compressLimited(bundle, kAllowed / 10), 1);
    ASSERT_EQ(compressLimited(bundle, kAllowed), 0);

    const PcaMap pca = readPcaFile(bundle + "/pca.exr");
    const VisibilityMap map = bands.rows(0, kHeight);
    std::vector<uint8_t> use;
    for (const Validity validity : map.validity) use.push_back(validity == Validity::Valid);
    CompressedVisibility expected = compressVisibility(map.coefficients, use, map.normals, kOrder,
                                                       map.projection, kComponents, WeightsFit::Irradiance);
    for (size_t i = 0; i < use.size(); ++i)
        if (!use[i]) std::fill_n(&expected.weights[i * kComponents], kComponents, 0.0f);
    EXPECT_LE(largestDifference(pca.mean, expected.pca.mean), 1e-5);
    EXPECT_LE(largestDifference(pca.basis, expected.pca.basis), 1e-5);
    EXPECT_LE(largestDifference(pca.weights, expected.weights), 1e-5);
}

}  // namespace
}  // namespace prt
