// Errors of PCA-compressed visibility in irradiance, and the claims of [IwanickiSloan2012, Sec. 5].
#include "tools/measure/compression.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "compress/quantize.h"
#include "compress/relit_error.h"
#include "compress/tables/normal_tables.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/math/environment.h"
#include "precompute/math/sh.h"
#include "tools/measure/projection.h"
#include "tools/measure/surface_points.h"

namespace prt::tools {
namespace {

constexpr double kFaithful = 1.1;               // of the error that uncompressed visibility has
const std::vector<double> kTiltsDeg = {0, 20};  // the normals of RelitProbe: one, and four tilted

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

double relativeRmse(std::span<const float> estimate, std::span<const float> truth) {
    double error = 0, square = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        const double d = double(estimate[i]) - double(truth[i]);
        error += d * d;
        square += double(truth[i]) * double(truth[i]);
    }
    return square > 0 ? std::sqrt(error / square) : 0;
}

// The same light without the bands from `lightOrder` on, in as many coefficients.
EnvironmentSh cut(const EnvironmentSh& environment, int lightOrder) {
    EnvironmentSh result = environment;
    if (lightOrder < environment.shOrder)
        for (std::vector<float>& colour : result.rgb)
            std::fill(colour.begin() + shCount(lightOrder), colour.end(), 0.0f);
    return result;
}

std::vector<float> asHalf(std::span<const float> values) {
    std::vector<float> result;
    for (const float value : values)
        result.push_back(floatFromHalf(halfFromFloat(std::clamp(value, -kMaxHalf, kMaxHalf))));
    return result;
}

// Visibility at the judged points, one way to store it.
struct StoredRows {
    int components = 0;
    std::vector<float> exact, shipped;  // [points×n²]
};

class OrderStudy {
  public:
    OrderStudy(CompressionScene& scene, const CompressionStudy& study, std::span<const SurfacePoint> points,
               const IrradianceJudge& judge, int shOrder)
        : scene_(scene), study_(study), points_(points), judge_(judge), shOrder_(shOrder) {
        const VisibilityMap& map = scene.visibility(shOrder);
        const size_t columns = size_t(shCount(shOrder));
        stored_.push_back(
            {0, at(map.grid, map.coefficients, columns), at(map.grid, asHalf(map.coefficients), columns)});
        for (const int components : componentsOf(study.components, shOrder)) {
            throwIfInterrupted();
            stored_.push_back(compressed(map, components));
        }
        for (const SurfacePoint& point : points) normals_.push_back(point.normal);
    }

    void run(const std::vector<Environment>& environments, CompressionResult& result) const {
        std::vector<EnvironmentSh> lights;
        const int bands = std::max(tableEnvironmentShOrder(shOrder_), kMostLightBands);
        for (const Environment& environment : environments)
            lights.push_back(projectEnvironment(environment.view(), bands));
        const RelitProbe probe(shOrder_, normals_, {}, lights, normals_.size());
        for (const StoredRows& stored : stored_) result.rows.push_back(row(stored, probe));
        result.orders.push_back(
            {shOrder_, againstTruth(scene_.bakePoints(points_, shOrder_)), againstTruth(stored_[0].exact)});
        runLightOrders(lights, result);
    }

  private:
    std::vector<float> at(const PointGrid& grid, std::span<const float> values, size_t perPoint) const {
        return interpolate(scene_.scene(), grid, points_, values, perPoint);
    }

    StoredRows compressed(const VisibilityMap& map, int components) const {
        const PcaMap pca = compressMap(map, components, scene_.fit());
        const std::vector<float> shipped = shippedWeights(pca, validPoints(map), study_.encoding);
        const size_t count = size_t(components);
        return {components, reconstruct(pca, at(map.grid, pca.weights, count)),
                reconstruct(pca, at(map.grid, shipped, count))};
    }

    double againstTruth(std::span<const float> rows) const {
        const double level = judge_.relativeRmse(rows, shOrder_, 0),
                     tilted = judge_.relativeRmse(rows, shOrder_, 1);
        return std::sqrt((level * level + 4 * tilted * tilted) / 5);
    }

    CompressionRow row(const StoredRows& stored, const RelitProbe& probe) const {
        const std::vector<float>& uncompressed = stored_[0].exact;
        const bool isPca = stored.components > 0;
        const int values = isPca ? stored.components : shCount(shOrder_);
        CompressionRow row;
        row.shOrder = shOrder_;
        row.components = stored.components;
        row.bytes = shippedBytes(values, isPca ? study_.encoding : "half");
        row.cost = pixelCost(values, isPca, scene_.visibility(shOrder_).grid.domain);
        row.coefficients = relativeRmse(stored.exact, uncompressed);
        row.compression = mean(probe.relativeRmse(uncompressed, stored.exact));
        row.shipped = mean(probe.relativeRmse(uncompressed, stored.shipped));
        row.truth = againstTruth(stored.shipped);
        return row;
    }

