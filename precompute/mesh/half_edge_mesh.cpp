// OpenMesh's half-edge structure (M. Botsch, S. Steinberg, S. Bischoff, L. Kobbelt, "OpenMesh: A Generic and
// Efficient Polygon Mesh Data Structure", OpenSG Symposium 2002), linked through its kernel rather than
// add_face: that one finds edges by their vertices, which can take time quadratic in the valence and refuses
// or mispairs faces where two edges join the same two vertices.
#include "precompute/mesh/half_edge_mesh.h"

#include <OpenMesh/Core/Mesh/TriConnectivity.hh>

#include "precompute/mesh/interrupt.h"
#include "precompute/mesh/topology.h"

namespace prt {
namespace {

using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

/// Faces around one vertex, by the half-edges that leave it, counter-clockwise from first to last.
struct Fan {
    uint32_t first, last;
};

/// Splits corners into fans by turning around each over paired edges.
/// @param fanOf  [3×faces] result
std::vector<Fan> findFans(std::span<const uint32_t> twin, std::vector<uint32_t>& fanOf) {
    std::vector<Fan> fans;
    fanOf.assign(twin.size(), kNone);
    for (uint32_t h = 0; h < twin.size(); ++h) {
        throwIfInterruptedAt(h);
        if (fanOf[h] != kNone) continue;
        uint32_t first = h;
        while (twin[first] != kNone) {
            first = nextCorner(twin[first]);
            if (first == h) break;
        }
        uint32_t last = first;
        for (;;) {
            fanOf[last] = uint32_t(fans.size());
            const uint32_t onward = twin[previousCorner(last)];
            if (onward == kNone || onward == first) break;
            last = onward;
        }
        fans.push_back({first, last});
    }
    return fans;
}

}  // namespace

struct HalfEdgeMesh::Structure {
    OpenMesh::TriConnectivity mesh;

