// Errors of irradiance [IwanickiSloan2012, Eq. 4] by stage: the pipeline with one stage exact, and with one
// stage alone.
#include "tools/measure/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "precompute/math/sh.h"
#include "tools/measure/error_storage.h"

namespace prt::tools {
namespace {

constexpr size_t kNormals = 5, kBlockPoints = 64, kHalves = 2;
// Rings of cells of the second half for those of the first.
constexpr double kOtherRings = 0.9;

// Differences from the truth that are followed.
enum Variant : size_t {
    kTotal,
    kWithout,
    kAlone = kWithout + kErrorStages,
    kUpTo = kAlone + kErrorStages,
    kPlain = kUpTo + kErrorStages,
    kBands,
    kLookup,
    kWeights,
    kTableFormat,
    kVariants
};
constexpr size_t at(Variant first, ErrorStage stage) { return size_t(first) + size_t(stage); }

std::vector<float> exchanged(const std::vector<float>& shipped, const std::vector<float>& own,
                             const std::vector<float>& other) {
    std::vector<float> result(shipped.size());
    for (size_t i = 0; i < result.size(); ++i) result[i] = shipped[i] + other[i] - own[i];
    return result;
}

// Visibility by the many directions of one half, in the bundle's kind of projection and in both.
struct DenseHalf {
    std::vector<float> own, weighted, plain;  // [points×n²]
    std::vector<float> fitted;                // [points×n²] own after PCA
    /// [points×n²] the bundle's after PCA, had it been projected by weight
    std::vector<float> reprojected;
};

double dot(const float* a, const float* b, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; ++i) sum += double(a[i]) * double(b[i]);
    return sum;
}

// Sums of one environment over points, by kind of normal: geometric, tilted.
struct Sums {
    std::array<std::array<double, 2>, kVariants> product{}, difference{};  // e_A·e_B, |e_A − e_B|²
    std::array<double, 2> truth{}, truthDifference{};
    std::array<size_t, 2> count{};
    double peak = 0;

    void add(const Sums& other) {
        for (size_t kind = 0; kind < 2; ++kind) {
            for (size_t v = 0; v < kVariants; ++v) {
                product[v][kind] += other.product[v][kind];
                difference[v][kind] += other.difference[v][kind];
            }
            truth[kind] += other.truth[kind];
            truthDifference[kind] += other.truthDifference[kind];
            count[kind] += other.count[kind];
        }
        peak = std::max(peak, other.peak);
    }
    ErrorFigure figure(size_t variant) const {
        const auto relative = [](double part, double whole) {
            return whole > 0 ? std::sqrt(std::max(0.0, part) / whole) : 0;
        };
        const std::array<double, 2>& p = product[variant];
        const double all = truth[0] + truth[1];
        ErrorFigure result;
        result.relativeRmse = relative(p[0] + p[1], all);
        result.geometric = relative(p[0], truth[0]);
        result.tilted = relative(p[1], truth[1]);
        result.noise = relative((difference[variant][0] + difference[variant][1]) / 4, all);
        const double rmse = std::sqrt(std::max(0.0, p[0] + p[1]) / double(count[0] + count[1]));
        result.psnrDb = rmse > 0 ? 20 * std::log10(peak / rmse) : std::numeric_limits<double>::infinity();
        return result;
    }
};

class ErrorStudyRun {
  public:
    ErrorStudyRun(const JudgedBundle& bundle, const RayCaster& caster, const JudgedPoints& points,
                  std::span<const Environment> environments, const ErrorStudy& study)
        : caster_(caster),
          points_(points),
          study_(study),
          count_(points.place.size()),
          coefficients_(size_t(shCount(bundle.visibility.shOrder))),
          channels_(3 * environments.size()),
          storage_(bundle, study.weights),
          tables_(environments, bundle.visibility.shOrder, storage_.pca().mean, storage_.pca().basis,
                  study.table, study.tables),
          shipped_(shippedRows(bundle)),
          shippedCompressed_(storage_, storage_.shipped(points.place)) {
        for (size_t h = 0; h < kHalves; ++h) {
            const int rays = halfRays(h);
            light_.emplace_back(environments, bundle.visibility.shOrder, rays);
            dense_.push_back(bakeHalf(bundle, rays));
        }
        if (study.maps) {
            maps_.resize(environments.size());
            for (ErrorMap& map : maps_) {
                map.total.resize(count_);
                for (std::vector<float>& stage : map.alone) stage.resize(count_);
            }
        }
    }

