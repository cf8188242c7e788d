// How commands are told which tables to make.
#pragma once

#include <string>

#include "compress/tables/table_options.h"
#include "tools/command_line.h"

namespace prt::tools {

/// Adds PREFIXlayout, PREFIXsize, PREFIXvariant and --window.
/// @param prefix  "--", or "--table-" where the plain names mean something else
void addTableOptions(CommandLine& line, const std::string& prefix, TableOptions& options);

/// Adds --extract-sun.
void addSunOption(CommandLine& line, TableOptions& options);

}  // namespace prt::tools
