// Data that does not fit together is refused with a clear line.
#include "precompute/base/error.h"
#include "precompute/math/sh.h"
#include "runtime/renderer.h"
#include "test_scenes.h"

namespace prt {
namespace {

using namespace test;
using testing::HasSubstr;

class RendererErrors : public testing::Test {
  protected:
    template <typename F>
    static std::string messageOf(F&& call) {
        try {
            call();
        } catch (const InputError& error) {
            return error.what();
        }
        return "no InputError";
    }
    std::string messageOfMaking(const VisibilityMap* visibility, const PcaMap* pca = nullptr) {
        return messageOf([&] { Renderer(context_, scene_, visibility, pca); });
    }
    GlContext context_;
    Scene scene_ = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    VisibilityMap visibility_ = noisyVisibility(texelGrid(4, 4), 2, 1);
};

TEST_F(RendererErrors, VertexCountDiffers) {
    const VisibilityMap wrong = noisyVisibility(vertexGrid(5), 2, 1);
    EXPECT_THAT(messageOfMaking(&wrong), HasSubstr("holds 5 vertices, the mesh 4"));
    const PcaMap pca = completePca(wrong, 0);
    EXPECT_THAT(messageOfMaking(nullptr, &pca), HasSubstr("holds 5 vertices, the mesh 4"));
}

TEST_F(RendererErrors, NoAtlasCoordinates) {
    scene_.uv1.clear();
    EXPECT_THAT(messageOfMaking(&visibility_), HasSubstr("TEXCOORD_1"));
    const VisibilityMap perVertex = noisyVisibility(vertexGrid(4), 2, 1);
    EXPECT_EQ(messageOfMaking(&perVertex), "no InputError");
}

TEST_F(RendererErrors, MissingAttributes) {
    const int texture = addTexture(scene_, 1, 1, [](int, int) {
        return std::array<uint8_t, 3>{128, 128, 255};
    });
    scene_.materials[0].normalTexture = texture;
    scene_.materials[0].name = "bricks";
    EXPECT_EQ(messageOfMaking(nullptr), "no InputError");
    scene_.tangents.clear();
    EXPECT_THAT(messageOfMaking(nullptr),
                HasSubstr("bricks: has a normal map, but the mesh has no tangents"));
    scene_.uv0.clear();
    EXPECT_THAT(messageOfMaking(nullptr), HasSubstr("no texture coordinates"));
    scene_.normals.clear();
    EXPECT_THAT(messageOfMaking(nullptr), HasSubstr("no normals"));
    scene_.indices.clear();
    EXPECT_THAT(messageOfMaking(nullptr), HasSubstr("no triangle"));
}

TEST_F(RendererErrors, DamagedTexture) {
    const int texture = addTexture(scene_, 8, 8, [](int, int) { return std::array<uint8_t, 3>{1, 2, 3}; });
    scene_.materials[0].baseColorTexture = texture;
    scene_.textures[0].encoded.resize(40);
    EXPECT_THAT(messageOfMaking(nullptr), HasSubstr("made by a test"));
}

TEST_F(RendererErrors, LargerThanOpenGlTakes) {
    const VisibilityMap wide = noisyVisibility(texelGrid(40000, 1), 1, 1);
    EXPECT_THAT(messageOfMaking(&wide), HasSubstr("visibility: 40000x1 texels in 1 layers"));
    Renderer renderer(context_, scene_, nullptr, nullptr);
    EXPECT_THAT(messageOf([&] { renderer.surface({}, {0, 10, true}); }), HasSubstr("size 0x10"));
    EXPECT_THAT(messageOf([&] { renderer.surface({}, {10, 100000, true}); }), HasSubstr("size 10x100000"));
    // The context is as good as before.
    EXPECT_EQ(renderer.surface({}, {10, 10, true}).pixels(), 100u);
}

TEST_F(RendererErrors, TableDoesNotFit) {
    const PcaMap pca = completePca(visibility_, 0);
    Renderer renderer(context_, scene_, &visibility_, &pca);
    const NormalTable order3 = noisyTable(TableKind::LightCosine, 3, 9, 4, 1);
    EXPECT_THAT(messageOf([&] { renderer.setTable(order3); }), HasSubstr("order 3 with 9 layers"));
    const NormalTable few = noisyTable(TableKind::TripleProduct, 2, 4, 4, 1);  // 4 components need 5 layers
    EXPECT_THAT(messageOf([&] { renderer.setTable(few); }), HasSubstr("needs order 2 with 5"));
    Renderer bare(context_, scene_, nullptr, nullptr);
    EXPECT_THAT(messageOf([&] { bare.setTable(order3); }), HasSubstr("light-cosine"));
}

TEST_F(RendererErrors, NothingToLightWith) {
    Renderer renderer(context_, scene_, &visibility_, nullptr);
    EXPECT_THAT(messageOf([&] { renderer.render({}, Technique::Pca, {}); }), HasSubstr("prt compress"));
    EXPECT_THAT(messageOf([&] { renderer.render({}, Technique::Unc, {}); }), HasSubstr("no table"));
    EXPECT_THAT(messageOf([&] { renderer.frameMilliseconds({}, Technique::Unc, {}, 1); }),
                HasSubstr("no table"));
}

}  // namespace
}  // namespace prt
