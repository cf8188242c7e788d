// What every `prt measure` command writes: PREFIX.csv, a plot PREFIX.svg or PREFIX.png, JSON where asked for,
// and a table on the terminal.
#pragma once

#include <string>
#include <vector>

#include "tools/command_line.h"
#include "tools/measure/figure.h"
#include "tools/measure/table.h"

namespace prt::tools {

struct MeasureOptions {
    std::string prefix;        ///< of the files written; set it to the default before declaring the options
    std::string plot = "svg";  ///< "svg", "png" or "none"
};

/// Declares -o/--output and --plot.
void addMeasureOptions(CommandLine& line, MeasureOptions& options);

/// Makes sure before long work that PREFIX.csv can be written.
/// @throws OutputError
void checkMeasureOutput(const MeasureOptions& options);

struct Measurement {
    std::string name;                                      ///< "parameterization", …
    Table rows;                                            ///< CSV in PREFIX.csv, JSON key `rows`
    std::vector<std::pair<std::string, Table>> more = {};  ///< further tables: PREFIX-NAME.csv, JSON key NAME
    std::vector<std::pair<std::string, Figure>> figures = {};  ///< "" is PREFIX.svg, NAME is PREFIX-NAME.svg
    std::string summary = {};                                  ///< printed instead of the rows
};

/// Writes all files and prints.
/// @param report  what JSON holds beside the tables (settings, statistics)
/// @throws OutputError
void writeMeasurement(const Measurement& measurement, const MeasureOptions& options,
                      const CommonOptions& common, Report report);

/// A name as part of a file name: what is no letter, digit, '_' or '-' becomes '_'.
std::string fileStem(std::string name);

/// Parses "3,6" or "3-6,8": rising, each once.
/// @throws UsageError  naming `option`
std::vector<int> parseIntegerList(const std::string& option, const std::string& text, int low, int high);
/// Parses "a,b,c", each one of `allowed`, each once; "all" is all of them.
/// @throws UsageError  naming `option`
std::vector<std::string> parseNameList(const std::string& option, const std::string& text,
                                       const std::vector<std::string>& allowed);

}  // namespace prt::tools
