// Stage 1 from a mesh file to a bundle.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/bundle.h"
#include "precompute/io/glb.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/precompute_job.h"
#include "tests/rays/shapes.h"

namespace prt {
namespace {

namespace fs = std::filesystem;

class PrecomputeJob : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "prt-visibility-XXXXXX").string();
        ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
        directory_ = pattern;
        setQuiet(true);
    }
    void TearDown() override {
        setQuiet(false);
        fs::remove_all(directory_);
    }
    std::string path(const std::string& name) const { return (directory_ / name).string(); }

    std::string writeObj(const std::string& name, const shapes::Mesh& mesh) const {
        std::ofstream out(path(name));
        out.precision(9);
        for (const Vec3f& p : mesh.positions) out << "v " << p.x() << " " << p.y() << " " << p.z() << "\n";
        for (size_t t = 0; t < mesh.triangles(); ++t)
            out << "f " << mesh.indices[3 * t] + 1 << " " << mesh.indices[3 * t + 1] + 1 << " "
                << mesh.indices[3 * t + 2] + 1 << "\n";
        return path(name);
    }
    PrecomputeSettings settings(const std::string& mesh) const {
        PrecomputeSettings result;
        result.meshPath = mesh;
        result.bundlePath = path("out.prt");
        result.texels = 64;
        result.shOrder = 3;
        result.rays = 256;
        return result;
    }
    std::set<std::string> files() const {
        std::set<std::string> names;
        for (const auto& entry : fs::recursive_directory_iterator(directory_))
            names.insert(fs::relative(entry.path(), directory_).string());
        return names;
    }

    fs::path directory_;
};

shapes::Mesh houseOnGround() {
    shapes::Mesh mesh = shapes::floorSquare(3);
    mesh.add(shapes::box({-1, -0.5f, -1}, {1, 1, 1}));
    return mesh;
}

TEST_F(PrecomputeJob, BakesTexels) {
    const PrecomputeSettings given = settings(writeObj("house.obj", houseOnGround()));
    const PrecomputeReport report = runPrecompute(given);
    EXPECT_EQ(files(), (std::set<std::string>{"house.obj", "out.prt", "out.prt/manifest.json",
                                              "out.prt/mesh.glb", "out.prt/visibility.exr"}));
    EXPECT_EQ(report.triangles, 14u);
    EXPECT_TRUE(report.atlasMade);
    EXPECT_GE(report.atlas.charts, 2);
    EXPECT_GT(report.points, 500u);
    EXPECT_GT(report.rays, report.points * 100);
    EXPECT_GT(report.meanAo, 0.3);
    EXPECT_LT(report.meanAo, 1.0);

    const Bundle bundle = Bundle::open(given.bundlePath);
    EXPECT_EQ(bundle.staleReason("visibility.exr", true), "");
    EXPECT_EQ(bundle.staleReason("mesh.glb", true), "");
    const BundleFile* visibilityFile = bundle.find("visibility.exr");
    ASSERT_NE(visibilityFile, nullptr);
    EXPECT_EQ(visibilityFile->madeFrom.at("mesh.glb"), bundle.find("mesh.glb")->xxh3);
    EXPECT_EQ(bundle.find("mesh.glb")->madeFrom.at(given.meshPath), xxh3HexOfFile(given.meshPath));
    EXPECT_THAT(visibilityFile->madeBy, testing::StartsWith("prt precompute "));
    EXPECT_THAT(visibilityFile->madeBy,
                testing::HasSubstr("--texels 64 --order 3 --projection irradiance --rays 256"));
    const std::string section = bundle.section("precompute");
    for (const char* key :
         {"\"points\"", "\"rays\"", "\"rays_per_s\"", "\"seconds\"", "\"peak_rss_bytes\"", "\"validity\"",
          "\"gutter_filled\"", "\"utilisation\"", "\"projection_cone_deg\"", "\"projection_floor\""})
        EXPECT_THAT(section, testing::HasSubstr(key));

    const VisibilityMap map = readVisibilityFile(bundle.pathOf("visibility.exr").string());
    EXPECT_EQ(map.grid.domain, PointDomain::Texel);
    EXPECT_EQ(map.grid.width, 64);
    EXPECT_EQ(map.shOrder, 3);
    EXPECT_EQ(map.projection, Projection{});
    EXPECT_EQ(map.attributes.at("directionSet"), "spherical-fibonacci");
    EXPECT_EQ(map.attributes.at("rays"), "256");
    EXPECT_EQ(map.attributes.at("embreeIsa"), report.instructionSet);
    std::array<size_t, kValidityCount> counted{};
    for (const Validity validity : map.validity) ++counted[size_t(validity)];
    EXPECT_EQ(counted, report.validity);
    EXPECT_EQ(counted[1] + counted[3] + counted[4], report.points);
    EXPECT_GT(counted[size_t(Validity::InsideFilled)] + counted[size_t(Validity::Inside)],
              0u);  // under the house
    EXPECT_GT(counted[size_t(Validity::GutterFilled)], 0u);

    // Ground points near the house see less, the roof sees all.
    const Scene scene = readGltf(bundle.pathOf("mesh.glb").string());
    EXPECT_EQ(scene.triangleCount(), 14u);
    EXPECT_EQ(scene.uv1.size(), scene.vertexCount());
    size_t open = 0;
    for (size_t t = 0; t < map.grid.count; ++t) {
        if (map.validity[t] != Validity::Valid) continue;
        EXPECT_NEAR(map.normals[t].norm(), 1, 1e-5);
        open += map.ao[t] == 1.0f;
    }
    EXPECT_GT(open, 50u);
}

