// Errors of techniques as README.md prints them.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace prt::tools::test {

/// The table between the markers <!-- technique-errors --> and <!-- /technique-errors --> of a Markdown text:
/// by technique (a cell in backquotes, or "floor") and column title ("house, sunset"); cells that hold no
/// number are left out.
std::map<std::pair<std::string, std::string>, double> errorTableOf(const std::string& markdown);

/// The same table as text.
/// @param columns     titles
/// @param techniques  rows, "floor" first where there is one
std::string errorTableText(const std::map<std::pair<std::string, std::string>, double>& errors,
                           const std::vector<std::string>& columns,
                           const std::vector<std::string>& techniques);

}  // namespace prt::tools::test
