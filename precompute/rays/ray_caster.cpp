// Ray casting through Embree 3 [Wald2014]. The watertight (robust) intersector is [Woop2013]'s idea in
// Plücker coordinates; the offset of ray origins follows the error analysis of [PharrJakobHumphreys2016,
// Sec. 3.9], reduced to two bounds: one relative to the scene, one relative to the coordinates.
#include "precompute/rays/ray_caster.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/rays/embree_internal.h"

namespace prt {
namespace {

// Embree ignores coordinates beyond this (its FLT_LARGE is 1.8e18).
constexpr float kLargestCoordinate = 1e18f;

constexpr float kFar = std::numeric_limits<float>::infinity();

RayHit hitOf(const RTCRayHit& query, float scale) {
    RayHit hit;
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
    hit.triangle = query.hit.primID;
    hit.distance = query.ray.tfar / scale;
    hit.u = query.hit.u;
    hit.v = query.hit.v;
    hit.backFace = query.hit.Ng_x * query.ray.dir_x + query.hit.Ng_y * query.ray.dir_y +
                       query.hit.Ng_z * query.ray.dir_z >
                   0;
    return hit;
}

// What changes from one query to the next; Embree itself writes nothing but tfar.
void setRay(RTCRay& ray, const Vec3f& origin, const Vec3f& direction) {
    ray.org_x = origin.x();
    ray.org_y = origin.y();
    ray.org_z = origin.z();
    ray.dir_x = direction.x();
    ray.dir_y = direction.y();
    ray.dir_z = direction.z();
    ray.tfar = kFar;
}

RTCRay makeRay(const Vec3f& origin, const Vec3f& direction) {
    RTCRay ray = {};
    ray.tfar = kFar;
    ray.mask = ~0u;
    setRay(ray, origin, direction);
    return ray;
}

// On the heap, so that every thread of the process does not carry it.
template <class Value>
Value& keptByThread() {
    thread_local const std::unique_ptr<Value> kept = std::make_unique<Value>();
    return *kept;
}

// Rays 0 … count − 1; endsOf(i) are the origin and the direction of one.
template <class EndsOf>
void castAll(const RayCaster& caster, size_t count, std::span<uint8_t> occluded, const EndsOf& endsOf) {
    RayStream stream(caster);
    for (size_t begin = 0; begin < count; begin += RayStream::kCapacity) {
        const size_t end = std::min(count, begin + RayStream::kCapacity);
        stream.clear();
        for (size_t i = begin; i < end; ++i) stream.add(endsOf(i).first, endsOf(i).second);
        stream.cast();
        for (size_t i = begin; i < end; ++i) occluded[i] = stream.blocked(i - begin);
    }
}

struct HitStream {
    std::array<RTCRayHit, kRayStream> queries{};
};

struct Packet {
    RTCRay16 rays = {};
    alignas(64) std::array<int, kRayPacket> valid{};
    Packet() { std::fill(std::begin(rays.mask), std::end(rays.mask), ~0u); }

