// glTF out and in: exact round trips, and everything a file of others may use.
#include "precompute/io/glb.h"

#include <webp/encode.h>

#include <functional>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "tests/base/temporary_directory.h"
#include "tests/io/gltf_text.h"
#include "tests/io/small_scene.h"

namespace prt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Scene readText(const std::string& bytes, const char* name = "a.glb") {
    TemporaryDirectory directory;
    writeFileAtomically(directory.path() / name, bytes);
    return readGltf(directory.file(name));
}

void expectEqual(const Scene& a, const Scene& b) {
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.normals, b.normals);
    EXPECT_EQ(a.tangents, b.tangents);
    EXPECT_EQ(a.uv0, b.uv0);
    EXPECT_EQ(a.uv1, b.uv1);
    EXPECT_EQ(a.indices, b.indices);
    ASSERT_EQ(a.primitives.size(), b.primitives.size());
    for (size_t i = 0; i < a.primitives.size(); ++i) {
        EXPECT_EQ(a.primitives[i].firstVertex, b.primitives[i].firstVertex);
        EXPECT_EQ(a.primitives[i].vertexCount, b.primitives[i].vertexCount);
        EXPECT_EQ(a.primitives[i].firstIndex, b.primitives[i].firstIndex);
        EXPECT_EQ(a.primitives[i].indexCount, b.primitives[i].indexCount);
        EXPECT_EQ(a.primitives[i].material, b.primitives[i].material);
    }
    ASSERT_EQ(a.materials.size(), b.materials.size());
    for (size_t i = 0; i < a.materials.size(); ++i) {
        EXPECT_EQ(a.materials[i].name, b.materials[i].name);
        EXPECT_EQ(a.materials[i].baseColor, b.materials[i].baseColor);
        EXPECT_EQ(a.materials[i].baseColorTexture, b.materials[i].baseColorTexture);
        EXPECT_EQ(a.materials[i].normalTexture, b.materials[i].normalTexture);
        EXPECT_EQ(a.materials[i].normalScale, b.materials[i].normalScale);
        EXPECT_EQ(a.materials[i].doubleSided, b.materials[i].doubleSided);
    }
    ASSERT_EQ(a.textures.size(), b.textures.size());
    for (size_t i = 0; i < a.textures.size(); ++i) {
        EXPECT_EQ(a.textures[i].name, b.textures[i].name);
        EXPECT_EQ(a.textures[i].mimeType, b.textures[i].mimeType);
        EXPECT_EQ(a.textures[i].encoded, b.textures[i].encoded);
    }
}

SceneTexture webpTexture() {
    const ByteImage image = gradientImage(8, 8, 4);
    uint8_t* encoded = nullptr;
    const size_t size = WebPEncodeLosslessRGBA(image.pixels.data(), 8, 8, 32, &encoded);
    SceneTexture texture{"webp", "image/webp", std::vector<uint8_t>(encoded, encoded + size)};
    WebPFree(encoded);
    return texture;
}

struct SceneCase {
    const char* name;
    std::function<void(Scene&)> change;
};
class GlbRoundTrip : public testing::TestWithParam<SceneCase> {};

TEST_P(GlbRoundTrip, IsExact) {
    TemporaryDirectory directory;
    Scene scene = smallScene();
    GetParam().change(scene);
    writeGlb(scene, directory.file("mesh.glb"));
    expectEqual(readGltf(directory.file("mesh.glb")), scene);
    const std::string bytes = readFile(directory.file("mesh.glb"));
    EXPECT_EQ(bytes.size() % 4, 0u);
    EXPECT_EQ(bytes.substr(8, 4), word(bytes.size()));
    // And again: what was read is written to the same bytes.
    writeGlb(readGltf(directory.file("mesh.glb")), directory.file("again.glb"));
    EXPECT_EQ(readFile(directory.file("again.glb")), bytes);
}

