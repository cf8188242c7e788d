// Tables over the normal against evaluation at the normal: [IwanickiSloan2012, Sec. 3.2], where 16 to 32
// texels are found adequate, and Sec. 3.3, where the cosine has three bands.
#include "tools/measure/tables.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>

#include "compress/tables/fast_tables.h"
#include "compress/tables/normal_tables.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "precompute/math/sh.h"
#include "precompute/math/table_layout.h"
#include "tools/measure/timing.h"

namespace prt::tools {
namespace {

constexpr int kDirections = 2048;  // that visibility is projected with
constexpr size_t kPointBlock = 64;

/// Visibility of a half-space with up to four round blockers.
struct Blocked {
    struct Cap {
        Vec3f axis;
        float cosine;
    };
    Vec3f normal;
    std::vector<Cap> caps;

    bool sees(const Vec3f& direction) const {
        return normal.dot(direction) > 0 && std::none_of(caps.begin(), caps.end(), [&](const Cap& cap) {
                   return cap.axis.dot(direction) > cap.cosine;
               });
    }
};

/// Irradiance of points under one light, three colours each: [points][3].
std::vector<double> directIrradiance(const EnvironmentSh& light, const TableStudy& study,
                                     const TablePoints& points, int cosineBands) {
    const size_t n2 = size_t(shCount(study.shOrder)), count = points.normals.size();
    const std::vector<float> transfer = evalLightCosine(light, study.shOrder, points.normals, cosineBands);
    std::vector<double> result(count * 3, 0.0);
    for (size_t colour = 0; colour < 3; ++colour)
        for (size_t i = 0; i < n2; ++i)
            for (size_t k = 0; k < count; ++k)
                result[k * 3 + colour] +=
                    double(points.visibility[k * n2 + i]) * double(transfer[(colour * n2 + i) * count + k]);
    return result;
}

/// The same looked up in a table.
std::vector<double> tableIrradiance(std::span<const float> table, size_t texels, const TableStudy& study,
                                    const TablePoints& points, std::span<const SphereTaps> taps) {
    const size_t n2 = size_t(shCount(study.shOrder)), count = points.normals.size();
    std::vector<double> result(count * 3, 0.0);
    parallelFor(count, kPointBlock, [&](size_t begin, size_t end) {
        for (size_t layer = 0; layer < 3 * n2; ++layer) {
            const float* values = table.data() + layer * texels;
            for (size_t k = begin; k < end; ++k) {
                double value = 0;
                for (const SphereTap& tap : taps[k]) value += double(tap.weight) * double(values[tap.texel]);
                result[k * 3 + layer / n2] += value * double(points.visibility[k * n2 + layer % n2]);
            }
        }
    });
    return result;
}

double rms(std::span<const double> values) {
    double sum = 0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / double(values.size()));
}

struct Difference {
    double relativeRms, relativeWorst;
};
Difference difference(std::span<const double> values, std::span<const double> reference) {
    std::vector<double> errors(values.size());
    double worst = 0;
    for (size_t k = 0; k < values.size(); ++k) {
        errors[k] = values[k] - reference[k];
        worst = std::max(worst, std::abs(errors[k]));
    }
    const double scale = rms(reference);
    return scale > 0 ? Difference{rms(errors) / scale, worst / scale} : Difference{0, 0};
}

/// A builder and where its layout looks the points up.
struct Candidate {
    std::string variant;
    LightTableBuilder builder;
    std::vector<SphereTaps> taps;
};

std::vector<Candidate> makeCandidates(const TableStudy& study, const TablePoints& points) {
    std::vector<Candidate> candidates;
    for (const std::string& variant : study.variants)
        for (const std::string& name : study.layouts)
            for (const int size : study.sizes) {
                const TableLayout layout(name, size);
                Candidate candidate{
                    variant, LightTableBuilder(layout, study.shOrder, tableVariantBands(variant)), {}};
                for (const Vec3f& normal : points.normals)
                    candidate.taps.push_back(layout.taps(normal.cast<double>()));
                candidates.push_back(std::move(candidate));
            }
    return candidates;
}

TableCostRow costOf(Candidate& candidate, const TableStudy& study, const EnvironmentSh& light) {
    LightTableBuilder& builder = candidate.builder;
    const size_t n2 = size_t(shCount(study.shOrder));
    const size_t components = std::min(size_t(study.components), n2);
    std::vector<float> lightCosine(3 * n2 * builder.texelCount());
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    TableCostRow row{candidate.variant,
                     builder.layout().name(),
                     builder.layout().size(),
                     uint64_t(builder.texelCount()),
                     lightCosine.size() * sizeof(float),
                     kNone,
                     kNone};
    if (study.rounds == 0) return row;
    // Which vectors does not matter to the time.
    std::vector<float> basis(n2 * components, 0.5f), mean(n2, 1.0f);
    std::vector<float> triple(3 * (components + 1) * builder.texelCount());
    const std::vector<double> ns = timeMethods({{"light-cosine", 1,
                                                 [&] {
                                                     builder.buildLightCosine(light, lightCosine);
                                                     keepResult(lightCosine.data());
                                                 }},
                                                {"triple-product", 1,
                                                 [&] {
                                                     builder.buildTripleProduct(light, mean, basis, triple);
                                                     keepResult(triple.data());
                                                 }}},
                                               study.rounds);
    row.lightCosineMs = ns[0] * 1e-6;
    row.tripleMs = ns[1] * 1e-6;
    return row;
}

}  // namespace