    ErrorResult run(std::span<const Environment> environments) {
        const size_t blocks = (count_ + kBlockPoints - 1) / kBlockPoints;
        std::vector<std::vector<Sums>> sums(blocks);
        Progress progress("judging", count_, "points");
        parallelFor(count_, kBlockPoints, [&](size_t begin, size_t end) {
            sums[begin / kBlockPoints] = judgeBlock(begin, end);
            progress.advance(end - begin);
        });
        ErrorResult result;
        result.points = count_;
        for (const RayLight& light : light_) result.directions += light.directions().size();
        result.components = storage_.pca().components;
        for (size_t e = 0; e < environments.size(); ++e) {
            Sums all;
            for (const std::vector<Sums>& block : sums) all.add(block[e]);
            result.environments.push_back(makeBlock(environments[e].name, all));
            const double truth = (all.truth[0] + all.truth[1]) / double(all.count[0] + all.count[1]);
            if (!maps_.empty()) scaleMap(maps_[e], truth);
        }
        result.maps = std::move(maps_);
        return result;
    }

  private:
    // Of numbers that the reference makes other rings of: two sets of cells alike would hide all noise.
    int halfRays(size_t half) const {
        const auto inRings = [](int pairs) {
            return int(std::lround(16 * pairs * pairs / std::numbers::pi));
        };
        const double share = study_.rays / (1 + kOtherRings * kOtherRings);
        const int pairs = int(std::lround(std::sqrt(std::numbers::pi * share) / 4));
        return inRings(half == 0 ? pairs : std::min(pairs - 1, int(kOtherRings * pairs)));
    }

    std::vector<float> shippedRows(const JudgedBundle& bundle) const {
        std::vector<float> rows;
        for (const uint32_t place : points_.place) {
            const float* row = &bundle.visibility.coefficients[place * coefficients_];
            rows.insert(rows.end(), row, row + coefficients_);
        }
        return rows;
    }

    DenseHalf bakeHalf(const JudgedBundle& bundle, int rays) const {
        const Projection own = bundle.visibility.projection;
        const int shOrder = bundle.visibility.shOrder;
        const bool isWeighted = own.kind == ProjectionKind::Irradiance;
        const Projection weighted{ProjectionKind::Irradiance, isWeighted ? own.weight : IrradianceWeight{}};
        std::vector<float> c = bakeJudgedPoints(caster_, points_, shOrder, rays, weighted);
        std::vector<float> plain = bakeJudgedPoints(caster_, points_, shOrder, rays, kPlainProjection);
        const std::vector<float>& mine = isWeighted ? c : plain;
        const std::span<const Vec3f> normals = points_.parts.normals;
        std::vector<float> reprojected = shippedCompressed_.fittedExpansion;
        if (!isWeighted) reprojected = storage_.expand(storage_.fit(exchanged(shipped_, plain, c), normals));
        std::vector<float> fitted = storage_.expand(storage_.fit(mine, normals));
        return {mine, c, plain, std::move(fitted), std::move(reprojected)};
    }

    std::array<Vec3f, kNormals> shadingNormals(const Vec3f& normal) const {
        const Frame frame = frameAround(normal);
        const float tilt = float(study_.tiltDeg * std::numbers::pi / 180);
        const float c = std::cos(tilt), s = std::sin(tilt);
        return {normal, (c * normal + s * frame.tangent).normalized(),
                (c * normal - s * frame.tangent).normalized(),
                (c * normal + s * frame.bitangent).normalized(),
                (c * normal - s * frame.bitangent).normalized()};
    }

    // What one shading normal sees of the light.
    struct NormalLight {
        std::array<std::vector<float>, kHalves> rays;  // [channels×n²]
        std::vector<float> lookedUp, stored;           // [channels×n²], [channels×(M + 1)]
    };

    NormalLight lightOf(const Vec3f& normal) const {
        NormalLight light;
        for (size_t h = 0; h < kHalves; ++h) {
            light.rays[h].resize(channels_ * coefficients_);
            light_[h].transfer(normal, light.rays[h]);
        }
        light.lookedUp.resize(channels_ * coefficients_);
        tables_.transfer(normal, light.lookedUp);
        light.stored.resize(channels_ * (storage_.components() + 1));
        tables_.stored(normal, light.stored);
        return light;
    }

