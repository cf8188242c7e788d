// SH lightmaps [IwanickiSloan2012, Sec. 5]: radiosity [GoralEtAl1984] kept at the points of the surface and
// gathered by rays [Heckbert1990]. Two sampling densities joined by the balance heuristic [VeachGuibas1995];
// nets of [Owen1995].
#include "precompute/visibility/lightmap.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/math/direction_sets.h"
#include "precompute/math/directions.h"
#include "precompute/math/irradiance_projection.h"
#include "precompute/math/sh.h"
#include "precompute/math/split_mix.h"
#include "precompute/visibility/accumulate.h"
#include "precompute/visibility/find_inside.h"
#include "precompute/visibility/lightmap_points.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr size_t kBlockItems = 32;
constexpr size_t kFewestPartRays = 4;
constexpr int kFewestFieldRays = 64;
constexpr size_t kColumns = size_t(3) * kLightmapCoefficients;

// Irradiance at the points of the surface, as far as it has bounced.
struct LightField {
    std::vector<float> front;  // [grid.count×3]
    std::vector<float> back;   // the same of the other side; empty where no material is double-sided
};

// What is gathered at all items.
struct Gathered {
    std::vector<float> irradiance;    // [items×3] about the normals of the parts
    std::vector<float> facing;        // [items×3] about the items' normals
    std::vector<float> coefficients;  // [items×27], or empty
    std::vector<float> squaredError;  // [items] of facing, summed over colours
};

enum class Side { Front, Back };

// A density over the hemisphere, half of it uniform and half cosine-weighted: p = (1 + 2h) / 4π, h the
// cosine.
double hemispherePdf(double height) { return (1 + 2 * height) / (4 * kPi); }

// Directions that items take: kSampleSets sets, each of them a net, so that neighbours err differently and
// none of it is computed anew for every item.
class SampleSets {
  public:
    SampleSets(size_t rays, const EnvironmentSampler& light) : size_(std::bit_ceil(rays)) {
        const int count = int(size_ * kSampleSets);
        for (const auto& [u1, u2] : sobolOwenPoints(count, 1)) {
            // ∫ (1 + 2h)/2 dh = (h + h²)/2 = u
            const double height = (std::sqrt(1 + 8 * u1) - 1) / 2, angle = 2 * kPi * u2;
            const double radius = std::sqrt(std::max(0.0, 1 - height * height));
            hemisphere_.push_back(
                Vec3d(radius * std::cos(angle), radius * std::sin(angle), height).cast<float>());
        }
        if (light.dark()) return;
        for (const auto& [u1, u2] : sobolOwenPoints(count, 2)) towardsLight_.push_back(light.sample(u1, u2));
    }
    /// Any set.
    static size_t choose(uint64_t seed) { return size_t(SplitMix64{seed}.next() % kSampleSets); }
    /// Along the axes of a frame, the k-th of a set.
    const Vec3f& hemisphere(size_t set, size_t k) const { return hemisphere_[set * size_ + k % size_]; }
    const LightSample& towardsLight(size_t set, size_t k) const {
        return towardsLight_[set * size_ + k % size_];
    }

  private:
    static constexpr uint64_t kSampleSets = 32;
    size_t size_;
    std::vector<Vec3f> hemisphere_;
    std::vector<LightSample> towardsLight_;
};

// Sums of one part of an item, over the rays of both densities.
struct PartSum {
    float share = 0;
    size_t rays = 0;
    Vec3d irradiance = Vec3d::Zero();
    std::array<Vec3d, 2> facing{Vec3d::Zero(), Vec3d::Zero()};  // of each half of the rays
    std::array<double, kColumns> expansion{};
    InsideCount seen;
};

class Gatherer {
  public:
    struct Context {
        const RayCaster& caster;
        const SurfaceAlbedo& albedo;
        const LightmapPoints& points;
        const EnvironmentSampler& light;
        const SampleSets& samples;
        size_t rays = 0;
        uint64_t seed = 0;  // of the pass
        Side side = Side::Front;
        const LightField* field = nullptr;  // none: surfaces are black
        bool expand = false;
        const CosineTable* weight = nullptr;  // none: plain
    };

    explicit Gatherer(const Context& context) : c_(context), stream_(context.caster) {}
    uint64_t rays() const { return cast_; }

