// Light that bounces, by path tracing with next-event estimation [Kajiya1986]. First directions and cells
// come from a Kronecker sequence [Roberts2018] with a shift per pixel [CranleyPatterson1976], later ones from
// SplitMix64 [Steele2014].
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/math/split_mix.h"
#include "runtime/reference/reference.h"

namespace prt {
namespace {

constexpr size_t kBlockPixels = 16;
constexpr size_t kBatchPaths = 256;  // that go on together

// Cells of the light, chosen in proportion to their flux.
class LightCells {
  public:
    explicit LightCells(const ReferenceDirections& directions)
        : directions_(directions), columns_(directions.radiance.size() * 3) {
        const size_t count = directions.direction.size();
        std::vector<double> share(count, 0.0);
        for (const std::vector<float>& radiance : directions.radiance) {
            double total = 0;
            for (size_t k = 0; k < count; ++k) total += flux(radiance, k);
            if (!(total > 0)) continue;
            for (size_t k = 0; k < count; ++k) share[k] += flux(radiance, k) / total;
        }
        double sum = 0;
        for (const double s : share) sum += s;
        for (const double s : share) {
            probability_.push_back(sum > 0 ? s / sum : 0);
            upTo_.push_back((upTo_.empty() ? 0 : upTo_.back()) + probability_.back());
        }
    }

    bool dark() const { return upTo_.empty() || !(upTo_.back() > 0); }
    size_t columns() const { return columns_; }
    /// @param u  in [0, 1)
    size_t choose(double u) const {
        const auto found = std::upper_bound(upTo_.begin(), upTo_.end(), u * upTo_.back());
        auto k = size_t(std::min(found - upTo_.begin(), std::ptrdiff_t(upTo_.size()) - 1));
        while (!(probability_[k] > 0)) --k;  // rounding at the end of the list
        return k;
    }
    const Vec3f& direction(size_t k) const { return directions_.direction[k]; }
    /// Radiance times solid angle over the probability of the choice, of colour c of environment e.
    double light(size_t k, size_t e, size_t c) const {
        return double(directions_.radiance[e][3 * k + c]) * double(directions_.solidAngleSr[k]) /
               probability_[k];
    }

  private:
    double flux(const std::vector<float>& radiance, size_t k) const {
        return (double(radiance[3 * k]) + double(radiance[3 * k + 1]) + double(radiance[3 * k + 2])) *
               double(directions_.solidAngleSr[k]);
    }
    const ReferenceDirections& directions_;
    size_t columns_;
    std::vector<double> probability_, upTo_;
};

// Direction with a density of cosine over π about a normal: towards a point that is uniform on the unit
// sphere which touches the surface there: a piece dA of it, at the distance 2cosθ and seen at the angle θ,
// fills dω = dA cosθ / (2cosθ)², so that dA/4π = cosθ dω/π.
Vec3f cosineDirection(const Vec3f& normal, double u1, double u2) {
    const double height = 1 - 2 * u1, radius = std::sqrt(std::max(0.0, 1 - height * height));
    const double angle = 2 * std::numbers::pi * u2;
    const Vec3d chord =
        normal.cast<double>() + Vec3d(radius * std::sin(angle), height, radius * std::cos(angle));
    // Opposite to the normal the chord vanishes.
    return chord.norm() > 1e-6 ? Vec3f(chord.normalized().cast<float>()) : normal;
}

struct Path {
    SplitMix64 random{0};
    size_t half = 0;
    double lightNumber = 0;  // chooses the cell at the next surface
    Vec3d throughput = Vec3d::Ones();
    Vec3f origin = Vec3f::Zero(), direction = Vec3f::Zero();
    Vec3f normal = Vec3f::Zero();  // of the surface it stands on, geometric
};

class PathTracer {
  public:
    PathTracer(const RayCaster& caster, const SurfaceAlbedo& albedo, const LightCells& cells,
               const BounceOptions& options)
        : caster_(caster), albedo_(albedo), cells_(cells), options_(options), stream_(caster) {}

    uint64_t rays() const { return rays_; }

