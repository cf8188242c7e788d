// Frames on a display: into a framebuffer of the caller's, and the colours of points.
#include <cmath>

#include "context_scene.h"
#include "precompute/base/error.h"
#include "runtime/gl_functions.h"
#include "runtime/gl_objects.h"

namespace prt {
namespace {

using namespace test;
using testing::HasSubstr;

constexpr int kWidth = 110, kHeight = 90;

/// A framebuffer of the application's, grey at first.
class Canvas {
  public:
    Canvas(const GlContext& context, GLenum format)
        : gl_(context.gl()), image_(makeImage(gl_, format, kWidth, kHeight)), frame_(makeFramebuffer(gl_)) {
        gl_.NamedFramebufferTexture(frame_.name(), GL_COLOR_ATTACHMENT0, image_.name(), 0);
        const GLfloat grey[4] = {0.5f, 0.5f, 0.5f, 0.5f};
        gl_.ClearNamedFramebufferfv(frame_.name(), GL_COLOR, 0, grey);
    }
    GLuint frame() const { return frame_.name(); }
    /// Bytes as they are stored, rows from the bottom.
    std::vector<uint8_t> bytes() const {
        std::vector<uint8_t> rgba(size_t(kWidth * kHeight * 4));
        gl_.GetTextureImage(image_.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, GLsizei(rgba.size()), rgba.data());
        return rgba;
    }

  private:
    const GlFunctions& gl_;
    GlObject image_, frame_;
};

/// The picture stands in the canvas, its lower left corner at (x0, y0), the right way up; all else is grey.
void expectShown(const std::vector<uint8_t>& canvas, const ByteImage& picture, int x0, int y0) {
    int worst = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const uint8_t* shown = &canvas[size_t(y * kWidth + x) * 4];
            const int px = x - x0, py = picture.height - 1 - (y - y0);
            if (px < 0 || py < 0 || px >= picture.width || py >= picture.height) {
                ASSERT_NEAR(shown[0], 128, 1) << x << " " << y;
                continue;
            }
            const uint8_t* expected =
                &picture.pixels[size_t(py * picture.width + px) * size_t(picture.channels)];
            for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(shown[c] - expected[c]));
            ASSERT_EQ(shown[3], 255);
        }
    EXPECT_LE(worst, 1);
}

class Draw : public testing::TestWithParam<ToneCurve> {};

TEST_P(Draw, IsTheRenderedFrameOnADisplay) {
    const Showcase showcase(PointDomain::Texel);
    GlContext context;
    const auto renderer = showcase.makeRenderer(context);
    const FloatImage radiance = showcase.draw(*renderer, Technique::Pca).radiance;
    const DisplayOptions display{0.7, GetParam()};
    const Canvas canvas(context, GL_RGBA8);
    renderer->draw(showcase.camera(), Technique::Pca, showcase.options(), display, {canvas.frame(), 7, 13});
    expectShown(canvas.bytes(), toDisplay(radiance, 0.7, GetParam()), 7, 13);
}
INSTANTIATE_TEST_SUITE_P(Curves, Draw,
                         testing::Values(ToneCurve::None, ToneCurve::Filmic, ToneCurve::Neutral),
                         [](const auto& curve) { return std::string(toneCurveName(curve.param)); });

TEST(Draw, EncodesOnce) {
    const Showcase showcase(PointDomain::Vertex);
    GlContext context;
    const auto renderer = showcase.makeRenderer(context);
    const ByteImage expected = toDisplay(showcase.draw(*renderer, Technique::Unc).radiance, 0);
    for (const bool writesSrgb : {false, true}) {
        const Canvas canvas(context, GL_SRGB8_ALPHA8);
        // GL_FRAMEBUFFER_SRGB was off when the canvas was cleared.
        if (writesSrgb) context.gl().Enable(GL_FRAMEBUFFER_SRGB);
        renderer->draw(showcase.camera(), Technique::Unc, showcase.options(), {}, {canvas.frame(), 0, 0});
        EXPECT_EQ(bool(context.gl().IsEnabled(GL_FRAMEBUFFER_SRGB)), writesSrgb);
        context.gl().Disable(GL_FRAMEBUFFER_SRGB);
        expectShown(canvas.bytes(), expected, 0, 0);
    }
}

// What was drawn into the caller's framebuffer leaves no trace in the frames that follow.
TEST(Draw, ChangesNoLaterFrame) {
    const Showcase showcase(PointDomain::Texel);
    GlContext context;
    const auto renderer = showcase.makeRenderer(context);
    const RenderedFrame before = showcase.draw(*renderer, Technique::Unc);
    const Canvas canvas(context, GL_RGBA8);
    renderer->draw(showcase.camera(), Technique::Pca, {31, 17, false}, {}, {canvas.frame(), 2, 3});
    const RenderedFrame after = showcase.draw(*renderer, Technique::Unc);
    EXPECT_EQ(before.radiance.pixels, after.radiance.pixels);
    EXPECT_EQ(before.irradiance.pixels, after.irradiance.pixels);
}

