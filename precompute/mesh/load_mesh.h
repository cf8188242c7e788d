// Any mesh file → a clean Scene.
#pragma once

#include <map>
#include <string>

#include "precompute/io/scene.h"

namespace prt {

struct LoadMeshOptions {
    double uvScale = 1;     ///< metres (scene units) per tile of box-projected TEXCOORD_0, where it is absent
    std::string normalMap;  ///< image file used as normal map by materials that have none; "" = none
    double creaseAngleDeg = 60;  ///< made normals are not averaged across sharper edges
};

/// What was repaired or made, by kind, e.g. {"degenerate_faces_dropped", 3}. Zero counts are left out.
struct LoadMeshReport {
    std::map<std::string, size_t> counts;
    bool hasAtlas =
        false;  ///< the file's second UV set is a valid atlas (in [0,1], no overlap) and stands in uv1
};

/// Loads OBJ+MTL (tinyobjloader), PLY, OFF, STL (OpenMesh), glTF, GLB (tinygltf); polygons triangulated,
/// harmless damage repaired and counted, normals (angle-weighted), TEXCOORD_0 (box projection) and tangents
/// made where absent. Every attribute but uv1 is present afterwards, primitives own their vertices, and
/// validateScene holds.
/// @throws InputError  missing, unknown extension, damaged, no face with area left, NaN position, index out
/// of range
Scene loadMesh(const std::string& path, const LoadMeshOptions& options, LoadMeshReport* report = nullptr);

/// The same repairs on triangles that are already in memory (what readGltf returns, or made by a program).
Scene prepareScene(Scene scene, const std::string& where, const LoadMeshOptions& options,
                   LoadMeshReport* report = nullptr);

/// Tangents from uv0 per vertex: angle-weighted over triangles, orthogonal to the normal, w by handedness.
/// Vertices whose triangles disagree in handedness must have been split before (prepareScene does).
void makeTangents(Scene& scene);

}  // namespace prt
