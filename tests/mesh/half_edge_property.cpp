// Adjacency on every kind of mesh against a map of edges, and against what OpenMesh finds by itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <OpenMesh/Core/Mesh/TriConnectivity.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>
#include <map>
#include <set>

#include "precompute/mesh/half_edge_mesh.h"
#include "precompute/mesh/load_mesh.h"
#include "precompute/mesh/topology.h"
#include "tests/mesh/mesh_kinds.h"

namespace prt {
namespace {

using Edge = std::pair<uint32_t, uint32_t>;

struct Paired {
    std::vector<uint32_t> corners;  ///< welded
    uint32_t vertices = 0;
    Adjacency adjacency;
    std::map<Edge, std::vector<uint32_t>> directed;  ///< half-edges by their ends
};

Paired paired(const MeshKind& kind) {
    Paired p;
    const Scene scene = prepareScene(kind.make(), kind.name, {});
    const std::vector<uint32_t> id = weldPositions(scene.positions, p.vertices);
    for (uint32_t i : scene.indices) p.corners.push_back(id[i]);
    p.adjacency = pairHalfEdges(p.corners, p.vertices, faceNormals(scene.positions, scene.indices));
    for (uint32_t h = 0; h < p.corners.size(); ++h)
        p.directed[{p.corners[h], p.corners[nextCorner(h)]}].push_back(h);
    return p;
}

class HalfEdges : public testing::TestWithParam<MeshKind> {};

TEST_P(HalfEdges, EqualAMapOfEdges) {
    const Paired p = paired(GetParam());
    const std::vector<uint32_t> opposite = HalfEdgeMesh(p.adjacency.twin).opposites();
    ASSERT_EQ(opposite.size(), p.corners.size());
    size_t complex = 0;
    for (const auto& [ends, along] : p.directed) {
        const auto back = p.directed.find({ends.second, ends.first});
        const size_t backs = back == p.directed.end() ? 0 : back->second.size();
        if (along.size() == 1 && backs <= 1) {
            EXPECT_EQ(opposite[along[0]], backs ? back->second[0] : kNone);
            continue;
        }
        ++complex;
        for (uint32_t h : along) {
            if (opposite[h] == kNone) continue;
            EXPECT_EQ(opposite[opposite[h]], h);
            EXPECT_TRUE(std::count(back->second.begin(), back->second.end(), opposite[h]));
        }
    }
    EXPECT_EQ(complex > 0, p.adjacency.nonManifoldEdges + p.adjacency.inconsistentEdges > 0);
}

TEST_P(HalfEdges, EqualWhatOpenMeshFindsOnTheSplitVertices) {
    const Paired p = paired(GetParam());
    const HalfEdgeMesh ours(p.adjacency.twin);
    const std::vector<uint32_t> opposite = ours.opposites(), vertex = ours.cornerVertices();
    OpenMesh::TriConnectivity theirs;
    for (uint32_t v = 0; v < ours.vertexCount(); ++v) theirs.new_vertex();
    const auto at = [&](uint32_t corner) { return OpenMesh::VertexHandle(int(vertex[corner])); };
    omerr().disable();
    size_t refused = 0;
    for (uint32_t h = 0; h < p.corners.size(); h += 3)
        refused += !theirs.add_face(at(h), at(h + 1), at(h + 2)).is_valid();
    omerr().enable();
    // By vertices alone it cannot tell apart two edges between the same two, as sheets sewn up at their rims
    // have.
    std::set<Edge> ends;
    for (uint32_t h = 0; h < p.corners.size(); ++h) ends.emplace(vertex[h], vertex[nextCorner(h)]);
    ASSERT_EQ(refused > 0, ends.size() < p.corners.size());
    if (refused > 0) return;
    EXPECT_EQ(ours.edgeCount(), theirs.n_edges());
    for (const auto& v : theirs.vertices()) EXPECT_TRUE(theirs.is_manifold(v));
    for (uint32_t h = 0; h < p.corners.size(); ++h) {
        const auto edge = theirs.find_halfedge(at(h), at(nextCorner(h)));
        const int other = theirs.opposite_face_handle(edge).idx();
        EXPECT_EQ(opposite[h] == kNone ? -1 : int(opposite[h] / 3), other);
    }
}

TEST_P(HalfEdges, GatherEveryCornerInOneFan) {
    const Paired p = paired(GetParam());
    const HalfEdgeMesh mesh(p.adjacency.twin);
    const std::vector<uint32_t> vertex = mesh.cornerVertices();
    std::vector<int> met(p.corners.size(), 0);
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
        const std::vector<uint32_t> around = mesh.cornersAround(v);
        ASSERT_FALSE(around.empty());
        for (size_t i = 0; i < around.size(); ++i) {
            ++met[around[i]];
            EXPECT_EQ(vertex[around[i]], v);
            EXPECT_EQ(p.corners[around[i]], p.corners[around[0]]) << "vertices never join positions";
            const uint32_t onward = p.adjacency.twin[previousCorner(around[i])];
            if (i + 1 < around.size()) {
                EXPECT_EQ(onward, around[i + 1]);
            } else {
                EXPECT_TRUE(onward == kNone || onward == around[0]);
            }
        }
    }
    EXPECT_THAT(met, testing::Each(1));
}

TEST_P(HalfEdges, CloseEveryHoleInALoop) {
    const Paired p = paired(GetParam());
    const HalfEdgeMesh mesh(p.adjacency.twin);
    const std::vector<uint32_t> vertex = mesh.cornerVertices();
    std::vector<int> met(p.corners.size(), 0);
    for (const std::vector<uint32_t>& loop : mesh.borders())
        for (size_t i = 0; i < loop.size(); ++i) {
            ++met[loop[i]];
            EXPECT_EQ(vertex[nextCorner(loop[i])], vertex[loop[(i + 1) % loop.size()]]);
        }
    for (uint32_t h = 0; h < p.corners.size(); ++h) EXPECT_EQ(met[h], p.adjacency.twin[h] == kNone) << h;
}

TEST_P(HalfEdges, ComponentsEqualDisjointSets) {
    const Paired p = paired(GetParam());
    const HalfEdgeMesh mesh(p.adjacency.twin);
    for (uint32_t labels : {1u, 2u, 5u}) {
        std::vector<uint32_t> label(mesh.faceCount());
        for (uint32_t f = 0; f < label.size(); ++f) label[f] = (f / 7) % labels;
        DisjointSets sets(label.size());
        for (uint32_t h = 0; h < p.corners.size(); ++h) {
            const uint32_t twin = p.adjacency.twin[h];
            if (twin != kNone && label[h / 3] == label[twin / 3]) sets.unite(h / 3, twin / 3);
        }
        std::map<uint32_t, uint32_t> number;
        std::vector<uint32_t> expected;
        for (uint32_t f = 0; f < label.size(); ++f)
            expected.push_back(number.try_emplace(sets.find(f), uint32_t(number.size())).first->second);
        uint32_t count = 0;
        EXPECT_EQ(mesh.components(label, count), expected);
        EXPECT_EQ(count, number.size());
    }
}

std::string kindName(const testing::TestParamInfo<MeshKind>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Kinds, HalfEdges, testing::ValuesIn(meshKinds()), kindName);

}  // namespace
}  // namespace prt
