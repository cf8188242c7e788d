// Occlusion rays through Embree 3 [Wald2014], one by one, in packets and in streams. What is timed is written
// to be cheap: of a ray only what changes is set again.
#include "precompute/rays/occlusion_loop.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <random>

#include "precompute/base/check.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/rays/embree_internal.h"

namespace prt {
namespace {

constexpr size_t kBlock = 256;         // near points that take one direction at a time
constexpr size_t kRandomBlock = 1024;  // points of a thread whose rays go in random order
constexpr float kFar = std::numeric_limits<float>::infinity();

void clear(RTCRay& ray) {
    ray = {};
    ray.tfar = kFar;
    ray.mask = ~0u;
}

void clear(RTCRay16& packet) {
    packet = {};
    std::fill(std::begin(packet.tfar), std::end(packet.tfar), kFar);
    std::fill(std::begin(packet.mask), std::end(packet.mask), ~0u);
}

// Vectors by coordinate, so that dot products of many vectorise.
struct VectorArray {
    std::vector<float> x, y, z;

    explicit VectorArray(std::span<const Vec3f> vectors, float scale = 1) {
        for (const Vec3f& v : vectors) {
            x.push_back(v.x() * scale);
            y.push_back(v.y() * scale);
            z.push_back(v.z() * scale);
        }
    }
    // Which of [begin, begin + list.size()) make an acute angle with v; offsets from begin.
    size_t listAcute(size_t begin, size_t count, const Vec3f& v, uint16_t* list) const {
        std::array<float, kBlock> cosine;
        size_t found = 0;
        for (size_t start = 0; start < count; start += kBlock) {
            const size_t some = std::min(kBlock, count - start);
            const float *px = &x[begin + start], *py = &y[begin + start], *pz = &z[begin + start];
            for (size_t i = 0; i < some; ++i) cosine[i] = px[i] * v.x() + py[i] * v.y() + pz[i] * v.z();
            for (size_t i = 0; i < some; ++i) {
                list[found] = uint16_t(start + i);
                found += cosine[i] > 0;
            }
        }
        return found;
    }
};

}  // namespace

const char* rayArrangementName(RayArrangement arrangement) {
    switch (arrangement) {
        case RayArrangement::SingleRandom:
            return "single-random";
        case RayArrangement::SingleDirectionMajor:
            return "single-direction-major";
        case RayArrangement::PacketPointMajor:
            return "packet-point-major";
        case RayArrangement::PacketDirectionMajor:
            return "packet-direction-major";
        case RayArrangement::StreamDirectionMajor:
            return "stream-direction-major";
    }
    return "";
}

uint64_t OcclusionCount::allBlocked() const {
    return std::accumulate(blocked.begin(), blocked.end(), uint64_t(0));
}

struct OcclusionLoop::State {
    EmbreeScene own;  // empty where the caster's scene is used
    RTCScene scene = nullptr;
    VectorArray origins, normals, directions;
    std::vector<uint32_t> shuffledPoints, shuffledDirections;

    State(std::span<const Vec3f> allOrigins, std::span<const Vec3f> allNormals,
          std::span<const Vec3f> allDirections, float scale)
        : origins(allOrigins, scale), normals(allNormals), directions(allDirections) {
        std::mt19937 random(1);
        shuffledPoints.resize(allOrigins.size());
        std::iota(shuffledPoints.begin(), shuffledPoints.end(), 0u);
        std::shuffle(shuffledPoints.begin(), shuffledPoints.end(), random);
        shuffledDirections.resize(allDirections.size());
        std::iota(shuffledDirections.begin(), shuffledDirections.end(), 0u);
        std::shuffle(shuffledDirections.begin(), shuffledDirections.end(), random);
    }
    size_t pointCount() const { return origins.x.size(); }
    size_t directionCount() const { return directions.x.size(); }
    Vec3f origin(size_t i) const { return {origins.x[i], origins.y[i], origins.z[i]}; }
    Vec3f normal(size_t i) const { return {normals.x[i], normals.y[i], normals.z[i]}; }
    Vec3f direction(size_t k) const { return {directions.x[k], directions.y[k], directions.z[k]}; }

