// Light that changes from frame to frame: what is made anew, and what is left alone.
#include "tools/relight_techniques.h"

#include <gtest/gtest.h>

#include <cmath>

#include "measure_compression_box.h"
#include "tools/relight_suns.h"

namespace prt::tools {
namespace {

constexpr double kTurn = 0.5;

class RelightedBox : public testing::Test {
  protected:
    RelightedBox() {
        arguments_.bundlePath = test::boxBundle(folder_, true, ProjectionKind::Irradiance);
        arguments_.environmentTexts = {"sky:clear", "sky:sunset"};
        arguments_.techniqueNames = {"unc", "sh2"};
        arguments_.output = "{technique}.png";
        arguments_.finish();
        data_ = loadRelightData(arguments_);
    }
    TemporaryDirectory folder_;
    RelightArguments arguments_;
    RelightData data_;
    GlContext context_;
};

TEST_F(RelightedBox, LightIsMadeAnewOnlyWhenItChanged) {
    Renderer renderer(context_, data_.scene, nullptr, nullptr);
    RelightTechniques techniques(arguments_, data_);
    techniques.addTo(renderer);
    for (const Technique technique : {Technique::Unc, Technique::Sh2}) {
        const auto set = [&](const std::vector<double>& weights, double turn) {
            techniques.setLight(renderer, technique, weights, turn);
            return renderer.lightRevision(technique);
        };
        EXPECT_EQ(renderer.lightRevision(technique), 0u);
        EXPECT_EQ(set({1, 0}, 0), 1u);
        EXPECT_EQ(set({1, 0}, 0), 1u);
        EXPECT_EQ(set({1, 0.5}, 0), 2u);
        EXPECT_EQ(set({1, 0.5}, kTurn), 3u);
        EXPECT_EQ(set({1, 0.5}, kTurn), 3u);
        EXPECT_EQ(set({1, 0}, 0), 4u);
    }
    // Another renderer has nothing yet; what was added again has lost its light.
    Renderer other(context_, data_.scene, nullptr, nullptr);
    techniques.addTo(other);
    techniques.setLight(other, Technique::Unc, {1, 0}, 0);
    EXPECT_EQ(other.lightRevision(Technique::Unc), 1u);
    EXPECT_EQ(renderer.lightRevision(Technique::Unc), 4u);
    techniques.addTo(renderer);
    techniques.setLight(renderer, Technique::Unc, {1, 0}, 0);
    EXPECT_EQ(renderer.lightRevision(Technique::Unc), 1u);
}

TEST_F(RelightedBox, TurnedAndTurnedBackDrawsTheSame) {
    Renderer renderer(context_, data_.scene, nullptr, nullptr);
    RelightTechniques techniques(arguments_, data_);
    RelightSuns suns(data_.bundle, data_.scene, data_.environments);
    techniques.addTo(renderer);
    const auto draw = [&](double turn) {
        techniques.setLight(renderer, Technique::Unc, {0.5, 1}, turn);
        suns.setTo(renderer, {0.5, 1}, turn);
        Camera camera;
        camera.eye = {1, 3, 2};
        return renderer.render(camera, Technique::Unc, {64, 48}).irradiance.pixels;
    };
    const std::vector<float> before = draw(0), turned = draw(kTurn);
    EXPECT_NE(before, turned);
    EXPECT_EQ(draw(0), before);
    EXPECT_EQ(draw(kTurn), turned);
}

TEST_F(RelightedBox, SunsTurnWithTheirEnvironments) {
    RelightSuns suns(data_.bundle, data_.scene, data_.environments);
    const std::vector<SunLight> still = suns.make({1, 2}, 0), turned = suns.make({1, 2}, kTurn);
    ASSERT_EQ(still.size(), turned.size());
    ASSERT_FALSE(still.empty());
    for (size_t i = 0; i < still.size(); ++i) {
        EXPECT_FLOAT_EQ(still[i].direction.y(), turned[i].direction.y());
        // +Z turns towards +X.
        const double angle = std::atan2(turned[i].direction.x(), turned[i].direction.z()) -
                             std::atan2(still[i].direction.x(), still[i].direction.z());
        EXPECT_NEAR(std::remainder(angle - kTurn, 2 * 3.14159265358979), 0, 1e-6);
        EXPECT_EQ(still[i].irradiance, turned[i].irradiance);
        EXPECT_EQ(suns.make({1, 2}, 0)[i].shadow, still[i].shadow);
    }
    EXPECT_NE(still.front().shadow, turned.front().shadow);
}

}  // namespace
}  // namespace prt::tools
