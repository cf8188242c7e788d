// Bad meshes as files through the command, and what threads may not change in what it writes.
#include <fstream>
#include <limits>

#include "precompute/io/visibility_file.h"
#include "tests/tools/prt_process.h"
#include "tests/visibility/nasty_meshes.h"

namespace prt::test {
namespace {
namespace fs = std::filesystem;

std::string objText(const Scene& scene) {
    std::ostringstream text;
    text.precision(std::numeric_limits<float>::max_digits10);
    for (const Vec3f& p : scene.positions) text << "v " << p.x() << " " << p.y() << " " << p.z() << "\n";
    for (size_t i = 0; i < scene.indices.size(); i += 3)
        text << "f " << scene.indices[i] + 1 << " " << scene.indices[i + 1] + 1 << " "
             << scene.indices[i + 2] + 1 << "\n";
    return text.str();
}

struct Sampling {
    std::string name;
    std::vector<std::string> words;
};
const Sampling kSamplings[] = {{"uniform", {"--rays", "64"}}, {"adaptive", {"--error", "0.02"}}};

// Bakes mesh.obj of a folder. @return its bundle
fs::path bake(const Folder& folder, const Sampling& sampling, std::vector<std::string> options) {
    const std::string bundle = sampling.name + "-" + std::to_string(folder.files().size()) + ".prt";
    options.insert(options.begin(), {"precompute", "mesh.obj", "-o", bundle, "--quiet"});
    options.insert(options.end(), sampling.words.begin(), sampling.words.end());
    const ProcessResult result = runPrt(folder, options);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return folder / bundle;
}

class NastyFile : public testing::TestWithParam<nasty::Kind> {};

TEST_P(NastyFile, Bakes) {
    Folder folder;
    folder.write("mesh.obj", objText(GetParam().mesh.make()));
    for (const Sampling& sampling : kSamplings)
        for (const auto& domain :
             {std::vector<std::string>{"--per-vertex"}, {"--texels", std::to_string(GetParam().texels)}}) {
            const fs::path bundle = bake(folder, sampling, domain);
            if (HasFailure()) return;
            nasty::expectSane(readVisibilityFile((bundle / "visibility.exr").string()),
                              sampling.name + " " + domain[0]);
        }
}

// All kinds are baked in memory by the tests of visibility; here the worst, from files.
std::vector<nasty::Kind> worst() {
    std::vector<nasty::Kind> all;
    for (const nasty::Kind& kind : nasty::kinds())
        for (const char* name : {"one_triangle", "book", "coincident", "specks", "without_area",
                                 "randomly_wound", "far_box", "one_speck", "as_large_as_the_world"})
            if (kind.mesh.name == name) all.push_back(kind);
    return all;
}
INSTANTIATE_TEST_SUITE_P(Meshes, NastyFile, testing::ValuesIn(worst()),
                         [](const auto& kind) { return kind.param.mesh.name; });

TEST(Threads, DoNotChangeAByteAdaptivelyOrPerVertex) {
    Folder folder;
    folder.write("mesh.obj", openBoxObj());
    for (const Sampling& sampling : kSamplings)
        for (const auto& domain : {std::vector<std::string>{"--per-vertex"}, {"--texels", "64"}}) {
            std::vector<std::string> written;
            for (const char* threads : {"1", "2"}) {
                std::vector<std::string> options = domain;
                options.insert(options.end(), {"--order", "5", "--threads", threads});
                written.push_back(slurp(bake(folder, sampling, options) / "visibility.exr"));
            }
            EXPECT_FALSE(written[0].empty());
            EXPECT_EQ(written[0], written[1]) << sampling.name << " " << domain[0];
        }
}

TEST(Atlases, OfAnySizeHoldASmallMesh) {
    Folder folder;
    folder.write("mesh.obj", cubeObj());
    for (const char* texels : {"16", "17", "1000"}) {
        const fs::path bundle = bake(folder, kSamplings[0], {"--texels", texels, "--order", "1"});
        const VisibilityMap map = readVisibilityFile((bundle / "visibility.exr").string());
        EXPECT_EQ(map.grid.width, std::stoi(texels));
        nasty::expectSane(map, texels);
    }
}

}  // namespace
}  // namespace prt::test