    // Each returns rays cast, and adds the blocked ones to blocked[point].
    uint64_t singleRandom(size_t begin, size_t end, uint32_t* blocked) const;
    uint64_t singles(size_t begin, size_t end, uint32_t* blocked) const;
    uint64_t pointPackets(size_t begin, size_t end, uint32_t* blocked) const;
    uint64_t packets(size_t begin, size_t end, uint32_t* blocked) const;
    uint64_t streams(size_t begin, size_t end, uint32_t* blocked) const;
    uint64_t cast(RayArrangement arrangement, size_t begin, size_t end, uint32_t* blocked) const;
};

uint64_t OcclusionLoop::State::singleRandom(size_t begin, size_t end, uint32_t* blocked) const {
    RTCIntersectContext context = makeContext(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    RTCRay ray;
    clear(ray);
    uint64_t rays = 0;
    // Every point takes its directions from a place of its own in the shuffled list.
    for (size_t pass = 0; pass < directionCount(); ++pass)
        for (size_t j = begin; j < end; ++j) {
            const uint32_t i = shuffledPoints[j];
            const uint32_t k = shuffledDirections[(pass + j * 2654435761u) % directionCount()];
            const Vec3f d = direction(k);
            if (!(normals.x[i] * d.x() + normals.y[i] * d.y() + normals.z[i] * d.z() > 0)) continue;
            ray.org_x = origins.x[i];
            ray.org_y = origins.y[i];
            ray.org_z = origins.z[i];
            ray.dir_x = d.x();
            ray.dir_y = d.y();
            ray.dir_z = d.z();
            ray.tfar = kFar;
            rtcOccluded1(scene, &context, &ray);
            blocked[i] += ray.tfar < 0;
            ++rays;
        }
    return rays;
}

uint64_t OcclusionLoop::State::singles(size_t begin, size_t end, uint32_t* blocked) const {
    RTCIntersectContext context = makeContext(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    RTCRay ray;
    clear(ray);
    std::array<uint16_t, kBlock> facing;
    uint64_t rays = 0;
    for (size_t k = 0; k < directionCount(); ++k) {
        const Vec3f d = direction(k);
        const size_t count = normals.listAcute(begin, end - begin, d, facing.data());
        ray.dir_x = d.x();
        ray.dir_y = d.y();
        ray.dir_z = d.z();
        for (size_t j = 0; j < count; ++j) {
            const size_t i = begin + facing[j];
            ray.org_x = origins.x[i];
            ray.org_y = origins.y[i];
            ray.org_z = origins.z[i];
            ray.tfar = kFar;
            rtcOccluded1(scene, &context, &ray);
            blocked[i] += ray.tfar < 0;
        }
        rays += count;
    }
    return rays;
}

uint64_t OcclusionLoop::State::pointPackets(size_t begin, size_t end, uint32_t* blocked) const {
    RTCIntersectContext context = makeContext(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    RTCRay16 packet;
    clear(packet);
    alignas(64) std::array<int, kRayPacket> valid;
    std::vector<uint16_t> facing(directionCount());
    uint64_t rays = 0;
    for (size_t i = begin; i < end; ++i) {
        const size_t count = directions.listAcute(0, directionCount(), normal(i), facing.data());
        std::fill(std::begin(packet.org_x), std::end(packet.org_x), origins.x[i]);
        std::fill(std::begin(packet.org_y), std::end(packet.org_y), origins.y[i]);
        std::fill(std::begin(packet.org_z), std::end(packet.org_z), origins.z[i]);
        for (size_t start = 0; start < count; start += kRayPacket) {
            const size_t some = std::min(kRayPacket, count - start);
            for (size_t lane = 0; lane < kRayPacket; ++lane) valid[lane] = lane < some ? -1 : 0;
            for (size_t lane = 0; lane < some; ++lane) {
                const size_t k = facing[start + lane];
                packet.dir_x[lane] = directions.x[k];
                packet.dir_y[lane] = directions.y[k];
                packet.dir_z[lane] = directions.z[k];
                packet.tfar[lane] = kFar;
            }
            rtcOccluded16(valid.data(), scene, &context, &packet);
            for (size_t lane = 0; lane < some; ++lane) blocked[i] += packet.tfar[lane] < 0;
        }
        rays += count;
    }
    return rays;
}

uint64_t OcclusionLoop::State::packets(size_t begin, size_t end, uint32_t* blocked) const {
    RTCIntersectContext context = makeContext(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
    RTCRay16 packet;
    clear(packet);
    alignas(64) std::array<int, kRayPacket> valid;
    std::array<uint16_t, kBlock> facing;
    uint64_t rays = 0;
    for (size_t k = 0; k < directionCount(); ++k) {
        const Vec3f d = direction(k);
        const size_t count = normals.listAcute(begin, end - begin, d, facing.data());
        std::fill(std::begin(packet.dir_x), std::end(packet.dir_x), d.x());
        std::fill(std::begin(packet.dir_y), std::end(packet.dir_y), d.y());
        std::fill(std::begin(packet.dir_z), std::end(packet.dir_z), d.z());
        for (size_t start = 0; start < count; start += kRayPacket) {
            const size_t some = std::min(kRayPacket, count - start);
            for (size_t lane = 0; lane < kRayPacket; ++lane) valid[lane] = lane < some ? -1 : 0;
            for (size_t lane = 0; lane < some; ++lane) {
                const size_t i = begin + facing[start + lane];
                packet.org_x[lane] = origins.x[i];
                packet.org_y[lane] = origins.y[i];
                packet.org_z[lane] = origins.z[i];
                packet.tfar[lane] = kFar;
            }
            rtcOccluded16(valid.data(), scene, &context, &packet);
            for (size_t lane = 0; lane < some; ++lane)
                blocked[begin + facing[start + lane]] += packet.tfar[lane] < 0;
        }
        rays += count;
    }
    return rays;
}

uint64_t OcclusionLoop::State::streams(size_t begin, size_t end, uint32_t* blocked) const {
    RTCIntersectContext context = makeContext(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    std::array<RTCRay, kRayStream> stream;
    for (RTCRay& ray : stream) clear(ray);
    std::array<uint16_t, kBlock> facing;
    uint64_t rays = 0;
    for (size_t k = 0; k < directionCount(); ++k) {
        const Vec3f d = direction(k);
        const size_t count = normals.listAcute(begin, end - begin, d, facing.data());
        for (size_t start = 0; start < count; start += kRayStream) {
            const size_t some = std::min(kRayStream, count - start);
            for (size_t j = 0; j < some; ++j) {
                const size_t i = begin + facing[start + j];
                stream[j].org_x = origins.x[i];
                stream[j].org_y = origins.y[i];
                stream[j].org_z = origins.z[i];
                stream[j].dir_x = d.x();
                stream[j].dir_y = d.y();
                stream[j].dir_z = d.z();
                stream[j].tfar = kFar;
            }
            rtcOccluded1M(scene, &context, stream.data(), unsigned(some), sizeof(RTCRay));
            for (size_t j = 0; j < some; ++j) blocked[begin + facing[start + j]] += stream[j].tfar < 0;
        }
        rays += count;
    }
    return rays;
}

uint64_t OcclusionLoop::State::cast(RayArrangement arrangement, size_t begin, size_t end,
                                    uint32_t* blocked) const {
    switch (arrangement) {
        case RayArrangement::SingleRandom:
            return singleRandom(begin, end, blocked);
        case RayArrangement::SingleDirectionMajor:
            return singles(begin, end, blocked);
        case RayArrangement::PacketPointMajor:
            return pointPackets(begin, end, blocked);
        case RayArrangement::PacketDirectionMajor:
            return packets(begin, end, blocked);
        case RayArrangement::StreamDirectionMajor:
            return streams(begin, end, blocked);
    }
    return 0;
}

OcclusionLoop::OcclusionLoop(const RayCaster& caster, std::span<const Vec3f> origins,
                             std::span<const Vec3f> normals, std::span<const Vec3f> directions, bool robust) {
    PRT_CHECK_EQ(origins.size(), normals.size());
    PRT_CHECK_LE(directions.size(), size_t(std::numeric_limits<uint16_t>::max()));
    const RayCaster::State& cast = *caster.state_;
    state_ = std::make_unique<State>(origins, normals, directions, cast.scale);
    if (!robust) state_->own.build(cast.positions, cast.indices, cast.scale, RTC_SCENE_FLAG_NONE);
    state_->scene = robust ? cast.embree.scene() : state_->own.scene();
}

OcclusionLoop::~OcclusionLoop() = default;
OcclusionLoop::OcclusionLoop(OcclusionLoop&&) noexcept = default;

OcclusionCount OcclusionLoop::run(RayArrangement arrangement) const {
    const State& s = *state_;
    OcclusionCount count;
    count.blocked.assign(s.pointCount(), 0);
    std::atomic<uint64_t> rays{0};
    const size_t block = arrangement == RayArrangement::SingleRandom ? kRandomBlock : kBlock;
    const Stopwatch watch;
    parallelFor(s.pointCount(), block, [&](size_t begin, size_t end) {
        rays += s.cast(arrangement, begin, end, count.blocked.data());
    });
    count.seconds = watch.seconds();
    count.rays = rays;
    return count;
}

}  // namespace prt
