// `prt measure basis` from its arguments to its files, and its pictures.
#include <cmath>
#include <fstream>
#include <sstream>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "tools/measure/basis_functions.h"
#include "tools/measure/commands.h"

namespace prt::tools {
namespace {

class MeasureBasis : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() /
                  ("prt-basis-" + std::to_string(::getpid()) + "-" +
                   testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override {
        std::filesystem::remove_all(folder_);
        setQuiet(false);
        setThreadCount(0);
    }
    /// @return what is printed; PREFIX is in the folder
    std::string run(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"basis", "-o", path("x"), "--quiet"});
        std::vector<char*> argv;
        for (std::string& argument : arguments) argv.push_back(argument.data());
        testing::internal::CaptureStdout();
        try {
            runMeasureBasis(int(argv.size()), argv.data());
        } catch (...) {
            testing::internal::GetCapturedStdout();
            throw;
        }
        return testing::internal::GetCapturedStdout();
    }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::string read(const std::string& name) const {
        std::ifstream file(path(name));
        std::ostringstream text;
        text << file.rdbuf();
        return text.str();
    }
    std::filesystem::path folder_;
};

size_t lines(const std::string& text) { return size_t(std::count(text.begin(), text.end(), '\n')); }

TEST_F(MeasureBasis, Irradiance) {
    const std::string out =
        run({"--signal", "irradiance", "--signals", "8", "--plot", "none", "--json", path("x.json")});
    EXPECT_NE(out.find("sqrt"), std::string::npos);
    // 2 models × (smooth + 4 numbers of lights with and without + 2 sums) × 16 candidates × 2 projections
    EXPECT_EQ(lines(read("x.csv")), 1 + 2u * 11 * 16 * 2);
    EXPECT_EQ(lines(read("x-ratios.csv")), 1 + 2u * 11);
    EXPECT_EQ(lines(read("x-cost.csv")), 1 + 14u);
    const std::string json = read("x.json");
    for (const char* text :
         {"\"rows\"", "\"signal\": \"lights-20-sh\"", "\"basis\": \"hsh\"", "\"imse\"", "\"coefficients\": 6",
          "\"projection\": \"sh9\"", "\"ratios\"", "\"cost\"", "\"ns_per_evaluation\"", "\"cpu\""})
        EXPECT_NE(json.find(text), std::string::npos) << text;
}

TEST_F(MeasureBasis, IrradianceOfEnvironments) {
    run({"--env", "sky:sunset", "--env", "sky:overcast", "--orientations", "1", "--plot", "none"});
    const std::string csv = read("x.csv");
    EXPECT_NE(csv.find("environment:sky:sunset,above"), std::string::npos);
    EXPECT_NE(csv.find("environment:sky:overcast,sphere"), std::string::npos);
    EXPECT_EQ(lines(csv), 1 + 3u * 2 * 16 * 2);
}

TEST_F(MeasureBasis, Lobes) {
    for (const auto& [signal, lobes] : {std::pair("phong", 6u), {"ward", 16u}}) {
        run({"--signal", signal, "--max-order", "2", "--orientations", "1", "--env", "sky:overcast", "--plot",
             "none", "--json", path("x.json")});
        // 4 families of 2 orders, and esh and zernike of 1 and 3 functions
        EXPECT_EQ(lines(read("x.csv")), 1 + lobes * 12) << signal;
        EXPECT_EQ(lines(read("x-wrong_light.csv")), 1 + 4u * 4);
        const std::string json = read("x.json");
        for (const char* text : {"\"accuracy\"", "\"stored\": 4", "\"wrong_light\"", "\"relative_rms\""})
            EXPECT_NE(json.find(text), std::string::npos) << text;
    }
}

TEST_F(MeasureBasis, PicturesOfTheChosenBases) {
    const std::string out = run({"--signal", "functions", "--bases", "h,zernike", "--order", "4"});
    EXPECT_EQ(lines(read("x.csv")), 1 + 6u + 10u);  // H ends at its third order
    if (out.find("x-h.svg") == std::string::npos) GTEST_SKIP() << "gnuplot is not installed";
    EXPECT_NE(read("x-h.svg").find("H5"), std::string::npos);
    EXPECT_NE(read("x-zernike.svg").find("n = 3, m = -3"), std::string::npos);
}

TEST_F(MeasureBasis, BadArguments) {
    EXPECT_THROW(run({"--signal", "cosine"}), UsageError);
    EXPECT_THROW(run({"--signal", "phong", "--bases", "sh"}), UsageError);
    EXPECT_THROW(run({"--signal", "functions", "--bases", "fourier"}), UsageError);
    EXPECT_THROW(run({"--signal", "functions", "--env", "sky:clear"}), UsageError);
    EXPECT_THROW(run({"--signals", "0"}), UsageError);
    EXPECT_THROW(run({"--max-order", "17"}), UsageError);
    EXPECT_THROW(run({"--env", path("missing.exr")}), InputError);
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(MeasureBasis, AnInterruptEndsIt) {
    requestInterrupt();
    EXPECT_THROW(run({"--plot", "none"}), Interrupted);
    EXPECT_THROW(run({"--signal", "ward", "--plot", "none"}), Interrupted);
    clearInterrupt();
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST(BasisPictures, EveryFamilyHasItsPlaces) {
    for (const BasisFamily& family : basisFamilies()) {
        const auto basis = makeBasis(family.name, std::min(3, family.maxOrder));
        const auto labels = functionLabels(*basis);
        ASSERT_EQ(labels.size(), size_t(basis->count())) << family.name;
        const Figure figure = basisFigure(*basis, "title");
        size_t drawn = 0;
        for (const Panel& panel : figure.panels) {
            if (panel.surface.points.empty()) continue;
            ++drawn;
            double largest = 0;
            for (const auto& [x, y, z, value] : panel.surface.points) {
                // a point lies in its direction at the distance |f|
                EXPECT_NEAR(std::sqrt(x * x + y * y + z * z), std::abs(value), 1e-12);
                EXPECT_GE(z, basis->domain() == BasisDomain::UpperHemisphere ? 0 : -1);
                largest = std::max(largest, std::abs(value));
            }
            EXPECT_NEAR(largest, 1, 1e-12);
        }
        EXPECT_EQ(drawn, labels.size()) << family.name;
    }
    const auto labels = functionLabels(*makeBasis("esh", 3));
    EXPECT_EQ(labels[4].title, "l = 2, m = 0");
    Table table = functionTable();
    addFunctionRows(*makeBasis("h", 2), table);
    EXPECT_EQ(table.rowCount(), 4u);
    // H3 = √(3/2π) (2z − 1) runs from −0.69 to 0.69
    EXPECT_NEAR(std::get<double>(table.cell(2, "lowest")), -0.690988298942671, 1e-12);
    EXPECT_NEAR(std::get<double>(table.cell(2, "highest")), 0.690988298942671, 1e-12);
}

}  // namespace
}  // namespace prt::tools
