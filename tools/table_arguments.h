// How commands are told which tables to make.
#pragma once

#include <string>

#include "compress/tables/table_options.h"
#include "tools/command_line.h"

namespace prt::tools {

/// Adds PREFIXlayout, PREFIXsize, PREFIXvariant, --window and --extract-sun.
/// @param prefix  "--", or "--table-" where the plain names mean something else
void addTableOptions(CommandLine& line, const std::string& prefix, TableOptions& options);

}  // namespace prt::tools
