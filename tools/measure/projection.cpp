// Irradiance of projected visibility against brute force, per point: every texel of an environment is a light
// of its own.
#include "tools/measure/projection.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "compress/compress_visibility.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "precompute/math/environment.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/bake.h"
#include "tools/measure/surface_points.h"

namespace prt::tools {
namespace {

using RowMatrixXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr Eigen::Index kChunk = 1024;  // directions between two sums in double

FloatImage halved(const FloatImage& image) {
    FloatImage half{image.width / 2, image.height / 2, image.channels, {}};
    half.pixels.resize(size_t(half.width) * size_t(half.height) * size_t(half.channels));
    for (int y = 0; y < half.height; ++y)
        for (int x = 0; x < half.width; ++x)
            for (int c = 0; c < half.channels; ++c)
                half.at(x, y)[c] = (image.at(2 * x, 2 * y)[c] + image.at(2 * x + 1, 2 * y)[c] +
                                    image.at(2 * x, 2 * y + 1)[c] + image.at(2 * x + 1, 2 * y + 1)[c]) /
                                   4;
    return half;
}

// Environments of one size: they share directions.
struct LightGroup {
    std::vector<Vec3f> directions;
    std::vector<float> basis;  // [K×n²]
    RowMatrixXf light;         // [K×3·environments] L ΔΩ
    Eigen::Index firstChannel = 0;
};

void makeDirections(LightGroup& group, int width, int height, int shOrder) {
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            group.directions.push_back(
                latLongDirection(x + 0.5, y + 0.5, width, height).cast<float>().normalized());
    group.basis.resize(group.directions.size() * size_t(shCount(shOrder)));
    evalShBatch(shOrder, group.directions, group.basis);
}

std::vector<LightGroup> makeGroups(std::span<const Environment> environments, int shOrder) {
    std::map<std::pair<int, int>, std::vector<FloatImage>> bySize;
    for (const Environment& environment : environments) {
        FloatImage image = environment.image;
        while (image.width > kWidestJudgedImage && image.width % 2 == 0 && image.height % 2 == 0)
            image = halved(image);
        bySize[{image.width, image.height}].push_back(std::move(image));
    }
    std::vector<LightGroup> groups;
    Eigen::Index channel = 0;
    for (const auto& [size, images] : bySize) {
        const auto [width, height] = size;
        LightGroup& group = groups.emplace_back();
        makeDirections(group, width, height, shOrder);
        group.firstChannel = channel;
        group.light.resize(Eigen::Index(group.directions.size()), Eigen::Index(3 * images.size()));
        for (size_t e = 0; e < images.size(); ++e)
            for (Eigen::Index k = 0; k < group.light.rows(); ++k) {
                const int y = int(k) / width, x = int(k) % width;
                const float solidAngle = float(latLongTexelSolidAngle(y, width, height));
                for (Eigen::Index c = 0; c < 3; ++c)
                    group.light(k, Eigen::Index(3 * e) + c) = images[e].at(x, y)[c] * solidAngle;
            }
        channel += group.light.cols();
    }
    return groups;
}

// A normal tilted from n towards a given azimuth.
Vec3f tilted(const Vec3f& n, double tiltDeg, double azimuthRad) {
    const Frame frame = frameAround(n);
    const double tilt = tiltDeg * std::numbers::pi / 180;
    const Vec3d side = std::cos(azimuthRad) * frame.tangent.cast<double>() +
                       std::sin(azimuthRad) * frame.bitangent.cast<double>();
    return (std::cos(tilt) * n.cast<double>() + std::sin(tilt) * side).normalized().cast<float>();
}

// Σ_k [Y | V]ᵀ H L ΔΩ: rows of transfer, then the truth.
Eigen::MatrixXd integrate(const LightGroup& group, std::span<const float> visible, const Vec3f& shadingNormal,
                          Eigen::Index coefficients) {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(coefficients + 1, group.light.cols());
    RowMatrixXf basis(kChunk, coefficients + 1), light(kChunk, group.light.cols());
    Eigen::MatrixXf product(coefficients + 1, group.light.cols());
    Eigen::Index filled = 0;
    const auto flush = [&] {
        product.noalias() = basis.topRows(filled).transpose() * light.topRows(filled);
        sum += product.cast<double>();
        filled = 0;
    };
    for (size_t k = 0; k < group.directions.size(); ++k) {
        const float cosine = shadingNormal.dot(group.directions[k]);
        if (!(cosine > 0)) continue;
        basis.row(filled).head(coefficients) =
            Eigen::Map<const Eigen::RowVectorXf>(&group.basis[k * size_t(coefficients)], coefficients);
        basis(filled, coefficients) = visible[k];
        light.row(filled) = cosine * group.light.row(Eigen::Index(k));
        if (++filled == kChunk) flush();
    }
    if (filled > 0) flush();
    return sum;
}

}  // namespace

IrradianceJudge::IrradianceJudge(const RayCaster& caster, std::span<const SurfacePoint> points,
                                 std::span<const Environment> environments, std::span<const double> tiltsDeg,
                                 int shOrder, uint64_t seed)
    : points_(points.size()),
      tilts_(tiltsDeg.size()),
      channels_(3 * environments.size()),
      coefficients_(size_t(shCount(shOrder))),
      transfer_(points_ * tilts_ * coefficients_ * channels_),
      truth_(points_ * tilts_ * channels_) {
    const std::vector<LightGroup> groups = makeGroups(environments, shOrder);
    std::mt19937_64 random(seed);
    std::vector<double> azimuths(points_ * tilts_);
    for (double& azimuth : azimuths) azimuth = 2 * std::numbers::pi * double(random() >> 11) * 0x1p-53;
    Progress progress("judging", points_, "points");
    parallelFor(points_, 1, [&](size_t begin, size_t end) {
        for (size_t p = begin; p < end; ++p) {
            throwIfInterrupted();
            for (const LightGroup& group : groups) {
                const std::vector<float> visible = traceVisibility(caster, points[p], group.directions);
                for (size_t t = 0; t < tilts_; ++t) {
                    const size_t place = p * tilts_ + t;
                    const Vec3f normal = tilted(points[p].normal, tiltsDeg[t], azimuths[place]);
                    const RowMatrixXf sums =
                        integrate(group, visible, normal, Eigen::Index(coefficients_)).cast<float>();
                    for (size_t i = 0; i <= coefficients_; ++i)
                        std::copy_n(sums.row(Eigen::Index(i)).data(), sums.cols(),
                                    (i < coefficients_ ? &transfer_[(place * coefficients_ + i) * channels_]
                                                       : &truth_[place * channels_]) +
                                        group.firstChannel);
                }
            }
            progress.advance(1);
        }
    });
}

double IrradianceJudge::relativeRmse(std::span<const float> coefficients, int shOrder, size_t tilt) const {
    const size_t count = size_t(shCount(shOrder));
    PRT_CHECK_LE(count, coefficients_);
    PRT_CHECK_LT(tilt, tilts_);
    PRT_CHECK_LE(points_ * count, coefficients.size());
    struct Sums {
        double error = 0, square = 0;
    };
    std::vector<Sums> sums(channels_ / 3);
    std::vector<double> estimate(channels_);
    for (size_t p = 0; p < points_; ++p) {
        const size_t place = p * tilts_ + tilt;
        std::fill(estimate.begin(), estimate.end(), 0.0);
        for (size_t i = 0; i < count; ++i) {
            const double c = double(coefficients[p * count + i]);
            const float* transfer = &transfer_[(place * coefficients_ + i) * channels_];
            for (size_t j = 0; j < channels_; ++j) estimate[j] += c * double(transfer[j]);
        }
        for (size_t j = 0; j < channels_; ++j) {
            const double truth = double(truth_[place * channels_ + j]), difference = estimate[j] - truth;
            sums[j / 3].error += difference * difference;
            sums[j / 3].square += truth * truth;
        }
    }
    double sum = 0;
    size_t lit = 0;
    for (const Sums& environment : sums) {
        if (!(environment.square > 0)) continue;
        sum += std::sqrt(environment.error / environment.square);
        ++lit;
    }
    return lit ? sum / double(lit) : 0.0;
}

namespace {

// Bakes of one order, and what judges them.
struct OrderStudy {
    const ProjectionStudy& study;
    const IrradianceJudge& judge;
    std::span<const SurfacePoint> points;
    std::vector<Vec3f> normals;
    int shOrder;

