// Bakes of bad meshes: no crash, and nothing in the results that is not a number of its range.
#include "tests/visibility/nasty_meshes.h"

#include "precompute/base/log.h"
#include "precompute/mesh/atlas.h"
#include "precompute/mesh/load_mesh.h"
#include "precompute/visibility/bake.h"
#include "precompute/visibility/fill.h"

namespace prt {
namespace {

struct Setting {
    std::string name;
    BakeOptions options;
};

std::vector<Setting> settings() {
    std::vector<Setting> all(4);
    all[0].name = "uniform, order 10";
    all[0].options.shOrder = 10;
    all[0].options.rays = 64;
    all[1].name = "adaptive, order 4";
    all[1].options.shOrder = 4;
    all[1].options.error = 0.02;
    all[2].name = "plain, order 3";
    all[2].options.shOrder = 3;
    all[2].options.rays = 64;
    all[2].options.projection = kPlainProjection;
    all[3].name = "one direction";
    all[3].options.shOrder = 2;
    all[3].options.rays = 1;
    return all;
}

class Nasty : public testing::TestWithParam<nasty::Kind> {
  protected:
    void SetUp() override { setQuiet(true); }
    void TearDown() override { setQuiet(false); }
};

TEST_P(Nasty, BakesPerTexel) {
    Scene scene = prepareScene(GetParam().mesh.make(), GetParam().mesh.name, {});
    AtlasOptions atlas;
    atlas.texels = GetParam().texels;
    buildAtlas(scene, atlas);
    const TexelSurface surface = rasterizeTexels(scene, atlas.texels, atlas.texels);
    ASSERT_FALSE(surface.points.empty());
    const RayCaster caster(scene.positions, scene.indices);
    for (const Setting& setting : settings()) {
        const BakeResult baked = bakeTexelVisibility(caster, surface, setting.options);
        nasty::expectSane(fillTexels(surface, baked, setting.options.shOrder), setting.name);
    }
}

TEST_P(Nasty, BakesPerVertex) {
    const Scene scene = prepareScene(GetParam().mesh.make(), GetParam().mesh.name, {});
    const VertexPoints vertices = makeVertexPoints(scene);
    const RayCaster caster(scene.positions, scene.indices);
    for (const Setting& setting : settings()) {
        const BakeResult baked = bakeVertexVisibility(caster, vertices, setting.options);
        nasty::expectSane(fillVertices(scene, vertices, baked, setting.options.shOrder), setting.name);
    }
}

INSTANTIATE_TEST_SUITE_P(Meshes, Nasty, testing::ValuesIn(nasty::kinds()),
                         [](const auto& kind) { return kind.param.mesh.name; });

// A program may hand over a scene that nobody repaired: vertices of faces without area bake to zeros.
TEST(NastyScene, FacesWithoutAreaBakeToZeros) {
    const Scene scene = nasty::withoutArea();
    const VertexPoints vertices = makeVertexPoints(scene);
    BakeOptions options;
    options.error = 0.02;
    const BakeResult baked =
        bakeVertexVisibility(RayCaster(scene.positions, scene.indices), vertices, options);
    const size_t columns = 36, lost = scene.vertexCount() - 1;
    EXPECT_EQ(vertices.firstPoint[lost], vertices.firstPoint[lost + 1]);
    EXPECT_EQ(vertices.normals[lost], Vec3f(Vec3f::Zero()));
    EXPECT_EQ(baked.ao[lost], 0);
    EXPECT_EQ(baked.error[lost], 0);
    for (size_t c = 0; c < columns; ++c) EXPECT_EQ(baked.coefficients[lost * columns + c], 0);
    EXPECT_EQ(baked.ao[0], 1);
    for (const float c : baked.coefficients) EXPECT_TRUE(std::isfinite(c));
}

}  // namespace
}  // namespace prt
