// prt measure rotation: errors against closed forms, the paper's facts and the rotated function, counts
// against the kernels, and what the command writes and refuses.
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/math/directions.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation_taylor_bands.h"
#include "tests/base/temporary_directory.h"
#include "tests/tools/run_command.h"
#include "tools/measure/basis_signals.h"
#include "tools/measure/commands.h"
#include "tools/measure/rotation_tables.h"

namespace prt::tools {
namespace {

constexpr ShTaylorOrder kOrders[] = {ShTaylorOrder::One, ShTaylorOrder::OneAndHalf, ShTaylorOrder::Two};

/// [3] by order of expansion.
std::vector<TaylorError> errorsAt(int shOrder, double betaDeg) {
    return taylorErrors(shOrder, std::array<double, 1>{betaDeg});
}

TEST(MeasureTaylorErrors, KnownNumbers) {
    const TaylorError error = errorsAt(6, 10)[1];
    EXPECT_EQ(error.taylorOrder, ShTaylorOrder::OneAndHalf);
    EXPECT_NEAR(error.mean / 0.053, 1, 0.01);
    EXPECT_NEAR(error.rms / 0.074, 1, 0.01);
    EXPECT_NEAR(error.max / 0.202, 1, 0.01);
    const std::vector<TaylorError> large = errorsAt(8, 25);
    EXPECT_NEAR(large[0].max / 3.58, 1, 0.003);
    EXPECT_NEAR(large[1].max / 3.79, 1, 0.003);
    EXPECT_NEAR(large[2].max / 3.99, 1, 0.003);
}

TEST(MeasureTaylorErrors, AreThoseOfTheEigenvalues) {
    // exp(βG) has the eigenvalues e^(imβ), −l <= m <= l, in band l, and so has its series: D is normal.
    for (const int n : {1, 3, 8})
        for (const double betaDeg : {0.0, 4.0, 25.0}) {
            const std::vector<TaylorError> errors = errorsAt(n, betaDeg);
            for (const TaylorError& error : {errors[0], errors[2]}) {
                double mean = 0, square = 0, most = 0;
                for (int l = 0; l < n; ++l)
                    for (int m = -l; m <= l; ++m) {
                        const double x = m * betaDeg * std::numbers::pi / 180;
                        const double second = error.taylorOrder == ShTaylorOrder::Two ? x * x / 2 : 0;
                        const double value = std::hypot(std::cos(x) - 1 + second, std::sin(x) - x);
                        mean += value / (n * n);
                        square += value * value / (n * n);
                        most = std::max(most, value);
                    }
                EXPECT_NEAR(error.mean, mean, 1e-12);
                EXPECT_NEAR(error.rms, std::sqrt(square), 1e-12);
                EXPECT_NEAR(error.max, most, 1e-12);
            }
        }
}

TEST(MeasureTaylorErrors, FallWithTheOrderOfExpansionAtSmallAnglesOnly) {
    for (const int n : {5, 8})
        for (const double betaDeg : {1.0, 3.0, 5.0, 10.0}) {
            const std::vector<TaylorError> errors = errorsAt(n, betaDeg);
            for (double TaylorError::*value :
                 {&TaylorError::max, &TaylorError::mean, &TaylorError::rms, &TaylorError::phong}) {
                EXPECT_LT(errors[1].*value, 0.9 * errors[0].*value) << n << ' ' << betaDeg;
                EXPECT_LT(errors[2].*value, 0.9 * errors[1].*value) << n << ' ' << betaDeg;
            }
        }
    const std::vector<TaylorError> large = errorsAt(8, 25);
    EXPECT_GT(large[1].max, 1.03 * large[0].max);
    EXPECT_GT(large[2].max, 1.03 * large[1].max);
}

TEST(MeasureTaylorErrors, PhongIsTheDistanceFromTheTurnedLobe) {
    const int n = 6;
    const double beta = 15 * std::numbers::pi / 180;
    const auto lobe = [](double tilt) {
        const Vec3d axis(std::sin(tilt), 0, std::cos(tilt));
        return projectSh(n, [&](const Vec3d& d) { return std::pow(std::max(0.0, d.dot(axis)), 7); });
    };
    const std::vector<double> still = lobe(0), turned = lobe(beta);
    const std::vector<TaylorError> errors = errorsAt(n, 15);
    for (size_t k = 0; k < 3; ++k) {
        std::vector<double> approximate(still.size());
        rotateShYTaylor(beta, kOrders[k], n, std::span<const double>(still), std::span<double>(approximate));
        double square = 0, length = 0;
        for (size_t i = 0; i < still.size(); ++i) {
            square += std::pow(approximate[i] - turned[i], 2);
            length += still[i] * still[i];
        }
        // the quadrature of a function with seven derivatives
        EXPECT_NEAR(errors[k].phong, std::sqrt(square), 1e-8);
        EXPECT_NEAR(errors[k].phongRelative, std::sqrt(square / length), 1e-8);
        EXPECT_GT(errors[k].phong, 1e-3);
    }
}

TEST(MeasureHshErrors, TheLobeTiltedFurtherIsTheLobeTurnedAndClipped) {
    const DirectionFunction lobe = phongLobe(kHshLobeTiltDeg).function;
    for (const double betaDeg : {0.0, 5.0, 20.0, double(kMaxHshBetaDeg)}) {
        const DirectionFunction further = phongLobe(kHshLobeTiltDeg + betaDeg).function;
        const Mat3d back = rotationAboutUp(betaDeg * std::numbers::pi / 180).transpose();
        for (const Vec3f& direction : randomDirections(500, 7)) {
            const Vec3d d = direction.cast<double>().normalized(), source = back * d;
            const double expected = d.z() < 0 || source.z() < 0 ? 0 : lobe(source);
            EXPECT_NEAR(d.z() < 0 ? 0 : further(d), expected, 1e-12);
        }
    }
}

TEST(MeasureHshErrors, RowsAreCompleteAndNothingIsLostWithoutATurn) {
    EXPECT_THAT(hshIntermediateOrders(5), testing::ElementsAre(5, 7, 10, 24));
    EXPECT_THAT(hshIntermediateOrders(20), testing::ElementsAre(20, 24));
    const std::vector<HshError> errors = hshErrors(3, 15);
    ASSERT_EQ(errors.size(), (4 + 2 + 3) * 4u);
    for (size_t i = 0; i < errors.size(); ++i) {
        EXPECT_EQ(errors[i].betaDeg, 15.0 * double(i % 4));
        EXPECT_EQ(errors[i].shOrder != 0, errors[i].method == kHshThroughSh);
        if (errors[i].betaDeg != 0) {
            EXPECT_GT(errors[i].relativeError, 1e-3);
        } else if (errors[i].shOrder == 0) {
            EXPECT_LT(errors[i].relativeError, 2e-6);
        }
    }
}

TEST(MeasureHshErrors, InterpolationErrorFallsWithTheNumberOfAngles) {
    const std::vector<HshTableError> errors = hshTableErrors(3);
    ASSERT_EQ(errors.size(), 2 * 9u);
    for (size_t i = 2; i < errors.size(); ++i) {
        EXPECT_EQ(errors[i].method, errors[i - 2].method);
        EXPECT_GT(errors[i].tabulatedAngles, errors[i - 2].tabulatedAngles);
        EXPECT_LT(errors[i].interpolationError, errors[i - 2].interpolationError);
        // n = 3: blocks of 6 and of 3 functions
        EXPECT_EQ(errors[i].bytes, size_t(errors[i].tabulatedAngles) * (36 + 9) * sizeof(float));
    }
    // Five times the angles, at least as good as power 3/2.
    EXPECT_EQ(errors[10].tabulatedAngles * 5 - 4, errors[16].tabulatedAngles);
    EXPECT_LT(errors[16].interpolationError, errors[10].interpolationError / std::pow(5, 1.5));
}

// A number that counts its multiplications: the kernels run on it as on floats.
struct Counted {
    static inline int multiplications = 0;
};
Counted operator+(Counted, Counted) { return {}; }
Counted operator-(Counted, Counted) { return {}; }
Counted operator*(Counted, Counted) {
    ++Counted::multiplications;
    return {};
}
/// A constant; ±1 costs nothing.
struct CountedConstant {
    double value;
    constexpr CountedConstant(double v) : value(v) {}
    constexpr bool operator!=(int other) const { return value != other; }
};
Counted operator+(CountedConstant, Counted) { return {}; }
Counted operator*(CountedConstant a, Counted) {
    Counted::multiplications += std::abs(std::abs(a.value) - 1) > 1e-11;
    return {};
}

constexpr auto kIn = [](auto&&...) { return Counted(); };
constexpr auto kOut = [](auto&&...) {};
constexpr auto kBands = std::make_index_sequence<detail::kUnrolledBands>();

int countZxzxz(int n) {
    Counted::multiplications = 0;
    detail::rotateUnrolledBands<CountedConstant, Counted>(n, detail::ZyzMultiples<Counted>(), kIn, kOut,
                                                          kBands);
    return Counted::multiplications;
}
template <int kTwiceOrder>
int countTaylor(int n) {
    Counted::multiplications = -2;  // β²/2, which is no part of the vector's
    detail::rotateUnrolledTaylorBands<CountedConstant, kTwiceOrder, Counted>(
        n, detail::ZyzMultiples<Counted>(), Counted(), kIn, kOut, kBands);
    return Counted::multiplications;
}

TEST(MeasureRotationCosts, MultiplicationsAreThoseOfTheKernels) {
    RotationCostSettings settings{
        .shOrders = {}, .methods = {"zxzxz", "taylor-1", "taylor-1.5-batch", "taylor-2"}, .rounds = 0};
    for (int n = 1; n <= detail::kUnrolledBands; ++n) settings.shOrders.push_back(n);
    const std::vector<RotationCost> costs = rotationCosts(settings);
    ASSERT_EQ(costs.size(), 4 * settings.shOrders.size());
    for (size_t i = 0; i < costs.size(); i += 4) {
        const int n = costs[i].shOrder;
        EXPECT_EQ(costs[i].multiplications, countZxzxz(n)) << n;
        EXPECT_EQ(costs[i + 1].multiplications, countTaylor<2>(n)) << n;
        EXPECT_EQ(costs[i + 2].multiplications, countTaylor<3>(n)) << n;
        EXPECT_EQ(costs[i + 3].multiplications, countTaylor<4>(n)) << n;
        EXPECT_LE(costs[i].multiplications, costs[i].paperMultiplications);
        EXPECT_LE(costs[i + 2].multiplications, costs[i + 2].paperMultiplications);
    }
}

TEST(MeasureRotationCosts, PapersNumbersStandBesideTheirMethods) {
    const std::vector<RotationCost> costs =
        rotationCosts({.shOrders = {6, 7}, .methods = rotationMethods(), .rounds = 0});
    ASSERT_EQ(costs.size(), 2 * rotationMethods().size());
    const auto find = [&](int n, const std::string& method) {
        const auto found = std::find_if(costs.begin(), costs.end(), [&](const RotationCost& c) {
            return c.shOrder == n && c.method == method;
        });
        return found == costs.end() ? RotationCost() : *found;
    };
    EXPECT_EQ(find(6, "zxzxz").paperMultiplications, 332);
    EXPECT_EQ(find(6, "taylor-1.5").paperMultiplications, 300);
    EXPECT_EQ(find(6, "ivanic-apply").paperMultiplications, 286);
    EXPECT_EQ(find(6, "one-matrix-batch").multiplications, 286);
    EXPECT_TRUE(std::isnan(find(6, "ivanic").multiplications));
    EXPECT_TRUE(std::isnan(find(6, "taylor-2").paperMultiplications));
    EXPECT_EQ(find(6, "taylor-1.5").paperUs, 0.68);
    EXPECT_EQ(find(6, "zxzxz").paperUs, 2.96);
    EXPECT_EQ(find(6, "ivanic").paperUs, 10.1);
    EXPECT_TRUE(std::isnan(find(7, "zxzxz").paperUs));
    EXPECT_TRUE(std::isnan(find(6, "zxzxz").ns));
}

void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "rotation");
    test::runCommand(runMeasureRotation, arguments);
}

