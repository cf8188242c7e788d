// A scene of Embree 3 [Wald2014].
#include <fmt/format.h>

#include <algorithm>

#include "precompute/base/error.h"
#include "precompute/rays/embree_internal.h"

namespace prt {

EmbreeScene::~EmbreeScene() {
    if (scene_) rtcReleaseScene(scene_);
    if (device_) rtcReleaseDevice(device_);
}

void EmbreeScene::throwIfFailed() {
    const RTCError code = rtcGetDeviceError(device_);
    const std::lock_guard lock(errorMutex_);
    if (code == RTC_ERROR_NONE && error_.empty()) return;
    throw InputError("ray casting", error_.empty() ? fmt::format("Embree error {}", int(code)) : error_,
                     code == RTC_ERROR_OUT_OF_MEMORY ? "use a mesh with fewer triangles" : "");
}

void EmbreeScene::build(std::span<const Vec3f> positions, std::span<const uint32_t> indices, float scale,
                        RTCSceneFlags flags) {
    device_ = rtcNewDevice(nullptr);
    if (!device_)
        throw InputError("ray casting",
                         fmt::format("Embree does not start (error {})", int(rtcGetDeviceError(nullptr))),
                         "it needs an x86-64 processor with SSE2 and enough memory");
    rtcSetDeviceErrorFunction(
        device_,
        [](void* user, RTCError, const char* message) {
            EmbreeScene& self = *static_cast<EmbreeScene*>(user);
            const std::lock_guard lock(self.errorMutex_);
            if (self.error_.empty() && message) self.error_ = message;
        },
        this);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, flags);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_MEDIUM);

    if (!indices.empty()) {
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        // Embree allocates (and pads) these buffers itself.
        auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), positions.size()));
        auto* triangles = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), indices.size() / 3));
        if (vertices && triangles) {
            for (size_t i = 0; i < positions.size(); ++i)
                for (int k = 0; k < 3; ++k) vertices[3 * i + size_t(k)] = positions[i][k] * scale;
            std::copy(indices.begin(), indices.end(), triangles);
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(scene_, geometry);
        }
        rtcReleaseGeometry(geometry);
    }
    throwIfFailed();
    rtcCommitScene(scene_);
    throwIfFailed();
}

}  // namespace prt
