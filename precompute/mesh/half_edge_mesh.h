// The half-edge mesh that the mesh stage walks over, kept by OpenMesh, whose headers stay in the .cpp.
// Internal to the mesh stage.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace prt {

/// Triangles as an oriented 2-manifold with border. Faces at one position that no paired edge joins around it
/// have vertices of their own, so every vertex has one fan of faces, and every input is representable: the
/// parts of a non-manifold edge or vertex, Möbius strips, faces that touch themselves. Immutable.
class HalfEdgeMesh {
  public:
    /// Linear in the triangles, whatever the valence.
    /// @param twin  [3×faces] the half-edge each is paired with (numbered as in Adjacency), kNone at a
    /// border;
    ///              twin[twin[h]] == h, and paired half-edges run in opposite directions
    explicit HalfEdgeMesh(std::span<const uint32_t> twin);
    ~HalfEdgeMesh();
    HalfEdgeMesh(HalfEdgeMesh&&) noexcept;
    HalfEdgeMesh& operator=(HalfEdgeMesh&&) noexcept;

    size_t faceCount() const;
    size_t vertexCount() const;
    size_t edgeCount() const;

    /// [3×faces] half-edge of the face on the other side, kNone at a border.
    std::vector<uint32_t> opposites() const;
    /// [3×faces] vertex at which each half-edge starts, numbered by first corner.
    std::vector<uint32_t> cornerVertices() const;
    /// [faces] pieces connected over edges between faces of one label, numbered by lowest face.
    /// @param label  [faces]
    std::vector<uint32_t> components(std::span<const uint32_t> label, uint32_t& count) const;
    /// Corners around a vertex, counter-clockwise seen from the side the faces wind that way on; of an open
    /// fan from border to border.
    std::vector<uint32_t> cornersAround(uint32_t vertex) const;
    /// Half-edges along each hole, each loop walked with the faces to its left.
    std::vector<std::vector<uint32_t>> borders() const;

  private:
    struct Structure;
    std::unique_ptr<Structure> structure_;
};

}  // namespace prt
