// One reader per file format. Each checks counts against the size of the file before it allocates, and every
// index. Internal to the mesh stage.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "precompute/mesh/corner_mesh.h"

namespace prt {

/// @throws InputError  missing, damaged, index out of range
CornerMesh readObj(const std::filesystem::path& path, LoadMeshReport& report);
CornerMesh readPly(const std::filesystem::path& path, LoadMeshReport& report);
CornerMesh readOff(const std::filesystem::path& path, LoadMeshReport& report);
CornerMesh readStl(const std::filesystem::path& path, LoadMeshReport& report);

/// What the scan of an OBJ file finds before tinyobjloader reads it.
struct ObjCounts {
    size_t vertices = 0, faces = 0, polygons = 0;
};
/// @throws InputError  with the line: index out of range, number missing or not finite, no faces
ObjCounts scanObj(std::string_view text, const std::string& where);

/// Cuts a polygon into triangles by ear clipping in the plane of its mean normal; concave ones too, and
/// self-intersecting ones in some way. Winding is kept.
/// @param  points  [n ≥ 3] corners in order
/// @return n − 2 triangles as positions in `points`
std::vector<std::array<uint32_t, 3>> triangulatePolygon(std::span<const Vec3f> points);

/// Polygons beyond this are refused: ear clipping is quadratic.
inline constexpr size_t kMaxPolygonCorners = 10000;

/// Corners of one polygon as they are read, then appended to a mesh as triangles.
class PolygonAppender {
  public:
    PolygonAppender(CornerMesh& mesh, LoadMeshReport& report) : mesh_(mesh), report_(report) {}
    /// @param corners   indices into mesh.positions
    /// @param normal    indices into mesh.normals, or empty
    /// @param texcoord  indices into mesh.uv0, or empty
    /// @throws InputError  (naming `where`) too many corners
    void append(std::span<const uint32_t> corners, std::span<const uint32_t> normal,
                std::span<const uint32_t> texcoord, int material, const std::string& where);

  private:
    CornerMesh& mesh_;
    LoadMeshReport& report_;
    std::vector<Vec3f> points_;
};

}  // namespace prt
