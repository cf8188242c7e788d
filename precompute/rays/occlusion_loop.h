// The bare ray-casting loop: occlusion rays and nothing else, in the orders that a program may cast them in.
// How fast a bake could be at most, and what its results can be checked against.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "precompute/math/vec.h"
#include "precompute/rays/ray_caster.h"

namespace prt {

/// In which order rays are cast, and how many at a time. "Near" points and directions are those that follow
/// each other in what the loop was given.
enum class RayArrangement {
    SingleRandom,          ///< one by one, point and direction at random
    SingleDirectionMajor,  ///< one by one, a direction over near points
    PacketPointMajor,      ///< 16 at once, a point and near directions
    PacketDirectionMajor,  ///< 16 at once, a direction and near points, flagged coherent
    StreamDirectionMajor,  ///< up to 128 at once, a direction and near points, not flagged coherent
};
inline constexpr std::array kRayArrangements{
    RayArrangement::SingleRandom, RayArrangement::SingleDirectionMajor, RayArrangement::PacketPointMajor,
    RayArrangement::PacketDirectionMajor, RayArrangement::StreamDirectionMajor};
/// "single-random", "single-direction-major", "packet-point-major", "packet-direction-major",
/// "stream-direction-major".
const char* rayArrangementName(RayArrangement arrangement);

struct OcclusionCount {
    uint64_t rays = 0;              ///< cast: those above their point's horizon
    double seconds = 0;             ///< wall clock
    std::vector<uint32_t> blocked;  ///< [points] blocked rays

    uint64_t allBlocked() const;
};

class OcclusionLoop {
  public:
    /// Points near each other should follow each other, and so should directions.
    /// @param caster      its scene is used; must outlive the loop
    /// @param origins     [N] starts of rays, scene units, as RayCaster::offsetOrigin gives them
    /// @param normals     [N] unit, the horizon; zero: the point casts no ray
    /// @param directions  [K] unit, at most 65,535
    /// @param robust      false: another scene of the same triangles is built whose intersection tests are
    ///                    not watertight, to learn what robustness costs
    /// @throws InputError  no memory
    OcclusionLoop(const RayCaster& caster, std::span<const Vec3f> origins, std::span<const Vec3f> normals,
                  std::span<const Vec3f> directions, bool robust = true);
    ~OcclusionLoop();
    OcclusionLoop(OcclusionLoop&&) noexcept;

    /// Casts a ray from every point into every direction above its horizon, on all threads of parallelFor.
    /// All arrangements cast the same rays; results of a few that graze an edge may differ between single
    /// rays, coherent packets and the rest.
    /// @throws Interrupted
    /// @source arrangements of [Wald2014]'s interface
    OcclusionCount run(RayArrangement arrangement) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace prt
