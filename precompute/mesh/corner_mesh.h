// The mesh while it is read and repaired: triangles whose corners index pools of attributes, as OBJ has them.
// Internal to the mesh stage.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "precompute/io/scene.h"
#include "precompute/mesh/load_mesh.h"
#include "precompute/mesh/topology.h"

namespace prt {

struct CornerMesh {
    std::vector<Vec3f> positions, normals;
    std::vector<Vec2f> uv0, uv1;
    std::vector<Vec4f> tangents;
    std::vector<uint32_t> position;          ///< [3×triangles]
    std::vector<uint32_t> normal, texcoord;  ///< [3×triangles] or empty; kNone where a corner has none
    std::vector<uint32_t> uv1Index;          ///< [3×triangles] or empty
    std::vector<uint32_t> tangent;           ///< [3×triangles] or empty; kNone where a corner has none
    std::vector<int> material;               ///< [triangles]
    std::vector<SceneMaterial> materials;
    std::vector<SceneTexture> textures;

    size_t triangleCount() const { return position.size() / 3; }
};

/// Adds to a count of the report, unless it is zero.
void countRepair(LoadMeshReport& report, const char* kind, size_t count);

/// Welds equal positions, drops isolated vertices and degenerate and duplicate faces.
/// @throws InputError  no face with area left, a position that is not finite
void repairFaces(CornerMesh& mesh, const std::string& where, LoadMeshReport& report);

/// Makes the normals of corners that have none or an unusable one: angle-weighted over the fan of faces that
/// is reached without crossing an edge sharper than the crease angle. Renormalises the others.
/// @source G. Thürmer and C. Wüthrich, "Computing vertex normals from polygonal facets", JGT 3(1), 1998
void makeNormals(CornerMesh& mesh, const Adjacency& adjacency, const std::vector<Vec3f>& faceNormal,
                 double creaseAngleDeg, LoadMeshReport& report);

/// Box-projects the texture coordinates of triangles that lack them at a corner.
/// @param uvScale  scene units per tile
void makeTexcoords(CornerMesh& mesh, const std::vector<Vec3f>& faceNormal, double uvScale);

/// Side of the tangent frame at a corner: +1, −1, or 0 where the triangle has no area in uv0.
int cornerHandedness(const Vec3f& normal, const Vec3f& faceNormal, const Vec2f& uvA, const Vec2f& uvB,
                     const Vec2f& uvC);

/// makeTangents for the vertices that are not marked in `keep` ([vertices] or empty).
void makeTangents(Scene& scene, const std::vector<uint8_t>& keep);

/// All of the above, and vertices from corners.
Scene prepareCorners(CornerMesh mesh, const std::string& where, const LoadMeshOptions& options,
                     LoadMeshReport& report);

/// Interior angle at corner `a` of a triangle, radians.
double cornerAngle(const Vec3f& a, const Vec3f& b, const Vec3f& c);

}  // namespace prt
