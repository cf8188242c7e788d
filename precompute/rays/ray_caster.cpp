// Ray casting through Embree 3 [Wald2014]. The watertight (robust) intersector is [Woop2013]'s idea in
// Plücker coordinates; the offset of ray origins follows the error analysis of [PharrJakobHumphreys2016,
// Sec. 3.9], reduced to two bounds: one relative to the scene, one relative to the coordinates.
#include "precompute/rays/ray_caster.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/rays/embree_internal.h"

namespace prt {
namespace {

// One stream of rays; larger ones gain nothing and spill the first-level cache.
constexpr size_t kStream = 256;

// Embree ignores coordinates beyond this (its FLT_LARGE is 1.8e18).
constexpr float kLargestCoordinate = 1e18f;

RTCRay makeRay(const Vec3f& origin, const Vec3f& direction) {
    RTCRay ray;
    ray.org_x = origin.x();
    ray.org_y = origin.y();
    ray.org_z = origin.z();
    ray.tnear = 0;
    ray.dir_x = direction.x();
    ray.dir_y = direction.y();
    ray.dir_z = direction.z();
    ray.time = 0;
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = ~0u;
    ray.id = 0;
    ray.flags = 0;
    return ray;
}

void occludedStream(RTCScene scene, RTCRay* rays, size_t count, uint8_t* occluded) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcOccluded1M(scene, &context, rays, unsigned(count), sizeof(RTCRay));
    for (size_t i = 0; i < count; ++i) occluded[i] = rays[i].tfar < 0;
}

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

}  // namespace

RayCaster::RayCaster(std::span<const Vec3f> positions, std::span<const uint32_t> indices)
    : state_(std::make_unique<State>()) {
    PRT_CHECK_EQ(indices.size() % 3, size_t(0));
    State& s = *state_;
    measure(positions, indices, s.extent, s.scale);
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
    const State& s = *state_;
    std::array<RTCRay, kStream> rays;
    for (size_t begin = 0; begin < origins.size(); begin += kStream) {
        const size_t count = std::min(kStream, origins.size() - begin);
        for (size_t i = 0; i < count; ++i) rays[i] = makeRay(origins[begin + i] * s.scale, direction);
        occludedStream(s.embree.scene(), rays.data(), count, &occluded[begin]);
    }
}

void RayCaster::occluded(const Vec3f& origin, std::span<const Vec3f> directions,
                         std::span<uint8_t> occluded) const {
    PRT_CHECK_LE(directions.size(), occluded.size());
    const State& s = *state_;
    const Vec3f start = origin * s.scale;
    std::array<RTCRay, kStream> rays;
    for (size_t begin = 0; begin < directions.size(); begin += kStream) {
        const size_t count = std::min(kStream, directions.size() - begin);
        for (size_t i = 0; i < count; ++i) rays[i] = makeRay(start, directions[begin + i]);
        occludedStream(s.embree.scene(), rays.data(), count, &occluded[begin]);
    }
}

RayHit RayCaster::firstHit(const Vec3f& origin, const Vec3f& direction) const {
    const State& s = *state_;
    RTCRayHit query;
    query.ray = makeRay(origin * s.scale, direction);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(s.embree.scene(), &context, &query);
    RayHit hit;
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
    hit.triangle = query.hit.primID;
    hit.distance = query.ray.tfar / s.scale;
    hit.u = query.hit.u;
    hit.v = query.hit.v;
    hit.backFace = Vec3f(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).dot(direction) > 0;
    return hit;
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
float RayCaster::extent() const { return state_->extent; }

std::string RayCaster::instructionSet() const {
    const RTCDevice device = state_->embree.device();
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) return "AVX512";
    if (!rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)) return "SSE2";
    return __builtin_cpu_supports("avx2") ? "AVX2" : "AVX";
}

}  // namespace prt
