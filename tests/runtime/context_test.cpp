#include "runtime/gl_context.h"

#include "precompute/base/error.h"
#include "runtime/gl_functions.h"
#include "runtime/gl_objects.h"
#include "runtime/shader_sources.h"

namespace prt {
namespace {

using testing::HasSubstr;

TEST(GlContext, IsSoftwareRendered45Core) {
    GlContext context;
    EXPECT_THAT(context.rendererName(), HasSubstr("llvmpipe"));
    const auto* version = reinterpret_cast<const char*>(context.gl().GetString(GL_VERSION));
    EXPECT_THAT(version, HasSubstr("4.5"));
    EXPECT_THAT(version, HasSubstr("Core"));
    EXPECT_GE(glInteger(context.gl(), GL_MAX_ARRAY_TEXTURE_LAYERS), 2048);
    EXPECT_NO_THROW(context.check("looking around"));
}

TEST(GlContext, ReportsAnErrorOnceWithItsText) {
    GlContext context;
    context.gl().Enable(0xdead);
    try {
        context.check("enabling nonsense");
        FAIL() << "no error reported";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("enabling nonsense: invalid enum"));
        EXPECT_THAT(error.what(), HasSubstr("glEnable"));  // the driver's own words
    }
    EXPECT_NO_THROW(context.check("after the report"));
}

TEST(GlContext, TwoLiveSideBySide) {
    GlContext a;
    GlObject inA = makeTexture(a.gl(), GL_TEXTURE_2D);
    {
        GlContext b;
        GlObject inB = makeTexture(b.gl(), GL_TEXTURE_2D);
        a.makeCurrent();
        a.gl().TextureStorage2D(inA.name(), 1, GL_RGBA32F, 4, 4);
        a.check("drawing in a");
        b.makeCurrent();
        b.gl().TextureStorage2D(inB.name(), 1, GL_RGBA32F, 4, 4);
        b.check("drawing in b");
    }
    a.makeCurrent();
    EXPECT_NO_THROW(a.check("after b is gone"));
}

TEST(GlFunctions, MissingFunctionIsNamed) {
    const auto lacking = [](const char* name) -> GlProc {
        return std::string(name) == "glDrawArrays" ? nullptr : GlProc([] {});
    };
    try {
        loadGlFunctions(lacking);
        FAIL() << "no error reported";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("glDrawArrays"));
    }
}

TEST(Shaders, AllAreCarriedAndCompile) {
    GlContext context;
    EXPECT_EQ(shaderSources().size(), 14u);
    const std::string table = "#define TABLE_LAYERS 2\n#define TABLE_SIZE 4\n";
    for (const std::string defines :
         {"", "#define PER_VERTEX\n", "#define WITH_MEAN\n", "#define MULTISAMPLED\n"})
        EXPECT_NO_THROW(GlProgram(context.gl(), "screen.vert", "light.frag", table + defines)) << defines;
    EXPECT_NO_THROW(GlProgram(context.gl(), "surface.vert", "surface.frag", ""));
    EXPECT_NO_THROW(GlProgram(context.gl(), "screen.vert", "background.frag", ""));
    EXPECT_NO_THROW(GlProgram(context.gl(), "screen.vert", "display.frag", ""));
    EXPECT_NO_THROW(GlProgram(context.gl(), "screen.vert", "classes.frag", ""));
    EXPECT_NO_THROW(GlProgram(context.gl(), "blend.vert", "blend.frag", "#define SOURCES 2\n", "blend.geom"));
    EXPECT_NO_THROW(context.check("compiling"));
}

TEST(Shaders, IncludesAreReplaced) {
    const std::string text =
        shaderWithIncludes("#include \"tone_curve.glsl\"\nvoid main() {}", "#define A\n");
    EXPECT_TRUE(text.starts_with("#version 450 core\n#define A\n"));
    EXPECT_THAT(text, HasSubstr("vec3 toneMapped("));
    EXPECT_THAT(text, testing::EndsWith("\nvoid main() {}"));
    EXPECT_EQ(text.find("#include"), std::string::npos);
    EXPECT_THROW(shaderWithIncludes("#include \"absent.glsl\"\n", ""), InputError);
    EXPECT_THROW(shaderText("absent.frag", ""), InputError);
}

TEST(Shaders, CompilerLogReachesTheMessage) {
    GlContext context;
    try {
        GlProgram(context.gl(), "screen.vert", "background.frag", "#error on purpose\n");
        FAIL() << "no error reported";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("screen.vert"));
        EXPECT_THAT(error.what(), HasSubstr("on purpose"));
    }
}

}  // namespace
}  // namespace prt
