#include "tools/report.h"

#include <limits>

#include "precompute/base/error.h"

namespace prt::tools {
namespace {

TEST(Report, KeepsOrderAndNests) {
    Report inner, report;
    inner.set("technique", "unc").set("relative_rmse", 0.5);
    std::vector<Report> rows;
    rows.push_back(std::move(inner));
    report.set("zeta", 1)
        .set("alpha", true)
        .set("rows", rows)
        .set("psnr_db", std::numeric_limits<double>::infinity());
    const std::string text = report.text();
    EXPECT_LT(text.find("zeta"), text.find("alpha"));
    EXPECT_NE(text.find("\"technique\": \"unc\""), std::string::npos);
    EXPECT_NE(text.find("\"psnr_db\": null"), std::string::npos);
}

TEST(Report, RefusesAnUnwritableFile) {
    EXPECT_THROW(Report().write("/nonexistent-folder/report.json"), OutputError);
}

}  // namespace
}  // namespace prt::tools