INSTANTIATE_TEST_SUITE_P(
    Each, GlbRoundTrip,
    testing::Values(SceneCase{"Full", [](Scene&) {}},
                    SceneCase{"NoTangents", [](Scene& s) { s.tangents.clear(); }},
                    SceneCase{"PositionsOnly",
                              [](Scene& s) {
                                  s.normals.clear();
                                  s.tangents.clear();
                                  s.uv0.clear();
                                  s.uv1.clear();
                              }},
                    SceneCase{"NoAtlas", [](Scene& s) { s.uv1.clear(); }},
                    SceneCase{"NoTextures",
                              [](Scene& s) {
                                  s.textures.clear();
                                  s.materials[0].baseColorTexture = s.materials[0].normalTexture = -1;
                                  s.materials[0].normalScale = 1;
                              }},
                    SceneCase{"WebP", [](Scene& s) { s.textures[1] = webpTexture(); }},
                    SceneCase{"SharedTexture",
                              [](Scene& s) {
                                  s.textures.pop_back();
                                  s.materials[0].normalTexture = 0;
                                  s.materials[1].baseColorTexture = 0;
                              }},
                    SceneCase{"TextNames", [](Scene& s) { s.materials[0].name = "Wände \"außen\"\n"; }},
                    SceneCase{"FarAway",
                              [](Scene& s) {
                                  for (Vec3f& p : s.positions)
                                      p = p * 1e-7f + Vec3f(12345.678f, -1e-30f, 3e20f);
                              }}),
    [](const auto& test) { return test.param.name; });

TEST(WriteGlb, RefusesBrokenScenesAndPlaces) {
    TemporaryDirectory directory;
    Scene scene = smallScene();
    scene.indices[0] = 77;
    EXPECT_THROW(writeGlb(scene, directory.file("a.glb")), InputError);
    EXPECT_THROW(writeGlb(Scene(), directory.file("a.glb")), InputError);
    EXPECT_THROW(writeGlb(smallScene(), directory.file("none/a.glb")), OutputError);
    EXPECT_THAT(directory.names(), IsEmpty());
}

// ---- topology

struct Topology {
    const char* name;
    int mode;
    std::vector<uint32_t> indices;
    std::vector<uint32_t> triangles;
};
class Modes : public testing::TestWithParam<std::tuple<Topology, int>> {};

TEST_P(Modes, BecomeTriangles) {
    const auto& [topology, componentType] = GetParam();
    GltfText text;
    text.addFloats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, 3);
    std::string bytes;
    for (uint32_t index : topology.indices)
        bytes += word(index).substr(0, componentType == 5121 ? 1 : componentType == 5123 ? 2 : 4);
    text.addAccessor(bytes, componentType, topology.indices.size(), "SCALAR");
    text.meshes = R"([{"primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":)" +
                  std::to_string(topology.mode) + "}]}]";
    EXPECT_EQ(readText(text.glb()).indices, topology.triangles);
}

INSTANTIATE_TEST_SUITE_P(
    Each, Modes,
    testing::Combine(testing::Values(Topology{"List", 4, {0, 1, 2, 2, 1, 3}, {0, 1, 2, 2, 1, 3}},
                                     Topology{"Strip", 5, {0, 1, 2, 3, 4}, {0, 1, 2, 1, 3, 2, 2, 3, 4}},
                                     Topology{"Fan", 6, {0, 1, 3, 2}, {1, 3, 0, 3, 2, 0}}),
                     testing::Values(5121, 5123, 5125)),
    [](const auto& test) {
        return std::get<0>(test.param).name + std::string("Of") + std::to_string(std::get<1>(test.param));
    });

TEST(ReadGltf, WithoutIndicesVerticesAreTakenInOrder) {
    const Scene scene = readText(triangleText().glb());
    EXPECT_THAT(scene.indices, ElementsAre(0, 1, 2));
    EXPECT_THAT(scene.normals, IsEmpty());
    EXPECT_THAT(scene.uv0, IsEmpty());
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].baseColor, Vec3f(1, 1, 1)) << "the default material of glTF";
}

