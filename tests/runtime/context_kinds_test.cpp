// OSMesa and EGL: the same pictures, side by side, nothing left behind, and clear words where there is none.
#include <cstdlib>

#include "context_scene.h"
#include "own_egl.h"
#include "precompute/base/error.h"
#include "runtime/gl_functions.h"
#include "runtime/gl_objects.h"
#include "tests/base/sanitized.h"

namespace prt {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;

/// What the error says, or "" without one.
template <typename E = InputError>
std::string errorOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const E& error) {
        return error.what();
    }
    return {};
}

/// An environment variable for a while.
class Variable {
  public:
    Variable(const char* name, const char* value) : name_(name) { ::setenv(name, value, 1); }
    ~Variable() { ::unsetenv(name_); }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

  private:
    const char* name_;
};

// An application that can make a context through EGL is the proof that ours must succeed, too.
constexpr const char* kNoEgl = "EGL makes no OpenGL 4.5 context here";
#define SKIP_WITHOUT_EGL() \
    if (!OwnEgl::make()) GTEST_SKIP() << kNoEgl

class EglPictures : public testing::TestWithParam<PointDomain> {};

TEST_P(EglPictures, AreThoseOfOsMesa) {
    SKIP_WITHOUT_EGL();
    const Showcase showcase(GetParam());
    GlContext osMesa, egl(GlContextKind::Egl);
    const auto first = showcase.makeRenderer(osMesa), second = showcase.makeRenderer(egl);
    // By turns, on one thread: neither may draw into the other.
    for (const Technique technique : {Technique::Unc, Technique::Pca}) {
        const RenderedFrame expected = showcase.draw(*first, technique);
        const RenderedFrame frame = showcase.draw(*second, technique);
        EXPECT_LT(relativeRmse(expected.radiance, frame.radiance), 1e-3);
        EXPECT_LT(relativeRmse(expected.irradiance, frame.irradiance), 1e-3);
    }
}

INSTANTIATE_TEST_SUITE_P(Domains, EglPictures, testing::Values(PointDomain::Texel, PointDomain::Vertex),
                         [](const auto& domain) { return std::string(pointDomainName(domain.param)); });

TEST(EglContext, IsWhatItSays) {
    SKIP_WITHOUT_EGL();
    GlContext context(GlContextKind::Egl);
    EXPECT_STREQ(glContextKindName(context.kind()), "egl");
    EXPECT_FALSE(context.rendererName().empty());
    EXPECT_GE(std::stod(context.versionName()), 4.5);
    // PRT_GL_DEBUG is set for these tests.
    EXPECT_TRUE(glInteger(context.gl(), GL_CONTEXT_FLAGS) & GL_CONTEXT_FLAG_DEBUG_BIT);
    EXPECT_EQ(glInteger(context.gl(), GL_CONTEXT_PROFILE_MASK), GL_CONTEXT_CORE_PROFILE_BIT);
    EXPECT_EQ(glInteger(context.gl(), GL_RESET_NOTIFICATION_STRATEGY), GL_LOSE_CONTEXT_ON_RESET);
}

// Mesa's EGL and OSMesa share a note of what is current: objects must still land where they belong.
TEST(EglContext, BesideOsMesa) {
    SKIP_WITHOUT_EGL();
    GlContext egl(GlContextKind::Egl);
    const GlObject kept = makeTexture(egl.gl(), GL_TEXTURE_2D);
    {
        GlContext osMesa;
        const GlObject other = makeTexture(osMesa.gl(), GL_TEXTURE_2D);
        EXPECT_EQ(other.name(), kept.name());  // the first name of either context
        egl.makeCurrent();
        const GlObject second = makeTexture(egl.gl(), GL_TEXTURE_2D);
        EXPECT_NE(second.name(), kept.name());
        egl.gl().TextureStorage2D(kept.name(), 1, GL_R8, 4, 4);
        egl.check("in EGL");
        osMesa.makeCurrent();
        osMesa.gl().TextureStorage2D(other.name(), 1, GL_R8, 4, 4);
        osMesa.check("in OSMesa");
        egl.makeCurrent();
    }
    egl.makeCurrent();
    EXPECT_NO_THROW(egl.check("after OSMesa is gone"));
}