    /// Bounced irradiance of one pixel; what each half of the paths gives lies in half(0) and half(1).
    void trace(const SurfaceImage& surface, size_t pixel) {
        for (std::vector<double>& half : halves_) half.assign(cells_.columns(), 0.0);
        const Vec3f position = caster_.snapToPlane(surface.position[pixel], surface.triangle[pixel]);
        const Vec3f& normal = surface.geometricNormal[pixel];
        const Vec3f origin = caster_.offsetOrigin(position, normal);
        SplitMix64 random{options_.seed * 0x2545f4914f6cdd1du + pixel};
        const std::array shift{random.uniform(), random.uniform(), random.uniform()};
        const auto count = size_t(options_.paths);
        for (size_t begin = 0; begin < count; begin += kBatchPaths) {
            throwIfInterrupted();
            paths_.clear();
            for (size_t i = begin; i < std::min(count, begin + kBatchPaths); ++i) {
                const std::array u = kronecker(i, shift);
                Path path;
                path.random.state = random.next();
                path.half = i < count / 2 ? 0 : 1;
                path.lightNumber = u[2];
                path.origin = origin;
                path.direction = cosineDirection(surface.shadingNormal[pixel], u[0], u[1]);
                if (path.direction.dot(normal) > 0) paths_.push_back(path);
            }
            for (int bounce = 0; bounce < options_.bounces && !paths_.empty(); ++bounce) {
                toNextSurface();
                addDirectLight();
                reflect();
            }
        }
        for (std::vector<double>& half : halves_)
            for (double& value : half) value /= double(count / 2);
    }
    std::span<const double> half(size_t which) const { return halves_[which]; }

  private:
    // x⁴ = x + 1: its powers are as badly approximable as three numbers can be.
    static std::array<double, 3> kronecker(size_t i, const std::array<double, 3>& shift) {
        constexpr double kRoot = 1.2207440846057594754;
        std::array<double, 3> u{};
        double step = 1;
        for (size_t d = 0; d < 3; ++d) {
            step /= kRoot;
            const double value = shift[d] + step * double(i + 1);
            u[d] = value - std::floor(value);
        }
        return u;
    }

    // Moves every path to what it meets; those that meet nothing, a black back or a black surface end.
    void toNextSurface() {
        origins_.clear();
        rayDirections_.clear();
        for (const Path& path : paths_) {
            origins_.push_back(path.origin);
            rayDirections_.push_back(path.direction);
        }
        hits_.resize(paths_.size());
        caster_.firstHits(origins_, rayDirections_, hits_);
        rays_ += paths_.size();
        size_t kept = 0;
        for (size_t i = 0; i < paths_.size(); ++i) {
            const RayHit& hit = hits_[i];
            if (hit.triangle == RayHit{}.triangle) continue;
            if (hit.backFace && !albedo_.doubleSided(hit.triangle)) continue;
            Path path = paths_[i];
            path.throughput =
                path.throughput.cwiseProduct(albedo_.at(hit.triangle, hit.u, hit.v).cast<double>());
            if (!(path.throughput.maxCoeff() > 0)) continue;
            if (!arrive(path, hit)) continue;
            paths_[kept++] = path;
        }
        paths_.resize(kept);
    }

    // @return false where the triangle has no area
    bool arrive(Path& path, const RayHit& hit) const {
        std::array<Vec3d, 3> p;
        for (size_t k = 0; k < 3; ++k)
            p[k] = caster_.positions()[caster_.indices()[3 * size_t(hit.triangle) + k]].cast<double>();
        const Vec3d cross = (p[1] - p[0]).cross(p[2] - p[0]);
        if (!(cross.norm() > 0)) return false;
        const double u = double(hit.u), v = double(hit.v);
        const Vec3f position = ((1 - u - v) * p[0] + u * p[1] + v * p[2]).cast<float>();
        path.normal = (cross.normalized() * (hit.backFace ? -1 : 1)).cast<float>();
        path.origin = caster_.offsetOrigin(position, path.normal);
        return true;
    }

