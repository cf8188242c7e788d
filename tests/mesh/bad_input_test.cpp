// One clear line for each kind of damaged file.
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <random>

#include "precompute/io/glb.h"
#include "tests/mesh/mesh_files.h"
#include "tests/mesh/mesh_kinds.h"

namespace prt {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;

using BadInput = MeshFiles;

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(BadInput, MissingFile) {
    for (const char* name : {"a.obj", "a.ply", "a.off", "a.stl", "a.glb", "a.gltf"})
        EXPECT_THAT(problemOfFile(directory_.file(name)), StartsWith(name));
}

TEST_F(BadInput, UnknownExtensionNamesTheKnown) {
    EXPECT_THAT(problemOf("a.fbx", "x"),
                AllOf(StartsWith("a.fbx: '.fbx'"), HasSubstr(".obj, .ply, .off, .stl, .gltf or .glb")));
    EXPECT_THAT(problemOf("mesh", "x"), HasSubstr("no extension"));
}

TEST_F(BadInput, EmptyFile) {
    for (const char* name : {"a.obj", "a.ply", "a.off", "a.stl", "a.glb"})
        EXPECT_THAT(problemOf(name, ""), StartsWith(name));
}

TEST_F(BadInput, NoFaces) {
    EXPECT_THAT(problemOf("a.obj", kSquare), HasSubstr("no faces"));
    EXPECT_THAT(problemOf("a.off", "OFF\n1 0 0\n0 0 0\n"), HasSubstr("no faces"));
    EXPECT_THAT(problemOf("a.stl", "solid a\nendsolid a\n"), HasSubstr("no faces"));
    EXPECT_THAT(problemOf("b.stl", binaryStl({}, 0)), HasSubstr("no faces"));
    EXPECT_THAT(problemOf("a.ply",
                          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                          "property float z\nend_header\n0 0 0\n"),
                HasSubstr("no faces"));
}

TEST_F(BadInput, FaceIndexOutOfRangeNamesTheLine) {
    EXPECT_EQ(problemOf("bunny.obj", std::string(kSquare) + "# comment\nf 1 2 3\nf 1 9999 3\n"),
              "bunny.obj:7: face uses vertex 9999 of 4; re-export the mesh");
    EXPECT_THAT(problemOf("a.obj", std::string(kSquare) + "f 1 0 3\n"),
                StartsWith("a.obj:5: face uses vertex 0 of 4"));
    EXPECT_THAT(problemOf("a.obj", std::string(kSquare) + "f -1 -2 -5\n"),
                StartsWith("a.obj:5: face uses vertex -5 of 4"));
    EXPECT_THAT(problemOf("a.obj", std::string(kSquare) + "vt 0 0\nf 1/1 2/2 3/1\n"),
                StartsWith("a.obj:6: face uses texture coordinate 2 of 1"));
    EXPECT_THAT(problemOf("a.obj", std::string(kSquare) + "vn 0 0 1\nf 1//1 2//1 3//7\n"),
                StartsWith("a.obj:6: face uses normal 7 of 1"));
    EXPECT_THAT(problemOf("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
                StartsWith("a.off:6: face uses vertex 3 of 3"));
    EXPECT_THAT(problemOf("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"),
                StartsWith("a.off:6: face uses vertex -1 of 3"));
    EXPECT_THAT(
        problemOf("a.ply",
                  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                  "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                  "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
        StartsWith("a.ply:13: face 0 uses vertex 3 of 3"));
}

TEST_F(BadInput, PositionThatIsNotFinite) {
    for (const char* number : {"nan", "NaN", "-inf", "1e999", "1e39"}) {
        const std::string n(number);
        EXPECT_THAT(problemOf("a.obj", std::string(kSquare) + "v 0 " + n + " 0\nf 1 2 3\n"),
                    StartsWith("a.obj:5: vertex 5 has a position that is not finite"));
        EXPECT_THAT(problemOf("a.off", "OFF\n3 1 0\n0 0 0\n1 " + n + " 0\n0 1 0\n3 0 1 2\n"),
                    StartsWith("a.off:4: vertex 1 has a position that is not finite"));
        EXPECT_THAT(
            problemOf("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 " + n +
                                   "\nvertex 0 1 0\n"
                                   "endloop\nendfacet\nendsolid\n"),
            AllOf(StartsWith("a.stl:5"), HasSubstr("not finite")));
        EXPECT_THAT(
            problemOf("a.ply",
                      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                      "0 0 0\n1 0 0\n0 1 " +
                          n + "\n3 0 1 2\n"),
            StartsWith("a.ply:12: vertex 2 has a position that is not finite"));
    }
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT(problemOf("b.stl", binaryStl({{0, 0, 0, 1, 0, 0, 0, nan, 0}}, 1)),
                HasSubstr("vertex 2 of triangle 0 is not finite"));
    Scene scene = makeGrid(1);
    scene.positions[2].x() = nan;
    try {
        prepareScene(scene, "memory", {});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), StartsWith("memory: vertex 2 has a position that is not finite"));
    }
}

TEST_F(BadInput, NoArea) {
    EXPECT_THAT(problemOf("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 2\n"),
                HasSubstr("none of its 2 triangles has an area"));
    EXPECT_THAT(problemOf("b.stl", binaryStl({{1, 1, 1, 1, 1, 1, 1, 1, 1}}, 1)), HasSubstr("has an area"));
}

TEST_F(BadInput, ObjGarbage) {
    EXPECT_THAT(problemOf("a.obj", "v 0 0\nf 1 1 1\n"),
                StartsWith("a.obj:1: vertex 1 does not have three coordinates"));
    EXPECT_THAT(problemOf("a.obj", "v 0 zero 0\nf 1 1 1\n"), StartsWith("a.obj:1:"));
    EXPECT_THAT(problemOf("a.obj", std::string(kSquare) + "f 1 two 3\n"),
                StartsWith("a.obj:5: a face has a vertex index that is no number"));
    EXPECT_THAT(problemOf("a.obj", std::string(kSquare) + "vt 0 0\nf 1/1 2/1 3/\n"),
                StartsWith("a.obj:6: a corner of a face ends in '/'"));
    std::string bytes;
    for (int i = 0; i < 4096; ++i) bytes += char((i * 7919) >> 3);
    EXPECT_THAT(problemOf("a.obj", bytes), HasSubstr("no faces"));
    std::string polygon = kSquare;
    polygon += "f";
    for (int i = 0; i < 300; ++i) polygon.append(" ").append(std::to_string(1 + i % 4));
    EXPECT_THAT(problemOf("a.obj", polygon + "\n"), StartsWith("a.obj:5: a face has 300 corners"));
}

TEST_F(BadInput, TruncatedStlBinary) {
    const std::string whole = binaryStl(std::vector<std::vector<float>>(12, {0, 0, 0, 1, 0, 0, 0, 1, 0}), 12);
    EXPECT_THAT(problemOf("a.stl", whole.substr(0, 84 + 50 * 3 + 20)),
                HasSubstr("promises 12 triangles, it holds 3"));
    for (size_t length = 1; length < whole.size(); length += 7)
        EXPECT_THAT(problemOf("a.stl", whole.substr(0, length)), StartsWith("a.stl: "));
}

TEST_F(BadInput, TruncatedStlText) {
    const std::string whole =
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
        "0\nendloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 -1 "
        "0\nendloop\nendfacet\nendsolid";
    EXPECT_EQ(problemOf("a.stl", whole), "no error");
    for (size_t length = 0; length < whole.size(); ++length)
        EXPECT_THAT(problemOf("a.stl", whole.substr(0, length)), StartsWith("a.stl")) << length;
    EXPECT_THAT(problemOf("a.stl", whole.substr(0, whole.size() - 8)),
                HasSubstr("truncated after 2 triangles"));
}

std::string plyWithCounts(const std::string& format, const std::string& vertices, const std::string& faces) {
    return "ply\nformat " + format + " 1.0\nelement vertex " + vertices +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
           "\nproperty list uchar int vertex_indices\nend_header\n";
}

TEST_F(BadInput, PlyWithHugeCount) {
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        EXPECT_THAT(problemOf("a.ply", plyWithCounts(format, "4000000000", "1") + std::string(64, '0')),
                    HasSubstr("promises"));
        EXPECT_THAT(
            problemOf("a.ply", plyWithCounts(format, "3", "9000000000000000000") + std::string(64, '0')),
            HasSubstr("promises"));
        EXPECT_THAT(problemOf("a.ply", plyWithCounts(format, "99999999999999999999999", "1")),
                    HasSubstr("no count"));
        EXPECT_THAT(problemOf("a.ply", plyWithCounts(format, "-1", "1")), HasSubstr("no count"));
    }
    // A list that claims to be longer than the file.
    std::string bytes =
        "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uint int vertex_indices\nend_header\n";
    EXPECT_THAT(problemOf("a.ply", bytes + rawBytes(0xffffffffu) + "0123"), HasSubstr("truncated"));
    EXPECT_THAT(problemOf("a.off", "OFF\n2000000000 1 0\n0 0 0\n"), HasSubstr("more than"));
}

