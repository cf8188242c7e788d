// A thousand changes of light in one process: nothing grows, nothing is left, and every frame is what a new
// renderer draws under the same light.
#include <cmath>

#include "precompute/base/error.h"
#include "runtime/gl_objects.h"
#include "tests/base/sanitized.h"
#include "tests/runtime/context_scene.h"

namespace prt {
namespace {

using namespace test;

constexpr int kOrder = 3, kEnvironments = 6;
constexpr Technique kTechniques[] = {Technique::Unc, Technique::Pca, Technique::PcaUniform, Technique::Sh2,
                                     Technique::PreconvolvedAo};

/// The light of step i.
struct Light {
    std::vector<double> weights = std::vector<double>(kEnvironments);
    double turn = 0;
    BlendOn blendOn = BlendOn::Cpu;
    int background = 0;
    explicit Light(int i) {
        // By turns one environment, two blended, all; every other stretch turned on and on.
        if (i % 3 == 0) weights[size_t(i / 3 % kEnvironments)] = 1;
        if (i % 3 == 1) weights[size_t(i % kEnvironments)] = weights[size_t((i + 1) % kEnvironments)] = 0.5;
        if (i % 3 == 2)
            for (size_t k = 0; k < kEnvironments; ++k) weights[k] = 0.1 * double((size_t(i) + k) % 4);
        turn = i / 40 % 2 ? 0.05 * i : 0;
        blendOn = i / 20 % 2 ? BlendOn::Gpu : BlendOn::Cpu;
        background = i / 5 % kEnvironments;
    }
};

class Switches : public testing::Test {
  protected:
    Switches() {
        for (int i = 0; i < kEnvironments; ++i) environments_.push_back(patchSky(i));
        TableOptions options;
        options.size = 8;
        light_ = std::make_unique<LiveLight>(environments_, kOrder, options);
    }
    std::unique_ptr<Renderer> makeRenderer() {
        auto renderer = std::make_unique<Renderer>(context_, scene_, &visibility_, &pca_);
        renderer->add(Technique::PcaUniform, pca_);
        renderer->add(Technique::Sh2, twoBands_);
        renderer->add(Technique::PreconvolvedAo, visibility_);
        return renderer;
    }
    RenderedFrame draw(Renderer& renderer, Technique technique, const Light& light) {
        renderer.setLight(technique, *light_, light.weights, light.turn, light.blendOn);
        renderer.setBackground(environments_[size_t(light.background)].image, light.turn);
        Camera camera;
        camera.eye = {1, 2, 3};
        return renderer.render(camera, technique, {32, 24, true});
    }

    GlContext context_;
    Scene scene_ = sphere({0, 0, 0}, 1, 8);
    VisibilityMap visibility_ = noisyVisibility(texelGrid(16, 16), kOrder, 3),
                  twoBands_ = noisyVisibility(texelGrid(16, 16), 2, 4);
    PcaMap pca_ = completePca(visibility_, 0.2f);
    std::vector<Environment> environments_;
    std::unique_ptr<LiveLight> light_;
};

TEST_F(Switches, LeaveNothingBehind) {
    // Sanitizers make a step several times as long.
    constexpr int kSteps = kSanitized ? 240 : 1000, kWarmUp = kSanitized ? 120 : 240, kCompared = 60;
    const auto renderer = makeRenderer();
    size_t objects = 0, resident = 0, compared = 0;
    for (int i = 0; i < kSteps; ++i) {
        const Light light(i);
        for (const Technique technique : kTechniques) {
            const RenderedFrame frame = draw(*renderer, technique, light);
            if (i % kCompared != kCompared - 1) continue;
            const RenderedFrame fresh = draw(*makeRenderer(), technique, light);
            ASSERT_EQ(frame.radiance.pixels, fresh.radiance.pixels) << techniqueName(technique) << " " << i;
            ASSERT_EQ(frame.irradiance.pixels, fresh.irradiance.pixels)
                << techniqueName(technique) << " " << i;
            ++compared;
        }
        ASSERT_NO_THROW(context_.check("drawing")) << i;  // messages of the driver, too
        if (i + 1 == kWarmUp) {
            // By then every program was compiled, and every table made.
            objects = liveGlObjects();
            resident = residentBytes();
        }
    }
    EXPECT_EQ(compared, size_t(kSteps / kCompared) * std::size(kTechniques));
    EXPECT_EQ(liveGlObjects(), objects);
    if (kSanitized) return;  // freed memory is kept for a while
    // The smallest table here is 6 x 10 x 10 x 16 bytes = 10 kB: one kept per step would be 7 MB, one of unc
    // 69 MB, one background 24 MB. Without any, 0.2 to 1.3 MB.
    EXPECT_LT(double(residentBytes()) - double(resident), 3e6);
}

}  // namespace
}  // namespace prt