    void addDirectLight() {
        for (size_t begin = 0; begin < paths_.size(); begin += RayStream::kCapacity) {
            const size_t end = std::min(paths_.size(), begin + RayStream::kCapacity);
            lit_.clear();
            stream_.clear();
            for (size_t i = begin; i < end; ++i) {
                const size_t k = cells_.choose(paths_[i].lightNumber);
                if (!(paths_[i].normal.dot(cells_.direction(k)) > 0)) continue;
                lit_.push_back({i, k});
                stream_.add(paths_[i].origin, cells_.direction(k));
            }
            stream_.cast();
            rays_ += lit_.size();
            for (size_t j = 0; j < lit_.size(); ++j)
                if (!stream_.blocked(j)) addLight(paths_[lit_[j].first], lit_[j].second);
        }
    }
    void addLight(const Path& path, size_t k) {
        const double cosine = double(path.normal.dot(cells_.direction(k)));
        std::vector<double>& sums = halves_[path.half];
        for (size_t column = 0; column < sums.size(); ++column)
            sums[column] +=
                path.throughput[int(column % 3)] * cosine * cells_.light(k, column / 3, column % 3);
    }

    void reflect() {
        for (Path& path : paths_) {
            const double u1 = path.random.uniform(), u2 = path.random.uniform();
            path.direction = cosineDirection(path.normal, u1, u2);
            path.lightNumber = path.random.uniform();
        }
    }

    const RayCaster& caster_;
    const SurfaceAlbedo& albedo_;
    const LightCells& cells_;
    const BounceOptions& options_;
    RayStream stream_;
    std::array<std::vector<double>, 2> halves_;
    std::vector<Path> paths_;
    std::vector<Vec3f> origins_, rayDirections_;
    std::vector<RayHit> hits_;
    std::vector<std::pair<size_t, size_t>> lit_;  // path, cell
    uint64_t rays_ = 0;
};

void checkOptions(const BounceOptions& options) {
    if (options.bounces < 0 || options.bounces > kMaxBounces)
        throw UsageError("bounces", fmt::format("{} is out of range", options.bounces),
                         fmt::format("choose 0 to {}", kMaxBounces));
    if (options.paths < 2 || options.paths > 1048576 || options.paths % 2 != 0)
        throw UsageError("paths", fmt::format("{} is odd or out of range", options.paths),
                         "choose an even number, 2 to 1048576");
}

// RMS of the error over RMS of the irradiance, covered pixels and all colours.
double relativeRms(const std::vector<double>& squaredErrors, const std::vector<float>& irradiance) {
    double error = 0, square = 0;
    for (const double e : squaredErrors) error += e;
    for (const float e : irradiance) square += double(e) * double(e);
    return square > 0 ? std::sqrt(error / square) : 0;
}

}  // namespace

BounceResult traceReferenceBounces(const RayCaster& caster, const SurfaceImage& surface,
                                   const ReferenceDirections& directions, const SurfaceAlbedo& albedo,
                                   const BounceOptions& options, const ReferenceVisitor& visitor) {
    checkOptions(options);
    BounceResult result;
    result.irradiance = traceReference(caster, surface, directions, visitor);
    const size_t environments = result.irradiance.size(), pixels = surface.pixels();
    result.relativeError.assign(environments, 0.0);
    const LightCells cells(directions);
    if (options.bounces == 0 || cells.dark()) return result;

    // [environments][pixels] of the mean of two halves, summed over colours
    std::vector<std::vector<double>> squaredErrors(environments, std::vector<double>(pixels, 0.0));
    std::atomic<uint64_t> rays{0};
    Progress progress("bounces", pixels, "pixels");
    parallelFor(pixels, kBlockPixels, [&](size_t begin, size_t end) {
        PathTracer tracer(caster, albedo, cells, options);
        for (size_t pixel = begin; pixel < end; ++pixel) {
            if (surface.triangle[pixel] == kNoTriangle) continue;
            tracer.trace(surface, pixel);
            for (size_t e = 0; e < environments; ++e)
                for (size_t c = 0; c < 3; ++c) {
                    const double a = tracer.half(0)[3 * e + c], b = tracer.half(1)[3 * e + c];
                    result.irradiance[e][3 * pixel + c] += float((a + b) / 2);
                    squaredErrors[e][pixel] += (a - b) * (a - b) / 4;
                }
        }
        rays += tracer.rays();
        progress.advance(end - begin);
    });
    result.rays = rays;
    for (size_t e = 0; e < environments; ++e)
        result.relativeError[e] = relativeRms(squaredErrors[e], result.irradiance[e]);
    return result;
}

}  // namespace prt
