// Sampling errors of visibility as irradiance shows them. What is estimated: [IwanickiSloan2012, Sec. 3] and
// its weighted form (precompute/math/irradiance_projection.h).
#include "tools/measure/sampling.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "precompute/math/irradiance_projection.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/accumulate.h"
#include "tools/measure/basis_signals.h"
#include "tools/measure/surface_points.h"

namespace prt::tools {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr size_t kChunk = 1024;  // directions between two sums in double

}  // namespace

struct VisibilityEstimator::State {
    int shOrder;
    std::optional<CosineTable> weight;  // none: plain projection
    std::optional<IrradianceProjection> projection;
};

VisibilityEstimator::VisibilityEstimator(int shOrder, const Projection& projection)
    : state_(std::make_unique<State>(State{shOrder, {}, {}})) {
    if (projection.kind == ProjectionKind::Plain) return;
    state_->weight.emplace(irradianceWeightTable(projection.weight));
    state_->projection.emplace(shOrder, projection.weight);
}
VisibilityEstimator::~VisibilityEstimator() = default;

VisibilityEstimator::Estimate VisibilityEstimator::estimate(const RayCaster& caster,
                                                            const SurfacePoint& point,
                                                            std::span<const Vec3f> directions,
                                                            std::span<float> out) const {
    const auto coefficients = Eigen::Index(shCount(state_->shOrder));
    PRT_CHECK_EQ(out.size(), size_t(coefficients));
    const std::vector<float> visible = traceVisibility(caster, point, directions);
    Estimate result;
    double open = 0, seen = 0;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(coefficients);
    std::vector<Vec3f> chunk;
    std::vector<float> weights, basis(kChunk * out.size());
    const auto flush = [&] {
        evalShBatch(state_->shOrder, chunk, std::span(basis).first(chunk.size() * out.size()));
        const Eigen::Map<const Eigen::MatrixXf> columns(basis.data(), coefficients,
                                                        Eigen::Index(chunk.size()));
        const Eigen::Map<const Eigen::VectorXf> values(weights.data(), Eigen::Index(chunk.size()));
        sum += (columns * values).cast<double>();
        chunk.clear();
        weights.clear();
    };
    for (size_t k = 0; k < directions.size(); ++k) {
        const float cosine = std::min(1.0f, point.normal.dot(directions[k]));
        if (!(cosine > 0)) continue;
        ++result.rays;
        open += double(cosine);
        if (visible[k] == 0) continue;
        seen += double(cosine);
        chunk.push_back(directions[k]);
        weights.push_back(state_->weight ? (*state_->weight)(cosine) : 1.0f);
        if (chunk.size() == kChunk) flush();
    }
    if (!chunk.empty()) flush();
    if (open > 0) result.ao = seen / open;
    sum *= 4 * std::numbers::pi / double(directions.size());
    Eigen::Map<Eigen::VectorXf>(out.data(), coefficients) = sum.cast<float>();
    if (state_->projection)
        state_->projection->solve(point.normal, out, float(result.ao * std::numbers::pi), out);
    return result;
}

std::vector<Vec3f> truthDirections(int count) {
    // No multiple of a symmetry of the sets, which stand upright.
    const Mat3d turn = Eigen::Quaterniond(0.61, -0.37, 0.52, 0.44).normalized().toRotationMatrix();
    std::vector<Vec3f> directions = sphericalFibonacci(count);
    for (Vec3f& direction : directions)
        direction = (turn * direction.cast<double>()).normalized().cast<float>();
    return directions;
}

namespace {

// One mesh: its points, their truth, and errors of anything else.
class MeshStudy {
  public:
    MeshStudy(const Scene& scene, const SamplingStudy& study)
        : study_(study),
          coefficients_(size_t(shCount(study.shOrder))),
          caster_(scene.positions, scene.indices),
          points_(outsidePoints(caster_, scene, size_t(study.points), study.seed)),
          estimator_(study.shOrder, study.projection),
          norm_(study.shOrder),
          truth_(points_.size() * coefficients_) {
        const std::vector<Vec3f> directions = truthDirections(study.truth);
        std::vector<double> ao(points_.size()), squares(points_.size());
        Progress progress("truth", points_.size(), "points");
        overPoints([&](size_t p) {
            const std::span<float> truth = std::span(truth_).subspan(p * coefficients_, coefficients_);
            ao[p] = estimator_.estimate(caster_, points_[p], directions, truth).ao;
            squares[p] = std::pow(norm_.evaluate(points_[p].normal, truth), 2);
            progress.advance(1);
        });
        for (size_t p = 0; p < points_.size(); ++p) {
            aoSum_ += ao[p];
            truthSum_ += squares[p];
        }
    }

    size_t points() const { return points_.size(); }
    double meanAo() const { return aoSum_ / double(points_.size()); }

    /// Sets of one kind and size, over all seeds.
    SamplingRow estimated(DirectionSetKind kind, int count, bool rotated) const {
        const bool seeded = kind != DirectionSetKind::Fibonacci;
        const int seeds = seeded || rotated ? study_.seeds : 1;
        double rays = 0, sum = 0;
        for (int s = 0; s < seeds; ++s) {
            const uint64_t seed = study_.seed * 1000003 + uint64_t(s);
            const std::vector<Vec3f> set = makeDirectionSet(kind, count, seed);
            SignalRandom random(seed);
            std::vector<Mat3d> turns;
            for (size_t p = 0; rotated && p < points(); ++p) turns.push_back(random.rotation());
            std::vector<double> traced(points()), errors(points());
            overPoints([&](size_t p) {
                std::vector<Vec3f> directions = set;
                if (rotated)
                    for (Vec3f& d : directions) d = (turns[p] * d.cast<double>()).normalized().cast<float>();
                std::vector<float> estimate(coefficients_);
                traced[p] = double(estimator_.estimate(caster_, points_[p], directions, estimate).rays);
                errors[p] = errorOf(p, estimate);
            });
            for (size_t p = 0; p < points(); ++p) {
                rays += traced[p];
                sum += errors[p] * errors[p];
            }
        }
        const std::string name = directionSetNames()[size_t(kind)] + (rotated ? "-rotated" : "");
        return row(name, count, rays / seeds, sum / seeds);
    }

