// Drawing into a context that the caller has: the same pictures, and its state as it was.
#include <thread>

#include "context_scene.h"
#include "own_egl.h"
#include "precompute/base/error.h"
#include "runtime/gl_functions.h"
#include "runtime/gl_objects.h"
#include "runtime/gl_state.h"

namespace prt {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;

/// State that can be asked for by number, in the active texture unit.
std::vector<GLint> integers(const GlFunctions& gl) {
    std::vector<GLint> values;
    for (const GLenum what : {GL_DRAW_FRAMEBUFFER_BINDING,
                              GL_READ_FRAMEBUFFER_BINDING,
                              GL_VIEWPORT,
                              GL_SCISSOR_BOX,
                              GL_CURRENT_PROGRAM,
                              GL_VERTEX_ARRAY_BINDING,
                              GL_CLIP_ORIGIN,
                              GL_CLIP_DEPTH_MODE,
                              GL_DEPTH_FUNC,
                              GL_DEPTH_WRITEMASK,
                              GL_DEPTH_RANGE,
                              GL_COLOR_WRITEMASK,
                              GL_CULL_FACE_MODE,
                              GL_FRONT_FACE,
                              GL_POLYGON_MODE,
                              GL_PROVOKING_VERTEX,
                              GL_ACTIVE_TEXTURE,
                              GL_PIXEL_PACK_BUFFER_BINDING,
                              GL_PIXEL_UNPACK_BUFFER_BINDING,
                              GL_PACK_ALIGNMENT,
                              GL_PACK_ROW_LENGTH,
                              GL_UNPACK_ALIGNMENT,
                              GL_UNPACK_ROW_LENGTH,
                              GL_UNPACK_SKIP_PIXELS,
                              GL_BLEND_SRC_RGB,
                              GL_BLEND_DST_RGB}) {
        GLint several[4] = {-7, -7, -7, -7};
        gl.GetIntegerv(what, several);
        values.insert(values.end(), several, several + 4);
    }
    for (const GLenum what :
         {GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_DEPTH_TEST, GL_CULL_FACE, GL_DEPTH_CLAMP,
          GL_RASTERIZER_DISCARD, GL_FRAMEBUFFER_SRGB, GL_POLYGON_OFFSET_FILL, GL_TEXTURE_CUBE_MAP_SEAMLESS,
          GL_CLIP_DISTANCE0, GL_COLOR_LOGIC_OP, GL_MULTISAMPLE, GL_SAMPLE_MASK, GL_PRIMITIVE_RESTART})
        values.push_back(gl.IsEnabled(what));
    return values;
}

std::vector<GLint> state(const GlFunctions& gl) {
    std::vector<GLint> values = integers(gl);
    const auto active = GLenum(glInteger(gl, GL_ACTIVE_TEXTURE));
    for (GLuint unit = 0; unit < 20; ++unit) {
        gl.ActiveTexture(GL_TEXTURE0 + unit);
        for (const GLenum what :
             {GL_TEXTURE_BINDING_2D, GL_TEXTURE_BINDING_2D_ARRAY, GL_TEXTURE_BINDING_BUFFER,
              GL_TEXTURE_BINDING_CUBE_MAP, GL_TEXTURE_BINDING_3D, GL_SAMPLER_BINDING})
            values.push_back(glInteger(gl, what));
    }
    gl.ActiveTexture(active);
    return values;
}

/// An application in the middle of its frame: nothing is as a new context has it.
class Disorder {
  public:
    explicit Disorder(const GlFunctions& gl)
        : colour_(makeImage(gl, GL_RGBA8, 32, 32)),
          frame_(makeFramebuffer(gl)),
          array_(makeVertexArray(gl)),
          layers_(makeTexture(gl, GL_TEXTURE_2D_ARRAY)),
          sampler_(makeSampler(gl)),
          program_(gl, "screen.vert", "background.frag", "") {
        gl.NamedFramebufferTexture(frame_.name(), GL_COLOR_ATTACHMENT0, colour_.name(), 0);
        gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, frame_.name());
        gl.BindFramebuffer(GL_READ_FRAMEBUFFER, frame_.name());
        gl.Viewport(3, 5, 17, 19);
        gl.ClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
        gl.DepthFunc(GL_NEVER);
        gl.DepthMask(GL_FALSE);
        gl.DepthRangeIndexed(0, 0.25, 0.5);
        for (const GLenum what :
             {GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_CULL_FACE, GL_DEPTH_CLAMP, GL_RASTERIZER_DISCARD,
              GL_FRAMEBUFFER_SRGB, GL_POLYGON_OFFSET_FILL, GL_TEXTURE_CUBE_MAP_SEAMLESS, GL_CLIP_DISTANCE0,
              GL_COLOR_LOGIC_OP, GL_SAMPLE_MASK, GL_PRIMITIVE_RESTART})
            gl.Enable(what);
        gl.Disable(GL_MULTISAMPLE);
        gl.ColorMaski(0, GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
        gl.CullFace(GL_FRONT_AND_BACK);
        gl.FrontFace(GL_CW);
        gl.PolygonMode(GL_FRONT_AND_BACK, GL_LINE);
        gl.ProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
        program_.use();
        gl.BindVertexArray(array_.name());
        for (GLuint unit = 0; unit < 20; unit += 3) {
            gl.BindTextureUnit(unit, unit % 2 ? colour_.name() : layers_.name());
            gl.BindSampler(unit, sampler_.name());
        }
        gl.ActiveTexture(GL_TEXTURE5);
        GLuint buffers[2];
        gl.CreateBuffers(2, buffers);
        for (GLuint i = 0; i < 2; ++i) {
            gl.NamedBufferStorage(buffers[i], 1 << 16, nullptr, 0);
            buffers_[i] =
                GlObject(gl, buffers[i], [](const GlFunctions& f, GLuint n) { f.DeleteBuffers(1, &n); });
        }
        gl.BindBuffer(GL_PIXEL_PACK_BUFFER, buffers[0]);
        gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, buffers[1]);
        gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
        gl.PixelStorei(GL_PACK_ROW_LENGTH, 77);
        gl.PixelStorei(GL_UNPACK_ALIGNMENT, 2);
        gl.PixelStorei(GL_UNPACK_ROW_LENGTH, 99);
        gl.PixelStorei(GL_UNPACK_SKIP_PIXELS, 3);
    }