    // Sums of an item in sum(): shares are made to sum to 1.
    // @return false where it has no part on this side
    bool gather(size_t item) {
        start(item);
        if (sums_.empty()) return false;
        castOverHemisphere();
        if (!c_.light.dark()) castTowardsLight();
        combine();
        return true;
    }
    const PartSum& sum() const { return total_; }

  private:
    struct Ray {
        size_t part, half;
    };

    void start(size_t item) {
        itemNormal_ = c_.points.normal(item) * (c_.side == Side::Back ? -1.0f : 1.0f);
        set_ = SampleSets::choose((c_.seed << 40) + item);
        sums_.clear();
        origins_.clear();
        normals_.clear();
        for (const LightmapPart& part : c_.points.parts(item)) {
            if (c_.side == Side::Back && !c_.albedo.doubleSided(part.point.triangle)) continue;
            PartSum sum;
            sum.share = part.share;
            // An even number, so that the halves are alike.
            sum.rays =
                std::max(kFewestPartRays, 2 * size_t(std::lround(double(part.share) * double(c_.rays) / 2)));
            sums_.push_back(sum);
            normals_.push_back(part.point.normal * (c_.side == Side::Back ? -1.0f : 1.0f));
            origins_.push_back(c_.caster.offsetOrigin(part.point.position, normals_.back()));
        }
    }

    // Expected number of rays per steradian, of both densities, in a direction of a part.
    double density(const PartSum& sum, double height, float lightPdf) const {
        return double(sum.rays) * (hemispherePdf(height) + double(lightPdf));
    }

    void castOverHemisphere() {
        rayOrigins_.clear();
        rayDirections_.clear();
        rays_.clear();
        size_t k = 0;
        for (size_t p = 0; p < sums_.size(); ++p) {
            const Frame frame = frameAround(normals_[p]);
            for (size_t j = 0; j < sums_[p].rays; ++j, ++k) {
                const Vec3f& local = c_.samples.hemisphere(set_, k);
                rayOrigins_.push_back(origins_[p]);
                rayDirections_.push_back(
                    (local.x() * frame.tangent + local.y() * frame.bitangent + local.z() * frame.normal)
                        .normalized());
                rays_.push_back({p, j * 2 < sums_[p].rays ? size_t(0) : size_t(1)});
            }
        }
        hits_.resize(rays_.size());
        c_.caster.firstHits(rayOrigins_, rayDirections_, hits_);
        cast_ += rays_.size();
        for (size_t r = 0; r < rays_.size(); ++r) {
            PartSum& sum = sums_[rays_[r].part];
            const double height = double(normals_[rays_[r].part].dot(rayDirections_[r]));
            ++sum.seen.rays;
            if (!(height > 0)) continue;
            if (hits_[r].triangle == RayHit{}.triangle) {
                const LightSample light = c_.light.evaluate(rayDirections_[r]);
                add(rays_[r], light.direction, light.radiance / density(sum, height, light.pdf), height);
                continue;
            }
            ++sum.seen.hits;
            const bool black = hits_[r].backFace && !c_.albedo.doubleSided(hits_[r].triangle);
            sum.seen.backs += black;
            // Only these rays find light that was reflected.
            if (!black && c_.field)
                add(rays_[r], rayDirections_[r],
                    reflected(hits_[r]) / (double(sum.rays) * hemispherePdf(height)), height);
        }
    }

    void castTowardsLight() {
        size_t k = 0;
        stream_.clear();
        waiting_.clear();
        for (size_t p = 0; p < sums_.size(); ++p)
            for (size_t j = 0; j < sums_[p].rays; ++j, ++k) {
                const LightSample& light = c_.samples.towardsLight(set_, k);
                const double height = double(normals_[p].dot(light.direction));
                if (!(height > 0)) continue;
                stream_.add(origins_[p], light.direction);
                waiting_.push_back({{p, j * 2 < sums_[p].rays ? size_t(0) : size_t(1)}, light, height});
                if (stream_.size() == RayStream::kCapacity) castWaiting();
            }
        castWaiting();
    }
    void castWaiting() {
        stream_.cast();
        cast_ += waiting_.size();
        for (size_t i = 0; i < waiting_.size(); ++i) {
            if (stream_.blocked(i)) continue;
            const auto& [ray, light, height] = waiting_[i];
            add(ray, light.direction, light.radiance / density(sums_[ray.part], height, light.pdf), height);
        }
        stream_.clear();
        waiting_.clear();
    }