TEST(Draw, ImagesOfOthers) {
    const Showcase showcase(PointDomain::Texel);
    GlContext context;
    const auto renderer = showcase.makeRenderer(context);
    for (const int channels : {3, 4})
        for (const int width : {20, 33}) {
            FloatImage image{width, 25, channels, {}};
            for (int i = 0; i < width * 25 * channels; ++i) image.pixels.push_back(float(i % 997) / 500);
            const Canvas canvas(context, GL_RGBA8);
            renderer->drawImage(image, {-1, ToneCurve::Filmic}, {canvas.frame(), 40, 1});
            expectShown(canvas.bytes(), toDisplay(image, -1, ToneCurve::Filmic), 40, 1);
        }
    EXPECT_THROW(renderer->drawImage({100000, 1, 3, std::vector<float>(300000)}, {}, {}), InputError);
}

TEST(Draw, RefusesTargetsThatAreNone) {
    const Showcase showcase(PointDomain::Texel);
    GlContext context;
    const auto renderer = showcase.makeRenderer(context);
    const GlObject empty = makeFramebuffer(context.gl());
    try {
        renderer->draw(showcase.camera(), Technique::Unc, showcase.options(), {}, {empty.name(), 0, 0});
        FAIL() << "no error reported";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("draw target"));
    }
}

/// A square that fills the middle of the image.
struct Square {
    GlContext context;
    Scene scene = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    Renderer renderer{context, scene, nullptr, nullptr};
    Camera camera;
    RenderOptions options{80, 80, true};
    Square() {
        camera.eye = {0, 0, 3};
        scene.materials[0].baseColor = {0.5f, 0.2f, 0.1f};  // must not matter
    }
    SurfaceImage surface() { return renderer.surface(camera, options); }
};

float colourOf(int x, int y, int c) { return float(x) + 10 * float(y) - 7 * float(c); }

std::vector<float> colours(int width, int height) {
    std::vector<float> rgb;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) rgb.push_back(colourOf(x, y, c));
    return rgb;
}

TEST(PointColours, OfTexels) {
    Square square;
    constexpr int kSide = 4;
    const SurfaceImage surface = square.surface();
    for (const bool smooth : {false, true}) {
        square.renderer.setPointColours(texelGrid(kSide, kSide), colours(kSide, kSide), smooth);
        const FloatImage image = square.renderer.renderPoints(square.camera, square.options);
        int seen = 0;
        for (size_t i = 0; i < image.pixels.size() / 3; ++i) {
            if (surface.triangle[i] == kNoTriangle) {
                ASSERT_EQ(image.pixels[i * 3], 0);
                continue;
            }
            ++seen;
            // The square's uv1 runs from the top left corner.
            const float u = (surface.position[i].x() + 1) / 2 * kSide,
                        v = (1 - surface.position[i].y()) / 2 * kSide;
            const auto clamped = [](float x) { return std::clamp(x, 0.0f, float(kSide - 1)); };
            const float x = clamped(smooth ? u - 0.5f : std::floor(u)),
                        y = clamped(smooth ? v - 0.5f : std::floor(v));
            const auto nearEdge = [](float t) { return std::abs(t - std::round(t)) < 1e-4f; };
            if (!smooth && (nearEdge(u) || nearEdge(v))) continue;
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(image.pixels[i * 3 + size_t(c)], x + 10 * y - 7 * float(c), 2e-3) << i;
        }
        EXPECT_GT(seen, 1000);
    }
}

TEST(PointColours, OfVertices) {
    Square square;
    const SurfaceImage surface = square.surface();
    for (const bool smooth : {false, true}) {
        square.renderer.setPointColours(vertexGrid(4), colours(4, 1), smooth);
        const FloatImage image = square.renderer.renderPoints(square.camera, square.options);
        int seen = 0;
        for (size_t i = 0; i < image.pixels.size() / 3; ++i) {
            if (surface.triangle[i] == kNoTriangle) continue;
            // Vertex k is corner (k & 1, k >> 1) of the unit square, from the top left.
            const float u = (surface.position[i].x() + 1) / 2, v = (1 - surface.position[i].y()) / 2;
            if (smooth) {
                // Linear in each triangle, and so in the whole: k = u + 2v.
                ASSERT_NEAR(image.pixels[i * 3], u + 2 * v, 1e-4);
            } else {
                const float value = image.pixels[i * 3];
                ASSERT_EQ(value, std::round(value));
                // Near a corner, its own colour.
                if (std::hypot(u - 1, v) < 0.2f) {
                    ASSERT_EQ(value, 1);
                }
                if (std::hypot(u, v - 1) < 0.2f) {
                    ASSERT_EQ(value, 2);
                }
            }
            ++seen;
        }
        EXPECT_GT(seen, 1000);
    }
}

TEST(PointColours, OnADisplay) {
    Square square;
    square.renderer.setPointColours(texelGrid(4, 4), std::vector<float>(48, 0.25f), true);
    const FloatImage image = square.renderer.renderPoints(square.camera, square.options);
    const Canvas canvas(square.context, GL_RGBA8);
    square.renderer.drawPoints(square.camera, square.options, {1, ToneCurve::Neutral},
                               {canvas.frame(), 3, 4});
    expectShown(canvas.bytes(), toDisplay(image, 1, ToneCurve::Neutral), 3, 4);
}

TEST(PointColours, Errors) {
    Square square;
    EXPECT_THROW(square.renderer.renderPoints(square.camera, square.options), InputError);
    EXPECT_THROW(square.renderer.setPointColours(vertexGrid(5), std::vector<float>(15), true), InputError);
}

}  // namespace
}  // namespace prt
