#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "precompute/mesh/load_mesh.h"
#include "tests/mesh/mesh_kinds.h"

namespace prt {
namespace {

using Counts = std::map<std::string, size_t>;

Scene prepared(Scene scene, LoadMeshReport& report) {
    return prepareScene(std::move(scene), "test", {}, &report);
}

/// Counts without those of things that are made for every bare mesh.
Counts repairs(const LoadMeshReport& report) {
    Counts counts = report.counts;
    for (const char* made : {"normals_made", "texcoords_made", "tangents_made"}) counts.erase(made);
    return counts;
}

TEST(Repair, SoundMeshesAreLeftAlone) {
    for (const Scene& scene : {makeSphere(8, 12), makeGrid(5), makeBox({0, 0, 0}, {1, 1, 1})}) {
        LoadMeshReport report;
        const Scene result = prepared(scene, report);
        EXPECT_TRUE(repairs(report).empty()) << repairs(report).begin()->first;
        EXPECT_EQ(result.triangleCount(), scene.triangleCount());
    }
}

TEST(Repair, DegenerateFacesAreDropped) {
    Scene scene = makeGrid(2);
    scene.positions.insert(scene.positions.end(),
                           {{0, 5, 0}, {1, 5, 0}, {2, 5, 0}, {0.5f, 5, 1e-9f}, {0, 5, 0}});
    const uint32_t n = 9;
    // A repeated index, a line, a needle below rounding, and corners that coincide.
    scene.indices.insert(scene.indices.end(),
                         {n, n, n + 1, n, n + 1, n + 2, n, n + 1, n + 3, n, n + 1, n + 4});
    LoadMeshReport report;
    const Scene result = prepared(sceneOf(scene.positions, scene.indices), report);
    EXPECT_EQ(repairs(report), (Counts{{"degenerate_faces_dropped", 4}}));
    EXPECT_EQ(result.triangleCount(), 8u);
}

TEST(Repair, ThinFacesThatHaveAreaStay) {
    LoadMeshReport report;
    const Scene result = prepared(sceneOf({{0, 0, 0}, {1, 0, 0}, {0.5f, 1e-5f, 0}}, {0, 1, 2}), report);
    EXPECT_EQ(result.triangleCount(), 1u);
}

TEST(Repair, DuplicateFacesAreDroppedAndDoubleSidedOnesCounted) {
    LoadMeshReport report;
    const Scene result =
        prepared(sceneOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                         {0, 1, 2, 1, 2, 0, 2, 0, 1, /*other side*/ 0, 2, 1, /*another*/ 0, 1, 3}),
                 report);
    EXPECT_EQ(repairs(report), (Counts{{"double_sided_face_pairs", 1},
                                       {"duplicate_faces_dropped", 2},
                                       {"non_manifold_edges_split", 1}}));
    EXPECT_EQ(result.triangleCount(), 3u);
}

TEST(Repair, IsolatedVerticesAreDropped) {
    Scene scene = makeGrid(1);
    scene.positions.insert(scene.positions.begin() + 4, 3, Vec3f(9, 9, 9));
    LoadMeshReport report;
    const Scene result = prepared(sceneOf(scene.positions, scene.indices), report);
    EXPECT_EQ(repairs(report), (Counts{{"isolated_vertices_dropped", 3}}));
    EXPECT_EQ(result.vertexCount(), 4u);
}

TEST(Repair, NonManifoldEdgesAndInconsistentWindingAreCounted) {
    LoadMeshReport report;
    // Three fins on the edge 0–1.
    prepared(
        sceneOf({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0.1f}, {0, 0, 1}}, {0, 2, 1, 1, 3, 0, 0, 4, 1}),
        report);
    EXPECT_EQ(repairs(report), (Counts{{"non_manifold_edges_split", 1}}));
    LoadMeshReport flipped;
    prepared(sceneOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 0, 3, 2}), flipped);
    EXPECT_EQ(repairs(flipped), (Counts{{"inconsistent_winding_edges", 1}}));
}

TEST(Repair, SoupsAreWelded) {
    Scene scene = makeSphere(6, 8);
    std::vector<Vec3f> positions;
    std::vector<uint32_t> indices;
    for (uint32_t i : scene.indices) {
        indices.push_back(uint32_t(positions.size()));
        positions.push_back(scene.positions[i]);
    }
    LoadMeshOptions options;
    options.creaseAngleDeg = 180;
    const Scene soup = prepareScene(sceneOf(positions, indices), "soup", options);
    const Scene whole = prepareScene(scene, "whole", options);
    EXPECT_EQ(soup.positions, whole.positions);
    EXPECT_EQ(soup.normals, whole.normals);
    EXPECT_EQ(soup.indices, whole.indices);
    // −0 and 0 are one place.
    const Scene zeros =
        prepareScene(sceneOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0f, 0, 0}, {0, 1, -0.0f}, {-1, 0, 0}},
                             {0, 1, 2, 3, 4, 5}),
                     "zeros", {});
    EXPECT_EQ(zeros.vertexCount(), 4u);
}

TEST(Repair, ManyFacesAroundOneVertexOrEdgeAreNoProblem) {
    // Quadratic behaviour would take minutes.
    constexpr uint32_t kFaces = 200'000;
    std::vector<Vec3f> fan{{0, 0, 0}}, book{{0, 0, 0}, {0, 1, 0}};
    std::vector<uint32_t> fanIndex, bookIndex;
    for (uint32_t i = 0; i < kFaces; ++i) {
        const double a = 2 * M_PI * i / kFaces;
        fan.emplace_back(float(std::cos(a)), float(std::sin(a)), 0.0f);
        book.emplace_back(float(std::cos(a)), 0.5f, float(std::sin(a)));
        fanIndex.insert(fanIndex.end(), {0, i + 1, (i + 1) % kFaces + 1});
        bookIndex.insert(bookIndex.end(), {0, i + 2, 1});
    }
    LoadMeshReport report;
    EXPECT_EQ(prepareScene(sceneOf(fan, fanIndex), "fan", {}).triangleCount(), kFaces);
    EXPECT_EQ(prepareScene(sceneOf(book, bookIndex), "book", {}, &report).triangleCount(), kFaces);
    EXPECT_EQ(report.counts.at("non_manifold_edges_split"), 1u);
}

TEST(Repair, PreparingTwiceChangesNothing) {
    for (const MeshKind& kind : meshKinds()) {
        const Scene once = prepareScene(kind.make(), kind.name, {});
        LoadMeshReport report;
        const Scene twice = prepareScene(once, kind.name, {}, &report);
        EXPECT_EQ(once.positions, twice.positions) << kind.name;
        EXPECT_EQ(once.normals, twice.normals) << kind.name;
        EXPECT_EQ(once.tangents, twice.tangents) << kind.name;
        EXPECT_EQ(once.uv0, twice.uv0) << kind.name;
        EXPECT_EQ(once.indices, twice.indices) << kind.name;
        EXPECT_EQ(report.counts.count("normals_made"), 0u) << kind.name;
        EXPECT_EQ(report.counts.count("texcoords_made"), 0u) << kind.name;
    }
}

}  // namespace
}  // namespace prt