TEST_F(PrecomputeJob, PlainProjectionDiffersInCoefficientsAlone) {
    PrecomputeSettings given = settings(writeObj("house.obj", houseOnGround()));
    const auto bake = [&](const Projection& projection) {
        given.projection = projection;
        runPrecompute(given);
        return readVisibilityFile(Bundle::open(given.bundlePath).pathOf("visibility.exr").string());
    };
    const VisibilityMap weighted = bake({}), plain = bake(kPlainProjection);
    EXPECT_EQ(plain.projection, kPlainProjection);
    EXPECT_EQ(weighted.ao, plain.ao);
    EXPECT_EQ(weighted.validity, plain.validity);
    EXPECT_NE(weighted.coefficients, plain.coefficients);
    const Bundle bundle = Bundle::open(given.bundlePath);
    EXPECT_THAT(bundle.section("precompute"), testing::HasSubstr("\"projection\": \"plain\""));
    EXPECT_THAT(bundle.section("precompute"), testing::Not(testing::HasSubstr("projection_floor")));
    EXPECT_THAT(bundle.find("visibility.exr")->madeBy, testing::HasSubstr("--projection plain"));
}

TEST_F(PrecomputeJob, BakesVertices) {
    PrecomputeSettings given = settings(writeObj("ball.obj", shapes::sphere(1, {0, 0, 0}, 3)));
    given.perVertex = true;
    given.rays = 1024;
    const PrecomputeReport report = runPrecompute(given);
    const Bundle bundle = Bundle::open(given.bundlePath);
    const VisibilityMap map = readVisibilityFile(bundle.pathOf("visibility.exr").string());
    const Scene scene = readGltf(bundle.pathOf("mesh.glb").string());
    EXPECT_EQ(map.grid.domain, PointDomain::Vertex);
    ASSERT_EQ(map.grid.count, scene.vertexCount());
    EXPECT_EQ(report.points, scene.vertexCount());
    EXPECT_FALSE(report.atlasMade);
    std::vector<float> cosine(9);
    for (size_t v = 0; v < map.grid.count; ++v) {
        EXPECT_EQ(map.validity[v], Validity::Valid);
        EXPECT_EQ(map.ao[v], 1.0f);
        evalClampedCosineSh(3, scene.normals[v], cosine);
        double sum = 0;
        for (size_t c = 0; c < 9; ++c) sum += double(cosine[c]) * double(map.coefficients[9 * v + c]);
        EXPECT_NEAR(sum, std::numbers::pi, 0.015 * std::numbers::pi);
    }
    EXPECT_THAT(bundle.find("mesh.glb")->madeBy, testing::HasSubstr("--per-vertex"));
}

