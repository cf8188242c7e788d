// Shadows of a disc by area sampling: directions over the disc in a sunflower's spiral [Vogel1979].
#include "precompute/visibility/sun_shadow.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "precompute/mesh/texel_raster.h"
#include "precompute/visibility/bake.h"
#include "precompute/visibility/fill.h"

namespace prt {
namespace {

constexpr size_t kBlockItems = 64;
constexpr double kGoldenAngle = std::numbers::pi * 0.76393202250021030;  // π (3 − √5)

// Uniform over the disc's solid angle.
std::vector<Vec3f> discDirections(const SkyDisc& disc, int count) {
    const Vec3d across = (std::abs(disc.direction.y()) < 0.9 ? Vec3d::UnitY() : Vec3d::UnitX())
                             .cross(disc.direction)
                             .normalized();
    const Vec3d along = disc.direction.cross(across);
    const double height = 2 * std::pow(std::sin(disc.angularRadiusRad / 2), 2);  // 1 − cos(radius)
    std::vector<Vec3f> directions;
    for (int k = 0; k < count; ++k) {
        const double down = height * (k + 0.5) / count, radius = std::sqrt(down * (2 - down));
        const double angle = kGoldenAngle * k;
        directions.push_back(
            ((1 - down) * disc.direction + radius * (std::cos(angle) * across + std::sin(angle) * along))
                .cast<float>());
    }
    return directions;
}

// Points to light, as spans over what the bake makes of texels or vertices.
struct Items {
    std::span<const SurfacePoint> points;
    std::span<const uint32_t> first;  // [items + 1]
    std::vector<uint32_t> pointOf;    // [parts] index into points; empty: part i is point i
    std::vector<float> share;         // [parts]
};

class DiscLight {
  public:
    DiscLight(const RayCaster& caster, std::vector<Vec3f> directions)
        : caster_(caster), directions_(std::move(directions)) {}

    std::vector<float> visible(const Items& items) const {
        std::vector<float> result(items.first.size() - 1, 0.0f);
        parallelFor(result.size(), kBlockItems, [&](size_t begin, size_t end) {
            throwIfInterrupted();
            Scratch scratch(caster_);
            for (size_t i = begin; i < end; ++i) result[i] = ofItem(items, i, scratch);
        });
        return result;
    }

  private:
    // Rays of a part of one item.
    struct Part {
        float cast = 0, open = 0;
        float hidden = 0;  // meet the back of a face first
    };
    struct Ray {
        Vec3f origin, direction;
        uint32_t part;
    };
    struct Scratch {
        explicit Scratch(const RayCaster& caster) : stream(caster) {}
        RayStream stream;
        std::vector<Part> parts;
        std::vector<Ray> rays;
        size_t blocked = 0;
        std::vector<Vec3f> origins, directions;
        std::vector<RayHit> hits;
    };

    // Every part has the rays whose numbers fall into its range of [0, rays): at least one of its own.
    float ofItem(const Items& items, size_t item, Scratch& s) const {
        const uint32_t first = items.first[item], last = items.first[item + 1];
        if (first == last) return 0;
        s.parts.assign(last - first, {});
        s.rays.clear();
        const auto rays = double(directions_.size());
        double passed = 0;
        for (uint32_t p = first; p < last; ++p) {
            const SurfacePoint& point = items.points[items.pointOf.empty() ? p : items.pointOf[p]];
            const Vec3f origin = caster_.offsetOrigin(point.position, point.normal);
            const auto from = size_t(std::min(passed * rays, rays - 1));
            passed += double(items.share[p]);
            const auto to = std::clamp(size_t(passed * rays), from + 1, directions_.size());
            s.parts[p - first].cast = float(to - from);
            for (size_t k = from; k < to; ++k) {
                // The step takes every part's rays from all over the disc.
                const Vec3f& direction = directions_[k * kStep % directions_.size()];
                if (direction.dot(point.normal) > 0) s.rays.push_back({origin, direction, p - first});
            }
        }
        const size_t blocked = castAll(s);
        // Where all is dark, or nothing is hidden, no part can be inside.
        if (blocked == s.rays.size()) return 0;
        if (blocked > 0) findHidden(s);
        float sum = 0, shares = 0;
        for (uint32_t p = 0; p < last - first; ++p) {
            const Part& part = s.parts[p];
            if (part.hidden > 0.5f * part.cast) continue;
            sum += items.share[first + p] * (part.open / part.cast);
            shares += items.share[first + p];
        }
        return shares > 0 ? sum / shares : 0.0f;
    }