const std::vector<std::string>& tableVariants() {
    static const std::vector<std::string> all = {"paper", "exact"};
    return all;
}

int tableVariantBands(const std::string& variant) {
    PRT_CHECK(variant == "paper" || variant == "exact");
    return variant == "paper" ? kPaperCosineBands : kTableCosineBands;
}

TablePoints makeTablePoints(const TableStudy& study) {
    std::mt19937_64 random(study.seed);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> uniform(0, 1);
    const auto direction = [&] {
        return Vec3f(Vec3f(normal(random), normal(random), normal(random)).normalized());
    };
    const std::vector<Vec3f> directions = sphericalFibonacci(kDirections);
    std::vector<float> values(directions.size());
    TablePoints points;
    for (int k = 0; k < study.points; ++k) {
        Blocked blocked{direction(), {}};
        const size_t caps = size_t(random() % 5);
        for (size_t c = 0; c < caps; ++c) {
            const float radiusRad = 0.1f + 0.6f * uniform(random);
            blocked.caps.push_back({direction(), std::cos(radiusRad)});
        }
        for (size_t d = 0; d < directions.size(); ++d) values[d] = blocked.sees(directions[d]) ? 1.0f : 0.0f;
        const std::vector<float> row = projectShSamples(study.shOrder, directions, values);
        points.visibility.insert(points.visibility.end(), row.begin(), row.end());
        // Uniform over the cone of shading normals.
        const float least = std::cos(float(study.coneDeg) * 0.0174532925f);
        const float cosine = 1 - uniform(random) * (1 - least);
        const Vec3f any = direction();
        const Vec3f across = (any - any.dot(blocked.normal) * blocked.normal).normalized();
        points.normals.push_back(
            (cosine * blocked.normal + std::sqrt(std::max(0.0f, 1 - cosine * cosine)) * across).normalized());
    }
    return points;
}

TableResult studyTables(const std::vector<Environment>& environments, const TableStudy& study) {
    PRT_CHECK(!environments.empty());
    const TablePoints points = makeTablePoints(study);
    std::vector<Candidate> candidates = makeCandidates(study, points);
    const int mostBands = kMaxShOrder + 1 - study.shOrder;
    TableResult result;
    for (const Environment& environment : environments) {
        throwIfInterrupted();
        const EnvironmentSh light = projectEnvironment(environment.view(), kMaxShOrder);
        const std::vector<double> truth = directIrradiance(light, study, points, mostBands);
        const std::vector<double> paper = directIrradiance(light, study, points, kPaperCosineBands);
        const std::vector<double> exact = directIrradiance(light, study, points, kTableCosineBands);
        result.variants.push_back(
            {environment.name, difference(paper, truth).relativeRms, difference(exact, truth).relativeRms});
        std::vector<float> table;
        for (Candidate& candidate : candidates) {
            throwIfInterrupted();
            LightTableBuilder& builder = candidate.builder;
            table.resize(size_t(3 * shCount(study.shOrder)) * builder.texelCount());
            builder.buildLightCosine(light, table);
            const std::vector<double> found =
                tableIrradiance(table, builder.texelCount(), study, points, candidate.taps);
            const Difference own = difference(found, candidate.variant == "paper" ? paper : exact);
            result.errors.push_back({environment.name, candidate.variant, builder.layout().name(),
                                     builder.layout().size(), own.relativeRms,
                                     difference(found, truth).relativeRms, own.relativeWorst});
        }
        if (&environment != &environments.back()) continue;
        for (Candidate& candidate : candidates) result.costs.push_back(costOf(candidate, study, light));
    }
    return result;
}

}  // namespace prt::tools