TEST(ReadGltf, PointsAndLinesAreLeftOut) {
    GltfText text = triangleText();
    text.meshes = R"([{"primitives":[{"attributes":{"POSITION":0},"mode":0},{"attributes":{"POSITION":0}},
                      {"attributes":{"POSITION":0},"mode":1}]}])";
    testing::internal::CaptureStderr();
    EXPECT_EQ(readText(text.glb()).primitives.size(), 1u);
    EXPECT_THAT(testing::internal::GetCapturedStderr(),
                HasSubstr("2 primitives of points or lines left out"));
    text.meshes = R"([{"primitives":[{"attributes":{"POSITION":0},"mode":0}]}])";
    EXPECT_THROW(readText(text.glb()), InputError);
}

TEST(ReadGltf, AttributesThatOnlySomePrimitivesHaveAreZeroInTheOthers) {
    GltfText text = triangleText();
    text.addFloats({0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f}, 2);
    text.meshes =
        R"([{"primitives":[{"attributes":{"POSITION":0}},{"attributes":{"POSITION":0,"TEXCOORD_0":1}},
                      {"attributes":{"POSITION":0}}]}])";
    const Scene scene = readText(text.glb());
    ASSERT_EQ(scene.uv0.size(), 9u);
    for (size_t i : {0, 1, 2, 6, 7, 8}) EXPECT_EQ(scene.uv0[i], Vec2f(0, 0));
    EXPECT_EQ(scene.uv0[4], Vec2f(0.3f, 0.4f));
    EXPECT_THAT(scene.normals, IsEmpty());
    EXPECT_EQ(scene.primitives[2].firstVertex, 6u);
    EXPECT_THAT(scene.indices, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8));
}

// ---- accessors

TEST(ReadGltf, StridesAndOffsetsAreFollowed) {
    // Position and texture coordinate interleaved, after 8 bytes of something else.
    std::vector<float> values{-1, -1};
    for (int i = 0; i < 3; ++i)
        for (float value : {float(i == 1), float(i == 2), 0.0f, 0.25f * float(i), 1 - 0.25f * float(i)})
            values.push_back(value);
    GltfText text;
    text.addView(raw(values), R"(,"byteStride":20)");
    text.accessors = {R"({"bufferView":0,"byteOffset":8,"componentType":5126,"count":3,"type":"VEC3"})",
                      R"({"bufferView":0,"byteOffset":20,"componentType":5126,"count":3,"type":"VEC2"})"};
    text.meshes = R"([{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1}}]}])";
    const Scene scene = readText(text.glb());
    EXPECT_THAT(scene.positions, ElementsAre(Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(0, 1, 0)));
    EXPECT_THAT(scene.uv0, ElementsAre(Vec2f(0, 1), Vec2f(0.25f, 0.75f), Vec2f(0.5f, 0.5f)));
}

TEST(ReadGltf, NormalisedIntegersAreFractions) {
    const auto uvOf = [](const std::string& bytes, int type, const std::string& extra) {
        GltfText text = triangleText();
        text.addAccessor(bytes, type, 3, "VEC2", extra, R"(,"byteStride":4)");
        text.meshes = R"([{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1}}]}])";
        return readText(text.glb()).uv0;
    };
    const std::string on = R"(,"normalized":true)";
    EXPECT_THAT(uvOf(raw<uint8_t>({0, 255, 0, 0, 51, 102, 0, 0, 128, 1, 0, 0}), 5121, on),
                ElementsAre(Vec2f(0, 1), Vec2f(0.2f, 0.4f), Vec2f(128 / 255.0f, 1 / 255.0f)));
    EXPECT_THAT(uvOf(raw<int8_t>({0, 127, 0, 0, -127, -128, 0, 0, 1, -1, 0, 0}), 5120, on),
                ElementsAre(Vec2f(0, 1), Vec2f(-1, -1), Vec2f(1 / 127.0f, -1 / 127.0f)));
    EXPECT_THAT(uvOf(raw<uint16_t>({0, 65535, 13107, 1, 2, 3}), 5123, on),
                ElementsAre(Vec2f(0, 1), Vec2f(0.2f, 1 / 65535.0f), Vec2f(2 / 65535.0f, 3 / 65535.0f)));
    EXPECT_THAT(uvOf(raw<int16_t>({0, 32767, -32768, -32767, 1, 2}), 5122, on),
                ElementsAre(Vec2f(0, 1), Vec2f(-1, -1), Vec2f(1 / 32767.0f, 2 / 32767.0f)));
    EXPECT_THAT(uvOf(raw<uint16_t>({0, 7, 300, 1, 2, 3}), 5123, ""),
                ElementsAre(Vec2f(0, 7), Vec2f(300, 1), Vec2f(2, 3)));
}

