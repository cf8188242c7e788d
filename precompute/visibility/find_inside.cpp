// Front or back of the first face hit, by majority over a few directions.
#include "precompute/visibility/find_inside.h"

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"

namespace prt {
namespace {

constexpr int kDirections = 128;   // over the sphere; half of them lie above the horizon
constexpr float kAoLimit = 0.35f;  // an inside point is nearly dark

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

void InsideCount::add(const RayCaster& caster, const SurfacePoint& point, const Vec3f& direction,
                      std::span<const uint8_t> doubleSided) {
    ++rays;
    const RayHit hit = caster.firstHit(caster.offsetOrigin(point.position, point.normal), direction);
    if (hit.triangle == RayHit{}.triangle) return;
    ++hits;
    backs += hit.backFace && (doubleSided.empty() || !doubleSided[hit.triangle]);
}

std::vector<uint8_t> findInside(const RayCaster& caster, const BakeItems& items, std::span<const float> ao,
                                std::span<const uint8_t> doubleSided) {
    std::vector<uint8_t> inside(items.count(), 0);
    const std::vector<Vec3f> directions = spreadDirections(kDirections);
    parallelFor(items.count(), 64, [&](size_t begin, size_t end) {
        for (auto item = uint32_t(begin); item < end; ++item) {
            if (ao[item] >= kAoLimit || items.begin(item) == items.end(item)) continue;
            InsideCount count;
            for (uint32_t k = 0; k < directions.size(); ++k) {
                if (count.isDecided()) break;
                const SurfacePoint& point = items.points[subPointOfDirection(items, item, k)];
                if (point.normal.dot(directions[k]) > 0) count.add(caster, point, directions[k], doubleSided);
            }
            inside[item] = count.isInside();
        }
    });
    return inside;
}

}  // namespace prt