TEST_F(BadInput, PlyTruncatedAtEveryLength) {
    std::string binary = plyWithCounts("binary_little_endian", "3", "1");
    for (float value : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) binary += rawBytes(value);
    binary += '\3';
    for (int i : {0, 1, 2}) binary += rawBytes(i);
    EXPECT_EQ(problemOf("a.ply", binary), "no error");
    for (size_t length = 0; length < binary.size(); ++length)
        EXPECT_THAT(problemOf("a.ply", binary.substr(0, length)), StartsWith("a.ply")) << length;
    // Of a text the last number may be cut short without a trace.
    const std::string text = plyWithCounts("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2";
    EXPECT_EQ(problemOf("a.ply", text), "no error");
    for (size_t length = 0; length < text.size(); ++length)
        EXPECT_THAT(problemOf("a.ply", text.substr(0, length)), StartsWith("a.ply")) << length;
}

TEST_F(BadInput, OffTruncatedAtEveryLine) {
    const std::string text = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    for (size_t end = text.find('\n'); end + 1 < text.size(); end = text.find('\n', end + 1))
        EXPECT_THAT(problemOf("a.off", text.substr(0, end + 1)), StartsWith("a.off")) << end;
    EXPECT_THAT(problemOf("a.off", "OFF BINARY\n"), HasSubstr("binary OFF"));
    EXPECT_THAT(problemOf("a.off", "4OFF\n1 1 1\n"), HasSubstr("does not start with OFF"));
}

TEST_F(BadInput, TruncatedGlb) {
    const Scene scene = prepareScene(makeGrid(2), "grid", {});
    const std::string path = directory_.file("whole.glb");
    writeGlb(scene, path);
    std::ifstream stream(path, std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(stream)), {});
    for (size_t length :
         {size_t(0), size_t(3), size_t(11), size_t(19), whole.size() / 3, whole.size() / 2, whole.size() - 1})
        EXPECT_THAT(problemOf("a.glb", whole.substr(0, length)), StartsWith("a.glb")) << length;
}