    std::vector<Sums> judgeBlock(size_t begin, size_t end) {
        std::vector<Vec3f> normals;
        for (size_t p = begin; p < end; ++p)
            for (const Vec3f& normal : shadingNormals(points_.parts.normals[p])) normals.push_back(normal);
        const std::vector<float> banded = tables_.transferWithoutTable(normals);
        std::vector<Sums> sums(channels_ / 3);
        std::array<NormalLight, kNormals> light;
        std::array<std::vector<float>, kHalves> truth;
        for (std::vector<float>& half : truth) half.resize(channels_);
        for (size_t p = begin; p < end; ++p) {
            throwIfInterrupted();
            std::array<std::vector<float>, kHalves> visible;
            for (size_t h = 0; h < kHalves; ++h)
                visible[h] = traceJudgedPoint(caster_, points_, p, light_[h].directions());
            const bool isSame = p > begin && points_.parts.normals[p] == points_.parts.normals[p - 1];
            for (size_t s = 0; s < kNormals; ++s) {
                const size_t place = (p - begin) * kNormals + s;
                if (!isSame) light[s] = lightOf(normals[place]);
                for (size_t h = 0; h < kHalves; ++h)
                    light_[h].irradiance(visible[h], normals[place], truth[h]);
                for (size_t j = 0; j < channels_; ++j)
                    judge(p, s > 0, j, {double(truth[0][j]), double(truth[1][j])}, light[s],
                          &banded[(place * channels_ + j) * coefficients_], sums[j / 3]);
            }
        }
        return sums;
    }

    // One colour at one normal of one point.
    void judge(size_t p, bool isTilted, size_t j, const std::array<double, kHalves>& truth,
               const NormalLight& light, const float* banded, Sums& sums) {
        std::array<std::array<double, kVariants>, kHalves> errors;
        for (size_t h = 0; h < kHalves; ++h) errors[h] = errorsOf(p, j, h, truth[h], light, banded);
        for (size_t v = 0; v < kVariants; ++v) {
            const double difference = errors[0][v] - errors[1][v];
            sums.product[v][isTilted] += errors[0][v] * errors[1][v];
            sums.difference[v][isTilted] += difference * difference;
        }
        sums.truth[isTilted] += truth[0] * truth[1];
        sums.truthDifference[isTilted] += (truth[0] - truth[1]) * (truth[0] - truth[1]);
        ++sums.count[isTilted];
        sums.peak = std::max(sums.peak, (truth[0] + truth[1]) / 2);
        if (maps_.empty()) return;
        const auto square = [&](size_t v) {
            return float(std::pow((errors[0][v] + errors[1][v]) / 2, 2) / double(3 * kNormals));
        };
        ErrorMap& map = maps_[j / 3];
        map.total[p] += square(kTotal);
        for (size_t stage = 0; stage < kErrorStages; ++stage) map.alone[stage][p] += square(kAlone + stage);
    }

    std::array<double, kVariants> errorsOf(size_t p, size_t j, size_t h, double truth,
                                           const NormalLight& light, const float* banded) const {
        const size_t n2 = coefficients_, m = storage_.components();
        const DenseHalf& dense = dense_[h];
        const float *rays = &light.rays[h][j * n2], *table = &light.lookedUp[j * n2],
                    *stored = &light.stored[j * (m + 1)];
        const auto by = [&](const std::vector<float>& rows, const float* transfer) {
            return dot(&rows[p * n2], transfer, n2);
        };
        using enum ErrorStage;
        const float* weights = &shippedCompressed_.stored[p * m];
        const double out = dot(weights, stored, m) + double(stored[m]);
        const double exact = by(dense.own, rays), weighted = by(dense.weighted, rays),
                     fittedRays = by(shippedCompressed_.fittedExpansion, rays),
                     fittedTable = by(shippedCompressed_.fittedExpansion, table),
                     storedRays = by(shippedCompressed_.storedExpansion, rays),
                     storedTable = by(shippedCompressed_.storedExpansion, table),
                     withoutTable = dot(&dense.own[p * n2], banded, n2);
        std::array<double, kVariants> e;
        e[kTotal] = out - truth;
        e[at(kWithout, Sampling)] = out + by(dense.fitted, table) - fittedTable - truth;
        e[at(kWithout, Truncation)] = out - exact;
        e[at(kWithout, Projection)] = out + by(dense.reprojected, table) - fittedTable - truth;
        e[at(kWithout, Pca)] = out + by(shipped_, table) - fittedTable - truth;
        e[at(kWithout, Quantisation)] = fittedTable - truth;
        e[at(kWithout, Tables)] = out + storedRays - storedTable - truth;
        e[at(kAlone, Sampling)] = by(shipped_, rays) - exact;
        e[at(kAlone, Truncation)] = weighted - truth;
        e[at(kAlone, Projection)] = exact - weighted;
        e[at(kAlone, Pca)] = by(dense.fitted, rays) - exact;
        e[at(kAlone, Quantisation)] = out - fittedTable;
        e[at(kAlone, Tables)] = by(dense.own, table) - exact;
        e[at(kUpTo, Truncation)] = e[at(kAlone, Truncation)];
        e[at(kUpTo, Projection)] = exact - truth;
        e[at(kUpTo, Sampling)] = by(shipped_, rays) - truth;
        e[at(kUpTo, Pca)] = fittedRays - truth;
        e[at(kUpTo, Quantisation)] = e[at(kWithout, Tables)];
        e[at(kUpTo, Tables)] = e[kTotal];
        e[kPlain] = by(dense.plain, rays) - truth;
        e[kBands] = withoutTable - exact;
        e[kLookup] = by(dense.own, table) - withoutTable;
        e[kWeights] = storedTable - fittedTable;
        e[kTableFormat] = out - storedTable;
        return e;
    }