TEST(ReadGltf, SparseAccessorsReplaceElements) {
    GltfText text = triangleText();
    const int indices = text.addView(raw<uint16_t>({0, 2}));
    const int values = text.addView(raw<float>({9, 9, 9, 8, 8, 8}));
    const std::string sparse = R"(,"sparse":{"count":2,"indices":{"bufferView":)" + std::to_string(indices) +
                               R"(,"componentType":5123},"values":{"bufferView":)" + std::to_string(values) +
                               "}}";
    text.accessors[0].insert(text.accessors[0].size() - 1, sparse);
    EXPECT_THAT(readText(text.glb()).positions, ElementsAre(Vec3f(9, 9, 9), Vec3f(1, 0, 0), Vec3f(8, 8, 8)));
    // Without a view, what is not replaced is zero.
    text.accessors[0] = R"({"componentType":5126,"count":3,"type":"VEC3")" + sparse + "}";
    EXPECT_THAT(readText(text.glb()).positions, ElementsAre(Vec3f(9, 9, 9), Vec3f(0, 0, 0), Vec3f(8, 8, 8)));
}

// ---- nodes

/// The triangle with normal +Z, tangent +X and sign 1, under the given nodes.
Scene readNodes(const std::string& nodes, const std::string& scenes = R"([{"nodes":[0]}])",
                const std::string& more = "") {
    GltfText text = triangleText();
    text.addFloats({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
    text.addFloats({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, 4);
    text.meshes = R"([{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TANGENT":2}}]}])";
    text.nodes = nodes;
    text.scenes = scenes;
    text.more = more;
    return readText(text.glb());
}

testing::Matcher<Vec3f> near(const Vec3f& expected) {
    return testing::ResultOf([expected](const Vec3f& v) { return (v - expected).norm(); },
                             testing::Lt(2e-6f));
}

TEST(ReadGltf, TransformsCompose) {
    // T · R · S, a quarter turn about +Z, below a parent that moves and doubles.
    const Scene scene = readNodes(
        R"([{"children":[1],"translation":[10,0,0],"scale":[2,2,2]},
            {"mesh":0,"translation":[0,1,0],"rotation":[0,0,0.70710678118654757,0.70710678118654757],"scale":[3,1,1]}])");
    EXPECT_THAT(scene.positions, ElementsAre(near({10, 2, 0}), near({10, 8, 0}), near({8, 2, 0})));
    EXPECT_THAT(scene.normals[0], near({0, 0, 1}));
    EXPECT_THAT(Vec3f(scene.tangents[0].head<3>()), near({0, 1, 0}));
    EXPECT_EQ(scene.tangents[0].w(), 1);
    // The same as a matrix, columns first.
    const Scene matrix = readNodes(R"([{"mesh":0,"matrix":[0,6,0,0, -2,0,0,0, 0,0,2,0, 10,2,0,1]}])");
    for (size_t i = 0; i < 3; ++i) EXPECT_THAT(matrix.positions[i], near(scene.positions[i]));
}

TEST(ReadGltf, NormalsStayPerpendicular) {
    // Shear x by z: tangents in the surface move with it, the normal doesn't.
    const Scene scene = readNodes(R"([{"mesh":0,"matrix":[1,0,1,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}])");
    const Vec3f face = triangleNormal(scene, 0);
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_THAT(scene.normals[i], near(face));
        EXPECT_NEAR(scene.tangents[i].head<3>().dot(scene.normals[i]), 0, 1e-6);
        EXPECT_NEAR(scene.tangents[i].head<3>().norm(), 1, 1e-6);
    }
}