  private:
    GlObject colour_, frame_, array_, layers_, sampler_, buffers_[2];
    GlProgram program_;
};

#define MAKE_OWN_EGL(own)            \
    const auto own = OwnEgl::make(); \
    if (!own) GTEST_SKIP() << "EGL makes no OpenGL 4.5 context here"

/// As OSMesa draws it.
RenderedFrame expectedFrame(const Showcase& showcase, Technique technique) {
    GlContext context;
    const auto renderer = showcase.makeRenderer(context);
    return showcase.draw(*renderer, technique);
}

TEST(OwnContext, SamePictureAndStateAsBefore) {
    const Showcase showcase(PointDomain::Texel);
    const RenderedFrame expected = expectedFrame(showcase, Technique::Pca);
    MAKE_OWN_EGL(own);
    GlContext context = GlContext::ofCaller(own->getProc());
    EXPECT_STREQ(glContextKindName(context.kind()), "current");
    const GlFunctions& gl = context.gl();
    {
        const Disorder disorder(gl);
        context.check("making disorder");
        const std::vector<GLint> before = state(gl);
        {
            const GlStateGuard guard(context);
            const auto renderer = showcase.makeRenderer(context);
            const RenderedFrame frame = showcase.draw(*renderer, Technique::Pca);
            EXPECT_LT(relativeRmse(expected.radiance, frame.radiance), 1e-3);
            EXPECT_LT(relativeRmse(expected.irradiance, frame.irradiance), 1e-3);
            EXPECT_NE(state(gl), before);
        }
        EXPECT_EQ(state(gl), before);
        context.check("in the caller's frame");
    }
    EXPECT_TRUE(own->isCurrent());
}

/// The first pixel's colour.
std::array<GLubyte, 4> firstPixel(const GlFunctions& gl, const GlObject& image) {
    std::vector<GLubyte> rgba(80 * 60 * 4);
    gl.GetTextureImage(image.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, GLsizei(rgba.size()), rgba.data());
    return {rgba[0], rgba[1], rgba[2], rgba[3]};
}

