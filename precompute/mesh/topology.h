// Which triangles touch which: welded positions, paired half-edges, disjoint sets. Internal to the mesh
// stage.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/math/vec.h"

namespace prt {

inline constexpr uint32_t kNone = 0xffffffffu;

/// Ids by exact position (−0 equals 0), numbered by first appearance.
/// @param count  number of different positions
/// @return [positions] id of each
std::vector<uint32_t> weldPositions(std::span<const Vec3f> positions, uint32_t& count);

/// (b − a) × (c − a): twice the area along the geometric normal, in double.
Vec3d triangleCross(const Vec3f& a, const Vec3f& b, const Vec3f& c);

/// Unit normals of triangles; zero where there is no area.
/// @param corners  [3×triangles] indices into positions
std::vector<Vec3f> faceNormals(std::span<const Vec3f> positions, std::span<const uint32_t> corners);

/// Half-edge 3t + k runs from corner k to corner (k + 1) mod 3 of triangle t.
struct Adjacency {
    std::vector<uint32_t> twin;    ///< [3×triangles] half-edge on the other side, kNone at a border
    size_t nonManifoldEdges = 0;   ///< shared by more than two triangles
    size_t inconsistentEdges = 0;  ///< shared by two triangles that run along it the same way
    size_t boundaryEdges = 0;      ///< of one triangle
};

/// Pairs the half-edges of a soup of triangles with welded corners. Around a non-manifold edge, triangles
/// that run in opposite directions are paired from the flattest pair on, the rest is left as a border;
/// triangles of inconsistent winding are not paired.
Adjacency pairHalfEdges(std::span<const uint32_t> corners, uint32_t vertexCount,
                        std::span<const Vec3f> normals);

/// Unpairs half-edges between faces whose normals' angle has a cosine below this.
void cutCreases(std::vector<uint32_t>& twin, std::span<const Vec3f> normals, float cosine);

/// Union-find; the representative of a set is its lowest member.
class DisjointSets {
  public:
    explicit DisjointSets(size_t count);
    uint32_t find(uint32_t item);
    void unite(uint32_t a, uint32_t b);

  private:
    std::vector<uint32_t> parent_;
};

inline uint32_t nextCorner(uint32_t halfEdge) { return halfEdge % 3 == 2 ? halfEdge - 2 : halfEdge + 1; }
inline uint32_t previousCorner(uint32_t halfEdge) { return halfEdge % 3 == 0 ? halfEdge + 2 : halfEdge - 1; }

}  // namespace prt
