// Tables of results: the same rows as CSV, as JSON and as text on the terminal.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "tools/report.h"

namespace prt::tools {

using Cell = std::variant<std::string, double, uint64_t>;

class Table {
  public:
    /// @param columns  names as in JSON: snake_case, unit as suffix
    explicit Table(std::vector<std::string> columns);

    /// @param cells  one per column; a NaN is a value there is none of: empty in CSV, null in JSON
    void add(std::vector<Cell> cells);
    size_t rowCount() const { return rows_.size(); }
    const std::vector<std::string>& columns() const { return columns_; }
    const Cell& cell(size_t row, const std::string& column) const;

    /// RFC 4180 with a header line; numbers in the shortest form that reads back the same.
    std::string csv() const;
    /// Aligned columns, numbers to four digits.
    std::string text() const;
    /// One object per row.
    std::vector<Report> reports() const;

  private:
    std::vector<std::string> columns_;
    std::vector<std::vector<Cell>> rows_;
};

}  // namespace prt::tools
