// Tables, figures and lists of `prt measure`.
#include "tools/measure/output.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "precompute/base/error.h"
#include "tools/measure/timing.h"

namespace prt::tools {
namespace {

std::string readAll(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

class MeasureFiles : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() /
                  ("prt-measure-" + std::to_string(::getpid()) + "-" +
                   testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::filesystem::path folder_;
};

TEST(MeasureTable, CsvQuotesWhatNeedsItAndKeepsEveryDigit) {
    Table table({"name", "value", "count"});
    table.add({std::string("a,\"b\""), 0.1, uint64_t{18446744073709551615u}});
    table.add({std::string("plain"), 1e-300, uint64_t{0}});
    EXPECT_EQ(table.csv(),
              "name,value,count\r\n\"a,\"\"b\"\"\",0.1,18446744073709551615\r\nplain,1e-300,0\r\n");
    EXPECT_EQ(std::get<double>(table.cell(1, "value")), 1e-300);
}

TEST(MeasureTable, ValuesThereAreNoneOfAreEmpty) {
    Table table({"a", "b"});
    table.add({std::nan(""), uint64_t{1}});
    EXPECT_EQ(table.csv(), "a,b\r\n,1\r\n");
    EXPECT_EQ(table.text(), "a  b\n-  1\n");
    EXPECT_NE(table.reports()[0].text().find("\"a\": null"), std::string::npos);
}

TEST(MeasureTable, TextAlignsColumns) {
    Table table({"layout", "mse"});
    table.add({std::string("cube"), 0.5});
    table.add({std::string("dual-paraboloid"), 0.000123456});
    EXPECT_EQ(table.text(),
              "layout                 mse\ncube                   0.5\ndual-paraboloid  0.0001235\n");
}

TEST(MeasureTableDeathTest, WrongNumberOfCells) {
    Table table({"a", "b"});
    EXPECT_DEATH(table.add({1.0}), "");
    EXPECT_DEATH(table.cell(0, "a"), "");
}

TEST(MeasureLists, Integers) {
    EXPECT_EQ(parseIntegerList("--orders", "3,6", 1, 10), (std::vector<int>{3, 6}));
    EXPECT_EQ(parseIntegerList("--orders", "5-7,3,6", 1, 10), (std::vector<int>{3, 5, 6, 7}));
    for (const char* bad : {"", "x", "3,", "3;4", "0", "11", "7-5", "3-11", "4-", "-4", "3 "})
        EXPECT_THROW(parseIntegerList("--orders", bad, 1, 10), UsageError) << bad;
}

TEST(MeasureLists, Names) {
    const std::vector<std::string> allowed = {"sh", "hsh"};
    EXPECT_EQ(parseNameList("--bases", "hsh,sh,hsh", allowed), (std::vector<std::string>{"hsh", "sh"}));
    EXPECT_EQ(parseNameList("--bases", "all", allowed), allowed);
    for (const char* bad : {"", "sh,", "SH", "hsh sh"})
        EXPECT_THROW(parseNameList("--bases", bad, allowed), UsageError) << bad;
}

Figure threePanels() {
    Panel curves{.title = "curves \"quoted\" \\n_{x}",
                 .xLabel = "samples",
                 .yLabel = "MSE",
                 .logX = true,
                 .logY = true};
    curves.series.push_back({"one", {{1, 1}, {10, 0}, {100, std::nan("")}, {1000, 1e-3}}});
    Panel bars{.title = "bars", .yLabel = "IMSE", .logY = true};
    bars.bars = {{"SH", 0.1, 0}, {"HSH", 0.01, 1}};
    Panel surface{.title = "surface"};
    surface.surface = {2, 2, {{0, 0, 0, 1}, {0, 1, 0, 1}, {1, 0, 0, -1}, {1, 1, 1, -1}}};
    return {.title = "three", .columns = 2, .panels = {curves, bars, surface}};
}

TEST_F(MeasureFiles, FigureIsDrawnWholeWithGapsForWhatCannotBeShown) {
    const std::string script = gnuplotScript(threePanels(), "svg", path("x.svg"));
    EXPECT_NE(script.find("10 NaN\n100 NaN\n1000 0.001"), std::string::npos);
    if (!drawFigure(threePanels(), "svg", path("x.svg"))) GTEST_SKIP() << "gnuplot is not installed";
    const std::string svg = readAll(path("x.svg"));
    EXPECT_NE(svg.find("</svg>"), std::string::npos);
    EXPECT_NE(svg.find("curves"), std::string::npos);
    ASSERT_TRUE(drawFigure(threePanels(), "png", path("x.png")));
    EXPECT_EQ(readAll(path("x.png")).substr(1, 3), "PNG");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 2) << "no temporary is left";
    EXPECT_THROW(drawFigure(threePanels(), "svg", path("missing/x.svg")), OutputError);
}

TEST_F(MeasureFiles, MeasurementWritesCsvPlotAndJson) {
    Measurement measurement{.name = "test", .rows = Table({"order", "mse"})};
    measurement.rows.add({uint64_t{3}, 0.25});
    measurement.more.emplace_back("errors", Table({"max"}));
    measurement.figures.emplace_back("", threePanels());
    CommonOptions common;
    common.json = path("x.json");
    testing::internal::CaptureStdout();
    writeMeasurement(measurement, {.prefix = path("x"), .plot = "none"}, common, Report());
    EXPECT_NE(testing::internal::GetCapturedStdout().find("order   mse"), std::string::npos);
    EXPECT_EQ(readAll(path("x.csv")), "order,mse\r\n3,0.25\r\n");
    EXPECT_EQ(readAll(path("x-errors.csv")), "max\r\n");
    EXPECT_FALSE(std::filesystem::exists(path("x.svg")));
    const std::string json = readAll(path("x.json"));
    EXPECT_NE(json.find("\"measure\": \"test\""), std::string::npos);
    EXPECT_NE(json.find("\"mse\": 0.25"), std::string::npos);
    EXPECT_NE(json.find("\"errors\": []"), std::string::npos);
    EXPECT_THROW(writeMeasurement(measurement, {.prefix = path("missing/x")}, common, Report()), OutputError);
    EXPECT_THROW(checkMeasureOutput({.prefix = path("missing/x")}), OutputError);
    checkMeasureOutput({.prefix = path("y")});
    EXPECT_FALSE(std::filesystem::exists(path("y.csv")));
}

TEST(MeasureTiming, RunsEveryMethodAndCountsItems) {
    size_t calls[2] = {0, 0};
    const std::vector<double> ns =
        timeMethods({{"a", 1, [&] { ++calls[0]; }}, {"b", 1000, [&] { ++calls[1]; }}}, 3, 1e-5);
    ASSERT_EQ(ns.size(), 2u);
    EXPECT_GT(ns[0], 0);
    EXPECT_GT(ns[1], 0);
    EXPECT_GE(calls[0], 4u);
    EXPECT_GE(calls[1], 4u);
    EXPECT_FALSE(cpuName().empty());
}

}  // namespace
}  // namespace prt::tools