    /// Uniform with `rays` directions where error is 0.
    SamplingRow baked(int rays, double error) const {
        BakeOptions options;
        options.shOrder = study_.shOrder;
        options.projection = study_.projection;
        options.findInside = false;
        options.rays = rays;
        options.error = error;
        const BakeResult result = bakeVisibility(caster_, points_, options);
        PRT_CHECK_EQ(result.error.size(), points());
        double sum = 0, estimatedSum = 0, belowError = 0, belowEstimate = 0;
        for (size_t p = 0; p < points(); ++p) {
            const double actual =
                errorOf(p, std::span(result.coefficients).subspan(p * coefficients_, coefficients_));
            const double estimate = double(result.error[p]);
            sum += actual * actual;
            estimatedSum += estimate * estimate;
            belowError += actual <= error;
            belowEstimate += actual <= 2 * estimate;
        }
        const double count = double(points());
        SamplingRow made = error > 0 ? row("adaptive-fibonacci", kNone, double(result.rays), sum)
                                     : row("fibonacci", rays, double(result.rays), sum);
        made.estimated = std::sqrt(estimatedSum / count);
        made.belowTwiceEstimate = belowEstimate / count;
        if (error > 0) {
            made.error = error;
            made.belowError = belowError / count;
        }
        return made;
    }

  private:
    template <class Body>
    void overPoints(const Body& body) const {
        parallelFor(points(), 1, [&](size_t begin, size_t end) {
            for (size_t p = begin; p < end; ++p) {
                throwIfInterrupted();
                body(p);
            }
        });
    }
    double errorOf(size_t p, std::span<const float> coefficients) const {
        std::vector<float> difference(coefficients_);
        for (size_t i = 0; i < coefficients_; ++i)
            difference[i] = coefficients[i] - truth_[p * coefficients_ + i];
        return norm_.evaluate(points_[p].normal, difference);
    }
    // @param rays, squares  sums over the points
    SamplingRow row(const std::string& set, double directions, double rays, double squares) const {
        const double count = double(points());
        return {set,
                directions,
                rays / count,
                std::sqrt(squares / truthSum_),
                std::sqrt(squares / count),
                kNone,
                kNone,
                kNone,
                kNone};
    }

    const SamplingStudy& study_;
    size_t coefficients_;
    RayCaster caster_;
    std::vector<SurfacePoint> points_;
    VisibilityEstimator estimator_;
    IrradianceNorm norm_;
    std::vector<float> truth_;  // [points × n²]
    double aoSum_ = 0, truthSum_ = 0;
};

// Where value y of a rising or falling curve is passed first, between logarithms.
double crossing(std::span<const SamplingRow> curve, double SamplingRow::*x, double SamplingRow::*y,
                double value) {
    for (size_t i = 0; i + 1 < curve.size(); ++i) {
        const double y0 = std::log(curve[i].*y), y1 = std::log(curve[i + 1].*y), at = std::log(value);
        if (!((y0 - at) * (y1 - at) <= 0)) continue;
        const double t = y0 == y1 ? 0 : (at - y0) / (y1 - y0);
        return std::exp(std::lerp(std::log(curve[i].*x), std::log(curve[i + 1].*x), t));
    }
    return kNone;
}

std::vector<SamplingRow> curveOf(std::span<const SamplingRow> rows, const std::string& set) {
    std::vector<SamplingRow> curve;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(curve),
                 [&](const SamplingRow& row) { return row.set == set; });
    return curve;
}

}  // namespace

SamplingResult studySampling(const Scene& scene, const SamplingStudy& study) {
    PRT_CHECK(!study.counts.empty());
    const MeshStudy mesh(scene, study);
    SamplingResult result{mesh.meanAo(), int(mesh.points()), {}};
    std::vector<SamplingRow> adaptive;
    for (const double error : study.errors) adaptive.push_back(mesh.baked(1, error));
    double least = std::numeric_limits<double>::infinity();
    for (const SamplingRow& row : adaptive) least = std::min(least, row.rms);
    for (const DirectionSetKind kind : study.sets)
        for (const bool rotated : {false, true}) {
            if (rotated && !study.rotated) continue;
            const bool asBaked = kind == DirectionSetKind::Fibonacci && !rotated;
            for (const int count : study.counts)
                result.rows.push_back(asBaked ? mesh.baked(count, 0) : mesh.estimated(kind, count, rotated));
            if (!asBaked || adaptive.empty()) continue;
            for (int count = 2 * study.counts.back();
                 count <= study.truth / 4 && result.rows.back().rms > least; count *= 2)
                result.rows.push_back(mesh.baked(count, 0));
        }
    result.rows.insert(result.rows.end(), adaptive.begin(), adaptive.end());
    return result;
}

SamplingEffort effortAt(std::span<const SamplingRow> rows, const std::string& set, double rms) {
    const std::vector<SamplingRow> curve = curveOf(rows, set);
    return {crossing(curve, &SamplingRow::directions, &SamplingRow::rms, rms),
            crossing(curve, &SamplingRow::rays, &SamplingRow::rms, rms)};
}

double rmsAt(std::span<const SamplingRow> rows, const std::string& set, double directions) {
    return crossing(curveOf(rows, set), &SamplingRow::rms, &SamplingRow::directions, directions);
}

}  // namespace prt::tools