std::vector<std::string> linesOf(const std::string& path) {
    std::istringstream csv(readFile(path));
    std::vector<std::string> lines;
    for (std::string line; std::getline(csv, line);) lines.push_back(line);
    return lines;
}

TEST(MeasureRotationCommand, WritesCsvAndJson) {
    const TemporaryDirectory folder;
    const std::string prefix = folder.file("turn"), json = folder.file("turn.json");
    run({"--orders", "2-3", "--rounds", "1", "--error-orders", "4", "--max-angle", "3", "--hsh-orders", "2",
         "--table-angles", "5", "--plot", "none", "-o", prefix, "--json", json, "--quiet"});
    const std::vector<std::string> rows = linesOf(prefix + ".csv");
    ASSERT_EQ(rows.size(), 1 + 2 * rotationMethods().size());
    EXPECT_EQ(rows[0], "order,method,ns,ratio_to_zxzxz,multiplications,paper_multiplications,paper_us\r");
    EXPECT_TRUE(rows[1].starts_with("2,zxzxz,")) << rows[1];
    EXPECT_NE(rows[1].find(",1,"), std::string::npos) << rows[1];
    const std::vector<std::string> errors = linesOf(prefix + "-errors.csv");
    ASSERT_EQ(errors.size(), 1 + 3 * 4u);
    EXPECT_EQ(errors[0], "order,taylor_order,beta_deg,max,mean,rms,phong,phong_relative\r");
    EXPECT_TRUE(errors[8].starts_with("4,1.5,3,0.")) << errors[8];
    EXPECT_EQ(linesOf(prefix + "-hsh_errors.csv").size(), 1 + hshErrors(2).size());
    EXPECT_EQ(linesOf(prefix + "-hsh_tables.csv").size(), 1 + 18u);
    EXPECT_EQ(linesOf(prefix + "-paper_times.csv").size(), 1 + publishedRotationTimes().size());
    const std::string text = readFile(json);
    for (const char* key :
         {"\"rows\": [", "\"errors\": [", "\"hsh_errors\": [", "\"hsh_tables\": [", "\"paper_times\": [",
          "\"method\": \"hsh-digon-removal\"", "\"ns\": ", "\"taylor_order\": 1.5", "\"beta_deg\": 3.0",
          "\"max\": ", "\"mean\": ", "\"phong\": ", "\"paper_us\": null", "\"tabulated_angles\": 19"})
        EXPECT_NE(text.find(key), std::string::npos) << key;
}