    void set(std::span<const Vec3f> origins, std::span<const Vec3f> directions, float scale) {
        for (size_t i = 0; i < kRayPacket; ++i) valid[i] = i < origins.size() ? -1 : 0;
        for (size_t i = 0; i < origins.size(); ++i) {
            rays.org_x[i] = origins[i].x() * scale;
            rays.org_y[i] = origins[i].y() * scale;
            rays.org_z[i] = origins[i].z() * scale;
            rays.dir_x[i] = directions[i].x();
            rays.dir_y[i] = directions[i].y();
            rays.dir_z[i] = directions[i].z();
            rays.tfar[i] = kFar;
        }
    }
};

void measure(std::span<const Vec3f> positions, std::span<const uint32_t> indices, float& extent,
             float& scale) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Vec3d low(kInfinity, kInfinity, kInfinity), high = -low;
    for (const uint32_t index : indices) {
        PRT_CHECK_LT(size_t(index), positions.size());
        const Vec3f& p = positions[index];
        if (!(p.cwiseAbs().maxCoeff() < kLargestCoordinate) || !p.allFinite())
            throw InputError(fmt::format("vertex {}", index),
                             fmt::format("its position ({}, {}, {}) is not finite or beyond {}", p.x(), p.y(),
                                         p.z(), kLargestCoordinate),
                             "repair the mesh or choose a larger unit of length");
        low = low.cwiseMin(p.cast<double>());
        high = high.cwiseMax(p.cast<double>());
    }
    extent = indices.empty() ? 0.0f : float((high - low).norm());
    // Multiplying by a power of two is exact, and keeps products of three lengths inside the range of float.
    const int exponent = extent > 0 ? std::ilogb(extent) : 0;
    scale = std::ldexp(1.0f, std::clamp(-exponent, -100, 100));
}

// Square root of the mean area of a triangle.
float meanEdge(std::span<const Vec3f> positions, std::span<const uint32_t> indices) {
    double area = 0;
    for (size_t i = 0; i < indices.size(); i += 3) {
        const Vec3d a = positions[indices[i]].cast<double>();
        area += 0.5 * (positions[indices[i + 1]].cast<double>() - a)
                          .cross(positions[indices[i + 2]].cast<double>() - a)
                          .norm();
    }
    return indices.empty() ? 0.0f : float(std::sqrt(area / double(indices.size() / 3)));
}

}  // namespace

RayCaster::RayCaster(std::span<const Vec3f> positions, std::span<const uint32_t> indices)
    : state_(std::make_unique<State>()) {
    PRT_CHECK_EQ(indices.size() % 3, size_t(0));
    State& s = *state_;
    measure(positions, indices, s.extent, s.scale);
    s.meanEdge = meanEdge(positions, indices);
    s.positions.assign(positions.begin(), positions.end());
    s.indices.assign(indices.begin(), indices.end());

    s.embree.build(positions, indices, s.scale, RTC_SCENE_FLAG_ROBUST);
}

RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

void RayCaster::occluded(std::span<const Vec3f> origins, const Vec3f& direction,
                         std::span<uint8_t> occluded) const {
    PRT_CHECK_LE(origins.size(), occluded.size());
    castAll(*this, origins.size(), occluded,
            [&](size_t i) { return std::pair<const Vec3f&, const Vec3f&>(origins[i], direction); });
}

void RayCaster::occluded(const Vec3f& origin, std::span<const Vec3f> directions,
                         std::span<uint8_t> occluded) const {
    PRT_CHECK_LE(directions.size(), occluded.size());
    castAll(*this, directions.size(), occluded,
            [&](size_t i) { return std::pair<const Vec3f&, const Vec3f&>(origin, directions[i]); });
}

RayStream::RayStream(const RayCaster& caster) : caster_(caster), scale_(caster.state_->scale) {
    static_assert(sizeof(Ray) == sizeof(RTCRay) && alignof(Ray) == alignof(RTCRay));
    static_assert(offsetof(Ray, direction) == offsetof(RTCRay, dir_x));
    static_assert(offsetof(Ray, far) == offsetof(RTCRay, tfar));
    static_assert(offsetof(Ray, mask) == offsetof(RTCRay, mask));
    static_assert(kCapacity == kRayStream);
}

