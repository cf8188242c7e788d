// Compression of points that arrive in parts, from files as from memory.
#include "compress/visibility_rows.h"

#include <cmath>
#include <set>

#include "compress/compress_visibility.h"
#include "compress/irradiance_weights.h"
#include "compress/row_sample.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "tests/base/temporary_directory.h"
#include "tests/compress/test_points.h"

namespace prt {
namespace {

// The same points in parts of `part`.
class InParts final : public VisibilityRows {
  public:
    InParts(int shOrder, const VisibilityTile& all, size_t part)
        : shOrder_(shOrder), all_(all), part_(part) {}
    int shOrder() const override { return shOrder_; }
    size_t count() const override { return all_.normals.size(); }
    void forEachTile(const std::function<void(const VisibilityTile&)>& body) const override {
        const size_t d = size_t(shCount(shOrder_));
        const auto slice = [](auto span, size_t begin, size_t points) {
            return span.empty() ? span : span.subspan(begin, points);
        };
        for (size_t begin = 0; begin < count(); begin += part_) {
            const size_t points = std::min(part_, count() - begin);
            body({begin, all_.rows.subspan(begin * d, points * d), all_.normals.subspan(begin, points),
                  slice(all_.use, begin, points), slice(all_.surface, begin, points),
                  slice(all_.rowWeights, begin, points)});
        }
    }