TEST(MeasureRotationCommand, DrawsEveryFigure) {
    const std::vector<TaylorError> errors = errorsAt(3, 10);
    const Measurement measurement =
        rotationMeasurement({rotationCosts({.shOrders = {3}, .methods = {"zxzxz", "ivanic"}, .rounds = 1}),
                             errors, hshErrors(2, 15), hshTableErrors(2)});
    ASSERT_EQ(measurement.figures.size(), 3u);
    EXPECT_EQ(measurement.figures[0].second.panels.size(), 3u) << "no panel for batches without any";
    EXPECT_EQ(measurement.figures[1].second.panels.size(), 3u);
    EXPECT_EQ(measurement.figures[2].second.panels.size(), 2u);
    EXPECT_EQ(measurement.figures[2].second.panels[0].series.size(), 4 + 2 + 3u);
    EXPECT_NE(measurement.summary.find("through SH of order 24"), std::string::npos);
}

TEST(MeasureRotationCommand, RefusesWhatItCannotMeasure) {
    for (const std::vector<std::string>& bad :
         std::vector<std::vector<std::string>>{{"--orders", "11"},
                                               {"--orders", "0"},
                                               {"--orders", "three"},
                                               {"--methods", "zxzxz,quaternions"},
                                               {"--error-orders", "25"},
                                               {"--hsh-orders", "11"},
                                               {"--max-angle", "91"},
                                               {"--table-angles", "1"},
                                               {"--rounds", "0"},
                                               {"--plot", "bmp"}})
        EXPECT_THROW(run(bad), UsageError) << bad[0] << ' ' << bad[1];
}

TEST(MeasureRotation, StopsWhenInterrupted) {
    requestInterrupt();
    EXPECT_THROW(hshErrors(2), Interrupted);
    EXPECT_THROW(hshTableErrors(2), Interrupted);
    EXPECT_THROW(rotationCosts({.shOrders = {2}, .methods = {"zxzxz"}}), Interrupted);
    clearInterrupt();
}

}  // namespace
}  // namespace prt::tools
