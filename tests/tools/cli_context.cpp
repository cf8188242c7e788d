// prt relight --context: the same result wherever it is drawn, and clear words where it cannot be.
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/tools/prt_process.h"

namespace prt::test {
namespace {

class ContextOption : public testing::Test {
  protected:
    void SetUp() override {
        folder_.write("box.obj", openBoxObj());
        for (const std::vector<std::string>& arguments :
             {std::vector<std::string>{"precompute", "box.obj", "-o", "box.prt", "--texels", "64", "--rays",
                                       "64", "--order", "3", "--quiet"},
              std::vector<std::string>{"compress", "box.prt", "--components", "4", "--quiet"}})
            ASSERT_EQ(runPrt(folder_, arguments).exitCode, 0);
    }
    ProcessResult relight(const std::vector<std::string>& options, const std::string& prelude = "") {
        std::vector<std::string> arguments = {"relight", "box.prt", "--size", "64x48", "--compare-reference",
                                              "--json",  "-"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return runPrt(folder_, arguments, prelude);
    }
    Folder folder_;
};

TEST_F(ContextOption, EglGivesWhatOsMesaGives) {
    const ProcessResult egl = relight({"--context", "egl"});
    if (egl.exitCode == 3 && egl.err.find("OpenGL: ") != std::string::npos) GTEST_SKIP() << egl.err;
    ASSERT_EQ(egl.exitCode, 0) << egl.err;
    const ProcessResult osMesa = relight({});
    ASSERT_EQ(osMesa.exitCode, 0) << osMesa.err;
    const auto a = nlohmann::json::parse(osMesa.out), b = nlohmann::json::parse(egl.out);
    EXPECT_EQ(a["context"], "osmesa");
    EXPECT_EQ(b["context"], "egl");
    EXPECT_FALSE(b["renderer"].get<std::string>().empty());
    EXPECT_EQ(a["covered_pixels"], b["covered_pixels"]);
    ASSERT_EQ(a["rows"].size(), b["rows"].size());
    for (size_t row = 0; row < a["rows"].size(); ++row) {
        EXPECT_EQ(a["rows"][row]["technique"], b["rows"][row]["technique"]);
        // Both pictures are at this distance from one truth, and at most 1e-3 apart.
        EXPECT_NEAR(a["rows"][row]["relative_rmse"].get<double>(),
                    b["rows"][row]["relative_rmse"].get<double>(), 1e-3);
    }
}

TEST_F(ContextOption, SaysWhatIsMissing) {
    const ProcessResult noEgl = relight({"--context", "egl"}, "export PRT_EGL_LIBRARY=libNoSuchEGL.so.1;");
    EXPECT_EQ(noEgl.exitCode, 3);
    EXPECT_NE(noEgl.err.find("libNoSuchEGL.so.1 cannot be loaded"), std::string::npos) << noEgl.err;
    EXPECT_EQ(std::count(noEgl.err.begin(), noEgl.err.end(), '\n'), 1) << noEgl.err;
    // OSMesa does not need it.
    EXPECT_EQ(relight({}, "export PRT_EGL_LIBRARY=libNoSuchEGL.so.1;").exitCode, 0);
    const ProcessResult unknown = relight({"--context", "window"});
    EXPECT_EQ(unknown.exitCode, 2);
    EXPECT_NE(unknown.err.find("--context"), std::string::npos) << unknown.err;
}

}  // namespace
}  // namespace prt::test
