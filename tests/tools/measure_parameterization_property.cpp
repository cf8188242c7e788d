// Figure 8 of [IwanickiSloan2012] by its own protocol: a million directions, orders 3 and 6. One test,
// because every test is a process of its own and the figure takes seconds.
#include <cmath>
#include <numbers>

#include "precompute/base/log.h"
#include "precompute/math/sphere_map.h"
#include "tools/measure/parameterization.h"

namespace prt::tools {
namespace {

using Rows = std::vector<ParameterizationRow>;

const std::vector<std::string> kPaper = {"cube", "cube-seamless", "dual-paraboloid", "dual-orthographic"};

Rows curve(const Rows& all, int shOrder, const std::string& layout, const std::string& table = "float") {
    Rows rows;
    for (const ParameterizationRow& row : all)
        if (row.shOrder == shOrder && row.layout == layout && row.table == table) rows.push_back(row);
    return rows;
}

double mseAtSize(const Rows& all, int shOrder, const std::string& layout, int size) {
    for (const ParameterizationRow& row : curve(all, shOrder, layout))
        if (row.size == size) return row.mse;
    ADD_FAILURE() << layout << " has no size " << size;
    return 0;
}

/// On the log-log line through the two points nearest in samples.
double mseAtSamples(const Rows& all, int shOrder, const std::string& layout, double samples) {
    const Rows rows = curve(all, shOrder, layout);
    size_t i = 1;
    while (i + 1 < rows.size() && rows[i].samples < samples) ++i;
    const double f =
        std::log(samples / rows[i - 1].samples) / std::log(double(rows[i].samples) / rows[i - 1].samples);
    return rows[i - 1].mse * std::pow(rows[i].mse / rows[i - 1].mse, f);
}

void expectKnownErrorsNear384Samples(const Rows& all) {
    EXPECT_NEAR(mseAtSize(all, 3, "cube-seamless", 8), 2.43e-5, 0.05e-5);
    EXPECT_NEAR(mseAtSize(all, 3, "cube", 8), 5.4e-5, 0.27e-5);
    EXPECT_NEAR(mseAtSize(all, 3, "dual-paraboloid", 14), 5.7e-5, 0.28e-5);     // 392 samples
    EXPECT_NEAR(mseAtSize(all, 3, "dual-orthographic", 14), 1.1e-3, 0.055e-3);  // 392 samples
}

void expectSeamlessCubeIsTheBestOfThePapersFour(const Rows& all, int shOrder) {
    const Rows seamless = curve(all, shOrder, "cube-seamless");
    ASSERT_EQ(seamless.size(), 10u);
    for (const ParameterizationRow& row : seamless)
        for (const std::string& other : kPaper) {
            if (other == row.layout) continue;
            EXPECT_LT(row.mse * 1.1, mseAtSamples(all, shOrder, other, row.samples))
                << other << ' ' << row.size;
        }
}

void expectOrthographicIsTheWorst(const Rows& all, int shOrder) {
    for (const ParameterizationRow& row : curve(all, shOrder, "dual-orthographic"))
        for (const SphereMapFamily& family : sphereMapFamilies()) {
            if (family.name == row.layout) continue;
            EXPECT_GT(row.mse, 1.4 * mseAtSamples(all, shOrder, family.name, row.samples)) << family.name;
        }
}

/// Bilinear interpolation errs by h², squared h⁴. Along edges and at corners, where the surface of the cube
/// is bent, by h on a strip of width h, squared h³, which shows at large sizes; faces apart do so at once.
void expectErrorsFallAsInterpolationPredicts(const Rows& all, int shOrder) {
    for (const int size : {4, 8, 16, 32}) {
        const auto exponent = [&](const std::string& layout) {
            return std::log2(mseAtSize(all, shOrder, layout, size) /
                             mseAtSize(all, shOrder, layout, 2 * size));
        };
        EXPECT_GT(exponent("cube-seamless"), 3.5) << size;
        EXPECT_LT(exponent("cube-seamless"), 4.2) << size;
        EXPECT_GT(exponent("cube"), 3.0) << size;
        EXPECT_LT(exponent("cube"), 3.8) << size;
    }
}

/// Half floats of v lie 2^-11 to 2^-10 times |v| apart, which is a variance of a twelfth of the square; the
/// mean of v² is 1/4π, and filtering never makes more of it. Below 3,000 samples it is lost in what the
/// texels leave.
void expectHalfFloatsAddTheirRounding(const Rows& all, int shOrder) {
    const double largest = std::pow(2, -20) / 12 / (4 * std::numbers::pi);
    for (const SphereMapFamily& family : sphereMapFamilies()) {
        const Rows floats = curve(all, shOrder, family.name),
                   halves = curve(all, shOrder, family.name, "half");
        ASSERT_EQ(floats.size(), halves.size());
        for (size_t i = 0; i < floats.size(); ++i) {
            if (floats[i].samples < 3000) {
                EXPECT_NEAR(halves[i].mse / floats[i].mse, 1, 0.01) << family.name << ' ' << floats[i].size;
            }
        }
        if (family.name == "dual-orthographic") continue;  // errs too much to the last
        const double added = halves.back().mse - floats.back().mse;
        EXPECT_GT(added, largest / 16) << family.name;
        EXPECT_LT(added, largest) << family.name;
    }
}

TEST(Figure8, HoldsForAMillionDirections) {
    setQuiet(true);
    ParameterizationSettings settings;
    for (const SphereMapFamily& family : sphereMapFamilies()) settings.layouts.push_back(family.name);
    settings.half = true;
    const Rows all = measureParameterization(settings);
    expectKnownErrorsNear384Samples(all);
    for (const int n : {3, 6}) {
        SCOPED_TRACE(testing::Message() << "order " << n);
        expectSeamlessCubeIsTheBestOfThePapersFour(all, n);
        expectOrthographicIsTheWorst(all, n);
        expectErrorsFallAsInterpolationPredicts(all, n);
        expectHalfFloatsAddTheirRounding(all, n);
    }
}

}  // namespace
}  // namespace prt::tools