    // Radiance that the hit sends back; same for every direction.
    Vec3f reflected(const RayHit& hit) const {
        const std::vector<float>& field = hit.backFace ? c_.field->back : c_.field->front;
        return c_.albedo.at(hit.triangle, hit.u, hit.v)
                   .cwiseProduct(c_.points.at(field, hit.triangle, hit.u, hit.v)) /
               float(kPi);
    }

    // @param light  radiance over the density of rays
    void add(const Ray& ray, const Vec3f& direction, const Vec3f& light, double height) {
        PartSum& sum = sums_[ray.part];
        const Vec3d value = light.cast<double>();
        sum.irradiance += height * value;
        const float facing = std::clamp(itemNormal_.dot(direction), -1.0f, 1.0f);
        if (facing > 0) sum.facing[ray.half] += double(facing) * value;
        if (!c_.expand) return;
        std::array<float, kLightmapCoefficients> basis{};
        evalSh(kLightmapShOrder, direction, basis);
        const double weight = c_.weight ? double((*c_.weight)(facing)) : 1.0;
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < basis.size(); ++i)
                sum.expansion[c * basis.size() + i] += weight * value[int(c)] * double(basis[i]);
    }

    void combine() {
        total_ = {};
        const bool allInside =
            std::all_of(sums_.begin(), sums_.end(), [](const PartSum& s) { return s.seen.isInside(); });
        double shares = 0;
        for (const PartSum& s : sums_)
            if (allInside || !s.seen.isInside()) shares += double(s.share);
        for (const PartSum& s : sums_) {
            if (!allInside && s.seen.isInside()) continue;
            const double share = double(s.share) / shares;
            total_.irradiance += share * s.irradiance;
            for (size_t h = 0; h < 2; ++h) total_.facing[h] += share * s.facing[h];
            for (size_t i = 0; i < kColumns; ++i) total_.expansion[i] += share * s.expansion[i];
        }
    }

    struct Waiting {
        Ray ray;
        LightSample light;
        double height;
    };
    const Context& c_;
    RayStream stream_;
    Vec3f itemNormal_ = Vec3f::UnitY();
    size_t set_ = 0;
    std::vector<PartSum> sums_;  // of the parts of the item
    PartSum total_;
    std::vector<Vec3f> origins_, normals_;  // of the parts
    std::vector<Vec3f> rayOrigins_, rayDirections_;
    std::vector<Ray> rays_;
    std::vector<RayHit> hits_;
    std::vector<Waiting> waiting_;
    uint64_t cast_ = 0;
};

// All passes over one set of points.
class LightmapBaker {
  public:
    LightmapBaker(const RayCaster& caster, const SurfaceAlbedo& albedo, const LightmapPoints& points,
                  const EnvironmentSampler& light, const LightmapOptions& options, bool twoSides)
        : caster_(caster),
          albedo_(albedo),
          points_(points),
          light_(light),
          options_(options),
          twoSides_(twoSides),
          progress_("lightmap", points.items() * size_t(1 + options.bounces * (twoSides ? 2 : 1)), "points") {
        if (options.projection.kind == ProjectionKind::Irradiance) {
            weight_.emplace(irradianceWeightTable(options.projection.weight));
            projection_.emplace(kLightmapShOrder, options.projection.weight);
        }
    }

    LightmapBake bake() {
        LightField field;
        for (int bounce = 0; bounce < options_.bounces; ++bounce) {
            LightField next;
            next.front =
                points_.spread(gather(bounce, bounce > 0 ? &field : nullptr, Side::Front).irradiance, 3);
            if (twoSides_)
                next.back =
                    points_.spread(gather(bounce, bounce > 0 ? &field : nullptr, Side::Back).irradiance, 3);
            field = std::move(next);
        }
        const Gathered last = gather(options_.bounces, options_.bounces > 0 ? &field : nullptr, Side::Front);
        LightmapBake result;
        result.coefficients = points_.spread(last.coefficients, kColumns);
        result.irradiance = points_.spread(last.facing, 3);
        result.rays = rays_;
        result.relativeError = relativeErrorOf(last);
        return result;
    }

