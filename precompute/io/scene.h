// The mesh as the stages pass it on: plain arrays.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "precompute/math/vec.h"

namespace prt {

/// An image as it was in its file (PNG, JPEG or WebP bytes).
struct SceneTexture {
    std::string name;
    std::string mimeType;
    std::vector<uint8_t> encoded;
};

/// Diffuse surface with an optional tangent-space normal map (+Y up, as glTF).
struct SceneMaterial {
    std::string name;
    Vec3f baseColor{0.7f, 0.7f, 0.7f};  ///< linear
    int baseColorTexture = -1;          ///< index into textures, sRGB
    int normalTexture = -1;
    float normalScale = 1;
    bool doubleSided = false;
};

/// A run of triangles of one material, with a run of vertices that no other primitive uses.
struct ScenePrimitive {
    uint32_t firstVertex = 0, vertexCount = 0;
    uint32_t firstIndex = 0, indexCount = 0;  ///< into Scene::indices, 3 per triangle
    int material = 0;
};

/// Indexed triangles with one set of attributes per vertex; attributes are empty or have one entry per
/// vertex. World: right-handed, +Y up. Counter-clockwise triangles face the viewer.
struct Scene {
    std::vector<Vec3f> positions;
    std::vector<Vec3f> normals;   ///< unit
    std::vector<Vec4f> tangents;  ///< xyz unit, w = ±1: bitangent = w · cross(normal, tangent)
    std::vector<Vec2f> uv0;       ///< TEXCOORD_0, materials; v = 0 is the top row of the image, as glTF
    std::vector<Vec2f> uv1;       ///< TEXCOORD_1, atlas; in [0, 1], v = 0 is the top row
    std::vector<uint32_t> indices;
    std::vector<ScenePrimitive> primitives;
    std::vector<SceneMaterial> materials;
    std::vector<SceneTexture> textures;

    size_t vertexCount() const { return positions.size(); }
    size_t triangleCount() const { return indices.size() / 3; }
};

/// [triangles] 1 for those of a material that is shown from both sides.
std::vector<uint8_t> doubleSidedTriangles(const Scene& scene);

/// Smallest axis-aligned box around all positions.
struct Bounds {
    Vec3f low, high;
};
Bounds sceneBounds(const Scene& scene);

/// Geometric (face) normal of a triangle, unit; (0,0,0) when it has no area. Computed in double.
Vec3f triangleNormal(const Scene& scene, size_t triangle);

/// Checks every promise of Scene (indices in range, runs disjoint, attribute counts, finite numbers).
/// @throws InputError naming `where`
void validateScene(const Scene& scene, const std::string& where);

}  // namespace prt
