// The table's texture in a program of the caller's: the one in tools/docs/runtime.md.
#include <fstream>
#include <sstream>

#include "context_scene.h"
#include "own_egl.h"
#include "precompute/base/error.h"
#include "precompute/math/sh.h"
#include "runtime/gl_functions.h"
#include "runtime/gl_objects.h"
#include "runtime/shader_sources.h"

namespace prt {
namespace {

using namespace test;

/// The fragment shader that the documentation shows.
std::string documentedShader() {
    std::ifstream file(PRT_SOURCE_DIR "/tools/docs/runtime.md");
    std::stringstream all;
    all << file.rdbuf();
    const std::string text = all.str(), opening = "```glsl\n";
    const size_t begin = text.find(opening);
    EXPECT_NE(begin, std::string::npos);
    return text.substr(begin + opening.size(), text.find("```\n", begin + 3) - begin - opening.size());
}

GlObject compiled(const GlFunctions& gl, GLenum stage, const std::string& text) {
    GlObject shader(gl, gl.CreateShader(stage), [](const GlFunctions& f, GLuint n) { f.DeleteShader(n); });
    const char* const lines = text.c_str();
    gl.ShaderSource(shader.name(), 1, &lines, nullptr);
    gl.CompileShader(shader.name());
    GLint good = 0;
    gl.GetShaderiv(shader.name(), GL_COMPILE_STATUS, &good);
    EXPECT_TRUE(good) << text;
    return shader;
}

/// What the program of the documentation computes, as an application would run it.
std::array<float, 4> irradianceByOwnProgram(const GlContext& context, const Renderer& renderer,
                                            Technique technique, const Vec3f& normal,
                                            std::vector<float> coefficients) {
    const GlFunctions& gl = context.gl();
    const GlObject vertex = compiled(gl, GL_VERTEX_SHADER, shaderText("screen.vert", "")),
                   fragment =
                       compiled(gl, GL_FRAGMENT_SHADER,
                                shaderWithIncludes(documentedShader(), renderer.shaderDefines(technique)));
    const GlObject program(gl, gl.CreateProgram(),
                           [](const GlFunctions& f, GLuint n) { f.DeleteProgram(n); });
    gl.AttachShader(program.name(), vertex.name());
    gl.AttachShader(program.name(), fragment.name());
    gl.LinkProgram(program.name());
    const GlObject image = makeImage(gl, GL_RGBA32F, 1, 1),
                   frame = makeFramebufferOver(gl, {image.name()}, 0), array = makeVertexArray(gl);
    const auto at = [&](const char* name) { return gl.GetUniformLocation(program.name(), name); };
    gl.ProgramUniform3fv(program.name(), at("normal"), 1, normal.data());
    coefficients.resize((coefficients.size() + 3) / 4 * 4);
    const auto setVectors = reinterpret_cast<PFNGLPROGRAMUNIFORM4FVPROC>(osMesaProc("glProgramUniform4fv"));
    setVectors(program.name(), at("coefficients"), GLsizei(coefficients.size() / 4), coefficients.data());
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, frame.name());
    gl.Viewport(0, 0, 1, 1);
    gl.Disable(GL_DEPTH_TEST);
    gl.UseProgram(program.name());
    gl.BindTextureUnit(5, renderer.tableTexture(technique).name);
    gl.BindVertexArray(array.name());
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    std::array<float, 4> result{};
    gl.GetTextureImage(image.name(), 0, GL_RGBA, GL_FLOAT, sizeof result, result.data());
    gl.UseProgram(0);
    context.check("drawing by a program of one's own");
    return result;
}

constexpr int kOrder = 3, kTableSize = 8;

/// A square with one value everywhere, seen from its front.
struct Square {
    GlContext context;
    Vec3f right = Vec3f(1, 0.3f, -0.5f).normalized(), up = Vec3f(0.1f, 1, 0.8f).cross(right).normalized();
    Scene scene = quad({0, 0, 0}, right, up);
    VisibilityMap visibility =
        uniformVisibility(texelGrid(2, 2), kOrder, {.9f, .1f, -.2f, .3f, .4f, -.5f, .6f, .7f, -.8f});
    PcaMap pca = completePca(visibility, 0.15f);
    Renderer renderer{context, scene, &visibility, &pca};
    Vec3f normal = right.cross(up);

    const float* irradiance(Technique technique) {
        Camera camera;
        camera.eye = 3 * normal;
        frame_ = renderer.render(camera, technique, {32, 32, true});
        return frame_.irradiance.at(16, 16);
    }