TEST(EglContext, MissingLibraryIsNamed) {
    const Variable library("PRT_EGL_LIBRARY", "libNoSuchEGL.so.1");
    EXPECT_THAT(errorOf([] { GlContext context(GlContextKind::Egl); }),
                AllOf(HasSubstr("libNoSuchEGL.so.1 cannot be loaded"), HasSubstr("PRT_EGL_LIBRARY")));
}

TEST(EglContext, WrongLibraryIsNamed) {
    const Variable library("PRT_EGL_LIBRARY", "libm.so.6");
    EXPECT_THAT(errorOf([] { GlContext context(GlContextKind::Egl); }),
                HasSubstr("libEGL has no function egl"));
}

TEST(EglContext, DeviceThatIsNotThere) {
    SKIP_WITHOUT_EGL();
    for (const char* number : {"1000", "-1", "none", "0x"}) {
        const Variable device("PRT_EGL_DEVICE", number);
        EXPECT_THAT(errorOf([] { GlContext context(GlContextKind::Egl); }),
                    AllOf(HasSubstr("PRT_EGL_DEVICE"), HasSubstr(number)));
    }
}

TEST(OsMesaContext, MissingLibraryIsNamed) {
    const Variable library("PRT_OSMESA_LIBRARY", "libNoSuchOSMesa.so.8");
    EXPECT_THAT(errorOf([] { GlContext context; }), HasSubstr("libNoSuchOSMesa.so.8 cannot be loaded"));
}

/// Names below 4096 that are in use, by kind of object.
std::vector<int> namesInUse(GlGetProc getProc) {
    std::vector<int> counts;
    for (const char* function : {"glIsTexture", "glIsBuffer", "glIsFramebuffer", "glIsProgram", "glIsShader",
                                 "glIsVertexArray", "glIsSampler"}) {
        const auto isOne = reinterpret_cast<GLboolean (*)(GLuint)>(getProc(function));
        counts.push_back(0);
        for (GLuint name = 1; name < 4096; ++name) counts.back() += isOne(name) ? 1 : 0;
    }
    return counts;
}

class Leaks : public testing::TestWithParam<GlContextKind> {};

TEST_P(Leaks, NoneFromFiftyRenderers) {
    const auto own = OwnEgl::make();
    if (GetParam() == GlContextKind::Egl && !own) GTEST_SKIP() << kNoEgl;
    const Showcase showcase(PointDomain::Texel);
    GlContext context(GetParam());
    const GlGetProc getProc = GetParam() == GlContextKind::Egl ? own->getProc() : osMesaProc;
    const size_t objects = liveGlObjects();
    const std::vector<int> names = namesInUse(getProc);
    size_t resident = 0;
    constexpr int kRounds = 50, kWarmUp = 20;
    for (int i = 0; i < kRounds; ++i) {
        {
            const auto renderer = showcase.makeRenderer(context);
            EXPECT_GT(liveGlObjects(), objects);
            showcase.draw(*renderer, i % 2 ? Technique::Unc : Technique::Pca);
            EXPECT_NE(namesInUse(getProc), names);
        }
        ASSERT_EQ(liveGlObjects(), objects);
        ASSERT_EQ(namesInUse(getProc), names);
        if (i + 1 == kWarmUp) resident = residentBytes();
    }
    if (kSanitized) return;  // freed memory is kept for a while
    // A renderer's images alone are 80 x 60 x (6 x 16 + 8) bytes = 0.5 MB: one kept per round would be 15 MB.
    EXPECT_LT(double(residentBytes()) - double(resident), 4e6);
}

INSTANTIATE_TEST_SUITE_P(Kinds, Leaks, testing::Values(GlContextKind::OsMesa, GlContextKind::Egl),
                         [](const auto& kind) { return std::string(glContextKindName(kind.param)); });

}  // namespace
}  // namespace prt
