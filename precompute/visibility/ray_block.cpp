// World-fixed directions, each traced from all points of a block that have it above their horizon: rays that
// start near each other and run parallel.
#include "precompute/visibility/ray_block.h"

#include <algorithm>
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"

namespace prt {
namespace {

constexpr size_t kSlots = 256;
constexpr size_t kQueue = 1024;  // rays

// cosines = n·ω, and bits where they are positive.
PRT_TARGET_CLONES
void findFacing(const float* x, const float* y, const float* z, float dx, float dy, float dz, size_t words,
                float* cosines, uint64_t* facing) {
    for (size_t i = 0; i < words * 64; ++i) cosines[i] = x[i] * dx + y[i] * dy + z[i] * dz;
    for (size_t w = 0; w < words; ++w) {
        uint64_t bits = 0;
        for (size_t i = 0; i < 64; ++i) bits |= uint64_t(cosines[w * 64 + i] > 0) << i;
        facing[w] = bits;
    }
}

}  // namespace

void RayBlock::begin(std::span<const uint32_t> block) {
    PRT_CHECK_LE(block.size(), kMostBlockPoints);
    block_ = block;
    orientation_ = block.empty() ? 0 : size_t(items_.orientation(block[0]));
    offset_.clear();
    normal_.clear();
    sharedList_.clear();
    shared_ = {};
    normalX_.fill(0);  // faces no direction
    normalY_.fill(0);
    normalZ_.fill(0);
    slots_.resize(kMostBlockPoints * kSlots);
    Vec3f axis = Vec3f::Zero();
    for (size_t i = 0; i < block.size(); ++i) {
        const uint32_t first = items_.begin(block[i]), last = items_.end(block[i]);
        offsetStart_[i] = uint32_t(offset_.size());
        for (uint32_t p = first; p < last; ++p) {
            const SurfacePoint& point = items_.points[p];
            offset_.push_back(caster_.offsetOrigin(point.position, point.normal));
            normal_.push_back(point.normal);
            axis += normal_.back();
        }
        if (last == first + 1) {
            normalX_[i] = normal_.back().x();
            normalY_[i] = normal_.back().y();
            normalZ_[i] = normal_.back().z();
        }
        PRT_CHECK_EQ(size_t(items_.orientation(block[i])), orientation_);
        // One sub-point with a normal of its own keeps its own horizon, as several do.
        if (last == first || (last == first + 1 && normal_.back() == items_.normal(block[i]))) continue;
        shared_.set(i);
        sharedList_.push_back(uint32_t(i));
        hash_[i] = dealOfDirection(block[i], 0);
        uint32_t point = first;
        for (size_t slot = 0; slot < kSlots; ++slot) {
            while (point + 1 < last && uint32_t(slot) << 24 >= items_.shareEnd[point]) ++point;
            slots_[i * kSlots + slot] = uint8_t(point - first);
        }
    }
    setCone(axis);
}

void RayBlock::setCone(Vec3f axis) {
    coneAxis_ = Vec3f::Zero();
    coneSine_ = 1;
    if (!(axis.norm() > 1e-3f)) return;
    axis.normalize();
    float smallest = 1;
    for (const Vec3f& normal : normal_) smallest = std::min(smallest, axis.dot(normal));
    coneAxis_ = axis;
    coneSine_ = smallest > 0 ? std::sqrt(std::max(0.0f, 1 - smallest * smallest)) : 2.0f;
}

uint32_t RayBlock::subPoint(size_t i, uint32_t k) const {
    if (!shared_.test(i)) return 0;
    return slots_[i * kSlots + ((hash_[i] + dealStep(k)) >> 24)];
}

PointMask RayBlock::above(const DirectionLevel& level, uint32_t k) {
    const Vec3f& direction = level.turned[orientation_].directions[k];
    PointMask mask;
    if (!(coneAxis_.dot(direction) > -coneSine_ - 1e-4f)) return mask;
    for (const uint32_t i : sharedList_) {
        const Vec3f& normal = normal_[offsetStart_[i] + subPoint(i, k)];
        normalX_[i] = normal.x();
        normalY_[i] = normal.y();
        normalZ_[i] = normal.z();
    }
    findFacing(normalX_.data(), normalY_.data(), normalZ_.data(), direction.x(), direction.y(), direction.z(),
               (block_.size() + 63) / 64, cosines_.data(), mask.words.data());
    return mask;
}

float RayBlock::cosineOf(const DirectionLevel& level, size_t i, uint32_t k) const {
    const Vec3f &n = normal_[offsetStart_[i] + subPoint(i, k)],
                &direction = level.turned[orientation_].directions[k];
    return n.x() * direction.x() + n.y() * direction.y() + n.z() * direction.z();
}

PointMask RayBlock::visible(const DirectionLevel& level, uint32_t k, const PointMask& rays,
                            RayCasting casting) {
    const Vec3f& direction = level.turned[orientation_].directions[k];
    std::array<size_t, std::tuple_size_v<decltype(rays.words)> + 1> first{};  // ray of each word
    size_t count = 0;
    for (size_t w = 0; w < rays.words.size(); ++w) {
        for (uint64_t word = rays.words[w]; word != 0; word &= word - 1) {
            const size_t i = w * 64 + size_t(std::countr_zero(word));
            origins_[count++] = offset_[offsetStart_[i] + subPoint(i, k)];
        }
        first[w + 1] = count;
    }
    const std::span origins(origins_.data(), count);
    const std::span blocked(blocked_.data(), count);
    if (casting == RayCasting::Stream)
        caster_.occluded(origins, direction, blocked);
    else
        for (size_t w = 0; w < rays.words.size(); ++w)
            caster_.occludedPackets(origins.subspan(first[w], first[w + 1] - first[w]), direction,
                                    blocked.subspan(first[w], first[w + 1] - first[w]));
    rays_ += count;
    PointMask result;
    size_t ray = 0;
    for (size_t w = 0; w < rays.words.size(); ++w) {
        uint64_t bits = 0;
        for (uint64_t word = rays.words[w]; word != 0; word &= word - 1)
            bits |= uint64_t(!blocked_[ray++]) << std::countr_zero(word);
        result.words[w] = bits;
    }
    return result;
}

void RayBlock::enqueue(const DirectionLevel& level, uint32_t k, const PointMask& rays,
                       std::vector<PointMask>& visible) {
    rays.forEach([&](size_t i) {
        queueOrigins_.push_back(offset_[offsetStart_[i] + subPoint(i, k)]);
        queueDirections_.push_back(level.turned[orientation_].directions[k]);
        queuePlaces_.emplace_back(k, uint32_t(i));
    });
    if (queueOrigins_.size() >= kQueue) flush(visible);
}

void RayBlock::flush(std::vector<PointMask>& visible) {
    queueBlocked_.resize(queueOrigins_.size());
    caster_.occludedRays(queueOrigins_, queueDirections_, queueBlocked_);
    rays_ += queueOrigins_.size();
    for (size_t ray = 0; ray < queueOrigins_.size(); ++ray)
        if (!queueBlocked_[ray]) visible[queuePlaces_[ray].first].set(queuePlaces_[ray].second);
    queueOrigins_.clear();
    queueDirections_.clear();
    queuePlaces_.clear();
}

}  // namespace prt