TEST(ReadGltf, MirroredNodesKeepTheirOutside) {
    for (const char* scale : {"[-1,1,1]", "[1,-2,1]", "[1,1,-1]", "[-1,-1,-1]"}) {
        const Scene scene = readNodes(std::string(R"([{"mesh":0,"scale":)") + scale + "}]");
        EXPECT_THAT(triangleNormal(scene, 0), near(scene.normals[0])) << scale;
        EXPECT_EQ(scene.tangents[0].w(), -1) << scale;
    }
    // Twice mirrored is turned.
    const Scene turned = readNodes(R"([{"mesh":0,"scale":[-1,-1,1]}])");
    EXPECT_THAT(triangleNormal(turned, 0), near(turned.normals[0]));
    EXPECT_EQ(turned.tangents[0].w(), 1);
}

TEST(ReadGltf, FlattenedNodesGiveNumbers) {
    const Scene scene = readNodes(R"([{"mesh":0,"scale":[1,1,0]}])");
    EXPECT_THAT(scene.normals[0], near({0, 0, 1}));
    const Scene line = readNodes(R"([{"mesh":0,"scale":[1,0,0]}])");
    EXPECT_EQ(line.normals[0], Vec3f(0, 0, 0));
}

TEST(ReadGltf, MeshesAreInstancedInNodeOrder) {
    const Scene scene =
        readNodes(R"([{"children":[1,3],"mesh":0},{"children":[2]},{"mesh":0,"translation":[1,0,0]},
                                      {"mesh":0,"translation":[2,0,0]}])");
    ASSERT_EQ(scene.primitives.size(), 3u);
    EXPECT_EQ(scene.positions[3].x(), 1);
    EXPECT_EQ(scene.positions[6].x(), 2);
    EXPECT_THAT(scene.indices, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8));
}

TEST(ReadGltf, TheDefaultSceneIsRead) {
    const std::string nodes = R"([{"mesh":0},{"mesh":0,"translation":[5,0,0]}])";
    const std::string scenes = R"([{"nodes":[0]},{"nodes":[1]}])";
    EXPECT_EQ(readNodes(nodes, scenes).positions[0].x(), 0);
    EXPECT_EQ(readNodes(nodes, scenes, R"(,"scene":1)").positions[0].x(), 5);
    EXPECT_EQ(readNodes(nodes, "").primitives.size(), 2u) << "no scene: all roots";
    EXPECT_EQ(readNodes("", "").primitives.size(), 1u) << "no nodes: all meshes";
}

TEST(ReadGltf, DeepHierarchiesDoNotOverflowTheStack) {
    std::string nodes = "[";
    for (int i = 0; i < 100000; ++i) nodes += R"({"children":[)" + std::to_string(i + 1) + "]},";
    EXPECT_EQ(readNodes(nodes + R"({"mesh":0}])").primitives.size(), 1u);
}

// ---- materials

/// The triangle with texture coordinates 0 (zeros) and 1 (ones), one material and one image.
GltfText texturedText(const std::string& material, const std::string& image, const std::string& texture) {
    GltfText text = triangleText();
    text.addFloats({0, 0, 0, 0, 0, 0}, 2);
    text.addFloats({1, 1, 1, 1, 1, 1}, 2);
    text.meshes =
        R"([{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1,"TEXCOORD_1":2},"material":0}]}])";
    text.more =
        R"(,"materials":[)" + material + R"(],"images":[)" + image + R"(],"textures":[)" + texture + "]";
    return text;
}

std::string pngBytes() {
    const std::vector<uint8_t> png = pngTexture("", 3, 2).encoded;
    return std::string(png.begin(), png.end());
}