void RayStream::cast() {
    RTCIntersectContext context = makeContext(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    rtcOccluded1M(caster_.state_->embree.scene(), &context, reinterpret_cast<RTCRay*>(rays_.data()),
                  unsigned(size_), sizeof(RTCRay));
}

void RayCaster::occludedPackets(std::span<const Vec3f> origins, std::span<const Vec3f> directions,
                                std::span<uint8_t> occluded) const {
    PRT_CHECK_EQ(origins.size(), directions.size());
    PRT_CHECK_LE(origins.size(), occluded.size());
    Packet& packet = keptByThread<Packet>();
    const State& s = *state_;
    RTCIntersectContext context = makeContext(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
    for (size_t begin = 0; begin < origins.size(); begin += kRayPacket) {
        const size_t count = std::min(kRayPacket, origins.size() - begin);
        packet.set(origins.subspan(begin, count), directions.subspan(begin, count), s.scale);
        rtcOccluded16(packet.valid.data(), s.embree.scene(), &context, &packet.rays);
        for (size_t i = 0; i < count; ++i) occluded[begin + i] = packet.rays.tfar[i] < 0;
    }
}

bool RayCaster::packetsAreFaster(float spacing) const {
    const std::string isa = instructionSet();
    // Where both are about equally fast, in mean edges of triangles: rays of four orientations slow packets
    // more than streams (tools/docs/performance.md).
    const float limit = isa == "AVX512" ? 0.35f : isa == "AVX2" ? 0.15f : 0.0f;
    return spacing < limit * state_->meanEdge;
}

RayHit RayCaster::firstHit(const Vec3f& origin, const Vec3f& direction, float farthest) const {
    const State& s = *state_;
    RTCRayHit query;
    query.ray = makeRay(origin * s.scale, direction);
    query.ray.tfar = farthest * s.scale;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context = makeContext(RTC_INTERSECT_CONTEXT_FLAG_NONE);
    rtcIntersect1(s.embree.scene(), &context, &query);
    return hitOf(query, s.scale);
}

void RayCaster::firstHits(std::span<const Vec3f> origins, std::span<const Vec3f> directions,
                          std::span<RayHit> hits) const {
    PRT_CHECK_EQ(origins.size(), directions.size());
    PRT_CHECK_LE(origins.size(), hits.size());
    HitStream& stream = keptByThread<HitStream>();
    const State& s = *state_;
    RTCIntersectContext context = makeContext(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    for (size_t begin = 0; begin < origins.size(); begin += kRayStream) {
        const size_t count = std::min(kRayStream, origins.size() - begin);
        for (size_t i = 0; i < count; ++i) {
            RTCRayHit& query = stream.queries[i];
            query.ray = makeRay(origins[begin + i] * s.scale, directions[begin + i]);
            query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect1M(s.embree.scene(), &context, stream.queries.data(), unsigned(count), sizeof(RTCRayHit));
        for (size_t i = 0; i < count; ++i) hits[begin + i] = hitOf(stream.queries[i], s.scale);
    }
}

float RayCaster::offsetDistance(const Vec3f& position) const {
    return std::ldexp(state_->extent, -20) + std::ldexp(position.cwiseAbs().maxCoeff(), -22);
}

Vec3f RayCaster::offsetOrigin(const Vec3f& position, const Vec3f& normal) const {
    return position + offsetDistance(position) * normal;
}

Vec3f RayCaster::snapToPlane(const Vec3f& position, uint32_t triangle) const {
    const State& s = *state_;
    PRT_CHECK_LT(size_t(triangle), s.indices.size() / 3);
    const uint32_t* corner = &s.indices[3 * size_t(triangle)];
    const Vec3d a = s.positions[corner[0]].cast<double>(), b = s.positions[corner[1]].cast<double>(),
                c = s.positions[corner[2]].cast<double>(), p = position.cast<double>();
    const Vec3d normal = (b - a).cross(c - a);
    const double squared = normal.squaredNorm();
    if (!(squared > 0)) return position;
    const double height = (p - a).dot(normal) / std::sqrt(squared);
    if (std::abs(height) > 1e-4 * double(s.extent)) return position;
    return (p - height / std::sqrt(squared) * normal).cast<float>();
}

size_t RayCaster::triangleCount() const { return state_->indices.size() / 3; }
std::span<const Vec3f> RayCaster::positions() const { return state_->positions; }
std::span<const uint32_t> RayCaster::indices() const { return state_->indices; }
float RayCaster::extent() const { return state_->extent; }

std::string RayCaster::instructionSet() const {
    const RTCDevice device = state_->embree.device();
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) return "AVX512";
    if (!rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)) return "SSE2";
    return __builtin_cpu_supports("avx2") ? "AVX2" : "AVX";
}

}  // namespace prt
