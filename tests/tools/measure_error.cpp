// The error report where the answers are known in closed form, or must be zero, or must fall.
#include "tools/measure/error.h"

#include <cmath>
#include <numbers>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "tests/tools/error_fixture.h"
#include "tools/measure/error_advice.h"
#include "tools/measure/error_images.h"

namespace prt::tools {
namespace {

constexpr std::array kStages{ErrorStage::Sampling, ErrorStage::Truncation,   ErrorStage::Projection,
                             ErrorStage::Pca,      ErrorStage::Quantisation, ErrorStage::Tables};

const ErrorFigure& alone(const ErrorBlock& block, ErrorStage stage) { return block.alone[size_t(stage)]; }
const ErrorFigure& without(const ErrorBlock& block, ErrorStage stage) { return block.without[size_t(stage)]; }

// An open floor under a sky of 1, one band: truth π(1 + cos t)/2 at a tilt of t. The plain expansion is 1/2
// everywhere, E = π/2; the weighted one has the exact E = π at the geometric normal and so at all others.
TEST(MeasureError, KnowsAnOpenFloorOfOneBand) {
    ErrorStudy study = smallErrorStudy();
    study.rays = 16384;
    const double cosine = std::cos(study.tiltDeg * std::numbers::pi / 180);
    // Sums over one geometric and four tilted normals, all points alike.
    const auto together = [&](double geometric, double tilted) {
        const double truth = (1 + cosine) / 2;
        return std::sqrt((geometric * geometric + 4 * tilted * tilted * truth * truth) /
                         (1 + 4 * truth * truth));
    };
    const double weightedTilted = (1 - cosine) / (1 + cosine), plainTilted = cosine / (1 + cosine);
    for (const bool isPlain : {true, false}) {
        BundleKind kind{.obj = floorObj(), .shOrder = 1, .rays = 16384};
        if (isPlain) kind.projection = ProjectionKind::Plain;
        const ErrorResult result = errorsOf(kind, {"sky:uniform"}, study);
        ASSERT_EQ(result.environments.size(), 1u);
        const ErrorBlock& block = result.environments[0];
        // Quadrature with 16384 directions is good to 1e-3 here.
        constexpr double kTolerance = 2e-3;
        const ErrorFigure& truncation = alone(block, ErrorStage::Truncation);
        EXPECT_NEAR(truncation.geometric, 0, kTolerance);
        EXPECT_NEAR(truncation.tilted, weightedTilted, kTolerance);
        EXPECT_NEAR(block.plain.geometric, 0.5, kTolerance);
        EXPECT_NEAR(block.plain.tilted, plainTilted, kTolerance);
        EXPECT_NEAR(block.total.geometric, isPlain ? 0.5 : 0, kTolerance);
        EXPECT_NEAR(block.total.tilted, isPlain ? plainTilted : weightedTilted, kTolerance);
        EXPECT_NEAR(block.total.relativeRmse,
                    isPlain ? together(0.5, plainTilted) : together(0, weightedTilted), kTolerance);
        EXPECT_NEAR(alone(block, ErrorStage::Projection).geometric, isPlain ? 0.5 : 0, kTolerance);
        EXPECT_NEAR(alone(block, ErrorStage::Projection).tilted, isPlain ? 1 / (1 + cosine) : 0, kTolerance);
        EXPECT_NEAR(without(block, ErrorStage::Projection).geometric, 0, kTolerance);
        EXPECT_NEAR(without(block, ErrorStage::Projection).tilted, weightedTilted, kTolerance);
        EXPECT_NEAR(without(block, ErrorStage::Truncation).relativeRmse, 0, kTolerance);
        // Peak π at the geometric normals; RMSE of the total by the same sums.
        const double truth = std::sqrt((1 + 4 * std::pow((1 + cosine) / 2, 2)) / 5);
        EXPECT_NEAR(block.total.psnrDb, -20 * std::log10(block.total.relativeRmse * truth), 0.05);
    }
}

TEST(MeasureError, StagesThatLoseNothingAreZero) {
    const ErrorResult result = errorsOf({}, {"sky:clear"}, smallErrorStudy());
    EXPECT_FALSE(result.isCompressed);
    EXPECT_EQ(result.components, 16);
    const ErrorBlock& block = result.environments[0];
    for (const ErrorStage stage : {ErrorStage::Pca, ErrorStage::Projection}) {
        EXPECT_EQ(alone(block, stage).relativeRmse, 0);
        EXPECT_NEAR(block.gain(stage), 0, 1e-7);
    }
    // Floats: rounding of sums of 16 products.
    EXPECT_LT(alone(block, ErrorStage::Quantisation).relativeRmse, 1e-5);
    EXPECT_GT(alone(block, ErrorStage::Truncation).relativeRmse, 0.01);
    EXPECT_GT(block.gain(ErrorStage::Truncation), 0);
    // The last step of the chain is the whole.
    EXPECT_EQ(block.upTo[size_t(ErrorStage::Tables)].relativeRmse, block.total.relativeRmse);
    EXPECT_EQ(block.upTo[size_t(ErrorStage::Truncation)].relativeRmse,
              alone(block, ErrorStage::Truncation).relativeRmse);
    // The bundle is the mean of nothing else.
    EXPECT_EQ(result.mean.total.relativeRmse, block.total.relativeRmse);
}

TEST(MeasureError, MoreVectorsLoseLess) {
    double last = 1;
    for (const int components : {2, 4, 8, 16}) {
        const ErrorBlock block =
            errorsOf({.components = components}, {"sky:clear"}, smallErrorStudy()).environments[0];
        const double error = alone(block, ErrorStage::Pca).relativeRmse;
        EXPECT_LT(error, last) << components;
        last = error;
        if (components == 16) {
            // All of them: what is left is rounding.
            EXPECT_LT(error, 1e-4);
        } else {
            EXPECT_GT(error, 1e-3);
        }
    }
}

TEST(MeasureError, MoreDirectionsErrLess) {
    ErrorStudy study = smallErrorStudy();
    study.rays = 32768;
    const auto sampling = [&](int rays) {
        return alone(errorsOf({.rays = rays}, {"sky:overcast"}, study).environments[0], ErrorStage::Sampling)
            .relativeRmse;
    };
    const double few = sampling(64), many = sampling(1024);
    // Random directions would gain 4.
    EXPECT_GT(few, 4 * many);
    EXPECT_GT(many, 1e-4);
}

TEST(MeasureError, FinerStorageAndTablesErrLess) {
    ErrorStudy study = smallErrorStudy();
    const BundleKind kind{.components = 6};
    study.weights = "unorm8";
    study.table.size = 4;
    const ErrorBlock coarse = errorsOf(kind, {"sky:clear"}, study).environments[0];
    study.weights = "unorm16";
    study.table.size = 16;
    const ErrorBlock fine = errorsOf(kind, {"sky:clear"}, study).environments[0];
    // Steps of 1/255 and 1/65535.
    EXPECT_NEAR(coarse.weights.relativeRmse / fine.weights.relativeRmse, 257, 100);
    EXPECT_GT(coarse.weights.relativeRmse, 1e-4);
    EXPECT_NEAR(coarse.weights.relativeRmse, alone(coarse, ErrorStage::Quantisation).relativeRmse, 1e-5);
    // Bilinear interpolation: a quarter for half the step, twice.
    EXPECT_GT(coarse.lookup.relativeRmse, 8 * fine.lookup.relativeRmse);
    EXPECT_LT(coarse.lookup.relativeRmse, 32 * fine.lookup.relativeRmse);

    study.table.variant = "paper";
    study.tables = "half";
    const ErrorBlock paper = errorsOf(kind, {"sky:clear"}, study).environments[0];
    EXPECT_GT(paper.bands.relativeRmse, 2 * fine.bands.relativeRmse);
    EXPECT_GT(paper.tableFormat.relativeRmse, 10 * fine.tableFormat.relativeRmse);
    EXPECT_LT(paper.tableFormat.relativeRmse, 1e-3);  // 2^-11 of each term
}

// Weights that are fitted here are those that prt compress finds: with as many directions in the bake as in
// the truth, exact sampling changes nothing.
TEST(MeasureError, FitsWeightsAsCompressDoes) {
    ErrorStudy study = smallErrorStudy();
    study.rays = 32768;
    for (const char* weights : {"irradiance", "plain"})
        for (const ProjectionKind projection : {ProjectionKind::Irradiance, ProjectionKind::Plain}) {
            const BundleKind kind{
                .rays = 16384, .projection = projection, .components = 4, .weights = weights};
            const ErrorBlock block = errorsOf(kind, {"sky:clear"}, study).environments[0];
            EXPECT_NEAR(without(block, ErrorStage::Sampling).relativeRmse, block.total.relativeRmse, 3e-3);
            EXPECT_GT(block.total.relativeRmse, 0.02);
        }
}

TEST(MeasureError, NoiseFallsWithDirectionsAndTellsItsLimit) {
    ErrorStudy study = smallErrorStudy();
    study.rays = 512;
    const ErrorBlock few = errorsOf({.rays = 4096}, {"sky:clear"}, study).environments[0];
    study.rays = 32768;
    const ErrorBlock many = errorsOf({.rays = 4096}, {"sky:clear"}, study).environments[0];
    EXPECT_GT(few.truthNoise, 4 * many.truthNoise);
    EXPECT_GT(few.total.noise, many.total.noise);
    // 4096 directions are better than the 256 of a half.
    EXPECT_LT(alone(few, ErrorStage::Sampling).relativeRmse, 2 * alone(few, ErrorStage::Sampling).noise);
    EXPECT_FALSE(many.total.isBelowNoise());
    EXPECT_NEAR(few.total.relativeRmse, many.total.relativeRmse, 3 * few.total.noise);
}

TEST(MeasureError, JudgesVerticesAndDarkness) {
    ErrorStudy study = smallErrorStudy();
    study.points = 0;
    BundleKind kind;
    kind.perVertex = true;
    const ErrorResult result =
        errorsOf(kind, {"sky:overcast", "sky:constant?r=0&g=0&b=0", "sky:clear"}, study);
    EXPECT_GE(result.points, 7u);
    ASSERT_EQ(result.environments.size(), 3u);
    EXPECT_TRUE(result.environments[1].isDark);
    EXPECT_EQ(result.environments[1].total.relativeRmse, 0);
    const double sum = result.environments[0].total.relativeRmse + result.environments[2].total.relativeRmse;
    EXPECT_NEAR(result.mean.total.relativeRmse, sum / 2, 1e-12);
    EXPECT_LT(result.environments[0].total.relativeRmse, 0.5);
}

TEST(MeasureError, PointsAreThoseOfTheBake) {
    const TemporaryDirectory folder;
    const JudgedBundle bundle = readJudgedBundle(makeBundle(folder, {.projection = ProjectionKind::Plain}));
    const RayCaster caster(bundle.scene.positions, bundle.scene.indices);
    const JudgedPoints all = judgedPoints(bundle, caster, 0), some = judgedPoints(bundle, caster, 10);
    EXPECT_EQ(some.place.size(), 10u);
    size_t valid = 0;
    for (const Validity validity : bundle.visibility.validity) valid += validity == Validity::Valid;
    ASSERT_EQ(all.place.size(), valid);
    for (size_t p = 0; p < valid; ++p) {
        double sum = 0;
        for (uint32_t k = all.parts.firstPoint[p]; k < all.parts.firstPoint[p + 1]; ++k)
            sum += double(all.parts.share[k]);
        EXPECT_NEAR(sum, 1, 1e-6);
        EXPECT_GT(all.parts.normals[p].dot(bundle.visibility.normals[all.place[p]]), 0.9999f);
    }
    // As many directions find nearly the same coefficients.
    const std::vector<float> again = bakeJudgedPoints(caster, all, 4, 512, bundle.visibility.projection);
    double difference = 0, square = 0;
    for (size_t p = 0; p < valid; ++p)
        for (size_t i = 0; i < 16; ++i) {
            const double c = double(bundle.visibility.coefficients[all.place[p] * 16 + i]);
            difference += std::pow(c - double(again[p * 16 + i]), 2);
            square += c * c;
        }
    EXPECT_LT(std::sqrt(difference / square), 0.03);
}

TEST(MeasureError, RefusesAnotherMesh) {
    const TemporaryDirectory folder;
    JudgedBundle bundle = readJudgedBundle(makeBundle(folder, {}));
    for (Vec2f& uv : bundle.scene.uv1) uv = Vec2f(uv.y(), 1 - uv.x());
    const RayCaster caster(bundle.scene.positions, bundle.scene.indices);
    EXPECT_THROW(judgedPoints(bundle, caster, 10), InputError);
    EXPECT_THROW(readJudgedBundle(folder.file("none.prt")), InputError);
}

TEST(MeasureError, StopsWhenInterrupted) {
    requestInterrupt();
    EXPECT_THROW(errorsOf({}, {"sky:uniform"}, smallErrorStudy()), Interrupted);
    clearInterrupt();
}

TEST(ErrorAdvice, ChangesOneOption) {
    EXPECT_EQ(withOption("prt precompute a.obj -o b --order 6 --error 0.01", "--order", "8"),
              "prt precompute a.obj -o b --order 8 --error 0.01");
    EXPECT_EQ(withOption("prt precompute a.obj --rays 64", "--rays", "128"),
              "prt precompute a.obj --rays 128");
    EXPECT_EQ(withOption("prt precompute a.obj", "--order", "8"), "prt precompute a.obj --order 8");
}

TEST(ErrorAdvice, TurnsTheKnobThatGainsMost) {
    JudgedBundle bundle;
    bundle.visibility.shOrder = 6;
    bundle.visibility.projection.kind = ProjectionKind::Irradiance;
    bundle.visibility.attributes = {{"rays", "adaptive"}, {"errorBound", "0.01"}};
    bundle.bakeCommand = "prt precompute a.obj -o b.prt --order 6 --error 0.01";
    ErrorResult result;
    result.isCompressed = true;
    result.components = 12;
    ErrorStudy study;
    result.mean.total.relativeRmse = 0.1;
    for (const ErrorStage stage : kStages) result.mean.without[size_t(stage)].relativeRmse = 0.1;
    const auto advice = [&](ErrorStage stage) {
        ErrorResult changed = result;
        changed.mean.without[size_t(stage)].relativeRmse = 0.05;
        const auto knobs = knobsOf("b.prt", bundle, changed, study, {"sky:clear"});
        EXPECT_LE(knobs.size(), 1u);
        if (knobs.empty()) return std::string();
        EXPECT_EQ(knobs[0].stage, stage);
        EXPECT_NEAR(knobs[0].gain, 0.05, 1e-12);
        return knobs[0].command;
    };
    EXPECT_EQ(advice(ErrorStage::Truncation),
              "prt precompute a.obj -o b.prt --order 8 --error 0.01 && prt compress b.prt --components 22");
    EXPECT_EQ(advice(ErrorStage::Sampling), "prt precompute a.obj -o b.prt --order 6 --error 0.005");
    EXPECT_EQ(advice(ErrorStage::Projection), "");  // weighted already
    EXPECT_EQ(advice(ErrorStage::Pca), "prt compress b.prt --components 18");
    EXPECT_EQ(advice(ErrorStage::Quantisation), "prt export b.prt -o FOLDER --weights unorm16 --tables half");
    EXPECT_EQ(advice(ErrorStage::Tables),
              "prt tabulate b.prt sky:clear --kind triple-product --layout cube --size 64");
    // The bands that are missing, where they lose more than the lookup.
    study.table.variant = "paper";
    result.mean.bands.relativeRmse = 0.01;
    EXPECT_EQ(advice(ErrorStage::Tables),
              "prt tabulate b.prt sky:clear --kind triple-product --layout cube --size 32");
    study.table.variant = "exact";
    EXPECT_EQ(advice(ErrorStage::Tables), "");
    bundle.visibility.shOrder = 10;
    EXPECT_EQ(advice(ErrorStage::Truncation), "");
    bundle.visibility.attributes = {{"rays", "256"}};
    EXPECT_EQ(advice(ErrorStage::Sampling),
              "prt precompute a.obj -o b.prt --order 6 --error 0.01 --rays 512");
    bundle.visibility.projection.kind = ProjectionKind::Plain;
    EXPECT_EQ(advice(ErrorStage::Projection),
              "prt precompute a.obj -o b.prt --order 6 --error 0.01 --projection irradiance");
    EXPECT_TRUE(knobsOf("b.prt", bundle, result, study, {}).empty());
    EXPECT_EQ(knobText({}, 0.1), "no knob gains more than the noise of this measurement\n");

    // The best comes first, and last on the terminal; what gains less than the noise not at all.
    result.mean.without[size_t(ErrorStage::Sampling)].relativeRmse = 0.09;
    result.mean.without[size_t(ErrorStage::Pca)].relativeRmse = 0.08;
    result.mean.without[size_t(ErrorStage::Quantisation)] = {.relativeRmse = 0.07, .noise = 0.04};
    const auto knobs = knobsOf("b.prt", bundle, result, study, {});
    ASSERT_EQ(knobs.size(), 2u);
    EXPECT_EQ(knobs[0].stage, ErrorStage::Pca);
    EXPECT_EQ(knobs[1].stage, ErrorStage::Sampling);
    EXPECT_EQ(knobText(knobs, 0.1),
              "then: sampling (0.1000 would become 0.0900 if it were exact): " + knobs[1].command +
                  "\nturn first: pca (0.1000 would become 0.0800 if it were exact): " + knobs[0].command +
                  "\n");
}

TEST(ErrorImages, RampRunsFromDarkToBright) {
    int last = -1;
    for (int k = 0; k <= 32; ++k) {
        const auto c = rampColour(k / 32.0);
        const int luma = 2 * c[0] + 7 * c[1] + c[2];
        EXPECT_GT(luma, last) << k;
        last = luma;
    }
    EXPECT_EQ(rampColour(-1), rampColour(0));
    EXPECT_EQ(rampColour(7), rampColour(1));
}

}  // namespace
}  // namespace prt::tools