TEST(ReadGltf, MaterialsAreRead) {
    const std::string bytes = pngBytes();
    const Scene scene = readText(
        texturedText(
            R"({"name":"wall","doubleSided":true,"pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,0.4],
                         "baseColorTexture":{"index":0}},"normalTexture":{"index":0,"scale":0.5}})",
            R"({"uri":"data:image/png;base64,)" + base64(bytes) + "\"}", R"({"source":0})")
            .glb());
    ASSERT_EQ(scene.materials.size(), 1u);
    const SceneMaterial& material = scene.materials[0];
    EXPECT_EQ(material.name, "wall");
    EXPECT_EQ(material.baseColor, Vec3f(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(material.baseColorTexture, 0);
    EXPECT_EQ(material.normalTexture, 0);
    EXPECT_EQ(material.normalScale, 0.5f);
    EXPECT_TRUE(material.doubleSided);
    ASSERT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(std::string(scene.textures[0].encoded.begin(), scene.textures[0].encoded.end()), bytes);
    EXPECT_EQ(scene.textures[0].mimeType, "image/png");
    EXPECT_EQ(scene.uv0[0], Vec2f(0, 0));
}

TEST(ReadGltf, TexturesMayUseTheSecondCoordinates) {
    const Scene scene = readText(
        texturedText(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1}}})",
                     R"({"uri":"data:image/png;base64,)" + base64(pngBytes()) + "\"}", R"({"source":0})")
            .glb());
    EXPECT_EQ(scene.uv0[0], Vec2f(1, 1));
    EXPECT_EQ(scene.uv1[0], Vec2f(1, 1));
}

TEST(ReadGltf, ImagesMayLieBesideTheFile) {
    TemporaryDirectory directory;
    std::filesystem::create_directory(directory.path() / "my textures");
    writeFileAtomically(directory.path() / "my textures" / "a.png", pngBytes());
    const GltfText text = texturedText(R"({"normalTexture":{"index":0}})", R"({"uri":"my%20textures/a.png"})",
                                       R"({"source":0})");
    writeFileAtomically(directory.path() / "mesh.bin", text.binary);
    writeFileAtomically(directory.path() / "mesh.gltf", text.json("mesh.bin"));
    const Scene scene = readGltf(directory.file("mesh.gltf"));
    ASSERT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(scene.textures[0].name, "a.png");
    EXPECT_EQ(scene.materials[0].normalTexture, 0);
    // Not found is an error, and not looked for elsewhere.
    std::filesystem::remove(directory.path() / "my textures" / "a.png");
    EXPECT_THROW(readGltf(directory.file("mesh.gltf")), InputError);
    std::filesystem::remove(directory.path() / "mesh.bin");
    EXPECT_THROW(readGltf(directory.file("mesh.gltf")), InputError);
}

TEST(ReadGltf, BuffersMayBeDataUris) {
    GltfText text = triangleText();
    const std::string uri = "data:application/octet-stream;base64," + base64(text.binary);
    EXPECT_EQ(readText(text.json(uri), "a.gltf").positions.size(), 3u);
    EXPECT_EQ(readText(glbFile(text.json(uri), "")).positions.size(), 3u);
}

TEST(ReadGltf, UnusedImagesAreNotNeeded) {
    EXPECT_THAT(
        readText(texturedText(R"({"name":"plain"})", R"({"uri":"absent.png"})", R"({"source":0})").glb())
            .textures,
        IsEmpty());
}

TEST(ReadGltf, TextureTransformsAreWarnedOf) {
    const auto warningFor = [](const std::string& transform) {
        const GltfText text = texturedText(
            R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":)" +
                transform + "}}}}",
            R"({"uri":"data:image/png;base64,)" + base64(pngBytes()) + "\"}", R"({"source":0})");
        testing::internal::CaptureStderr();
        readText(text.glb());
        return testing::internal::GetCapturedStderr();
    };
    EXPECT_THAT(warningFor(R"({"scale":[2,2]})"), HasSubstr("KHR_texture_transform is ignored"));
    EXPECT_THAT(warningFor(R"({"offset":[0.5,0]})"), HasSubstr("KHR_texture_transform is ignored"));
    EXPECT_THAT(warningFor(R"({"rotation":1})"), HasSubstr("KHR_texture_transform is ignored"));
    EXPECT_EQ(warningFor(R"({"scale":[1,1],"offset":[0,0],"rotation":0})"), "");
    EXPECT_EQ(warningFor("{}"), "");
}

}  // namespace
}  // namespace prt
