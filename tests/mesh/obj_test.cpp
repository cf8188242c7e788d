#include "precompute/io/image.h"
#include "tests/mesh/mesh_files.h"
#include "tests/mesh/mesh_kinds.h"

namespace prt {
namespace {

using testing::HasSubstr;

class Obj : public MeshFiles {
  protected:
    std::string png() const {
        ByteImage image{1, 1, 4, {10, 20, 30, 255}};
        const auto bytes = encodePng(image);
        return std::string(bytes.begin(), bytes.end());
    }
};

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(Obj, QuadsAndPolygonsAreTriangulated) {
    LoadMeshReport report;
    const Scene scene = load("a.obj",
                             std::string(kSquare) +
                                 "v 2 0 0\nv 2 1 0\nv 1.5 0.2 0\n# concave at the last\n"
                                 "f 1 2 3 4\nf 3 2 7 5 6\n",
                             &report);
    EXPECT_EQ(scene.triangleCount(), 5u);
    EXPECT_EQ(report.counts.at("polygons_triangulated"), 2u);
    for (const Vec3f& n : scene.normals) EXPECT_EQ(n, Vec3f(0, 0, 1));
    EXPECT_NEAR(surfaceArea(scene), 1 + 0.9, 1e-6);
}

TEST_F(Obj, TextureCoordinatesAreTurnedUpsideDown) {
    const Scene scene =
        load("a.obj", std::string(kSquare) + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
    for (size_t v = 0; v < scene.vertexCount(); ++v) {
        EXPECT_EQ(scene.uv0[v], Vec2f(scene.positions[v].x(), 1 - scene.positions[v].y()));
        EXPECT_LT((scene.tangents[v] - Vec4f(1, 0, 0, 1)).norm(), 1e-6f);
    }
}

TEST_F(Obj, NegativeIndicesGroupsNormalsAndLineEnds) {
    const Scene plain =
        load("a.obj", std::string(kSquare) + "vn 0 0 1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n");
    const Scene fancy = load("b.obj",
                             "o thing\r\ng one two\r\nv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nvn 0 0 1\r\ns 1\r\n"
                             "f -3//-1 -2//-1 -1//-1\r\ng three\r\nv 0 1 0\r\nf 1//1 3//1 4//1\r\n");
    EXPECT_EQ(plain.positions, fancy.positions);
    EXPECT_EQ(plain.normals, fancy.normals);
    EXPECT_EQ(plain.indices, fancy.indices);
}

TEST_F(Obj, MaterialsBecomePrimitives) {
    write("wall.png", png());
    write("bumps.png", png());
    write("m.mtl",
          "newmtl grey\nKd 0.5 0.25 0.125\n\nnewmtl brick\nmap_Kd wall.png\nnorm -bm 0.5 bumps.png\n"
          "newmtl black\nKd 0 0 0\nmap_Kd wall.png\nmap_Kn bumps.png\nnewmtl unused\nKd 1 0 0\n");
    const Scene scene = load(
        "a.obj",
        std::string("mtllib m.mtl\n") + kSquare +
            "usemtl black\nf 1 2 3\nusemtl grey\nf 1 3 4\nusemtl brick\nf 1 2 4\nusemtl grey\nf 2 3 4\n");
    ASSERT_EQ(scene.primitives.size(), 3u);
    uint32_t vertex = 0, index = 0;
    int last = -1;
    for (const ScenePrimitive& p : scene.primitives) {
        EXPECT_GT(p.material, last);
        last = p.material;
        EXPECT_EQ(p.firstVertex, vertex);
        EXPECT_EQ(p.firstIndex, index);
        vertex += p.vertexCount;
        index += p.indexCount;
    }
    EXPECT_EQ(vertex, scene.vertexCount());
    EXPECT_EQ(index, scene.indices.size());
    EXPECT_EQ(scene.primitives[0].indexCount, 6u);

    ASSERT_EQ(scene.materials.size(), 4u);
    EXPECT_EQ(scene.materials[0].name, "grey");
    EXPECT_EQ(scene.materials[0].baseColor, Vec3f(0.5f, 0.25f, 0.125f));
    EXPECT_EQ(scene.materials[0].baseColorTexture, -1);
    EXPECT_EQ(scene.materials[1].baseColor, Vec3f(1, 1, 1)) << "no Kd: the texture as it is";
    EXPECT_EQ(scene.materials[1].normalScale, 0.5f);
    EXPECT_EQ(scene.materials[2].baseColor, Vec3f(1, 1, 1)) << "a black Kd would hide the texture";
    ASSERT_EQ(scene.textures.size(), 2u) << "one for each file";
    EXPECT_EQ(scene.materials[1].baseColorTexture, scene.materials[2].baseColorTexture);
    EXPECT_EQ(scene.materials[1].normalTexture, scene.materials[2].normalTexture);
    EXPECT_EQ(scene.textures[0].mimeType, "image/png");
    EXPECT_EQ(std::string(scene.textures[0].encoded.begin(), scene.textures[0].encoded.end()), png());
}

TEST_F(Obj, TexturesLieBesideTheMaterialFile) {
    std::filesystem::create_directories(directory_.path() / "sub" / "maps");
    write("sub/maps/wall.png", png());
    write("sub/m.mtl", "newmtl a\nmap_Kd maps\\wall.png\n");
    const Scene scene = load("a.obj", std::string("mtllib sub/m.mtl\n") + kSquare + "usemtl a\nf 1 2 3\n");
    ASSERT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(scene.textures[0].name, "wall.png");
}

TEST_F(Obj, OtherImageFormatsBecomePng) {
    // A 1×1 TGA, 24 bits, blue-green-red.
    const std::string tga("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0\36\24\12", 21);
    write("wall.tga", tga);
    write("m.mtl", "newmtl a\nmap_Kd wall.tga\n");
    const Scene scene = load("a.obj", std::string("mtllib m.mtl\n") + kSquare + "usemtl a\nf 1 2 3\n");
    ASSERT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(scene.textures[0].mimeType, "image/png");
    const ByteImage image = decodeImage(scene.textures[0].encoded, "wall");
    EXPECT_EQ(image.pixels, (std::vector<uint8_t>{10, 20, 30, 255}));
}

TEST_F(Obj, MissingMaterialsAndTexturesAreWarnings) {
    testing::internal::CaptureStderr();
    LoadMeshReport report;
    write("m.mtl", "newmtl a\nKd 0.5 0.5 0.5\nmap_Kd nowhere.png\n");
    const Scene scene = load(
        "a.obj", std::string("mtllib gone.mtl\nmtllib m.mtl\n") + kSquare + "usemtl a\nf 1 2 3\n", &report);
    const std::string warnings = testing::internal::GetCapturedStderr();
    EXPECT_THAT(warnings, HasSubstr("gone.mtl"));
    EXPECT_THAT(warnings, HasSubstr("nowhere.png"));
    EXPECT_EQ(report.counts.at("textures_missing"), 1u);
    EXPECT_EQ(scene.materials.back().baseColorTexture, -1);
}

TEST_F(Obj, NormalMapOfTheOptionsGoesToMaterialsWithoutOne) {
    write("own.png", png());
    const std::string given = write("given.png", png());
    write("m.mtl", "newmtl a\nnorm own.png\nnewmtl b\nKd 1 1 1\n");
    LoadMeshOptions options;
    options.normalMap = given;
    const Scene scene = loadMesh(
        write("a.obj", std::string("mtllib m.mtl\n") + kSquare + "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n"),
        options);
    EXPECT_EQ(scene.textures[size_t(scene.materials[0].normalTexture)].name, "own.png");
    EXPECT_EQ(scene.textures[size_t(scene.materials[1].normalTexture)].name, "given.png");
    options.normalMap = directory_.file("none.png");
    EXPECT_THROW(loadMesh(directory_.file("a.obj"), options), InputError);
    options.normalMap = write("broken.png", "not an image");
    EXPECT_THROW(loadMesh(directory_.file("a.obj"), options), InputError);
}

}  // namespace
}  // namespace prt
