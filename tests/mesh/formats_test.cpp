// Every format gives the same mesh.
#include "precompute/io/glb.h"
#include "tests/mesh/mesh_files.h"
#include "tests/mesh/mesh_kinds.h"

namespace prt {
namespace {

using testing::HasSubstr;

using Formats = MeshFiles;

/// A unit square facing +Z out of two triangles.
void expectSquare(const Scene& scene) {
    ASSERT_EQ(scene.triangleCount(), 2u);
    EXPECT_EQ(scene.vertexCount(), 4u);
    EXPECT_NEAR(surfaceArea(scene), 1, 1e-6);
    for (const Vec3f& n : scene.normals) EXPECT_LT((n - Vec3f(0, 0, 1)).norm(), 1e-6f);
    EXPECT_EQ(scene.tangents.size(), 4u);
    EXPECT_EQ(scene.uv0.size(), 4u);
    EXPECT_TRUE(scene.uv1.empty());
}

/// Texture coordinates that put the image upright on the square, as glTF has them.
void expectUprightTexture(const Scene& scene) {
    for (size_t v = 0; v < scene.vertexCount(); ++v) {
        EXPECT_EQ(scene.uv0[v], Vec2f(scene.positions[v].x(), 1 - scene.positions[v].y()));
        EXPECT_LT((scene.tangents[v] - Vec4f(1, 0, 0, 1)).norm(), 1e-6f);
    }
}

std::string plyHeader(const std::string& format, const std::string& vertexProperties, int vertices,
                      int faces) {
    return "ply\nformat " + format + " 1.0\ncomment made by a test\nelement vertex " +
           std::to_string(vertices) + "\nproperty float x\nproperty float y\nproperty float z\n" +
           vertexProperties + "element face " + std::to_string(faces) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
}
constexpr const char* kUv = "property float s\nproperty float t\n";

TEST_F(Formats, TextPlyWithTextureCoordinates) {
    const Scene scene = load(
        "a.ply", plyHeader("ascii", kUv, 4, 1) + "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n");
    expectSquare(scene);
    expectUprightTexture(scene);
}

TEST_F(Formats, TextPlyWithoutFinalLineEndAndWithCarriageReturns) {
    std::string text = plyHeader("ascii", "", 4, 2) + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3";
    std::string dos;
    for (char c : text) {
        if (c == '\n') dos += '\r';
        dos += c;
    }
    expectSquare(load("unix.ply", text));
    expectSquare(load("dos.ply", dos));
}

TEST_F(Formats, BinaryPlyOfEitherByteOrder) {
    for (bool big : {false, true}) {
        std::string bytes = plyHeader(big ? "binary_big_endian" : "binary_little_endian", kUv, 4, 2);
        for (const auto& p : {std::array<float, 2>{0, 0}, {1, 0}, {1, 1}, {0, 1}})
            for (float value : {p[0], p[1], 0.0f, p[0], p[1]}) bytes += rawBytes(value, big);
        for (const auto& t : {std::array<int, 3>{0, 1, 2}, {0, 2, 3}}) {
            bytes += '\3';
            for (int i : t) bytes += rawBytes(i, big);
        }
        const Scene scene = load("b.ply", bytes);
        expectSquare(scene);
        expectUprightTexture(scene);
    }
}

TEST_F(Formats, PlyWithElementsAndPropertiesOfOtherPrograms) {
    const Scene scene =
        load("c.ply",
             "ply\nformat ascii 1.0\nelement camera 1\nproperty double f\nproperty list uchar float k\n"
             "element vertex 4\nproperty double x\nproperty uchar red\nproperty double y\n"
             "property double z\nelement face 1\nproperty uchar material\n"
             "property list uint8 uint32 vertex_index\nproperty list uchar float texcoord\nend_header\n"
             "35 2 0.1 0.2\n0 255 0 0\n1 0 0 0\n1 9 1 0\n0 9 1 0\n7 4 0 1 2 3 8 0 0 1 0 1 1 0 1\n");
    expectSquare(scene);
    expectUprightTexture(scene);
}

TEST_F(Formats, PlyNormalsAreKept) {
    const Scene scene =
        load("n.ply", plyHeader("ascii", "property float nx\nproperty float ny\nproperty float nz\n", 3, 1) +
                          "0 0 0 0 0.6 0.8\n1 0 0 0 0.6 0.8\n0 1 0 0 0.6 0.8\n3 0 1 2\n");
    for (const Vec3f& n : scene.normals) EXPECT_LT((n - Vec3f(0, 0.6f, 0.8f)).norm(), 1e-6f);
}

TEST_F(Formats, Off) {
    const std::string body = "0 0 0\n1 0 0\n# a comment\n1 1 0\n\n0 1 0\n";
    expectSquare(load("a.off", "OFF\n4 1 0\n" + body + "4 0 1 2 3\n"));
    expectSquare(load("b.off", "OFF 4 2 0\n" + body + "3 0 1 2 255 0 0\n3 0 2 3 0.1 0.2 0.3 1\n"));
    expectSquare(load(
        "c.off", "COFF\n4 1 4\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n1 1 0 1 1 1 1\n0 1 0 1 1 1 1\n4 0 1 2 3\n"));
    const Scene scene =
        load("d.off", "STOFF\n4 1 4\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n");
    expectSquare(scene);
    expectUprightTexture(scene);
}

TEST_F(Formats, TextStl) {
    LoadMeshReport report;
    const Scene scene = load(
        "a.stl",
        "solid square made by hand\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n"
        "   vertex 1.0e0 1 0\n  endloop\n endfacet\n facet normal nan nan nan\n  outer loop\n"
        "   vertex 0 0 0\n   vertex 1 1 0\n   vertex 0 1 0\n  endloop\n endfacet\nendsolid square\n",
        &report);
    expectSquare(scene);
    EXPECT_EQ(report.counts.at("normals_made"), 4u);
    EXPECT_EQ(report.counts.at("texcoords_made"), 4u);
}

TEST_F(Formats, BinaryStlIsWelded) {
    const std::vector<std::vector<float>> triangles{{0, 0, 0, 1, 0, 0, 1, 1, 0}, {0, 0, 0, 1, 1, 0, 0, 1, 0}};
    std::string bytes = binaryStl(triangles, 2);
    expectSquare(load("a.stl", bytes));
    // Some programs start binary files with "solid", and some add bytes at the end.
    bytes.replace(0, 5, "solid");
    expectSquare(load("b.stl", bytes));
    expectSquare(load("c.STL", binaryStl(triangles, 2) + "trailing"));
}

TEST_F(Formats, GlbComesBackAsItWasWritten) {
    Scene scene = prepareScene(makeBox({0, 0, 0}, {1, 1, 1}), "box", {});
    scene.materials[0].name = "paint";
    scene.materials[0].baseColor = Vec3f(0.25f, 0.5f, 1);
    const std::string path = directory_.file("box.glb");
    writeGlb(scene, path);
    LoadMeshReport report;
    const Scene back = loadMesh(path, {}, &report);
    EXPECT_EQ(back.positions, scene.positions);
    EXPECT_EQ(back.normals, scene.normals);
    EXPECT_EQ(back.tangents, scene.tangents);
    EXPECT_EQ(back.uv0, scene.uv0);
    EXPECT_EQ(back.indices, scene.indices);
    EXPECT_EQ(back.materials[0].name, "paint");
    EXPECT_TRUE(report.counts.empty()) << report.counts.begin()->first;
    EXPECT_FALSE(report.hasAtlas);
}

}  // namespace
}  // namespace prt
