// Parts of the viewer that need neither window nor context: colours of points, references traced beside,
// names of screenshots.
#include <atomic>
#include <cmath>
#include <fstream>
#include <thread>

#include "precompute/base/error.h"
#include "runtime/reference/reference.h"
#include "tests/base/temporary_directory.h"
#include "tests/runtime/test_scenes.h"
#include "tools/view/point_colours.h"
#include "tools/view/reference.h"
#include "tools/view/screenshots.h"

namespace prt::tools {
namespace {

Vec3f colourOf(const PointColours& colours, size_t point) {
    return {colours.rgb[3 * point], colours.rgb[3 * point + 1], colours.rgb[3 * point + 2]};
}

PointGrid grid(int width, int height) {
    return {PointDomain::Texel, width, height, size_t(width) * size_t(height)};
}

TEST(PointColours, SignedScaleEndsAtTheLargestMagnitude) {
    // Every second number is another coefficient's; the point without surface does not count.
    const std::vector<float> values = {-2, 9, 0, 9, 1, 9, 4, 9, -100, 9};
    const std::vector<Validity> validity = {Validity::Valid, Validity::Valid, Validity::GutterFilled,
                                            Validity::InsideFilled, Validity::Empty};
    const PointColours colours = signedColours(grid(5, 1), values, 2, validity, "test");
    ASSERT_EQ(colours.legend.size(), 3u);
    EXPECT_EQ(colours.legend[0].text, "-4");
    EXPECT_EQ(colours.legend[2].text, "4");
    const Vec3f negative = colours.legend[0].colour, white = colours.legend[1].colour,
                positive = colours.legend[2].colour;
    EXPECT_EQ(white, Vec3f(1, 1, 1));
    EXPECT_LT((colourOf(colours, 0) - 0.5f * (white + negative)).norm(), 1e-6f);
    EXPECT_EQ(colourOf(colours, 1), white);
    EXPECT_LT((colourOf(colours, 2) - (0.75f * white + 0.25f * positive)).norm(), 1e-6f);
    EXPECT_LT((colourOf(colours, 3) - positive).norm(), 1e-6f);
    EXPECT_EQ(colourOf(colours, 4), Vec3f(0, 0, 0));
    std::vector<float> many(1000, 0.5f);
    many[3] = -80;  // sticks out
    const PointColours clipped = signedColours(grid(1000, 1), many, 1, {}, "clipped");
    EXPECT_EQ(clipped.legend[2].text, ">= 0.5");
    EXPECT_LT((colourOf(clipped, 3) - negative).norm(), 1e-6f);
    EXPECT_LT((colourOf(clipped, 4) - positive).norm(), 1e-6f);
    const PointColours flat = signedColours(grid(1, 1), std::vector<float>{0}, 1, {}, "flat");
    EXPECT_EQ(colourOf(flat, 0), white);
}

TEST(PointColours, ShowWhatTheMapsHold) {
    VisibilityMap map = test::noisyVisibility(grid(4, 2), 2, 3);
    map.ao = {0, 0.25f, 0.5f, 1, 1, 1, 1, 2};
    map.validity = {Validity::Empty,  Validity::Valid, Validity::GutterFilled, Validity::InsideFilled,
                    Validity::Inside, Validity::Valid, Validity::Valid,        Validity::Valid};
    const PointColours ao = pointColours(Shown::Ao, 0, {}, &map, nullptr);
    EXPECT_EQ(colourOf(ao, 1), Vec3f(0.25f, 0.25f, 0.25f));
    EXPECT_EQ(colourOf(ao, 7), Vec3f(1, 1, 1));
    const PointColours validity = pointColours(Shown::Validity, 0, {}, &map, nullptr);
    EXPECT_FALSE(validity.smooth) << "a mixture of reasons would be another reason";
    for (size_t i = 0; i < map.grid.count; ++i)
        EXPECT_EQ(colourOf(validity, i), validityColour(map.validity[i]));
    ASSERT_EQ(validity.legend.size(), size_t(kValidityCount));
    for (int reason = 0; reason < kValidityCount; ++reason)
        EXPECT_THAT(validity.legend[size_t(reason)].text, testing::HasSubstr(validityName(Validity(reason))));
    EXPECT_EQ(validity.legend[1].text, "valid (4)");

    map.validity.assign(map.grid.count, Validity::Valid);
    const PointColours third = pointColours(Shown::Coefficient, 2, {}, &map, nullptr);
    size_t largest = 0;
    for (size_t i = 0; i < map.grid.count; ++i)
        if (std::abs(map.coefficients[4 * i + 2]) > std::abs(map.coefficients[4 * largest + 2])) largest = i;
    const LegendEntry& end = third.legend[map.coefficients[4 * largest + 2] < 0 ? 0 : 2];
    EXPECT_LT((colourOf(third, largest) - end.colour).norm(), 1e-6f);
    EXPECT_EQ(third.title, "coefficient 2: band 1, m +0");

    const PcaMap pca = test::completePca(map, 0);
    EXPECT_EQ(pointColours(Shown::Weight, 2, {}, nullptr, &pca).rgb, third.rgb)
        << "unit vectors: weights are coefficients";
    EXPECT_THROW(pointColours(Shown::Ao, 0, {}, nullptr, &pca), InputError);
    EXPECT_THROW(pointColours(Shown::Weight, 0, {}, &map, nullptr), InputError);
}

TEST(PointColours, ChartsHaveBlackEdges) {
    Scene scene = test::quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    test::append(scene, test::quad({3, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    for (size_t v = 0; v < scene.uv1.size(); ++v) {
        scene.uv1[v] = scene.uv1[v] * 0.3f + Vec2f(v < scene.uv1.size() / 2 ? 0.1f : 0.6f, 0.35f);
    }
    VisibilityMap map = test::noisyVisibility(grid(40, 40), 1, 1);
    const PointColours charts = pointColours(Shown::Charts, 0, scene, &map, nullptr);
    const auto at = [&](int x, int y) { return colourOf(charts, size_t(y * 40 + x)); };
    EXPECT_THAT(charts.legend[1].text, testing::HasSubstr("2 charts"));
    EXPECT_GT(at(10, 20).norm(), 0.1f);
    EXPECT_GT(at(30, 20).norm(), 0.1f);
    EXPECT_NE(at(10, 20), at(30, 20));
    EXPECT_EQ(at(10, 18), at(10, 20));
    EXPECT_EQ(at(20, 20), Vec3f(0, 0, 0)) << "between the charts";
    // From the middle to the left there is an edge, and then nothing.
    int edge = 10;
    while (edge > 0 && at(edge, 20).norm() > 0) --edge;
    EXPECT_GE(edge, 2);
    EXPECT_LE(edge, 5);
}

/// A floor under a block, lit by two skies.
class ReferenceTracing : public testing::Test {
  protected:
    ReferenceTracing() : scene_(test::quad({0, 0, 0}, {2, 0, 0}, {0, 0, -2})) {
        test::append(scene_, test::quad({0, 1, 0}, {0.7f, 0, 0}, {0, 0, -0.7f}));
        for (const char* sky : {"sky:clear", "sky:overcast"}) environments_.push_back(loadEnvironment(sky));
        caster_.emplace(scene_.positions, scene_.indices);
        picture_ = {{}, 40, 70, true, 0.5, {0, 1}};
        Camera camera;
        camera.eye = {0, 5, 4};
        surface_ = castPrimaryRays(*caster_, scene_, camera, picture_.width, picture_.height);
    }
    static void waitFor(ReferenceTracer& tracer) {
        while (tracer.underWay() && !tracer.poll()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }

    Scene scene_;
    std::vector<Environment> environments_;
    std::optional<RayCaster> caster_;
    ReferencePicture picture_;
    SurfaceImage surface_;
};

TEST_F(ReferenceTracing, EqualsTheWholePictureAtOnce) {
    std::atomic<int> wakes{0};
    ReferenceTracer tracer(*caster_, environments_, 64, [&] { ++wakes; });
    EXPECT_FALSE(tracer.poll());
    EXPECT_EQ(tracer.result(), nullptr);
    tracer.start(picture_, [&] { return surface_; });
    waitFor(tracer);
    ASSERT_NE(tracer.result(), nullptr);
    EXPECT_EQ(tracer.underWay(), nullptr);
    EXPECT_GE(wakes, 3) << "70 rows are three parts";
    const std::vector<double> turns(2, 0.5);
    const auto directions = makeReferenceDirections(environments_, turns, 64);
    const auto expected = traceReference(*caster_, surface_, directions);
    ASSERT_EQ(tracer.result()->irradiance, expected);
    EXPECT_GT(*std::ranges::max_element(expected[0]), 0.1f);
    const std::vector<float> blend = tracer.result()->blend(std::vector<double>{2, 0.5});
    for (size_t i = 0; i < blend.size(); ++i)
        EXPECT_NEAR(blend[i], 2 * expected[0][i] + 0.5f * expected[1][i], 1e-5f * (1 + blend[i]));
    int called = 0;
    tracer.start(picture_, [&] {
        ++called;
        return surface_;
    });
    EXPECT_EQ(called, 0) << "it is there already";
}

TEST_F(ReferenceTracing, AnotherPictureEndsTheOneUnderWay) {
    ReferenceTracer tracer(*caster_, environments_, 64, {});
    for (int i = 0; i < 5; ++i) {
        picture_.rotationRad = 0.1 * i;
        picture_.environments = {1};
        tracer.start(picture_, [&] { return surface_; });
    }
    waitFor(tracer);
    ASSERT_NE(tracer.result(), nullptr);
    EXPECT_EQ(tracer.result()->picture, picture_);
    EXPECT_EQ(tracer.result()->irradiance.size(), 1u);
    EXPECT_TRUE(picture_.covers(std::vector<double>{0, 3}));
    EXPECT_FALSE(picture_.covers(std::vector<double>{1, 3}));
    picture_.normalMap = false;
    tracer.start(picture_, [&] { return surface_; });
    tracer.stop();
    EXPECT_FALSE(tracer.poll());
    EXPECT_TRUE(tracer.result()->picture.normalMap) << "the last one that was finished stays";
}

TEST(Screenshots, TakeTheFirstFreeNumber) {
    const TemporaryDirectory folder;
    EXPECT_EQ(nextScreenshot(folder.path()).filename(), "prt-view-0001.png");
    std::ofstream(folder.path() / "prt-view-0001.png") << "x";
    std::ofstream(folder.path() / "prt-view-0003.png") << "x";
    EXPECT_EQ(nextScreenshot(folder.path()).filename(), "prt-view-0002.png");
    std::filesystem::create_symlink("nowhere", folder.path() / "prt-view-0002.png");
    EXPECT_EQ(nextScreenshot(folder.path()).filename(), "prt-view-0004.png");
    EXPECT_THROW(nextScreenshot(folder.path() / "none"), OutputError);
}

}  // namespace
}  // namespace prt::tools
