// Normal maps the right way up.
#include <cmath>

#include "precompute/math/sh.h"
#include "runtime/renderer.h"
#include "test_scenes.h"

namespace prt {
namespace {

using namespace test;

std::array<uint8_t, 3> encodeNormal(const Vec3d& n) {
    return {uint8_t(std::lround(127.5 + 127.5 * n.x())), uint8_t(std::lround(127.5 + 127.5 * n.y())),
            uint8_t(std::lround(127.5 + 127.5 * n.z()))};
}

Camera facing() {
    Camera camera;
    camera.eye = {0, 0, 3};
    camera.verticalFovDeg = 37;  // the quad fills the picture
    return camera;
}
constexpr RenderOptions kSquare{64, 64, true};

// Mirrors uv0 from left to right, as an atlas or a mirrored model does.
void mirrorUv(Scene& scene) {
    for (Vec2f& uv : scene.uv0) uv.x() = 1 - uv.x();
    for (Vec4f& tangent : scene.tangents)
        tangent = Vec4f(-tangent.x(), -tangent.y(), -tangent.z(), -tangent.w());
}

Vec3f normalInTheMiddle(GlContext& context, const Scene& scene, const RenderOptions& options = kSquare) {
    Renderer renderer(context, scene, nullptr, nullptr);
    return renderer.surface(facing(), options).shadingNormal[32 * 64 + 32];
}

// 8-bit maps hold a normal to half a step of 1/127.5.
constexpr double kEightBits = 0.006;

TEST(NormalMap, TurnsTheNormalInTheTangentFrame) {
    GlContext context;
    const Vec3d tangentSpace = Vec3d(0.5, 0.3, 0.8).normalized();
    Scene scene = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    scene.materials[0].normalTexture =
        addTexture(scene, 4, 4, [&](int, int) { return encodeNormal(tangentSpace); });
    // Facing the viewer, tangent right, bitangent up: tangent space is world space.
    EXPECT_LT((normalInTheMiddle(context, scene).cast<double>() - tangentSpace).norm(), kEightBits);
    EXPECT_EQ(normalInTheMiddle(context, scene, {64, 64, false}), Vec3f(0, 0, 1));

    Scene mirrored = scene;
    mirrorUv(mirrored);
    const Vec3d flipped(-tangentSpace.x(), tangentSpace.y(), tangentSpace.z());
    EXPECT_LT((normalInTheMiddle(context, mirrored).cast<double>() - flipped).norm(), kEightBits);

    Scene scaled = scene;
    scaled.materials[0].normalScale = 0.5f;
    const Vec3d half = Vec3d(0.5 * tangentSpace.x(), 0.5 * tangentSpace.y(), tangentSpace.z()).normalized();
    EXPECT_LT((normalInTheMiddle(context, scaled).cast<double>() - half).norm(), kEightBits);

    // On a floor: tangent +x, bitangent −z (towards the top of the image on it), normal +y.
    Scene floor = quad({0, 0, 0}, {2, 0, 0}, {0, 0, -2});
    floor.textures = scene.textures;
    floor.materials[0].normalTexture = 0;
    Renderer renderer(context, floor, nullptr, nullptr);
    Camera above;
    above.eye = {0, 3, 0};
    above.up = {0, 0, -1};
    const Vec3d onFloor(tangentSpace.x(), tangentSpace.z(), -tangentSpace.y());
    EXPECT_LT((renderer.surface(above, kSquare).shadingNormal[32 * 64 + 32].cast<double>() - onFloor).norm(),
              kEightBits);
}

// A dome that fills the texture, standing out of the surface. Mean irradiance of its four sides.
struct Sides {
    double left, right, top, bottom;
};
Sides litDome(GlContext& context, const Vec3d& lightFrom, bool mirrored) {
    Scene scene = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    scene.materials[0].normalTexture = addTexture(scene, 64, 64, [](int x, int y) {
        const double s = (x + 0.5) / 32 - 1, t = 1 - (y + 0.5) / 32, square = s * s + t * t;  // t is up
        return encodeNormal(square < 0.9 ? Vec3d(s, t, std::sqrt(1 - square)) : Vec3d(0, 0, 1));
    });
    if (mirrored) mirrorUv(scene);
    const VisibilityMap visibility = uniformVisibility(texelGrid(2, 2), 4, hemisphereSh(4, {0, 0, 1}));
    Renderer renderer(context, scene, &visibility, nullptr);
    const auto light = [&](const Vec3d& d) {
        return Vec3f::Constant(float(std::pow(std::max(0.0, d.dot(lightFrom)), 2)));
    };
    renderer.setTable(lightCosineTable(light, 4, 16));
    const FloatImage image = renderer.render(facing(), Technique::Unc, kSquare).irradiance;
    const auto mean = [&](int x0, int y0) {
        double sum = 0;
        for (int y = y0; y < y0 + 8; ++y)
            for (int x = x0; x < x0 + 8; ++x) sum += double(image.at(x, y)[0]) / 64;
        return sum;
    };
    return {mean(8, 28), mean(48, 28), mean(28, 8), mean(28, 48)};
}

TEST(NormalMap, BumpsAreBrightOnTheSideOfTheLight) {
    GlContext context;
    const Sides fromLeft = litDome(context, Vec3d(-1, 0, 0.5).normalized(), false);
    EXPECT_GT(fromLeft.left, 2 * fromLeft.right);
    EXPECT_NEAR(fromLeft.top / fromLeft.bottom, 1, 0.05);
    const Sides fromRight = litDome(context, Vec3d(1, 0, 0.5).normalized(), false);
    EXPECT_GT(fromRight.right, 2 * fromRight.left);
    const Sides fromAbove = litDome(context, Vec3d(0, 1, 0.5).normalized(), false);
    EXPECT_GT(fromAbove.top, 2 * fromAbove.bottom);
    EXPECT_NEAR(fromAbove.left / fromAbove.right, 1, 0.05);
}

TEST(NormalMap, BumpsStandOutOnMirroredTextureCoordinates) {
    GlContext context;
    const Sides fromLeft = litDome(context, Vec3d(-1, 0, 0.5).normalized(), true);
    EXPECT_GT(fromLeft.left, 2 * fromLeft.right);
    const Sides fromAbove = litDome(context, Vec3d(0, 1, 0.5).normalized(), true);
    EXPECT_GT(fromAbove.top, 2 * fromAbove.bottom);
}

TEST(NormalMap, IsMagnifiedWithoutSteps) {
    // Two texels of opposite tilt over the whole view: 8-bit filtering would make at most 128 distinct
    // values.
    GlContext context;
    Scene scene = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    scene.materials[0].normalTexture = addTexture(
        scene, 2, 1, [](int x, int) { return encodeNormal(Vec3d(x == 0 ? -0.1 : 0.1, 0, 0.995)); });
    Renderer renderer(context, scene, nullptr, nullptr);
    const SurfaceImage surface = renderer.surface(facing(), {256, 256, true});
    int distinct = 0;
    for (int x = 100; x < 156; ++x) {
        const size_t i = size_t(128 * 256 + x);
        if (surface.shadingNormal[i].x() > surface.shadingNormal[i - 1].x()) ++distinct;
    }
    EXPECT_EQ(distinct, 56);
}

TEST(NormalMap, TexturesTileAndTheirTopRowIsUp) {
    GlContext context;
    Scene scene = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    for (Vec2f& uv : scene.uv0) uv = 2 * uv - Vec2f(1, 1);  // −1 … 1: two tiles each way
    // Quarters: red, green above; blue, white below.
    scene.materials[0].baseColorTexture = addTexture(scene, 32, 32, [](int x, int y) {
        if (y < 16) return x < 16 ? std::array<uint8_t, 3>{255, 0, 0} : std::array<uint8_t, 3>{0, 255, 0};
        return x < 16 ? std::array<uint8_t, 3>{0, 0, 255} : std::array<uint8_t, 3>{255, 255, 255};
    });
    Renderer renderer(context, scene, nullptr, nullptr);
    const SurfaceImage surface = renderer.surface(facing(), kSquare);
    const auto albedo = [&](int x, int y) { return surface.albedo[size_t(y * 64 + x)]; };
    for (const int tileX : {0, 1})
        for (const int tileY : {0, 1}) {
            const int x = tileX * 32, y = tileY * 32;
            EXPECT_EQ(albedo(x + 8, y + 8), Vec3f(1, 0, 0));
            EXPECT_EQ(albedo(x + 24, y + 8), Vec3f(0, 1, 0));
            EXPECT_EQ(albedo(x + 8, y + 24), Vec3f(0, 0, 1));
            EXPECT_EQ(albedo(x + 24, y + 24), Vec3f(1, 1, 1));
        }
}

}  // namespace
}  // namespace prt
