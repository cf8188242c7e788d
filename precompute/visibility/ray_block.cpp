// World-fixed directions, each traced from all points of a block that have it above their horizon: rays that
// start near each other and run parallel.
#include "precompute/visibility/ray_block.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"

namespace prt {
namespace {

constexpr size_t kSlots = 256;

// Bits where n·ω is positive. No clones for wider vectors: between casts, 512-bit instructions made Embree 8
// % slower.
void findFacing(const float* x, const float* y, const float* z, float dx, float dy, float dz, size_t words,
                uint64_t* facing) {
    for (size_t w = 0; w < words; ++w) {
        std::array<uint8_t, 64> flags;
        for (size_t i = 0; i < 64; ++i)
            flags[i] = x[w * 64 + i] * dx + y[w * 64 + i] * dy + z[w * 64 + i] * dz > 0;
        uint64_t bits = 0;
        for (size_t byte = 0; byte < 8; ++byte) {
            uint64_t eight;
            std::memcpy(&eight, &flags[byte * 8], sizeof eight);
            // Moves the low bit of byte i to bit 56 + i; no two products meet.
            bits |= (eight * 0x0102040810204080u >> 56) << byte * 8;
        }
        facing[w] = bits;
    }
}

std::array<Vec3f, kOrientations> turnedDirections(const DirectionLevel& level, uint32_t k) {
    return {level.turned[0][k], level.turned[1][k], level.turned[2][k], level.turned[3][k]};
}

}  // namespace

void RayBlock::begin(std::span<const uint32_t> block) {
    PRT_CHECK_LE(block.size(), kMostBlockPoints);
    block_ = block;
    offset_.clear();
    normal_.clear();
    sharedList_.clear();
    shared_ = {};
    placed_ = kNoDirection;
    normalX_.fill(0);  // faces no direction
    normalY_.fill(0);
    normalZ_.fill(0);
    slots_.resize(kMostBlockPoints * kSlots);
    for (size_t i = 0; i < block.size(); ++i) addSubPoints(i);
    Vec3f axis = Vec3f::Zero();
    for (const Vec3f& normal : normal_) axis += normal;
    setCone(axis);
}

void RayBlock::addSubPoints(size_t i) {
    const uint32_t item = block_[i], first = items_.begin(item), last = items_.end(item);
    orientation_[i] = uint8_t(items_.orientation(item));
    offsetStart_[i] = uint32_t(offset_.size());
    for (uint32_t p = first; p < last; ++p) {
        const SurfacePoint& point = items_.points[p];
        offset_.push_back(caster_.offsetOrigin(point.position, point.normal));
        normal_.push_back(turnedBack(orientation_[i], point.normal));
    }
    if (last == first) return;
    if (last == first + 1) {
        normalX_[i] = normal_.back().x();
        normalY_[i] = normal_.back().y();
        normalZ_[i] = normal_.back().z();
        start_[i] = offset_.back();
    }
    // One sub-point with a normal of its own keeps its own horizon, as several do.
    if (last == first + 1 && items_.points[first].normal == items_.normal(item)) return;
    shared_.set(i);
    sharedList_.push_back(uint32_t(i));
    hash_[i] = dealOfDirection(item, 0);
    const auto slots = slots_.begin() + ptrdiff_t(i * kSlots);
    for (uint32_t p = first, slot = 0; p < last; ++p) {
        const bool takesRest = p + 1 == last || items_.shareEnd[p] == 0xffffffffu;
        const uint32_t end = takesRest ? uint32_t(kSlots) : items_.shareEnd[p] >> 24;
        std::fill(slots + slot, slots + std::max(slot, end), uint8_t(p - first));
        slot = std::max(slot, end);
    }
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

size_t RayBlock::subPoint(size_t i, uint32_t k) const {
    if (!shared_.test(i)) return offsetStart_[i];
    return offsetStart_[i] + slots_[i * kSlots + ((hash_[i] + dealStep(k)) >> 24)];
}

PointMask RayBlock::above(const DirectionLevel& level, uint32_t k) {
    const Vec3f direction(level.x[k], level.y[k], level.z[k]);
    PointMask mask;
    if (!(coneAxis_.dot(direction) > -coneSine_ - 1e-4f)) return mask;
    placeShared(k);
    findFacing(normalX_.data(), normalY_.data(), normalZ_.data(), direction.x(), direction.y(), direction.z(),
               (block_.size() + 63) / 64, mask.words.data());
    return mask;
}

float RayBlock::cosineOf(const DirectionLevel& level, size_t i, uint32_t k) const {
    const Vec3f& n = normal_[subPoint(i, k)];
    return n.x() * level.x[k] + n.y() * level.y[k] + n.z() * level.z[k];
}

void RayBlock::placeShared(uint32_t k) {
    if (placed_ == k) return;
    placed_ = k;
    for (const uint32_t i : sharedList_) {
        const size_t point = subPoint(i, k);
        start_[i] = offset_[point];
        normalX_[i] = normal_[point].x();
        normalY_[i] = normal_[point].y();
        normalZ_[i] = normal_[point].z();
    }
}

PointMask RayBlock::visible(const DirectionLevel& level, uint32_t k, const PointMask& rays,
                            RayCasting casting) {
    placeShared(k);
    rays_ += rays.count();
    return casting == RayCasting::Stream ? streamed(level, k, rays) : inPackets(level, k, rays);
}

PointMask RayBlock::streamed(const DirectionLevel& level, uint32_t k, const PointMask& rays) {
    const std::array turned = turnedDirections(level, k);
    std::array<uint16_t, kMostBlockPoints> items;
    size_t count = 0;
    rays.forEach([&](size_t i) { items[count++] = uint16_t(i); });
    PointMask result;
    for (size_t begin = 0; begin < count; begin += RayStream::kCapacity) {
        const size_t end = std::min(count, begin + RayStream::kCapacity);
        stream_.clear();
        for (size_t ray = begin; ray < end; ++ray)
            stream_.add(start_[items[ray]], turned[orientation_[items[ray]]]);
        stream_.cast();
        for (size_t ray = begin; ray < end; ++ray)
            result.words[items[ray] / 64] |= uint64_t(!stream_.blocked(ray - begin)) << items[ray] % 64;
    }
    return result;
}

PointMask RayBlock::inPackets(const DirectionLevel& level, uint32_t k, const PointMask& rays) {
    const std::array turned = turnedDirections(level, k);
    PointMask result;
    std::array<Vec3f, 64> origins, directions;
    std::array<uint8_t, 64> blocked;
    for (size_t w = 0; w < rays.words.size(); ++w) {
        size_t count = 0;
        for (uint64_t left = rays.words[w]; left != 0; left &= left - 1) {
            const size_t i = w * 64 + size_t(std::countr_zero(left));
            origins[count] = start_[i];
            directions[count++] = turned[orientation_[i]];
        }
        caster_.occludedPackets(std::span(origins).first(count), std::span(directions).first(count), blocked);
        size_t ray = 0;
        for (uint64_t left = rays.words[w]; left != 0; left &= left - 1)
            result.words[w] |= uint64_t(!blocked[ray++]) << std::countr_zero(left);
    }
    return result;
}

void RayBlock::enqueue(const DirectionLevel& level, uint32_t k, const PointMask& rays,
                       std::vector<PointMask>& visible) {
    placeShared(k);
    const std::array turned = turnedDirections(level, k);
    rays.forEach([&](size_t i) {
        queuePlaces_[queue_.size()] = {k, uint32_t(i)};
        queue_.add(start_[i], turned[orientation_[i]]);
        if (queue_.size() == RayStream::kCapacity) flush(visible);
    });
}

void RayBlock::flush(std::vector<PointMask>& visible) {
    queue_.cast();
    rays_ += queue_.size();
    for (size_t ray = 0; ray < queue_.size(); ++ray)
        if (!queue_.blocked(ray)) visible[queuePlaces_[ray].first].set(queuePlaces_[ray].second);
    queue_.clear();
}

}  // namespace prt