  private:
    RenderedFrame frame_;
};

class TableTextures : public testing::TestWithParam<const char*> {};

TEST_P(TableTextures, GiveTheRenderersIrradiance) {
    Square square;
    TableOptions options;
    options.layout = GetParam();
    options.size = kTableSize;
    const LiveLight light({patchSky(0), patchSky(3)}, kOrder, options);
    const auto first = [](const std::vector<float>& values) {
        return std::vector<float>(values.begin(), values.begin() + shCount(kOrder));
    };
    for (const BlendOn blendOn : {BlendOn::Cpu, BlendOn::Gpu})
        for (const auto& [technique, coefficients] :
             {std::pair(Technique::Unc, first(square.visibility.coefficients)),
              std::pair(Technique::Pca, first(square.pca.weights))}) {
            square.renderer.setLight(technique, light, {0.3, 0.7}, 0.4, blendOn);
            const float* expected = square.irradiance(technique);
            const std::array<float, 4> own = irradianceByOwnProgram(square.context, square.renderer,
                                                                    technique, square.normal, coefficients);
            EXPECT_GT(std::abs(expected[0]), 0.05f);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(own[size_t(c)], expected[c], 2e-5f) << techniqueName(technique);
        }
}

// As TableTexture says: layers of the array, texel by texel, against the table that was set.
TEST_P(TableTextures, AreIndexedAsDocumented) {
    Square square;
    const NormalTable table =
        noisyTable(TableKind::TripleProduct, kOrder, shCount(kOrder) + 1, kTableSize, 3, GetParam());
    square.renderer.setTable(Technique::Pca, table);
    const TableTexture texture = square.renderer.tableTexture(Technique::Pca);
    EXPECT_EQ(texture.layout, GetParam());
    EXPECT_EQ(texture.size, kTableSize);
    EXPECT_EQ(texture.layers, 3);  // nine in fours
    EXPECT_TRUE(texture.hasMean);
    const bool cube = texture.layout == "cube";
    EXPECT_EQ(texture.imagesPerGroup, cube ? 6 : 1);
    const auto [width, height] = table.imageSize();
    // A cube's faces are stacked in the table; in the texture they have a border.
    const int border = cube ? 1 : 0, rows = cube ? kTableSize : height, stride = width + 2 * border,
              columnsTall = rows + 2 * border, images = (3 * texture.layers + 1) * texture.imagesPerGroup;
    std::vector<float> rgba(size_t(stride * columnsTall * images * 4));
    const GlFunctions& gl = square.context.gl();
    gl.GetTextureImage(texture.name, 0, GL_RGBA, GL_FLOAT, GLsizei(rgba.size() * 4), rgba.data());
    square.context.check("reading the table");
    const auto texel = [&](int group, int image, int x, int y, int channel) {
        const int layer = group * texture.imagesPerGroup + image;
        return rgba[size_t(((layer * columnsTall + y + border) * stride + x + border) * 4 + channel)];
    };
    for (int image = 0; image < texture.imagesPerGroup; ++image)
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < width; ++x) {
                const auto at = size_t((image * rows + y) * width + x);
                for (int colour = 0; colour < 3; ++colour) {
                    for (int k = 0; k < shCount(kOrder); ++k)
                        ASSERT_EQ(texel(colour * texture.layers + k / 4, image, x, y, k % 4),
                                  table.layer(colour, k)[at]);
                    ASSERT_EQ(texel(3 * texture.layers, image, x, y, colour),
                              table.layer(colour, shCount(kOrder))[at]);
                }
            }
}
INSTANTIATE_TEST_SUITE_P(Layouts, TableTextures, testing::Values("cube", "dual-paraboloid", "octahedral"),
                         [](const auto& layout) {
                             std::string name = layout.param;
                             std::erase(name, '-');
                             return name;
                         });

TEST(TableTexture, OfPreconvolvedLightIsAMeanAlone) {
    Square square;
    square.renderer.add(Technique::PreconvolvedAo, square.visibility);  // nothing is occluded
    const LiveLight light({patchSky(1)}, kOrder, {});
    square.renderer.setLight(Technique::PreconvolvedAo, light, {1}, 0);
    const TableTexture texture = square.renderer.tableTexture(Technique::PreconvolvedAo);
    EXPECT_EQ(texture.layers, 0);
    EXPECT_TRUE(texture.hasMean);
    EXPECT_EQ(texture.imagesPerGroup, 6);
}

TEST(TableTexture, Errors) {
    Square square;
    EXPECT_THROW(square.renderer.tableTexture(Technique::Unc), InputError);  // no light
    EXPECT_THROW(square.renderer.shaderDefines(Technique::Unc), InputError);
    EXPECT_THROW(square.renderer.tableTexture(Technique::PreconvolvedAo), InputError);  // not added
    square.renderer.add(Technique::PcaUniform, square.pca);
    square.renderer.setLight(Technique::PcaUniform, LiveLight({patchSky(0)}, kOrder, {}), {1}, 0);
    EXPECT_THROW(square.renderer.tableTexture(Technique::PcaUniform), InputError);  // uniforms
}

}  // namespace
}  // namespace prt