TEST_F(PrecomputeJob, SameInputSameBytes) {
    PrecomputeSettings given = settings(writeObj("house.obj", houseOnGround()));
    runPrecompute(given);
    const std::string first = readFile(path("out.prt/visibility.exr")),
                      mesh = readFile(path("out.prt/mesh.glb"));
    given.bundlePath = path("again.prt");
    runPrecompute(given);
    EXPECT_EQ(first, readFile(path("again.prt/visibility.exr")));
    EXPECT_EQ(mesh, readFile(path("again.prt/mesh.glb")));
}

TEST_F(PrecomputeJob, KeepsAnAtlasOfTheFile) {
    PrecomputeSettings given = settings(writeObj("house.obj", houseOnGround()));
    runPrecompute(given);
    PrecomputeSettings again = given;
    again.meshPath = path("out.prt/mesh.glb");
    again.bundlePath = path("again.prt");
    EXPECT_FALSE(runPrecompute(again).atlasMade);
    EXPECT_EQ(readGltf(path("again.prt/mesh.glb")).uv1, readGltf(path("out.prt/mesh.glb")).uv1);
}

TEST_F(PrecomputeJob, RefusesSettingsOutOfRange) {
    const PrecomputeSettings good = settings(writeObj("ball.obj", shapes::sphere(1, {0, 0, 0}, 1)));
    const auto refused = [&](auto change) {
        PrecomputeSettings bad = good;
        change(bad);
        EXPECT_THROW(runPrecompute(bad), UsageError);
    };
    refused([](PrecomputeSettings& s) { s.shOrder = 0; });
    refused([](PrecomputeSettings& s) { s.shOrder = 11; });
    refused([](PrecomputeSettings& s) { s.rays = -1; });
    refused([](PrecomputeSettings& s) { s.rays = 1 << 20; });
    refused([](PrecomputeSettings& s) { s.rays = 0, s.error = 0; });
    refused([](PrecomputeSettings& s) { s.rays = 0, s.error = 1.5; });
    refused([](PrecomputeSettings& s) { s.rays = 0, s.error = std::nan(""); });
    refused([](PrecomputeSettings& s) { s.texels = -5; });
    refused([](PrecomputeSettings& s) { s.texels = 8193; });
    EXPECT_EQ(files(), (std::set<std::string>{"ball.obj"}));
}

TEST_F(PrecomputeJob, FailureLeavesNothing) {
    const std::string mesh = writeObj("ball.obj", shapes::sphere(1, {0, 0, 0}, 1));
    EXPECT_THROW(runPrecompute(settings(path("missing.obj"))), InputError);
    EXPECT_EQ(files(), (std::set<std::string>{"ball.obj"}));

    PrecomputeSettings nowhere = settings(mesh);
    nowhere.bundlePath = mesh + "/out.prt";  // below a file
    EXPECT_THROW(runPrecompute(nowhere), OutputError);
    EXPECT_EQ(files(), (std::set<std::string>{"ball.obj"}));

    requestInterrupt();
    EXPECT_THROW(runPrecompute(settings(mesh)), Interrupted);
    clearInterrupt();
    EXPECT_EQ(files(), (std::set<std::string>{"ball.obj"}));

    // A bundle that was there stays as it was.
    runPrecompute(settings(mesh));
    const std::string manifest = readFile(path("out.prt/manifest.json"));
    requestInterrupt();
    EXPECT_THROW(runPrecompute(settings(mesh)), Interrupted);
    clearInterrupt();
    EXPECT_EQ(readFile(path("out.prt/manifest.json")), manifest);
    EXPECT_EQ(Bundle::open(path("out.prt")).staleReason("visibility.exr", true), "");
    EXPECT_EQ(files().size(), 5u);
}

TEST_F(PrecomputeJob, CommandLineIsQuoted) {
    fs::create_directory(path("my meshes"));
    const std::string mesh = writeObj("my meshes/it's.obj", shapes::sphere(1, {0, 0, 0}, 1));
    runPrecompute(settings(mesh));
    EXPECT_THAT(Bundle::open(path("out.prt")).find("mesh.glb")->madeBy,
                testing::HasSubstr("my meshes/it'\\''s.obj' -o "));
}

}  // namespace
}  // namespace prt
