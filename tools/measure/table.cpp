#include "tools/measure/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "precompute/base/check.h"

namespace prt::tools {
namespace {

std::string csvCell(const Cell& cell) {
    if (const auto* value = std::get_if<double>(&cell))
        return std::isnan(*value) ? "" : fmt::format("{}", *value);
    if (const auto* value = std::get_if<uint64_t>(&cell)) return fmt::format("{}", *value);
    const std::string& text = std::get<std::string>(cell);
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"') quoted += '"';
        quoted += c;
    }
    return quoted + '"';
}

std::string textCell(const Cell& cell) {
    if (const auto* value = std::get_if<double>(&cell))
        return std::isnan(*value) ? "-" : fmt::format("{:.4g}", *value);
    if (const auto* value = std::get_if<uint64_t>(&cell)) return fmt::format("{}", *value);
    return std::get<std::string>(cell);
}

}  // namespace

Table::Table(std::vector<std::string> columns) : columns_(std::move(columns)) {}

void Table::add(std::vector<Cell> cells) {
    PRT_CHECK_EQ(cells.size(), columns_.size());
    rows_.push_back(std::move(cells));
}

const Cell& Table::cell(size_t row, const std::string& column) const {
    PRT_CHECK_LT(row, rows_.size());
    const auto found = std::find(columns_.begin(), columns_.end(), column);
    PRT_CHECK(found != columns_.end());
    return rows_[row][size_t(found - columns_.begin())];
}

std::string Table::csv() const {
    std::string out = fmt::format("{}\r\n", fmt::join(columns_, ","));
    for (const auto& row : rows_) {
        for (size_t c = 0; c < row.size(); ++c) {
            if (c > 0) out += ',';
            out += csvCell(row[c]);
        }
        out += "\r\n";
    }
    return out;
}

std::string Table::text() const {
    std::vector<size_t> widths;
    for (size_t c = 0; c < columns_.size(); ++c) {
        size_t width = columns_[c].size();
        for (const auto& row : rows_) width = std::max(width, textCell(row[c]).size());
        widths.push_back(width);
    }
    std::string out;
    const auto line = [&](const auto& cellText, const auto& leftAligned) {
        std::string text;
        for (size_t c = 0; c < columns_.size(); ++c)
            text += leftAligned(c) ? fmt::format("{:<{}}  ", cellText(c), widths[c])
                                   : fmt::format("{:>{}}  ", cellText(c), widths[c]);
        out += text.substr(0, text.find_last_not_of(' ') + 1) + '\n';
    };
    const auto isText = [&](size_t c) {
        return !rows_.empty() && std::holds_alternative<std::string>(rows_.front()[c]);
    };
    line([&](size_t c) { return columns_[c]; }, isText);
    for (const auto& row : rows_) line([&](size_t c) { return textCell(row[c]); }, isText);
    return out;
}

std::vector<Report> Table::reports() const {
    std::vector<Report> reports;
    for (const auto& row : rows_) {
        Report report;
        for (size_t c = 0; c < row.size(); ++c)
            std::visit([&](const auto& value) { report.set(columns_[c], value); }, row[c]);
        reports.push_back(std::move(report));
    }
    return reports;
}

}  // namespace prt::tools
