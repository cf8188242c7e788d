// A hidden window's context: the same pictures as OSMesa's; or clear words where there is none.
#include <cstdlib>

#include "context_scene.h"
#include "precompute/base/error.h"

namespace prt {
namespace {

using namespace test;
using testing::HasSubstr;

constexpr const char* kNoWindow =
    "no window: needs a build with PRT_WITH_VIEWER and a display (xvfb-run -s -noreset)";

std::string errorOfWindow() {
    try {
        const GlContext context(GlWindowOptions{64, 48, "hidden", false});
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

bool mayHaveWindow() {
#ifdef PRT_WITH_VIEWER
    return std::getenv("DISPLAY") != nullptr;
#else
    return false;
#endif
}

TEST(WindowContext, DrawsWhatOsMesaDraws) {
    if (!mayHaveWindow()) GTEST_SKIP() << kNoWindow;
    const Showcase showcase(PointDomain::Texel);
    GlContext window(GlWindowOptions{64, 48, "hidden", false});
    GlContext osMesa;
    EXPECT_STREQ(glContextKindName(window.kind()), "window");
    EXPECT_NE(window.window(), nullptr);
    EXPECT_EQ(osMesa.window(), nullptr);
    const auto first = showcase.makeRenderer(osMesa), second = showcase.makeRenderer(window);
    for (const Technique technique : {Technique::Unc, Technique::Pca}) {
        const RenderedFrame expected = showcase.draw(*first, technique);
        const RenderedFrame frame = showcase.draw(*second, technique);
        EXPECT_LT(relativeRmse(expected.radiance, frame.radiance), 1e-3);
        EXPECT_LT(relativeRmse(expected.irradiance, frame.irradiance), 1e-3);
    }
}

TEST(WindowContext, OneAfterTheOther) {
    if (!mayHaveWindow()) GTEST_SKIP() << kNoWindow;
    for (int i = 0; i < 3; ++i) EXPECT_EQ(errorOfWindow(), "") << i;
}

TEST(WindowContext, SaysWhyThereIsNone) {
    const char* display = std::getenv("DISPLAY");
    const std::string before = display ? display : "";
    ::setenv("DISPLAY", ":nowhere", 1);
#ifdef PRT_WITH_VIEWER
    EXPECT_THAT(errorOfWindow(), HasSubstr("no window can be made"));
#else
    EXPECT_THAT(errorOfWindow(), HasSubstr("PRT_WITH_VIEWER"));
#endif
    if (display)
        ::setenv("DISPLAY", before.c_str(), 1);
    else
        ::unsetenv("DISPLAY");
}

}  // namespace
}  // namespace prt