    // @return rays that something blocks; these come first in s.rays
    size_t castAll(Scratch& s) const {
        size_t blocked = 0;
        for (size_t begin = 0; begin < s.rays.size(); begin += RayStream::kCapacity) {
            const size_t count = std::min(RayStream::kCapacity, s.rays.size() - begin);
            s.stream.clear();
            for (size_t r = 0; r < count; ++r)
                s.stream.add(s.rays[begin + r].origin, s.rays[begin + r].direction);
            s.stream.cast();
            for (size_t r = 0; r < count; ++r) {
                if (s.stream.blocked(r))
                    std::swap(s.rays[blocked++], s.rays[begin + r]);
                else
                    s.parts[s.rays[begin + r].part].open += 1;
            }
        }
        s.blocked = blocked;
        return blocked;
    }

    void findHidden(Scratch& s) const {
        s.origins.clear();
        s.directions.clear();
        for (size_t r = 0; r < s.blocked; ++r) {
            s.origins.push_back(s.rays[r].origin);
            s.directions.push_back(s.rays[r].direction);
        }
        s.hits.resize(s.blocked);
        caster_.firstHits(s.origins, s.directions, s.hits);
        for (size_t r = 0; r < s.blocked; ++r)
            if (s.hits[r].backFace) s.parts[s.rays[r].part].hidden += 1;
    }

    static constexpr size_t kStep = 29;  // coprime to the number of rays where that is a power of two
    const RayCaster& caster_;
    const std::vector<Vec3f> directions_;
};

// What fillTexels and fillVertices spread: one coefficient, the visible share.
BakeResult asBaked(std::vector<float> shares) {
    BakeResult baked;
    baked.ao.assign(shares.size(), 0.0f);
    baked.error.assign(shares.size(), 0.0f);
    baked.inside.assign(shares.size(), 0);
    baked.coefficients = std::move(shares);
    return baked;
}

}  // namespace

std::vector<float> sunShadow(const RayCaster& caster, const Scene& scene, const PointGrid& grid,
                             std::span<const Validity> validity, const SkyDisc& disc, int rays) {
    PRT_CHECK_LE(1, rays);
    PRT_CHECK_EQ(validity.size(), grid.count);
    const DiscLight light(caster, discDirections(disc, rays));
    if (grid.domain == PointDomain::Vertex) {
        const VertexPoints vertices = makeVertexPoints(scene);
        PRT_CHECK_EQ(vertices.sameAs.size(), grid.count);
        BakeResult baked = asBaked(light.visible({vertices.points, vertices.firstPoint, {}, vertices.share}));
        for (size_t v = 0; v < grid.count; ++v) baked.inside[v] = isInside(validity[v]);
        return fillVertices(scene, vertices, baked, 1).coefficients;
    }
    const TexelSurface surface = rasterizeTexels(scene, grid.width, grid.height);
    Items items{surface.subPoints, surface.firstPart, {}, {}};
    for (const TexelPart& part : surface.parts) {
        items.pointOf.push_back(part.subPoint);
        items.share.push_back(part.share);
    }
    BakeResult baked = asBaked(light.visible(items));
    for (size_t t = 0; t < grid.count; ++t)
        if (const uint32_t point = surface.pointOfTexel[t]; point != kNoPoint)
            baked.inside[point] = isInside(validity[t]);
    return fillTexels(surface, baked, 1).coefficients;
}

}  // namespace prt
