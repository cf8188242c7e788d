// The half-edge mesh on shapes whose structure is known by hand, among them those that break half-edge
// meshes.
#include "precompute/mesh/half_edge_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "precompute/mesh/topology.h"

namespace prt {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;

/// Pairs by corners alone: all faces lie flat.
HalfEdgeMesh meshOf(const std::vector<uint32_t>& corners) {
    const uint32_t vertices = *std::max_element(corners.begin(), corners.end()) + 1;
    const std::vector<Vec3f> up(corners.size() / 3, Vec3f(0, 1, 0));
    return HalfEdgeMesh(pairHalfEdges(corners, vertices, up).twin);
}

uint32_t onePiece(const HalfEdgeMesh& mesh) {
    uint32_t count = 0;
    mesh.components(std::vector<uint32_t>(mesh.faceCount(), 0), count);
    return count;
}

TEST(HalfEdgeMesh, EmptyHasNothing) {
    const HalfEdgeMesh mesh{std::span<const uint32_t>()};
    EXPECT_EQ(mesh.faceCount() + mesh.vertexCount() + mesh.edgeCount(), 0u);
    EXPECT_THAT(mesh.opposites(), IsEmpty());
    EXPECT_THAT(mesh.borders(), IsEmpty());
    EXPECT_EQ(onePiece(mesh), 0u);
}

TEST(HalfEdgeMesh, TriangleIsAllBorder) {
    const HalfEdgeMesh mesh = meshOf({0, 1, 2});
    EXPECT_EQ(mesh.vertexCount(), 3u);
    EXPECT_EQ(mesh.edgeCount(), 3u);
    EXPECT_THAT(mesh.opposites(), Each(kNone));
    EXPECT_THAT(mesh.cornerVertices(), ElementsAre(0, 1, 2));
    EXPECT_THAT(mesh.borders(), ElementsAre(ElementsAre(0, 1, 2)));
}

TEST(HalfEdgeMesh, TetrahedronIsClosed) {
    const HalfEdgeMesh mesh = meshOf({0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0});
    EXPECT_EQ(mesh.vertexCount(), 4u);
    EXPECT_EQ(mesh.edgeCount(), 6u);
    EXPECT_THAT(mesh.opposites(), ElementsAre(5, 8, 11, 10, 6, 0, 4, 9, 1, 7, 3, 2));
    EXPECT_THAT(mesh.borders(), IsEmpty());
    EXPECT_EQ(mesh.cornersAround(0).size(), 3u);
}

TEST(HalfEdgeMesh, BowTieHasTwoVerticesAtItsKnot) {
    const HalfEdgeMesh mesh = meshOf({0, 1, 2, 0, 3, 4});
    EXPECT_EQ(mesh.vertexCount(), 6u);
    EXPECT_EQ(onePiece(mesh), 2u);
    EXPECT_EQ(mesh.borders().size(), 2u);
}

TEST(HalfEdgeMesh, PillowOfTwoFacesIsClosed) {
    const HalfEdgeMesh mesh = meshOf({0, 1, 2, 0, 2, 1});
    EXPECT_EQ(mesh.vertexCount(), 3u);
    EXPECT_EQ(mesh.edgeCount(), 3u);
    EXPECT_THAT(mesh.borders(), IsEmpty());
    EXPECT_THAT(mesh.cornersAround(0), testing::UnorderedElementsAre(0, 3));
}

TEST(HalfEdgeMesh, BooksOfPagesArePairedAndTheRestIsBorder) {
    // Three pages on the edge 0–1: the third, against which none is left, keeps a spine of its own.
    const HalfEdgeMesh mesh = meshOf({0, 1, 2, 1, 0, 3, 0, 1, 4});
    EXPECT_THAT(mesh.opposites(), ElementsAre(3, kNone, kNone, 0, kNone, kNone, kNone, kNone, kNone));
    EXPECT_EQ(mesh.vertexCount(), 4u + 3u);
    EXPECT_EQ(onePiece(mesh), 2u);
}

TEST(HalfEdgeMesh, TwoEdgesMayJoinTheSameVertices) {
    // Two pillows, glued by exchanging the partners of one edge: a sphere of four faces on three vertices,
    // where two edges run between 0 and 1. Structures that look up edges by their ends refuse it.
    const std::vector<uint32_t> twin{9, 5, 4, 6, 2, 1, 3, 11, 10, 0, 8, 7};
    const HalfEdgeMesh mesh(twin);
    EXPECT_EQ(mesh.opposites(), twin);
    EXPECT_EQ(mesh.edgeCount(), 6u);
    EXPECT_EQ(mesh.vertexCount() + mesh.faceCount(), mesh.edgeCount() + 2);
    EXPECT_THAT(mesh.borders(), IsEmpty());
    EXPECT_EQ(onePiece(mesh), 1u);
}

TEST(HalfEdgeMesh, FaceMayTouchItself) {
    // A cone rolled from one triangle: two of its edges are one.
    const std::vector<uint32_t> twin{1, 0, kNone};
    const HalfEdgeMesh mesh(twin);
    EXPECT_EQ(mesh.opposites(), twin);
    EXPECT_EQ(mesh.vertexCount(), 2u);
    EXPECT_THAT(mesh.cornerVertices(), ElementsAre(0, 1, 0));
    EXPECT_THAT(mesh.borders(), ElementsAre(ElementsAre(2)));
}

TEST(HalfEdgeMesh, ComponentsFollowLabelsInOrderOfTheirLowestFace) {
    // A strip of five faces.
    const HalfEdgeMesh mesh = meshOf({0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5, 4, 5, 6});
    uint32_t count = 0;
    EXPECT_THAT(mesh.components(std::vector<uint32_t>{7, 7, 3, 3, 7}, count), ElementsAre(0, 0, 1, 1, 2));
    EXPECT_EQ(count, 3u);
    EXPECT_THAT(mesh.components(std::vector<uint32_t>{1, 0, 1, 0, 1}, count), ElementsAre(0, 1, 2, 3, 4));
    EXPECT_EQ(count, 5u);
    EXPECT_EQ(onePiece(mesh), 1u);
}

TEST(HalfEdgeMesh, HubOfManyFacesIsWalkedOnce) {
    constexpr uint32_t kSpokes = 200'000;
    std::vector<uint32_t> corners;
    for (uint32_t i = 0; i < kSpokes; ++i) corners.insert(corners.end(), {0, 1 + i, 1 + (i + 1) % kSpokes});
    const HalfEdgeMesh mesh = meshOf(corners);
    EXPECT_EQ(mesh.vertexCount(), kSpokes + 1);
    const std::vector<uint32_t> around = mesh.cornersAround(0);
    ASSERT_EQ(around.size(), kSpokes);
    for (size_t i = 1; i < around.size(); ++i) ASSERT_EQ(around[i], (around[i - 1] + 3) % (3 * kSpokes));
    const auto borders = mesh.borders();
    ASSERT_EQ(borders.size(), 1u);
    EXPECT_EQ(borders[0].size(), kSpokes);
}

TEST(CutCreases, CutsBothSidesOfSharpEdgesOnly) {
    const std::vector<Vec3f> normals{{0, 1, 0}, {0, 1, 0}, {1, 0, 0}};
    std::vector<uint32_t> twin{kNone, 3, kNone, 1, 6, kNone, 4, kNone, kNone};
    cutCreases(twin, normals, 0.5f);
    EXPECT_THAT(twin, ElementsAre(kNone, 3, kNone, 1, kNone, kNone, kNone, kNone, kNone));
    cutCreases(twin, normals, 1.0f);
    EXPECT_EQ(twin[1], 3u);
}

}  // namespace
}  // namespace prt