    // Mean + Σ_m w_m basis_m of all points.
    std::vector<float> compressed(const BakeResult& baked, const Projection& projection,
                                  WeightsFit fit) const {
        const int dimension = shCount(shOrder);
        const CompressedVisibility result = compressVisibility(
            baked.coefficients, {}, normals, shOrder, projection, std::min(study.components, dimension), fit);
        const auto count = Eigen::Index(points.size()), components = Eigen::Index(result.pca.components);
        const Eigen::Map<const RowMatrixXf> weights(result.weights.data(), count, components),
            basis(result.pca.basis.data(), components, dimension);
        RowMatrixXf rows = weights * basis;
        rows.rowwise() += Eigen::Map<const Eigen::RowVectorXf>(result.pca.mean.data(), dimension);
        return {rows.data(), rows.data() + rows.size()};
    }

    std::vector<ProjectionRow> rows(const BakeResult& plain, const BakeResult& weighted) const {
        const Projection projection{ProjectionKind::Irradiance, study.weight};
        const std::vector<float> pcaPlain = compressed(plain, kPlainProjection, WeightsFit::Plain),
                                 pcaFitted = compressed(plain, kPlainProjection, WeightsFit::Irradiance),
                                 pcaWeighted = compressed(weighted, projection, WeightsFit::Irradiance);
        std::vector<ProjectionRow> result;
        for (size_t t = 0; t < study.tiltsDeg.size(); ++t) {
            const auto rmse = [&](std::span<const float> coefficients) {
                return judge.relativeRmse(coefficients, shOrder, t);
            };
            result.push_back({shOrder, study.tiltsDeg[t], rmse(plain.coefficients),
                              rmse(weighted.coefficients), rmse(pcaPlain), rmse(pcaFitted),
                              rmse(pcaWeighted)});
        }
        return result;
    }
};

}  // namespace

ProjectionResult studyProjection(const Scene& scene, std::span<const Environment> environments,
                                 const ProjectionStudy& study) {
    PRT_CHECK(!study.orders.empty());
    const RayCaster caster(scene.positions, scene.indices);
    const std::vector<SurfacePoint> points =
        outsidePoints(caster, scene, size_t(std::max(study.population, study.points)), study.seed);
    const IrradianceJudge judge(
        caster, std::span(points).first(std::min(points.size(), size_t(study.points))), environments,
        study.tiltsDeg, *std::max_element(study.orders.begin(), study.orders.end()), study.seed);
    std::vector<Vec3f> normals;
    for (const SurfacePoint& point : points) normals.push_back(point.normal);
    ProjectionResult result;
    for (const int shOrder : study.orders) {
        BakeOptions options;
        options.shOrder = shOrder;
        options.rays = study.rays;
        options.findInside = false;
        options.projection = kPlainProjection;
        const BakeResult plain = bakeVisibility(caster, points, options);
        options.projection = {ProjectionKind::Irradiance, study.weight};
        const BakeResult weighted = bakeVisibility(caster, points, options);
        const std::vector<ProjectionRow> rows =
            OrderStudy{study, judge, points, normals, shOrder}.rows(plain, weighted);
        result.rows.insert(result.rows.end(), rows.begin(), rows.end());
        result.meanAo = std::accumulate(plain.ao.begin(), plain.ao.end(), 0.0) / double(points.size());
    }
    return result;
}

}  // namespace prt::tools
