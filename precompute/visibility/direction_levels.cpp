// Spherical Fibonacci sets [Keinert2015] with their neighbours: on the spiral the height falls with the
// index, so near directions lie in a short range of indices.
#include "precompute/visibility/direction_levels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/directions.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/accumulate.h"
#include "precompute/visibility/bake_items.h"

namespace prt {
namespace {

// No part of a set is so thin that its nearest directions lie farther than this many mean spacings.
constexpr double kSearchSpacings = 2.5;
// One of so many directions is traced whatever coarser ones say: what is thinner than their spacing is found
// by some of these.
constexpr uint32_t kAuditStep = 16;

}  // namespace

template <size_t K>
std::array<uint16_t, K> nearestDirections(const std::vector<Vec3f>& set, const Vec3f& direction,
                                          uint32_t skip) {
    const double count = double(set.size());
    const double reach = kSearchSpacings * std::sqrt(4 * std::numbers::pi / count);
    const double angle = std::acos(std::clamp(double(direction.y()), -1.0, 1.0));
    const double top = std::cos(std::max(0.0, angle - reach)),
                 bottom = std::cos(std::min(std::numbers::pi, angle + reach));
    // Height of direction i: 1 − (2i+1)/N.
    const auto first = uint32_t(std::clamp((1 - top) / 2 * count - 1, 0.0, count));
    const auto last = uint32_t(std::clamp((1 - bottom) / 2 * count + 1, 0.0, count));
    std::array<uint16_t, K> nearest{};
    std::array<float, K> cosines;
    cosines.fill(-2);
    for (uint32_t i = first; i < last; ++i) {
        const float cosine = set[i].dot(direction);
        if (!(cosine > cosines[K - 1]) || i == skip) continue;
        size_t place = K - 1;
        for (; place > 0 && cosine > cosines[place - 1]; --place) {
            cosines[place] = cosines[place - 1];
            nearest[place] = nearest[place - 1];
        }
        cosines[place] = cosine;
        nearest[place] = uint16_t(i);
    }
    PRT_CHECK(cosines[K - 1] > -2);
    return nearest;
}
template std::array<uint16_t, 4> nearestDirections<4>(const std::vector<Vec3f>&, const Vec3f&, uint32_t);
template std::array<uint16_t, 6> nearestDirections<6>(const std::vector<Vec3f>&, const Vec3f&, uint32_t);

DirectionLevels::DirectionLevels(std::vector<int> sizes, int shOrder)
    : sizes_(std::move(sizes)), shOrder_(shOrder), slots_(std::make_unique<Slot[]>(sizes_.size())) {
    PRT_CHECK(!sizes_.empty());
    for (size_t level = 1; level < sizes_.size(); ++level) {
        PRT_CHECK_LT(sizes_[level - 1], sizes_[level]);
        PRT_CHECK_LE(sizes_[level], 65536);
    }
}

const DirectionLevel& DirectionLevels::operator[](size_t level) const {
    PRT_CHECK_LT(level, count());
    Slot& slot = slots_[level];
    std::call_once(slot.once, [&] {
        DirectionLevel& made = slot.level;
        const std::vector<Vec3f> directions = sphericalFibonacci(sizes_[level]);
        for (const Vec3f& direction : directions) {
            made.x.push_back(direction.x());
            made.y.push_back(direction.y());
            made.z.push_back(direction.z());
            for (int o = 0; o < kOrientations; ++o)
                made.turned[size_t(o)].push_back(turnedIntoWorld(o, direction));
        }
        const size_t columns = size_t(shCount(shOrder_));
        made.stride = paddedColumns(columns);
        made.basis.assign(made.size() * made.stride, 0.0f);
        for (size_t k = 0; k < made.size(); ++k)
            evalSh(shOrder_, directions[k], std::span(&made.basis[k * made.stride], columns));
        if (level == 0) return;
        for (const uint32_t k : mortonOrder(directions)) made.order.push_back(uint16_t(k));
        const std::vector<Vec3f> coarser = sphericalFibonacci(sizes_[level - 1]);
        for (size_t k = 0; k < made.size(); ++k) {
            made.coarser.push_back(nearestDirections<4>(coarser, directions[k], UINT32_MAX));
            made.near.push_back(nearestDirections<6>(directions, directions[k], uint32_t(k)));
        }
        if (made.size() > kAuditStep * size_t(sizes_[0])) made.auditStep = kAuditStep;
    });
    return slot.level;
}

}  // namespace prt
