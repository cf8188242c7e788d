// Damaged glTF: every accessor, index and length is checked; no damage crashes.
#include <functional>
#include <random>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/io/glb.h"
#include "tests/base/temporary_directory.h"
#include "tests/io/gltf_text.h"
#include "tests/io/small_scene.h"

namespace prt {
namespace {

using testing::HasSubstr;

std::string problemOf(const std::string& bytes) {
    TemporaryDirectory directory;
    rewriteFile(directory.file("a.glb"), bytes);
    try {
        readGltf(directory.file("a.glb"));
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("a.glb"));
        return error.what();
    }
    return "accepted";
}

/// A triangle with indices, normals, a sparse accessor, nodes and a texture, in text.
std::string fullText() {
    GltfText text;
    text.addFloats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
    text.addAccessor(raw<uint16_t>({0, 1, 2}), 5123, 3, "SCALAR");
    text.addFloats({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
    const int indices = text.addView(raw<uint8_t>({1, 0, 0, 0}));
    const int values = text.addView(raw<float>({0, 1, 0}));
    text.accessors[2].insert(text.accessors[2].size() - 1,
                             R"(,"sparse":{"count":1,"indices":{"bufferView":)" + std::to_string(indices) +
                                 R"(,"byteOffset":0,"componentType":5121},"values":{"bufferView":)" +
                                 std::to_string(values) + R"(,"byteOffset":0}})");
    const std::vector<uint8_t> png = pngTexture("", 2, 2).encoded;
    const int image = text.addView(std::string(png.begin(), png.end()));
    text.meshes = R"([{"primitives":[{"attributes":{"POSITION":0,"NORMAL":2},"indices":1,"material":0}]}])";
    text.nodes = R"([{"children":[1]},{"mesh":0}])";
    text.more = R"(,"scene":0,"materials":[{"normalTexture":{"index":0}}],"textures":[{"source":0}],)"
                R"("images":[{"mimeType":"image/png","bufferView":)" +
                std::to_string(image) + "}]";
    return glbFile(text.json(), text.binary);
}

std::string jsonOf(const std::string& glb) {
    uint32_t length;
    std::memcpy(&length, glb.data() + 12, 4);
    return glb.substr(20, length);
}
std::string binaryOf(const std::string& glb) { return glb.substr(28 + jsonOf(glb).size()); }

struct Change {
    const char *from, *to, *message;
};
class DamagedGltf : public testing::TestWithParam<Change> {};

TEST_P(DamagedGltf, IsRefusedWithItsReason) {
    const std::string glb = fullText();
    std::string json = jsonOf(glb);
    const size_t at = json.find(GetParam().from);
    ASSERT_NE(at, std::string::npos) << json;
    json.replace(at, std::string(GetParam().from).size(), GetParam().to);
    EXPECT_THAT(problemOf(glbFile(json, binaryOf(glb))), HasSubstr(GetParam().message)) << json;
}

// In order of the document: buffer, views 0 positions (0, 36), 1 indices (36, 6), 2 normals (44, 36), …
INSTANTIATE_TEST_SUITE_P(
    Each, DamagedGltf,
    testing::Values(
        Change{R"("byteOffset":0,"byteLength":36)", R"("byteOffset":100000,"byteLength":36)",
               "buffer view 0"},
        Change{R"("byteOffset":0,"byteLength":36)", R"("byteOffset":0,"byteLength":100000)", "buffer view 0"},
        Change{R"("byteOffset":0,"byteLength":36)", R"("byteOffset":18446744073709551612,"byteLength":36)",
               "buffer view 0"},
        Change{R"("byteOffset":0,"byteLength":36)", R"("byteOffset":0,"byteLength":35)",
               "reach beyond buffer view 0"},
        Change{R"("byteLength":36)", R"("byteLength":36,"byteStride":8)", "stride of 8"},
        Change{R"("byteLength":36)", R"("byteLength":36,"byteStride":16)", "reach beyond buffer view 0"},
        Change{R"([{"buffer":0)", R"([{"buffer":3)", "buffer"},
        Change{R"([{"buffer":0)", R"([{"buffer":-1)", "buffer"},
        Change{R"("bufferView":0,"componentType":5126,"count":3)",
               R"("bufferView":0,"componentType":5126,"count":4)", "reach beyond buffer view 0"},
        Change{R"("bufferView":0,"componentType":5126,"count":3)",
               R"("bufferView":0,"componentType":5126,"count":4611686018427387904)",
               "reach beyond buffer view 0"},
        Change{R"("bufferView":0,"componentType":5126,"count":3)",
               R"("bufferView":0,"byteOffset":4,"componentType":5126,"count":3)",
               "reach beyond buffer view 0"},
        Change{R"("bufferView":0,"componentType":5126,"count":3)",
               R"("bufferView":0,"byteOffset":18446744073709551608,"componentType":5126,"count":3)",
               "reach beyond buffer view 0"},
        Change{R"("bufferView":0,"componentType":5126)", R"("bufferView":77,"componentType":5126)",
               "buffer view 77"},
        Change{R"("bufferView":0,"componentType":5126,"count":3)",
               R"("componentType":5126,"count":4000000000)", "without a buffer"},
        Change{R"("bufferView":0,"componentType":5126)", R"("bufferView":0,"componentType":5130)",
               "component type 5130"},
        Change{R"("bufferView":0,"componentType":5126)", R"("bufferView":0,"componentType":5125)",
               "component type 5125"},
        Change{R"("bufferView":0,"componentType":5126)", R"("bufferView":0,"componentType":1)", "glTF"},
        Change{R"("count":3,"type":"VEC3")", R"("count":3,"type":"VEC2")", "3 components"},
        Change{R"("count":3,"type":"VEC3")", R"("count":3,"type":"VEC9")", "glTF"},
        Change{R"("componentType":5123,"count":3)", R"("componentType":5126,"count":3)", "no vertex indices"},
        Change{R"("componentType":5123,"count":3)", R"("componentType":5123,"count":2)",
               "not a multiple of 3"},
        Change{R"("componentType":5123,"count":3)", R"("componentType":5121,"count":6)", "accepted"},
        Change{R"("componentType":5123,"count":3)", R"("componentType":5125,"count":3)", "reach beyond"},
        Change{R"("sparse":{"count":1)", R"("sparse":{"count":4)", "replaces 4 of 3"},
        Change{R"("sparse":{"count":1)", R"("sparse":{"count":2)", "reach beyond"},
        Change{R"("sparse":{"count":1)", R"("sparse":{"count":-1)", "replaces -1"},
        Change{R"("byteOffset":0,"componentType":5121)", R"("byteOffset":-8,"componentType":5121)",
               "negative offset"},
        Change{R"("byteOffset":0,"componentType":5121)", R"("byteOffset":4,"componentType":5121)",
               "reach beyond"},
        Change{R"("byteOffset":0,"componentType":5121)", R"("byteOffset":0,"componentType":5126)",
               "indices of type"},
        Change{R"("POSITION":0)", R"("POSITION":9)", "accessor 9"},
        Change{R"("POSITION":0)", R"("POSITION":-1)", "accessor"},
        Change{R"("POSITION":0)", R"("POSITIOM":0)", "no POSITION"},
        Change{R"("indices":1,"material")", R"("indices":9,"material")", "glTF"},
        Change{R"("material":0)", R"("material":5)", "material 5"},
        Change{R"("normalTexture":{"index":0})", R"("normalTexture":{"index":4})", "texture 4"},
        Change{R"({"source":0})", R"({"source":4})", "image 4"},
        Change{R"({"source":0})", R"({})", "image -1"},
        Change{R"("children":[1])", R"("children":[7])", "node 7"},
        Change{R"("children":[1])", R"("children":[-1])", "node -1"},
        Change{R"("children":[1])", R"("children":[0])", "reached twice"},
        Change{R"("children":[1])", R"("children":[1,1])", "reached twice"},
        Change{R"({"mesh":0})", R"({"mesh":0,"children":[0]})", "reached twice"},
        Change{R"({"mesh":0})", R"({"mesh":3})", "mesh 3"}, Change{R"({"mesh":0})", R"({})", "no triangles"},
        Change{R"("scene":0)", R"("scene":2)", "scene 2"},
        Change{R"({"mesh":0})", R"({"mesh":0,"scale":[1e308,1e308,1e308],"translation":[0,0,0]})",
               "accepted"},
        Change{R"({"asset":)", R"({"extensionsRequired":["KHR_draco_mesh_compression"],"asset":)",
               "KHR_draco_mesh_compression"},
        Change{R"({"asset":)", R"({"Asset":)", "glTF"}, Change{"{", "[", "glTF"}));

TEST(DamagedGlb, IndexOutOfRangeNamesThePrimitive) {
    const std::string glb = fullText();
    std::string binary = binaryOf(glb);
    binary[38] = 9;
    EXPECT_THAT(problemOf(glbFile(jsonOf(glb), binary)),
                testing::AllOf(HasSubstr("mesh 0, primitive 0"), HasSubstr("vertex 9 of 3")));
}

TEST(DamagedGlb, SparseTargetOutOfRangeIsRefused) {
    const std::string glb = fullText();
    std::string binary = binaryOf(glb);
    binary[80] = 3;
    EXPECT_THAT(problemOf(glbFile(jsonOf(glb), binary)), HasSubstr("replaces element 3 of 3"));
}

TEST(DamagedGlb, HeadersAreChecked) {
    const std::string good = fullText();
    ASSERT_EQ(problemOf(good), "accepted");
    std::string bytes = good;
    bytes.replace(4, 4, word(1));
    EXPECT_THAT(problemOf(bytes), HasSubstr("glTF version 1"));
    bytes = good;
    bytes.replace(8, 4, word(good.size() + 1));
    EXPECT_THAT(problemOf(bytes), HasSubstr("its header promises"));
    bytes = good;
    bytes.replace(12, 4, word(0xfffffff0));
    EXPECT_THAT(problemOf(bytes), HasSubstr("JSON chunk"));
    // The length of the binary chunk covers its own header: tinygltf lets this pass and reads too far.
    const size_t chunk = 20 + jsonOf(good).size();
    bytes = good;
    bytes.replace(chunk, 4, word(good.size() - chunk));
    EXPECT_THAT(problemOf(bytes), HasSubstr("binary chunk"));
    EXPECT_THAT(problemOf("glTF"), HasSubstr("too short"));
    EXPECT_THAT(problemOf(""), HasSubstr("glTF"));
    EXPECT_THAT(problemOf("{}"), HasSubstr("glTF"));
    EXPECT_THAT(problemOf("hello"), HasSubstr("glTF"));
}

TEST(DamagedGlb, DeepNestingIsRefused) {
    const std::string glb = fullText();
    std::string json = jsonOf(glb);
    const std::string deep = std::string(200000, '[') + std::string(200000, ']');
    json.replace(json.find("{"), 1, R"({"extras":)" + deep + ",");
    EXPECT_THAT(problemOf(glbFile(json, binaryOf(glb))), HasSubstr("nested too deeply"));
}

TEST(DamagedGlb, UrisAreNotRunByAShell) {
    TemporaryDirectory directory;
    GltfText text = triangleText();
    writeFileAtomically(directory.path() / "a.gltf", text.json("$(touch " + directory.file("ran") + ").bin"));
    EXPECT_THROW(readGltf(directory.file("a.gltf")), InputError);
    EXPECT_FALSE(std::filesystem::exists(directory.path() / "ran"));
}

TEST(DamagedGlb, MissingFilesAndDirectories) {
    TemporaryDirectory directory;
    EXPECT_THROW(readGltf(directory.file("absent.glb")), InputError);
    EXPECT_THROW(readGltf(directory.path()), InputError);
}

TEST(DamagedGlb, EveryTruncationIsRefused) {
    TemporaryDirectory directory;
    const std::string path = directory.file("mesh.glb");
    writeGlb(smallScene(), path);
    const std::string whole = readFile(path);
    for (size_t length = 0; length < whole.size(); ++length) {
        rewriteFile(path, whole.substr(0, length));
        EXPECT_THROW(readGltf(path), InputError) << length << " of " << whole.size();
    }
}

TEST(DamagedGlb, FlippedBitsNeverCrash) {
    TemporaryDirectory directory;
    const std::string path = directory.file("mesh.glb");
    std::mt19937 random(7);
    for (const std::string& whole : {fullText(), [&] {
                                         writeGlb(smallScene(), path);
                                         return readFile(path);
                                     }()}) {
        int refused = 0, accepted = 0;
        testing::internal::CaptureStderr();
        for (int i = 0; i < 6000; ++i) {
            std::string bytes = whole;
            const size_t at = size_t(i) < whole.size() ? size_t(i) : random() % whole.size();
            bytes[at] = char(bytes[at] ^ char(1u << random() % 8));
            rewriteFile(path, bytes);
            try {
                const Scene scene = readGltf(path);
                for (uint32_t index : scene.indices) ASSERT_LT(index, scene.positions.size());
                ++accepted;
            } catch (const InputError&) {
                ++refused;
            }
        }
        testing::internal::GetCapturedStderr();
        EXPECT_GT(refused, 100);
        EXPECT_GT(accepted, 100);
    }
}

}  // namespace
}  // namespace prt
