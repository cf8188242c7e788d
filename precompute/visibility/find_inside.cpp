// Front or back of the first face hit, by majority over a few directions.
#include "precompute/visibility/find_inside.h"

#include <algorithm>
#include <numeric>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "precompute/visibility/surely_outside.h"

namespace prt {
namespace {

constexpr int kDirections = 128;   // over the sphere; half of them lie above the horizon
constexpr float kAoLimit = 0.35f;  // an inside point is nearly dark

constexpr size_t kRun = 256;  // neighbours that cast rays of one direction together

// Places of a run that look for geometry around them, one direction after another.
class InsideSearch {
  public:
    InsideSearch(const RayCaster& caster, std::span<const uint8_t> doubleSided)
        : caster_(caster), doubleSided_(doubleSided) {}

    void begin(size_t places) {
        counts_.assign(places, {});
        open_.resize(places);
        std::iota(open_.begin(), open_.end(), 0u);
    }
    /// @param pointOf  pointOf(place, direction's index): the surface point that takes the direction
    template <class PointOf>
    void run(std::span<const Vec3f> directions, const PointOf& pointOf) {
        for (uint32_t k = 0; k < directions.size() && !open_.empty(); ++k) {
            quick_.clear();
            full_.clear();
            for (const uint32_t place : open_) {
                const SurfacePoint& point = pointOf(place, k);
                if (!(point.normal.dot(directions[k]) > 0)) continue;
                // Where nothing was hit so far, first whether anything is: that is cheaper than what.
                Rays& rays = counts_[place].hits == 0 ? quick_ : full_;
                rays.origins.push_back(caster_.offsetOrigin(point.position, point.normal));
                rays.places.push_back(place);
            }
            askWhether(directions[k]);
            askWhat(directions[k]);
            std::erase_if(open_, [&](uint32_t place) { return counts_[place].isDecided(); });
        }
    }
    bool isInside(size_t place) const { return counts_[place].isInside(); }

  private:
    struct Rays {
        std::vector<Vec3f> origins;
        std::vector<uint32_t> places;
        void clear() {
            origins.clear();
            places.clear();
        }
    };

    // Counts the quick rays that meet nothing; the others are cast again in full.
    void askWhether(const Vec3f& direction) {
        blocked_.resize(quick_.origins.size());
        caster_.occluded(quick_.origins, direction, blocked_);
        for (size_t ray = 0; ray < blocked_.size(); ++ray) {
            if (!blocked_[ray]) {
                ++counts_[quick_.places[ray]].rays;
                continue;
            }
            full_.origins.push_back(quick_.origins[ray]);
            full_.places.push_back(quick_.places[ray]);
        }
    }

    void askWhat(const Vec3f& direction) {
        directions_.assign(full_.origins.size(), direction);
        hits_.resize(full_.origins.size());
        caster_.firstHits(full_.origins, directions_, hits_);
        for (size_t ray = 0; ray < hits_.size(); ++ray) {
            InsideCount& count = counts_[full_.places[ray]];
            const RayHit& hit = hits_[ray];
            ++count.rays;
            if (hit.triangle == RayHit{}.triangle) continue;
            ++count.hits;
            count.backs += hit.backFace && (doubleSided_.empty() || !doubleSided_[hit.triangle]);
        }
    }

    const RayCaster& caster_;
    std::span<const uint8_t> doubleSided_;
    std::vector<InsideCount> counts_;
    std::vector<uint32_t> open_;  // places that are not decided
    Rays quick_, full_;
    std::vector<Vec3f> directions_;
    std::vector<RayHit> hits_;
    std::vector<uint8_t> blocked_;
};

// Drops items all of whose sub-points lie on faces that are outside.
void dropOutside(const RayCaster& caster, const BakeItems& items, std::span<const uint8_t> doubleSided,
                 std::vector<uint32_t>& candidates) {
    const std::vector<uint8_t> outside =
        findSurelyOutside(caster, doubleSided, candidates.size() / kFacePrice);
    std::erase_if(candidates, [&](uint32_t item) {
        return std::all_of(items.points.begin() + items.begin(item), items.points.begin() + items.end(item),
                           [&](const SurfacePoint& point) { return outside[point.triangle] != 0; });
    });
}

}  // namespace

std::vector<Vec3f> spreadDirections(int count) {
    PRT_CHECK(count > 0 && (count & (count - 1)) == 0);
    const std::vector<Vec3f> spiral = sphericalFibonacci(count);
    // About 0.4 of the count, and odd, so that it meets all of a power of two.
    const size_t step = spiral.size() * 2 / 5 | 1;
    std::vector<Vec3f> spread;
    for (size_t k = 0; k < spiral.size(); ++k) spread.push_back(spiral[k * step % spiral.size()]);
    return spread;
}

std::vector<uint8_t> findInsidePoints(const RayCaster& caster, std::span<const SurfacePoint> points,
                                      std::span<const Vec3f> directions,
                                      std::span<const uint8_t> doubleSided) {
    std::vector<uint8_t> inside(points.size(), 0);
    parallelFor(points.size(), kRun * 4, [&](size_t begin, size_t end) {
        throwIfInterrupted();
        InsideSearch search(caster, doubleSided);
        for (size_t first = begin; first < end; first += kRun) {
            const size_t count = std::min(kRun, end - first);
            search.begin(count);
            search.run(directions,
                       [&](size_t i, uint32_t) -> const SurfacePoint& { return points[first + i]; });
            for (size_t i = 0; i < count; ++i) inside[first + i] = search.isInside(i);
        }
    });
    return inside;
}

std::vector<uint8_t> findInside(const RayCaster& caster, const BakeItems& items, std::span<const float> ao,
                                std::span<const uint8_t> doubleSided) {
    std::vector<uint8_t> inside(items.count(), 0);
    const std::vector<Vec3f> directions = spreadDirections(kDirections);
    std::vector<uint32_t> candidates;
    for (uint32_t item = 0; item < items.count(); ++item)
        if (ao[item] < kAoLimit && items.begin(item) != items.end(item)) candidates.push_back(item);
    if (!items.hidden.empty()) {
        for (const uint32_t item : candidates) inside[item] = items.hidden[item];
        return inside;
    }
    if (candidates.size() > caster.triangleCount()) dropOutside(caster, items, doubleSided, candidates);
    parallelFor(candidates.size(), kRun, [&](size_t begin, size_t end) {
        throwIfInterrupted();
        InsideSearch search(caster, doubleSided);
        search.begin(end - begin);
        search.run(directions, [&](size_t i, uint32_t k) -> const SurfacePoint& {
            return items.points[subPointOfDirection(items, candidates[begin + i], k)];
        });
        for (size_t i = begin; i < end; ++i) inside[candidates[i]] = search.isInside(i - begin);
    });
    return inside;
}

}  // namespace prt