  private:
    Gathered gather(int pass, const LightField* field, Side side) {
        const bool last = pass == options_.bounces;
        const int rays = last ? options_.rays : std::max(kFewestFieldRays, options_.rays / 4);
        const SampleSets samples(size_t(rays), light_);
        Gatherer::Context context{caster_, albedo_, points_, light_, samples, {}, {}, {}, {}, {}, {}};
        context.rays = size_t(rays);
        context.seed = uint64_t(2 * pass) + (side == Side::Back ? 1 : 0);
        context.side = side;
        context.field = field;
        context.expand = last;
        context.weight = weight_ ? &*weight_ : nullptr;

        Gathered result;
        result.irradiance.assign(points_.items() * 3, 0.0f);
        result.facing = result.irradiance;
        result.squaredError.assign(points_.items(), 0.0f);
        if (last) result.coefficients.assign(points_.items() * kColumns, 0.0f);
        std::atomic<uint64_t> cast{0};
        parallelFor(points_.items(), kBlockItems, [&](size_t begin, size_t end) {
            Gatherer gatherer(context);
            for (size_t i = begin; i < end; ++i) {
                throwIfInterrupted();
                if (gatherer.gather(i)) store(gatherer.sum(), i, result);
            }
            cast += gatherer.rays();
            progress_.advance(end - begin);
        });
        rays_ += cast;
        return result;
    }

    void store(const PartSum& sum, size_t item, Gathered& result) const {
        const Vec3d facing = sum.facing[0] + sum.facing[1];
        result.squaredError[item] = float((sum.facing[0] - sum.facing[1]).squaredNorm());
        for (size_t c = 0; c < 3; ++c) {
            result.irradiance[3 * item + c] = float(sum.irradiance[int(c)]);
            result.facing[3 * item + c] = float(facing[int(c)]);
            if (result.coefficients.empty()) continue;
            std::array<float, kLightmapCoefficients> b{};
            for (size_t i = 0; i < b.size(); ++i) b[i] = float(sum.expansion[c * b.size() + i]);
            const std::span out(&result.coefficients[item * kColumns + c * b.size()], b.size());
            if (projection_)
                projection_->solve(points_.normal(item), b, float(facing[int(c)]), out);
            else
                std::copy(b.begin(), b.end(), out.begin());
        }
    }

    double relativeErrorOf(const Gathered& gathered) const {
        double error = 0, square = 0;
        for (size_t i = 0; i < points_.items(); ++i) {
            if (points_.inside(i)) continue;
            error += double(gathered.squaredError[i]);
            for (size_t c = 0; c < 3; ++c) square += std::pow(double(gathered.facing[3 * i + c]), 2);
        }
        return square > 0 ? std::sqrt(error / square) : 0;
    }

    const RayCaster& caster_;
    const SurfaceAlbedo& albedo_;
    const LightmapPoints& points_;
    const EnvironmentSampler& light_;
    const LightmapOptions& options_;
    const bool twoSides_;
    std::optional<CosineTable> weight_;
    std::optional<IrradianceProjection> projection_;
    Progress progress_;
    uint64_t rays_ = 0;
};

void checkOptions(const LightmapOptions& options) {
    const auto check = [](const char* name, int value, int low, int high) {
        if (value < low || value > high)
            throw UsageError(name, fmt::format("{} is out of range", value),
                             fmt::format("choose {} to {}", low, high));
    };
    check("--bounces", options.bounces, 0, kMaxLightmapBounces);
    check("--rays", options.rays, kMinLightmapRays, kMaxLightmapRays);
    PRT_CHECK(isValid(options.projection.weight));
}

}  // namespace

LightmapBake bakeLightmap(const RayCaster& caster, const Scene& scene, const SurfaceAlbedo& albedo,
                          const PointGrid& grid, std::span<const Validity> validity,
                          const EnvironmentSampler& light, const LightmapOptions& options) {
    checkOptions(options);
    PRT_CHECK_EQ(caster.triangleCount(), scene.triangleCount());
    const LightmapPoints points(scene, grid, validity);
    const bool twoSides = std::any_of(scene.materials.begin(), scene.materials.end(),
                                      [](const SceneMaterial& material) { return material.doubleSided; });
    return LightmapBaker(caster, albedo, points, light, options, twoSides).bake();
}

}  // namespace prt