  private:
    int shOrder_;
    VisibilityTile all_;
    size_t part_;
};

struct Both {
    PcaResult pca;
    std::vector<float> weights;
    CompressionErrors errors;
};

Both compressed(const VisibilityRows& rows, const Projection& projection,
                const CompressionSettings& settings) {
    Both result;
    result.pca = VisibilityStatistics(rows, projection).basis(settings);
    compressRows(
        rows, projection, result.pca, settings.fit,
        [&](std::span<const float> weights) {
            result.weights.insert(result.weights.end(), weights.begin(), weights.end());
        },
        &result.errors);
    return result;
}

// Within the tolerance times the largest value, or 1 where all are smaller.
void expectNear(std::span<const float> a, std::span<const float> b, double tolerance, const char* what) {
    ASSERT_EQ(a.size(), b.size());
    double largest = 0, scale = 1;
    for (size_t k = 0; k < a.size(); ++k) {
        largest = std::max(largest, std::abs(double(a[k]) - double(b[k])));
        scale = std::max(scale, std::abs(double(b[k])));
    }
    EXPECT_LE(largest, tolerance * scale) << what << " up to " << scale;
}

// Sums of parts are joined in double: what differs is the order of float sums inside blocks of 1024 rows.
void expectSame(const Both& a, const Both& b) {
    expectNear(a.pca.mean, b.pca.mean, 1e-5, "mean");
    expectNear(a.pca.basis, b.pca.basis, 1e-5, "basis");
    // Weights fitted for irradiance follow the vectors by the condition of their least squares: 1.2e-5 seen.
    expectNear(a.weights, b.weights, 4e-5, "weights");
    EXPECT_NEAR(a.errors.relativeRmse, b.errors.relativeRmse, 1e-6);
    EXPECT_NEAR(a.errors.rmse, b.errors.rmse, 1e-6);
    EXPECT_NEAR(a.errors.irradianceRelativeRmse, b.errors.irradianceRelativeRmse, 1e-6);
}

constexpr int kOrder = 3;

class Parts : public testing::TestWithParam<std::tuple<WeightsFit, Covariance, ProjectionKind>> {};
INSTANTIATE_TEST_SUITE_P(Kinds, Parts,
                         testing::Combine(testing::Values(WeightsFit::Irradiance, WeightsFit::Plain),
                                          testing::Values(Covariance::Irradiance, Covariance::Plain),
                                          testing::Values(ProjectionKind::Irradiance,
                                                          ProjectionKind::Plain)));

TEST_P(Parts, AreTheWhole) {
    const auto [fit, covariance, kind] = GetParam();
    const Projection projection{kind, {}};
    const Points points = testPoints(kOrder, 7000, 3, 50, projection);
    std::vector<uint8_t> use(7000, 1), surface(7000, 1);
    std::vector<float> counts(7000);
    for (size_t i = 0; i < 7000; ++i) {
        use[i] = i % 5 != 2;
        surface[i] = i % 10 != 2;
        counts[i] = float(1 + i % 7);
    }
    for (const bool weighted : {false, true}) {
        const VisibilityTile all{
            0,   points.rows, points.normals,
            use, surface,     weighted ? std::span<const float>(counts) : std::span<const float>()};
        const CompressionSettings settings{4, fit, covariance};
        const Both whole = compressed(VisibilityInMemory(kOrder, all), projection, settings);
        for (const size_t part : {size_t(100), size_t(1024), size_t(6999)})
            expectSame(compressed(InParts(kOrder, all, part), projection, settings), whole);
        for (size_t i = 2; i < 7000; i += 10)
            for (size_t m = 0; m < 4; ++m) ASSERT_EQ(whole.weights[i * 4 + m], 0.0f);
        // Errors are those of the functions for rows in memory.
        if (weighted) continue;
        const PcaError error = pcaError(whole.pca, points.rows, whole.weights, use, shCount(kOrder));
        EXPECT_DOUBLE_EQ(whole.errors.relativeRmse, error.relativeRmse);
        EXPECT_DOUBLE_EQ(whole.errors.rmse, error.rmse);
        EXPECT_DOUBLE_EQ(
            whole.errors.irradianceRelativeRmse,
            irradianceRelativeRmse(whole.pca, points.rows, whole.weights, points.normals, use, kOrder));
    }
}

TEST(VisibilityStatistics, IrradianceCovarianceHelpsWhatIrradianceSees) {
    const Projection projection;
    const Points points = testPoints(4, 3000, 5, 3000, projection);
    const VisibilityInMemory rows(4, {0, points.rows, points.normals, {}, {}, {}});
    const auto error = [&](Covariance covariance) {
        return compressed(rows, projection, {6, WeightsFit::Irradiance, covariance})
            .errors.irradianceRelativeRmse;
    };
    EXPECT_LT(error(Covariance::Irradiance), error(Covariance::Plain));
}

TEST(RowMoments, WholeWeightsAreRepetitions) {
    const Points points = testPoints(kOrder, 3000, 7, 3000);
    const size_t d = size_t(shCount(kOrder));
    std::vector<float> counts, repeated;
    for (size_t i = 0; i < 3000; ++i) {
        counts.push_back(float(i % 4));
        const auto row = points.rows.begin() + ptrdiff_t(i * d);
        for (size_t k = 0; k < i % 4; ++k) repeated.insert(repeated.end(), row, row + ptrdiff_t(d));
    }
    RowMoments weighted(9), plain(9);
    weighted.add(points.rows, {}, counts);
    plain.add(repeated);
    EXPECT_DOUBLE_EQ(weighted.weight(), plain.weight());
    EXPECT_EQ(weighted.rowsUsed(), 3000u);
    const std::vector<double> a = weighted.covariance(), b = plain.covariance();
    for (size_t k = 0; k < d; ++k) EXPECT_NEAR(weighted.mean()[k], plain.mean()[k], 1e-12);
    for (size_t k = 0; k < d * d; ++k) EXPECT_NEAR(a[k], b[k], 1e-6);
}

TEST(RowMoments, WeightsOfZeroAreRefused) {
    RowMoments moments(4);
    moments.add(std::vector<float>(40, 1.0f), {}, std::vector<float>(10, 0.0f));
    EXPECT_THROW(principalComponents(moments, 1), InputError);
}

TEST(RowMoments, NameTheBadPointOfALaterPart) {
    RowMoments moments(4);
    moments.add(std::vector<float>(40, 1.0f));
    std::vector<float> rows(40, 1.0f);
    rows[14] = std::nanf("");
    try {
        moments.add(rows);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("point 13 "), std::string::npos) << error.what();
    }
}

TEST(RowSampler, TakesAllOrTheCapacityWhateverTheParts) {
    std::vector<float> rows;
    std::vector<Vec3f> normals;
    std::vector<uint8_t> use;
    for (size_t i = 0; i < 5000; ++i) {
        rows.push_back(float(i));
        normals.emplace_back(float(i), 0, 0);
        use.push_back(i % 2 == 0);
    }
    for (const size_t capacity : {size_t(100), size_t(2499), size_t(2500), size_t(9999)}) {
        const auto sampled = [&](size_t part) {
            RowSampler sampler(capacity, 1);
            for (size_t i = 0; i < 5000; i += part)
                sampler.add(std::span(rows).subspan(i, part), std::span(normals).subspan(i, part),
                            std::span(use).subspan(i, part), std::span(rows).subspan(i, part));
            return sampler.sample();
        };
        const SampledRows all = sampled(5000);
        ASSERT_EQ(all.rows.size(), std::min<size_t>(capacity, 2500));
        EXPECT_TRUE(std::is_sorted(all.rows.begin(), all.rows.end()));
        EXPECT_EQ(std::set<float>(all.rows.begin(), all.rows.end()).size(), all.rows.size());
        EXPECT_EQ(all.rows, all.rowWeights);
        for (size_t k = 0; k < all.rows.size(); ++k) {
            EXPECT_EQ(int(all.rows[k]) % 2, 0);
            EXPECT_EQ(all.normals[k].x(), all.rows[k]);
        }
        EXPECT_EQ(sampled(50).rows, all.rows);
    }
}

TEST(RowSampler, IsEven) {
    // Mean and spread over residues of 64 of a uniform sample: deviations of 5 standard deviations fail.
    constexpr size_t kRows = 1 << 18, kCapacity = 4096;
    std::vector<float> rows(kRows);
    for (size_t i = 0; i < kRows; ++i) rows[i] = float(i);
    RowSampler sampler(kCapacity, 1);
    sampler.add(rows, std::vector<Vec3f>(kRows, Vec3f(0, 1, 0)), {}, {});
    std::vector<double> residues(64);
    double mean = 0;
    for (const float value : sampler.sample().rows) {
        residues[size_t(value) % 64] += 1;
        mean += double(value) / kCapacity / kRows;
    }
    EXPECT_NEAR(mean, 0.5, 5 * std::sqrt(1 / 12.0 / kCapacity));
    for (const double count : residues) EXPECT_NEAR(count, 64, 5 * 8);
    const SampledRows thin = thinned(sampler.sample(), 1, 1000);
    EXPECT_EQ(thin.rows.size(), 1000u);
    EXPECT_EQ(thinned(thin, 1, 1000).rows, thin.rows);
}

VisibilityMap mapOf(const Points& points, const PointGrid& grid, const Projection& projection) {
    VisibilityMap map;
    map.grid = grid;
    map.shOrder = kOrder;
    map.projection = projection;
    map.coefficients = points.rows;
    map.normals = points.normals;
    map.ao.assign(grid.count, 0.5f);
    map.validity.assign(grid.count, Validity::Valid);
    for (size_t i = 0; i < grid.count; i += 3) map.validity[i] = Validity(i % 5);
    return map;
}

// Both domains; files of several tiles, the last of them no whole chunk.
TEST(VisibilityOnDisk, EqualsMemory) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("v.exr");
    // Tiles hold 4 MB of coefficients, or two chunks of rows where rows are long.
    for (const PointGrid& grid :
         {PointGrid{PointDomain::Texel, 7300, 37, size_t(7300) * 37}, vertexGrid(300000), vertexGrid(10)}) {
        Points few = testPoints(kOrder, 500, 11, 40, Projection{}), points;
        for (size_t i = 0; i < grid.count; ++i) {
            points.normals.push_back(few.normals[i % 500]);
            const auto row = few.rows.begin() + ptrdiff_t(i % 500 * 9);
            points.rows.insert(points.rows.end(), row, row + 9);
            points.rows.back() += 1e-3f * float(i % 1013);
        }
        const VisibilityMap map = mapOf(points, grid, Projection{});
        writeVisibilityFile(path, map);
        std::vector<uint8_t> use, surface;
        for (const Validity validity : map.validity) {
            use.push_back(validity == Validity::Valid);
            surface.push_back(validity != Validity::Empty);
        }
        const VisibilityOnDisk file(path);
        size_t tiles = 0, next = 0;
        file.forEachTile([&](const VisibilityTile& tile) {
            EXPECT_EQ(tile.first, next);
            for (size_t i = 0; i < tile.normals.size(); ++i) {
                ASSERT_EQ(tile.normals[i], map.normals[next + i]);
                ASSERT_EQ(tile.use[i], use[next + i]);
                ASSERT_EQ(tile.rows[i * 9 + 5], map.coefficients[(next + i) * 9 + 5]);
            }
            next += tile.normals.size();
            ++tiles;
        });
        EXPECT_EQ(next, grid.count);
        if (grid.count > 1000) {
            EXPECT_GT(tiles, 1u);
        }
        const CompressionSettings settings{5, WeightsFit::Irradiance, Covariance::Irradiance};
        expectSame(
            compressed(file, Projection{}, settings),
            compressed(VisibilityInMemory(kOrder, {0, map.coefficients, map.normals, use, surface, {}}),
                       Projection{}, settings));
    }
}

