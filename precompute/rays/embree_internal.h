// Embree's side of ray casting, for the files of this folder only.
#pragma once

#include <embree3/rtcore.h>

#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "precompute/rays/ray_caster.h"

namespace prt {

/// Rays of one call of rtcOccluded1M: longer streams are no faster, and spill the first-level cache.
inline constexpr size_t kRayStream = 128;
/// Rays of rtcOccluded16.
inline constexpr size_t kRayPacket = 16;

inline RTCIntersectContext makeContext(RTCIntersectContextFlags flags) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = flags;
    return context;
}

/// A device with one scene of one triangle mesh.
class EmbreeScene {
  public:
    EmbreeScene() = default;
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    /// Once per object.
    /// @param positions  all finite, scene units
    /// @param indices    3 per triangle, in range
    /// @param scale      what positions are multiplied by; rays must be, too
    /// @param flags      RTC_SCENE_FLAG_ROBUST for results; others only to learn what that costs. Not
    /// COMPACT:
    ///                   with ROBUST, and packets flagged COHERENT, Embree 3.13.5 can loop forever on AVX-512
    /// @throws InputError  Embree does not start, or no memory
    void build(std::span<const Vec3f> positions, std::span<const uint32_t> indices, float scale,
               RTCSceneFlags flags);
    RTCDevice device() const { return device_; }
    RTCScene scene() const { return scene_; }

  private:
    void throwIfFailed();

    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
    std::mutex errorMutex_;
    std::string error_;
};

struct RayCaster::State {
    EmbreeScene embree;
    std::vector<Vec3f> positions;  // as given
    std::vector<uint32_t> indices;
    float extent = 0;
    float scale = 1;     // power of two that brings the extent near 1
    float meanEdge = 0;  // square root of the mean area of a triangle
};

}  // namespace prt