    void runLightOrders(const std::vector<EnvironmentSh>& lights, CompressionResult& result) const {
        const size_t first = result.lights.size(), orders = study_.lightOrders.size();
        result.lights.resize(first + (stored_.size() - 1) * orders);
        for (size_t k = 0; k < orders; ++k) {
            throwIfInterrupted();
            const int lightOrder = study_.lightOrders[k];
            std::vector<EnvironmentSh> few;
            for (const EnvironmentSh& light : lights) few.push_back(cut(light, lightOrder));
            const RelitProbe probe(shOrder_, normals_, {}, few, normals_.size());
            for (size_t s = 1; s < stored_.size(); ++s)
                result.lights[first + (s - 1) * orders + k] = {
                    shOrder_, stored_[s].components, lightOrder,
                    mean(probe.relativeRmse(stored_[0].exact, stored_[s].exact))};
        }
    }

    CompressionScene& scene_;
    const CompressionStudy& study_;
    std::span<const SurfacePoint> points_;
    const IrradianceJudge& judge_;
    int shOrder_;
    std::vector<Vec3f> normals_;
    std::vector<StoredRows> stored_;  // [0]: uncompressed
};

}  // namespace

std::vector<int> componentsOf(const std::vector<int>& components, int shOrder) {
    std::vector<int> result;
    for (const int count : components)
        if (count < shCount(shOrder)) result.push_back(count);
    result.push_back(shCount(shOrder));
    return result;
}

CompressionResult studyCompression(CompressionScene& scene, const std::vector<Environment>& environments,
                                   const CompressionStudy& study) {
    PRT_CHECK(!study.orders.empty() && !environments.empty());
    const std::vector<SurfacePoint> points =
        outsidePoints(scene.caster(), scene.scene(), size_t(study.points), study.seed);
    const IrradianceJudge judge(scene.caster(), points, environments, kTiltsDeg,
                                *std::max_element(study.orders.begin(), study.orders.end()), study.seed);
    CompressionResult result;
    result.points = int(points.size());
    for (const int shOrder : study.orders) {
        result.domain = scene.visibility(shOrder).grid.domain;
        OrderStudy(scene, study, points, judge, shOrder).run(environments, result);
    }
    return result;
}

std::vector<CompressionClaim> checkClaims(const CompressionResult& result) {
    std::vector<CompressionClaim> claims;
    for (const std::pair<int, int>& said : {std::pair{4, 12}, std::pair{6, 16}, std::pair{6, 24}}) {
        const int shOrder = said.first, components = said.second;
        const auto order = std::find_if(result.orders.begin(), result.orders.end(),
                                        [&](const CompressionOrder& o) { return o.shOrder == shOrder; });
        if (order == result.orders.end()) continue;
        CompressionClaim claim{shOrder, components, -1, order->truncation, 0, order->uncompressed};
        for (const CompressionRow& row : result.rows) {
            if (row.shOrder != shOrder || row.components == 0) continue;
            const bool isEnough = row.compression <= order->truncation,
                       isFaithful = row.truth <= kFaithful * order->uncompressed;
            if (claim.leastEnough == 0 && isEnough) claim.leastEnough = row.components;
            if (claim.leastFaithful == 0 && isFaithful) claim.leastFaithful = row.components;
            if (row.components != components) continue;
            claim.compression = row.compression;
            claim.truth = row.truth;
            claim.isEnough = isEnough;
            claim.isFaithful = isFaithful;
        }
        if (claim.compression >= 0) claims.push_back(claim);
    }
    return claims;
}

std::vector<LightSensitivity> lightSensitivity(const CompressionResult& result) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    std::vector<LightSensitivity> all;
    for (const LightOrderRow& row : result.lights) {
        if (row.lightOrder < 3) continue;
        if (all.empty() || all.back().shOrder != row.shOrder || all.back().components != row.components)
            all.push_back({row.shOrder, row.components, row.compression, row.compression, kNone, kNone});
        LightSensitivity& last = all.back();
        last.lowest = std::min(last.lowest, row.compression);
        last.highest = std::max(last.highest, row.compression);
        if (row.lightOrder < row.shOrder + 2) continue;
        last.lowestSeen = std::fmin(last.lowestSeen, row.compression);  // these two pass over NaN
        last.highestSeen = std::fmax(last.highestSeen, row.compression);
    }
    return all;
}

}  // namespace prt::tools