// Ctrl-C in the midst of either pass.
TEST(VisibilityOnDisk, InterruptsEndBothPasses) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("v.exr"), out = directory.file("p.exr");
    const PointGrid grid = vertexGrid(300000);
    Points points{std::vector<float>(grid.count * 9, 0.25f), std::vector<Vec3f>(grid.count, Vec3f(0, 1, 0))};
    points.rows[0] = 1;
    writeVisibilityFile(path, mapOf(points, grid, Projection{}));
    size_t bands = 0;
    const VisibilityOnDisk interrupted(path, [&](int, int rows, std::vector<float>& weights) {
        weights.assign(size_t(rows) * size_t(kVertexRowLength), 1.0f);
        ++bands;
        requestInterrupt();
    });
    EXPECT_THROW(VisibilityStatistics(interrupted, Projection{}), Interrupted);
    EXPECT_EQ(bands, 1u);
    clearInterrupt();

    const VisibilityOnDisk file(path);
    const PcaResult pca = VisibilityStatistics(file, Projection{}).basis({1, WeightsFit::Plain, {}});
    size_t taken = 0;
    {
        PcaMap map;
        map.grid = grid;
        map.shOrder = kOrder;
        map.components = 1;
        map.mean = pca.mean;
        map.basis = pca.basis;
        map.variance = pca.variance;
        PcaWriter writer(out, map);
        EXPECT_THROW(compressRows(file, Projection{}, pca, WeightsFit::Plain,
                                  [&](std::span<const float> weights) {
                                      writer.write(weights);
                                      ++taken;
                                      requestInterrupt();
                                  }),
                     Interrupted);
        clearInterrupt();
    }
    EXPECT_EQ(taken, 1u);
    size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(directory.path())) {
        EXPECT_EQ(entry.path().string(), path);
        ++files;
    }
    EXPECT_EQ(files, 1u);
}

}  // namespace
}  // namespace prt
