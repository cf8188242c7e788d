// Pictures as they were when somebody last looked at them: every technique, in every context.
// PRT_UPDATE_GOLDEN=1 writes them anew; look at them then.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "context_scene.h"
#include "golden_scene.h"
#include "own_egl.h"
#include "precompute/io/image.h"

namespace prt {
namespace {

using namespace test;

constexpr RenderOptions kOptions{96, 60, true, 1};
constexpr DisplayOptions kDisplay{0.5, ToneCurve::Filmic};
// In steps of 8 bits, over all pixels: rounding of other compilers in software, and a GPU's texture filter
// and pixels along edges. Techniques differ by more from each other, see below.
constexpr double kSoftwareRmse = 0.4, kGpuRmse = 2.5;

std::filesystem::path goldenPath(Technique technique) {
    return std::filesystem::path(PRT_SOURCE_DIR) / "tests/runtime/golden" /
           (techniqueName(technique) + ".png");
}

void writePng(const std::filesystem::path& path, const ByteImage& image) {
    ByteImage rgb{image.width, image.height, 3, {}};
    for (size_t i = 0; i < image.pixels.size(); ++i)
        if (i % 4 != 3) rgb.pixels.push_back(image.pixels[i]);
    const std::vector<uint8_t> png = encodePng(rgb);
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(png.data()), std::streamsize(png.size()));
}

ByteImage readGolden(Technique technique) {
    std::ifstream file(goldenPath(technique), std::ios::binary);
    const std::vector<uint8_t> bytes((std::istreambuf_iterator<char>(file)), {});
    return decodeImage(bytes, goldenPath(technique).string());
}

double rmse(const ByteImage& a, const ByteImage& b) {
    EXPECT_EQ(a.pixels.size(), b.pixels.size());
    double sum = 0;
    for (size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i)
        if (i % 4 != 3) sum += std::pow(double(a.pixels[i]) - double(b.pixels[i]), 2);
    return std::sqrt(sum / (double(a.width) * a.height * 3));
}

const GoldenScene& scene() {
    static const GoldenScene kScene;
    return kScene;
}

class Golden : public testing::TestWithParam<GlContextKind> {};

TEST_P(Golden, EveryTechniqueIsAsItWas) {
    if (GetParam() == GlContextKind::Egl && !OwnEgl::make())
        GTEST_SKIP() << "EGL makes no OpenGL 4.5 context here";
    GlContext context(GetParam());
    const bool software = context.rendererName().find("llvmpipe") != std::string::npos;
    const double largest = software ? kSoftwareRmse : kGpuRmse;
    const auto renderer = scene().makeRenderer(context);
    const char* update = std::getenv("PRT_UPDATE_GOLDEN");
    for (const Technique technique : listedTechniques()) {
        const ByteImage picture = renderer->picture(GoldenScene::camera(), technique, kOptions, kDisplay);
        if (update && *update == '1') writePng(goldenPath(technique), picture);
        const double difference = rmse(picture, readGolden(technique));
        if (difference < largest) continue;
        const auto now =
            std::filesystem::path(testing::TempDir()) / ("prt-" + techniqueName(technique) + ".png");
        writePng(now, picture);
        ADD_FAILURE() << techniqueName(technique) << " differs by " << difference << ": see " << now;
    }
}
INSTANTIATE_TEST_SUITE_P(Kinds, Golden, testing::Values(GlContextKind::OsMesa, GlContextKind::Egl),
                         [](const auto& kind) { return std::string(glContextKindName(kind.param)); });

// The threshold tells techniques that matter from each other.
TEST(GoldenPictures, DifferByMoreThanIsAllowed) {
    const Technique unc6{TechniqueKind::Unc, 6}, unc3{TechniqueKind::Unc, 3}, pca4{TechniqueKind::Pca, 4},
        pca24{TechniqueKind::Pca, 24};
    const std::pair<Technique, Technique> pairs[] = {{unc6, unc3},
                                                     {pca24, pca4},
                                                     {unc6, Technique::Sh2},
                                                     {unc6, Technique::PreconvolvedAo},
                                                     {unc6, Technique::VertexPca}};
    for (const auto& [a, b] : pairs)
        EXPECT_GT(rmse(readGolden(a), readGolden(b)), kGpuRmse)
            << techniqueName(a) << " " << techniqueName(b);
}

TEST(GoldenPictures, AreTheSameInEveryContext) {
    if (!OwnEgl::make()) GTEST_SKIP() << "EGL makes no OpenGL 4.5 context here";
    GlContext osMesa, egl(GlContextKind::Egl);
    const auto first = scene().makeRenderer(osMesa), second = scene().makeRenderer(egl);
    for (const Technique technique : listedTechniques()) {
        const RenderedFrame a = first->render(GoldenScene::camera(), technique, kOptions),
                            b = second->render(GoldenScene::camera(), technique, kOptions);
        for (const auto& [x, y] :
             {std::pair(&a.radiance, &b.radiance), std::pair(&a.irradiance, &b.irradiance)}) {
            const double most = *std::ranges::max_element(x->pixels);
            double sum = 0;
            for (size_t i = 0; i < x->pixels.size(); ++i)
                sum += std::pow(double(x->pixels[i]) - double(y->pixels[i]), 2);
            EXPECT_LT(std::sqrt(sum / double(x->pixels.size())), 1e-3 * most) << techniqueName(technique);
        }
    }
}

}  // namespace
}  // namespace prt