TEST_F(BadInput, DamagedBytesAreLoadedOrRefusedButNeverWorse) {
    std::string ply = plyWithCounts("binary_little_endian", "4", "2");
    for (float value : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) ply += rawBytes(value);
    for (int face = 0; face < 2; ++face) {
        ply += '\3';
        for (int i : {0, 1, 2 + face}) ply += rawBytes(i);
    }
    const std::map<std::string, std::string> files{
        {"a.obj", std::string(kSquare) +
                      "vt 0 0\nvn 0 0 1\no part\nusemtl x\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf -1 -2 -3\n"},
        {"b.ply", ply},
        {"c.ply", plyWithCounts("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
        {"d.off", "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n"},
        {"e.stl", binaryStl({{0, 0, 0, 1, 0, 0, 0, 1, 0}}, 1)},
        {"f.stl",
         "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
         "0\nendloop\nendfacet\nendsolid\n"}};
    std::mt19937 random(17);
    for (const auto& [name, sound] : files) {
        EXPECT_EQ(problemOf(name, sound), "no error") << name;
        for (int trial = 0; trial < 300; ++trial) {
            std::string bytes = sound;
            for (uint32_t k = 0; k <= random() % 3; ++k) {
                const size_t at = random() % bytes.size();
                switch (random() % 4) {
                    case 0:
                        bytes[at] = char(random());
                        break;
                    case 1:
                        bytes[at] = "0129-.e/ \n"[random() % 10];
                        break;
                    case 2:
                        bytes.erase(at, 1 + random() % 4);
                        break;
                    default:
                        bytes.insert(at, bytes.substr(random() % bytes.size(), 1 + random() % 8));
                }
                if (bytes.empty()) bytes.push_back(' ');
            }
            try {
                const Scene scene = load(name, bytes);
                EXPECT_NO_THROW(validateScene(scene, name));
            } catch (const InputError& error) {
                EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
            }
        }
    }
}

TEST_F(BadInput, ScenesOutOfRange) {
    Scene scene = makeGrid(1);
    scene.indices[4] = 99;
    EXPECT_THROW(prepareScene(scene, "memory", {}), InputError);
    scene = makeGrid(1);
    scene.indices.pop_back();
    EXPECT_THROW(prepareScene(scene, "memory", {}), InputError);
    scene = makeGrid(1);
    scene.normals.resize(1);
    EXPECT_THROW(prepareScene(scene, "memory", {}), InputError);
    scene = makeGrid(1);
    scene.primitives[0].material = 3;
    EXPECT_THROW(prepareScene(scene, "memory", {}), InputError);
    EXPECT_THROW(prepareScene({}, "memory", {}), InputError);
    LoadMeshOptions options;
    options.uvScale = 0;
    EXPECT_THROW(prepareScene(makeGrid(1), "memory", options), UsageError);
}

}  // namespace
}  // namespace prt
