// glTF 2.0 binary: in (any .glb or .gltf) and out (the bundle's mesh.glb).
#pragma once

#include <string>

#include "precompute/io/scene.h"

namespace prt {

/// What a glTF file holds before the mesh stage repairs it: triangles with the transforms of its nodes
/// applied. Missing attributes are left empty only if no primitive has them, else filled with zeros for the
/// ones without; the mesh stage makes them. Every accessor is checked against its buffer view and buffer;
/// sparse accessors, strips and fans are understood. External buffers and images of .gltf are read from
/// beside it.
/// @throws InputError  missing, truncated, accessor out of bounds, no triangles, index out of range
Scene readGltf(const std::string& path);

/// Writes positions, normals, tangents, TEXCOORD_0, TEXCOORD_1, materials and textures (PNG/JPEG/WebP bytes
/// in buffer views; WebP through EXT_texture_webp). One glTF primitive per ScenePrimitive, vertices in Scene
/// order.
/// @throws OutputError
void writeGlb(const Scene& scene, const std::string& path);

}  // namespace prt
