// Rays against a static triangle mesh. The only place that knows Embree.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>

#include "precompute/math/vec.h"

namespace prt {

struct RayHit {
    uint32_t triangle = 0xffffffffu;  ///< 0xffffffff: nothing hit
    float distance = 0;
    float u = 0, v = 0;     ///< barycentric coordinates of corners 1 and 2
    bool backFace = false;  ///< the ray meets the clockwise side
};

class RayCaster {
  public:
    /// Builds the acceleration structure (robust intersection).
    /// @param positions  all finite; copied (scaled by a power of two, so results do not depend on the scale)
    /// @param indices    3 per triangle, in range
    /// @throws InputError  a position is not finite, or no memory
    RayCaster(std::span<const Vec3f> positions, std::span<const uint32_t> indices);
    ~RayCaster();
    RayCaster(RayCaster&&) noexcept;
    RayCaster& operator=(RayCaster&&) noexcept;

    /// One direction from many near points: occluded[i] = 1 when anything lies on the ray from origins[i].
    /// What comes out for a ray does not depend on the other rays.
    /// @param origins     [N] already offset (offsetOrigin), scene units, near each other for speed
    /// @param direction   unit
    /// @param occluded    [N] out
    /// @source streams of rays [Wald2014]
    void occluded(std::span<const Vec3f> origins, const Vec3f& direction, std::span<uint8_t> occluded) const;

    /// As RayStream, 16 at a time, for rays near each other in both: faster where packetsAreFaster. Whether
    /// a ray that grazes an edge within rounding is blocked may depend on the others of its 16 (of the rays
    /// from a multiple of 16 on): seen in one ray of a thousand that were aimed at edges, in none of millions
    /// from surfaces.
    /// @source packets of rays, their common frustum tested first [Wald2014]
    void occludedPackets(std::span<const Vec3f> origins, std::span<const Vec3f> directions,
                         std::span<uint8_t> occluded) const;

    /// Whether occludedPackets is the faster of the two, by what was measured; the same answer on every
    /// machine of one instruction set.
    /// @param spacing  between neighbouring origins, scene units
    bool packetsAreFaster(float spacing) const;

    /// Many directions from one point.
    void occluded(const Vec3f& origin, std::span<const Vec3f> directions, std::span<uint8_t> occluded) const;

    /// First hit.
    /// @param farthest  scene units; what lies beyond is not looked for
    RayHit firstHit(const Vec3f& origin, const Vec3f& direction,
                    float farthest = std::numeric_limits<float>::infinity()) const;
    /// The same of many rays, for speed near each other in both; other hits of equal distance may be found.
    /// @param origins, directions, hits  [N]
    /// @source streams of rays [Wald2014]
    void firstHits(std::span<const Vec3f> origins, std::span<const Vec3f> directions,
                   std::span<RayHit> hits) const;

    /// Start of rays that leave a surface point into the hemisphere of its geometric normal: moved along the
    /// normal by offsetDistance(position).
    Vec3f offsetOrigin(const Vec3f& position, const Vec3f& normal) const;

    /// 2^-20 of the extent (what ray-triangle tests over the whole scene can be wrong by) plus 2^-22 of the
    /// largest coordinate (2 to 4 units in its last place: what rounding of the position and of the moved
    /// origin can be wrong by).
    float offsetDistance(const Vec3f& position) const;

    /// The point of a triangle's plane nearest to `position`, for positions that are off by more than
    /// rounding (interpolated by a rasteriser). Unchanged when the triangle has no area or the plane is
    /// farther than 1e-4 extents.
    /// @param triangle  < triangleCount()
    Vec3f snapToPlane(const Vec3f& position, uint32_t triangle) const;

    size_t triangleCount() const;
    /// As given.
    std::span<const Vec3f> positions() const;
    std::span<const uint32_t> indices() const;  ///< 3 per triangle
    /// Diagonal of the bounding box of the triangles.
    float extent() const;

    /// "SSE2", "AVX", "AVX2" or "AVX512": what Embree runs on here; results may differ in rare grazing rays.
    std::string instructionSet() const;

  private:
    friend class OcclusionLoop;
    friend class RayStream;
    struct State;
    std::unique_ptr<State> state_;
};

/// Rays that are cast together, of any origins and directions; for speed in an order in which those that
/// follow each other are near in both. What comes out for a ray does not depend on the others.
/// @source streams of rays [Wald2014]
class RayStream {
  public:
    /// Longer streams are no faster, and spill the first-level cache.
    static constexpr size_t kCapacity = 128;

    /// @param caster  must outlive the stream
    explicit RayStream(const RayCaster& caster);

    size_t size() const { return size_; }
    void clear() { size_ = 0; }
    /// @param origin     already offset (RayCaster::offsetOrigin), scene units
    /// @param direction  unit
    void add(const Vec3f& origin, const Vec3f& direction) {
        Ray& ray = rays_[size_++];
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = origin[k] * scale_;
            ray.direction[k] = direction[k];
        }
        ray.far = std::numeric_limits<float>::infinity();
    }
    /// Casts all rays; then whether anything lies on ray i.
    void cast();
    bool blocked(size_t i) const { return rays_[i].far < 0; }

  private:
    // Embree's ray. What add() does not set never changes.
    struct alignas(16) Ray {
        float origin[3] = {}, near = 0, direction[3] = {}, time = 0, far = 0;
        uint32_t mask = ~uint32_t(0), id = 0, flags = 0;
    };
    const RayCaster& caster_;
    float scale_;
    size_t size_ = 0;
    std::array<Ray, kCapacity> rays_;
};

}  // namespace prt