// Without a guard of the caller's: every function of the renderer keeps one.
TEST(OwnContext, EveryFunctionLeavesTheState) {
    const Showcase showcase(PointDomain::Texel);
    const RenderedFrame expected = expectedFrame(showcase, Technique::Unc);
    MAKE_OWN_EGL(own);
    GlContext context = GlContext::ofCaller(own->getProc());
    const GlFunctions& gl = context.gl();
    const GlObject canvas = makeImage(gl, GL_RGBA8, 80, 60), frame = makeFramebuffer(gl);
    gl.NamedFramebufferTexture(frame.name(), GL_COLOR_ATTACHMENT0, canvas.name(), 0);
    std::unique_ptr<Renderer> renderer;
    RenderedFrame rendered;
    const LiveLight light({patchSky(0)}, 4, {});
    const PointGrid grid = texelGrid(16, 16);
    const SunLight sun{Vec3f::UnitY(), Vec3f::Ones(), std::vector<float>(grid.count, 1.0f)};
    const Camera camera = Showcase::camera();
    const RenderOptions options = Showcase::options();
    const DrawTarget target{frame.name(), 0, 0};
    const std::pair<const char*, std::function<void()>> calls[] = {
        {"Renderer, setTable, setBackground", [&] { renderer = showcase.makeRenderer(context); }},
        {"render", [&] { rendered = showcase.draw(*renderer, Technique::Unc); }},
        {"surface", [&] { renderer->surface(camera, options); }},
        {"frameMilliseconds", [&] { renderer->frameMilliseconds(camera, std::nullopt, options, 1); }},
        {"setPointColours", [&] { renderer->setPointColours(grid, std::vector<float>(768, 1.0f), false); }},
        {"renderPoints", [&] { renderer->renderPoints(camera, options); }},
        {"drawPoints", [&] { renderer->drawPoints(camera, options, {}, target); }},
        {"drawImage", [&] { renderer->drawImage(expected.irradiance, {}, target); }},
        {"draw", [&] { renderer->draw(camera, Technique::Unc, options, {}, target); }},
        {"picture",
         [&] {
             RenderOptions four = options;
             four.samples = 4;
             renderer->picture(camera, Technique::Unc, four, {});
         }},
        {"setLight on the GPU", [&] { renderer->setLight(Technique::Pca, light, {1.0}, 0.5, BlendOn::Gpu); }},
        {"setLight", [&] { renderer->setLight(Technique::Unc, light, {1.0}, 0.5); }},
        {"setSuns",
         [&] {
             renderer->setSuns({&sun, 1}, grid);
         }},
        {"~Renderer", [&] { renderer.reset(); }}};
    {
        const Disorder disorder(gl);
        const std::vector<GLint> before = state(gl);
        for (const auto& [name, call] : calls) {
            call();
            EXPECT_EQ(state(gl), before) << name;
            context.check(name);
        }
    }
    const GlStateGuard guard(context);  // to read what was drawn
    EXPECT_LT(relativeRmse(expected.radiance, rendered.radiance), 1e-3);
    const ByteImage shown = toDisplay(expected.radiance, 0);
    const std::array<GLubyte, 4> lowest = firstPixel(gl, canvas);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(lowest[size_t(c)], shown.pixels[size_t(59 * 80 * 3 + c)], 1);
}

TEST(OwnContext, GuardsWithinAGuardDoNothing) {
    MAKE_OWN_EGL(own);
    const GlContext context = GlContext::ofCaller(own->getProc());
    const GlFunctions& gl = context.gl();
    gl.Enable(GL_SCISSOR_TEST);
    {
        const GlStateGuard outer(context);
        EXPECT_FALSE(gl.IsEnabled(GL_SCISSOR_TEST));
        gl.Enable(GL_SCISSOR_TEST);
        { const GlStateGuard inner(context); }
        EXPECT_TRUE(gl.IsEnabled(GL_SCISSOR_TEST));
        gl.Disable(GL_SCISSOR_TEST);
    }
    EXPECT_TRUE(gl.IsEnabled(GL_SCISSOR_TEST));
    {
        const GlStateGuard next(context);
        EXPECT_FALSE(gl.IsEnabled(GL_SCISSOR_TEST));
    }
    gl.Disable(GL_SCISSOR_TEST);
}

