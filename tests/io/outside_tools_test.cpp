// What other people's tools say of our files: exrheader (OpenEXR) and gltf-validator (Khronos).
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "precompute/base/atomic_file.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/glb.h"
#include "tests/base/temporary_directory.h"
#include "tests/io/small_maps.h"
#include "tests/io/small_scene.h"

namespace prt {
namespace {

using testing::HasSubstr;

struct Outcome {
    int status;
    std::string output;
};

Outcome run(const std::string& command) {
    std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    std::string output;
    std::array<char, 4096> block;
    size_t count = 0;
    while ((count = std::fread(block.data(), 1, block.size(), pipe)) > 0) output.append(block.data(), count);
    const int status = ::pclose(pipe);
    return {status, output};
}

TEST(ExrHeader, OpensEveryKindOfFile) {
    if (run("command -v exrheader").status != 0)
        GTEST_SKIP() << "exrheader (package openexr) is not installed";
    TemporaryDirectory directory;
    writeVisibilityFile(directory.file("texel.exr"), randomVisibility({PointDomain::Texel, 9, 7, 63}, 6));
    writeVisibilityFile(directory.file("vertex.exr"), randomVisibility(vertexGrid(2000), 4));
    writePcaFile(directory.file("pca.exr"), randomPca(vertexGrid(2000), 4, 5));
    writeTableFile(directory.file("table.exr"), randomTable(TableKind::TripleProduct, 8, 4, 6));
    writeExrImage(directory.file("image.exr"), {4, 2, 3, std::vector<float>(24, 0.5f)});
    const std::map<std::string, std::vector<std::string>> expected{
        {"texel.exr",
         {"V.35, 32-bit floating-point", "validity, 32-bit unsigned integer", "Condon-Shortley"}},
        {"vertex.exr",
         {"vertexCount (type int): 2000", "shOrder (type int): 4", "domain (type string): \"vertex\""}},
        {"pca.exr", {"\"weights\"", "\"basis\"", "w.04", "value", "variance"}},
        {"table.exr", {"B.01.A", "mean.R", "tableKind (type string): \"triple-product\""}},
        {"image.exr", {"R, 16-bit floating-point"}}};
    for (const auto& [name, lines] : expected) {
        const Outcome outcome = run("exrheader '" + directory.file(name) + "'");
        EXPECT_EQ(outcome.status, 0) << outcome.output;
        for (const std::string& line : lines) EXPECT_THAT(outcome.output, HasSubstr(line)) << name;
    }
}

/// Runs the validator over a file; prints the number of errors and the messages.
constexpr const char* kValidate = R"(
const validator = require(process.argv[2] + '/node_modules/gltf-validator');
const bytes = new Uint8Array(require('fs').readFileSync(process.argv[3]));
validator.validateBytes(bytes).then((report) => {
  console.log('errors: ' + report.issues.numErrors + ', warnings: ' + report.issues.numWarnings + ';');
  for (const message of report.issues.messages) console.log(JSON.stringify(message));
}).catch((error) => { console.log('failed: ' + error); process.exit(1); });
)";

TEST(GltfValidator, FindsNoErrors) {
    const char* folder = std::getenv("PRT_GLTF_VALIDATOR_DIR");
    if (!folder || run("command -v node").status != 0)
        GTEST_SKIP()
            << "set PRT_GLTF_VALIDATOR_DIR to where npm installed gltf-validator@2.0.0-dev.3.10, with node";
    TemporaryDirectory directory;
    writeFileAtomically(directory.path() / "validate.js", kValidate);
    std::vector<Scene> scenes(5, smallScene());
    scenes[1].tangents.clear();
    scenes[1].uv1.clear();
    scenes[2].uv0.clear();
    scenes[2].tangents.clear();
    scenes[2].textures.clear();
    scenes[2].materials[0] = SceneMaterial();
    // A lossy WebP of one pixel.
    scenes[3].textures[1].encoded = {'R',  'I',  'F',  'F',  36,   0,    0,    0,    'W',  'E',  'B',
                                     'P',  'V',  'P',  '8',  ' ',  24,   0,    0,    0,    0x30, 0x01,
                                     0x00, 0x9d, 0x01, 0x2a, 0x01, 0x00, 0x01, 0x00, 0x02, 0x00, 0x34,
                                     0x25, 0xa4, 0x00, 0x03, 0x70, 0x00, 0xfe, 0xfb, 0x94, 0x00, 0x00};
    scenes[3].textures[1].mimeType = "image/webp";
    scenes[4].materials[0].baseColor = Vec3f(1.5f, -0.1f, 0.5f);
    for (size_t i = 0; i < scenes.size(); ++i) {
        const std::string path = directory.file("mesh" + std::to_string(i) + ".glb");
        writeGlb(scenes[i], path);
        const Outcome outcome =
            run("node '" + directory.file("validate.js") + "' '" + folder + "' '" + path + "'");
        EXPECT_EQ(outcome.status, 0) << outcome.output;
        // Without tangents it warns that other viewers may make other ones.
        const int warnings = scenes[i].tangents.empty() && scenes[i].materials[0].normalTexture >= 0 ? 1 : 0;
        EXPECT_THAT(outcome.output, HasSubstr("errors: 0, warnings: " + std::to_string(warnings) + ";")) << i;
    }
}

}  // namespace
}  // namespace prt
