// Dealing of directions to sub-points, and the order of items [Morton1966].
#include "precompute/visibility/bake_items.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace prt {
namespace {

uint32_t hash32(uint32_t x) {  // finaliser of MurmurHash3
    x ^= x >> 16;
    x *= 0x85ebca6bu;
    x ^= x >> 13;
    x *= 0xc2b2ae35u;
    return x ^ (x >> 16);
}

// Spreads the low 21 bits to every third bit.
uint64_t spreadBits(uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffffull;
    x = (x | x << 16) & 0x1f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

constexpr double kDealSteps = 256;

}  // namespace

ShareEnds::ShareEnds(double sum) : scale_(kDealSteps / sum) {}

uint32_t ShareEnds::next(double share) {
    passed_ += share;
    const double step = std::round(passed_ * scale_);
    return step >= kDealSteps ? 0xffffffffu : uint32_t(step) << 24;
}

float BakeItems::openShare(uint32_t item) const {
    const uint32_t first = begin(item), last = end(item);
    if (first == last) return 0;
    double sum = 0, passed = 0;
    for (uint32_t p = first; p < last; ++p) {
        const double upTo = p + 1 < last ? double(shareEnd[p]) * 0x1p-32 : 1;
        sum += (upTo - passed) * 0.5 * (1 + double(normal(item).dot(points[p].normal)));
        passed = upTo;
    }
    return float(std::min(1.0, sum));
}

uint32_t dealOfDirection(uint32_t item, uint32_t direction) { return dealStep(direction) + hash32(item); }

uint32_t subPointOfDirection(const BakeItems& items, uint32_t item, uint32_t direction) {
    if (items.firstPoint.empty()) return item;
    const uint32_t last = items.end(item) - 1, deal = dealOfDirection(item, direction);
    uint32_t point = items.begin(item);
    while (point < last && deal >= items.shareEnd[point]) ++point;
    return point;
}

std::vector<uint32_t> mortonOrder(std::span<const Vec3f> positions) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Vec3d low(kInfinity, kInfinity, kInfinity), high = -low;
    for (const Vec3f& p : positions) {
        low = low.cwiseMin(p.cast<double>());
        high = high.cwiseMax(p.cast<double>());
    }
    const double edge = positions.empty() ? 0 : (high - low).maxCoeff();
    const double scale = edge > 0 ? 2097151.0 / edge : 0;
    std::vector<std::pair<uint64_t, uint32_t>> keys(positions.size());
    for (size_t i = 0; i < positions.size(); ++i) {
        const Vec3d q = (positions[i].cast<double>() - low) * scale;
        keys[i] = {
            spreadBits(uint64_t(q.x())) << 2 | spreadBits(uint64_t(q.y())) << 1 | spreadBits(uint64_t(q.z())),
            uint32_t(i)};
    }
    std::sort(keys.begin(), keys.end());
    std::vector<uint32_t> order(positions.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = keys[i].second;
    return order;
}

std::vector<uint32_t> mortonOrderOfItems(const BakeItems& items) {
    std::vector<Vec3f> positions(items.count(), Vec3f::Zero());
    for (uint32_t i = 0; i < items.count(); ++i)
        if (items.begin(i) < items.end(i)) positions[i] = items.points[items.begin(i)].position;
    return mortonOrder(positions);
}

}  // namespace prt