TEST(OwnContext, StaysAliveAndCurrent) {
    MAKE_OWN_EGL(own);
    {
        const GlContext context = GlContext::ofCaller();
        EXPECT_FALSE(context.rendererName().empty());
    }
    EXPECT_TRUE(own->isCurrent());
    const auto getString = reinterpret_cast<PFNGLGETSTRINGPROC>(own->getProc()("glGetString"));
    EXPECT_NE(getString(GL_VERSION), nullptr);
}

TEST(OwnContext, UseWhileAnotherIsCurrent) {
    MAKE_OWN_EGL(own);
    const GlContext context = GlContext::ofCaller();
    own->release();
    EXPECT_THROW(context.makeCurrent(), Error);
    own->makeCurrent();
    EXPECT_NO_THROW(context.makeCurrent());
    {
        const GlContext osMesa;  // takes the thread without EGL seeing
        EXPECT_THROW(GlStateGuard{context}, Error);
    }
    own->makeCurrent();
    EXPECT_NO_THROW(context.rendererName());
}

TEST(OwnContext, ErrorsOfTheCallerAreNotOurs) {
    MAKE_OWN_EGL(own);
    const GlContext context = GlContext::ofCaller();
    context.gl().Enable(0xdead);
    testing::internal::CaptureStderr();
    {
        const GlStateGuard guard(context);
        EXPECT_NO_THROW(context.check("drawing"));
    }
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("the caller left unread: invalid enum"));
}

TEST(OwnContext, NoneIsCurrent) {
    std::string error;
    std::thread([&] {
        try {
            const GlContext context = GlContext::ofCaller();
        } catch (const InputError& e) {
            error = e.what();
        }
    }).join();
    EXPECT_THAT(error, HasSubstr("no context of EGL, GLX or OSMesa is current"));
}

// What follows needs functions that lie: these wrap OSMesa's.
GLenum resetStatus = GL_NO_ERROR;

GlProc procWithResets(const char* name) {
    if (std::string(name) != "glGetGraphicsResetStatus") return osMesaProc(name);
    return reinterpret_cast<GlProc>(+[]() -> GLenum { return resetStatus; });
}

TEST(OwnContext, LossIsReported) {
    const GlContext osMesa;
    const GlContext context = GlContext::ofCaller(procWithResets);
    EXPECT_NO_THROW(context.check("drawing"));
    for (const GLenum status :
         {GL_GUILTY_CONTEXT_RESET, GL_INNOCENT_CONTEXT_RESET, GL_UNKNOWN_CONTEXT_RESET}) {
        resetStatus = status;
        try {
            context.check("drawing");
            ADD_FAILURE() << "no error reported";
        } catch (const GlContextLost& error) {
            EXPECT_THAT(error.what(), HasSubstr("drawing: the GPU was reset"));
        }
    }
    resetStatus = GL_NO_ERROR;
}

GlProc procOfOldVersion(const char* name) {
    if (std::string(name) != "glGetString") return osMesaProc(name);
    return reinterpret_cast<GlProc>(+[](GLenum what) -> const GLubyte* {
        return reinterpret_cast<const GLubyte*>(what == GL_VERSION ? "3.3.0 NVIDIA 390.157" : "GeForce 9");
    });
}

TEST(OwnContext, OldVersionIsNamed) {
    const GlContext osMesa;
    try {
        const GlContext context = GlContext::ofCaller(procOfOldVersion);
        FAIL() << "no error reported";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), AllOf(HasSubstr("3.3.0 NVIDIA 390.157 of GeForce 9 is too old"),
                                        HasSubstr("OpenGL 4.5")));
    }
}

TEST(GlDebug, UndefinedBehaviourIsAnErrorOnDemand) {
    using Insert = void (*)(GLenum, GLenum, GLuint, GLenum, GLsizei, const GLchar*);
    for (const bool strict : {true, false}) {
        ::setenv("PRT_GL_DEBUG", strict ? "1" : "0", 1);
        const GlContext context;
        const auto insert = reinterpret_cast<Insert>(osMesaProc("glDebugMessageInsert"));
        insert(GL_DEBUG_SOURCE_APPLICATION, GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR, 1, GL_DEBUG_SEVERITY_HIGH, -1,
               "reads what was never written");
        if (strict)
            EXPECT_THROW(context.check("drawing"), Error);
        else
            EXPECT_NO_THROW(context.check("drawing"));
    }
    ::setenv("PRT_GL_DEBUG", "1", 1);
}

}  // namespace
}  // namespace prt