    static ErrorBlock makeBlock(const std::string& name, const Sums& sums) {
        ErrorBlock block;
        block.environment = name;
        const double truth = sums.truth[0] + sums.truth[1];
        block.isDark = !(truth > 0);
        if (block.isDark) return block;
        block.truthNoise = std::sqrt((sums.truthDifference[0] + sums.truthDifference[1]) / 4 / truth);
        block.total = sums.figure(kTotal);
        for (size_t stage = 0; stage < kErrorStages; ++stage) {
            block.alone[stage] = sums.figure(kAlone + stage);
            block.without[stage] = sums.figure(kWithout + stage);
            block.upTo[stage] = sums.figure(kUpTo + stage);
        }
        block.plain = sums.figure(kPlain);
        block.bands = sums.figure(kBands);
        block.lookup = sums.figure(kLookup);
        block.weights = sums.figure(kWeights);
        block.tableFormat = sums.figure(kTableFormat);
        return block;
    }

    // From squares to shares of the RMS of the truth.
    static void scaleMap(ErrorMap& map, double truthSquare) {
        const auto scale = [&](std::vector<float>& values) {
            for (float& value : values)
                value = truthSquare > 0 ? float(std::sqrt(double(value) / truthSquare)) : 0.0f;
        };
        scale(map.total);
        for (std::vector<float>& stage : map.alone) scale(stage);
    }

    const RayCaster& caster_;
    const JudgedPoints& points_;
    const ErrorStudy& study_;
    size_t count_, coefficients_, channels_;
    BundleStorage storage_;
    TabulatedLight tables_;
    std::vector<float> shipped_;  // [points×n²]
    StoredExpansion shippedCompressed_;
    std::vector<RayLight> light_;   // [halves]
    std::vector<DenseHalf> dense_;  // [halves]
    std::vector<ErrorMap> maps_;
};

void addFigure(ErrorFigure& sum, const ErrorFigure& figure, double share) {
    sum.relativeRmse += share * figure.relativeRmse;
    sum.geometric += share * figure.geometric;
    sum.tilted += share * figure.tilted;
    sum.psnrDb += share * figure.psnrDb;
    sum.noise += share * figure.noise;
}

ErrorBlock meanOf(const std::vector<ErrorBlock>& blocks) {
    const auto lit =
        std::count_if(blocks.begin(), blocks.end(), [](const ErrorBlock& block) { return !block.isDark; });
    ErrorBlock mean;
    mean.environment = "mean";
    mean.isDark = lit == 0;
    const double share = 1 / std::max(1.0, double(lit));
    for (const ErrorBlock& block : blocks) {
        if (block.isDark) continue;
        mean.truthNoise += share * block.truthNoise;
        addFigure(mean.total, block.total, share);
        for (size_t stage = 0; stage < kErrorStages; ++stage) {
            addFigure(mean.alone[stage], block.alone[stage], share);
            addFigure(mean.without[stage], block.without[stage], share);
            addFigure(mean.upTo[stage], block.upTo[stage], share);
        }
        addFigure(mean.plain, block.plain, share);
        addFigure(mean.bands, block.bands, share);
        addFigure(mean.lookup, block.lookup, share);
        addFigure(mean.weights, block.weights, share);
        addFigure(mean.tableFormat, block.tableFormat, share);
    }
    return mean;
}

}  // namespace

const char* errorStageName(ErrorStage stage) {
    constexpr std::array<const char*, kErrorStages> names{"sampling", "truncation",   "projection",
                                                          "pca",      "quantisation", "tables"};
    return names[size_t(stage)];
}

ErrorResult studyError(const JudgedBundle& bundle, const RayCaster& caster, const JudgedPoints& points,
                       std::span<const Environment> environments, const ErrorStudy& study) {
    PRT_CHECK(!environments.empty());
    PRT_CHECK(!points.place.empty());
    if (study.rays < kFewestErrorRays || study.rays > kMaxBakeRays)
        throw UsageError("--rays", fmt::format("{} is out of range", study.rays),
                         fmt::format("choose {} to {}", kFewestErrorRays, kMaxBakeRays));
    ErrorStudyRun run(bundle, caster, points, environments, study);
    ErrorResult result = run.run(environments);
    result.isCompressed = bundle.pca.has_value();
    result.mean = meanOf(result.environments);
    return result;
}

}  // namespace prt::tools