    /// Half-edge 3t + k is k steps from the first of face t.
    HalfedgeHandle handle(uint32_t halfEdge) const {
        HalfedgeHandle h = mesh.halfedge_handle(FaceHandle(int(halfEdge / 3)));
        for (uint32_t k = 0; k < halfEdge % 3; ++k) h = mesh.next_halfedge_handle(h);
        return h;
    }
    uint32_t index(HalfedgeHandle h) const {
        const FaceHandle face = mesh.face_handle(h);
        if (!face.is_valid()) return kNone;
        const HalfedgeHandle first = mesh.halfedge_handle(face);
        const uint32_t k = h == first ? 0 : h == mesh.next_halfedge_handle(first) ? 1 : 2;
        return 3 * uint32_t(face.idx()) + k;
    }
};

HalfEdgeMesh::HalfEdgeMesh(std::span<const uint32_t> twin) : structure_(std::make_unique<Structure>()) {
    auto& mesh = structure_->mesh;
    std::vector<uint32_t> fanOf;
    const std::vector<Fan> fans = findFans(twin, fanOf);
    size_t edges = 0;
    for (uint32_t h = 0; h < twin.size(); ++h) edges += twin[h] == kNone || h < twin[h];
    mesh.reserve(fans.size(), edges, twin.size() / 3);

    for (size_t v = 0; v < fans.size(); ++v) mesh.new_vertex();
    std::vector<HalfedgeHandle> handle(twin.size());
    for (uint32_t h = 0; h < twin.size(); ++h) {
        throwIfInterruptedAt(h);
        if (twin[h] != kNone && h > twin[h]) continue;
        handle[h] = mesh.new_edge(VertexHandle(int(fanOf[h])), VertexHandle(int(fanOf[nextCorner(h)])));
        if (twin[h] != kNone) handle[twin[h]] = mesh.opposite_halfedge_handle(handle[h]);
    }
    for (uint32_t first = 0; first < twin.size(); first += 3) {
        throwIfInterruptedAt(first / 3);
        const FaceHandle face = mesh.new_face();
        mesh.set_halfedge_handle(face, handle[first]);
        for (uint32_t h = first; h < first + 3; ++h) {
            mesh.set_face_handle(handle[h], face);
            mesh.set_next_halfedge_handle(handle[h], handle[nextCorner(h)]);
        }
    }
    for (size_t v = 0; v < fans.size(); ++v) {
        const auto [first, last] = fans[v];
        const VertexHandle vertex{int(v)};
        if (twin[first] != kNone) {
            mesh.set_halfedge_handle(vertex, handle[first]);
            continue;
        }
        // An open fan: the hole is entered and left here, and OpenMesh wants the way out at the vertex.
        const HalfedgeHandle out = mesh.opposite_halfedge_handle(handle[previousCorner(last)]);
        mesh.set_halfedge_handle(vertex, out);
        mesh.set_next_halfedge_handle(mesh.opposite_halfedge_handle(handle[first]), out);
    }
}

HalfEdgeMesh::~HalfEdgeMesh() = default;
HalfEdgeMesh::HalfEdgeMesh(HalfEdgeMesh&&) noexcept = default;
HalfEdgeMesh& HalfEdgeMesh::operator=(HalfEdgeMesh&&) noexcept = default;

size_t HalfEdgeMesh::faceCount() const { return structure_->mesh.n_faces(); }
size_t HalfEdgeMesh::vertexCount() const { return structure_->mesh.n_vertices(); }
size_t HalfEdgeMesh::edgeCount() const { return structure_->mesh.n_edges(); }

std::vector<uint32_t> HalfEdgeMesh::opposites() const {
    const auto& mesh = structure_->mesh;
    std::vector<uint32_t> result(3 * faceCount());
    for (uint32_t first = 0; first < result.size(); first += 3) {
        HalfedgeHandle h = structure_->handle(first);
        for (uint32_t k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
            result[first + k] = structure_->index(mesh.opposite_halfedge_handle(h));
    }
    return result;
}

std::vector<uint32_t> HalfEdgeMesh::cornerVertices() const {
    const auto& mesh = structure_->mesh;
    std::vector<uint32_t> result(3 * faceCount());
    for (uint32_t first = 0; first < result.size(); first += 3) {
        HalfedgeHandle h = structure_->handle(first);
        for (uint32_t k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
            result[first + k] = uint32_t(mesh.from_vertex_handle(h).idx());
    }
    return result;
}

std::vector<uint32_t> HalfEdgeMesh::components(std::span<const uint32_t> label, uint32_t& count) const {
    const auto& mesh = structure_->mesh;
    std::vector<uint32_t> result(faceCount(), kNone);
    std::vector<uint32_t> open;
    size_t done = 0;
    count = 0;
    for (uint32_t seed = 0; seed < result.size(); ++seed) {
        if (result[seed] != kNone) continue;
        result[seed] = count;
        open.push_back(seed);
        while (!open.empty()) {
            throwIfInterruptedAt(done++);
            const FaceHandle face{int(open.back())};
            open.pop_back();
            HalfedgeHandle h = mesh.halfedge_handle(face);
            for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h)) {
                const FaceHandle other = mesh.opposite_face_handle(h);
                if (!other.is_valid() || result[size_t(other.idx())] != kNone ||
                    label[size_t(other.idx())] != label[seed])
                    continue;
                result[size_t(other.idx())] = count;
                open.push_back(uint32_t(other.idx()));
            }
        }
        ++count;
    }
    return result;
}

std::vector<uint32_t> HalfEdgeMesh::cornersAround(uint32_t vertex) const {
    const auto& mesh = structure_->mesh;
    std::vector<uint32_t> corners;
    for (const auto& h : mesh.voh_ccw_range(VertexHandle(int(vertex))))
        if (!mesh.is_boundary(h)) corners.push_back(structure_->index(h));
    return corners;
}

std::vector<std::vector<uint32_t>> HalfEdgeMesh::borders() const {
    const auto& mesh = structure_->mesh;
    std::vector<std::vector<uint32_t>> loops;
    std::vector<uint8_t> seen(mesh.n_halfedges(), 0);
    for (const auto& start : mesh.halfedges()) {
        if (!mesh.is_boundary(start)) continue;
        std::vector<uint32_t> loop;
        for (HalfedgeHandle h = start; !seen[size_t(h.idx())]; h = mesh.prev_halfedge_handle(h)) {
            seen[size_t(h.idx())] = 1;
            loop.push_back(structure_->index(mesh.opposite_halfedge_handle(h)));
        }
        if (!loop.empty()) loops.push_back(std::move(loop));
    }
    return loops;
}

}  // namespace prt
