// Options of one subcommand: names, defaults and ranges, all of them shown by --help and checked with
// one-line errors. The only user of CLI11 is command_line.cpp.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace prt::tools {

/// Options that every subcommand has.
struct CommonOptions {
    std::string json;  ///< file or "-"; empty = none
    int threads = 0;   ///< 0 = all cores
    bool quiet = false;
};

class CommandLine {
  public:
    /// @param name  e.g. "prt precompute"
    /// @param epilogue  examples, shown below the options
    CommandLine(const std::string& name, const std::string& description, const std::string& epilogue);
    ~CommandLine();

    void positional(const std::string& name, std::string& value, const std::string& help);
    void positionalList(const std::string& name, std::vector<std::string>& values, const std::string& help);
    void integer(const std::string& names, int& value, int low, int high, const std::string& help);
    void real(const std::string& names, double& value, double low, double high, const std::string& help);
    void text(const std::string& names, std::string& value, const std::string& type, const std::string& help,
              bool required = false);
    void textList(const std::string& names, std::vector<std::string>& values, const std::string& type,
                  const std::string& help);
    void choice(const std::string& names, std::string& value, const std::vector<std::string>& choices,
                const std::string& help);
    void flag(const std::string& names, bool& value, const std::string& help);

    /// Parses, applies --threads and --quiet, and prints help where it is asked for.
    /// @return false: help was printed, there is nothing to do
    /// @throws UsageError
    bool parse(int argc, char** argv);
    const CommonOptions& common() const;
    /// Whether an option stood on the command line, by one of its names.
    bool isGiven(const std::string& name) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Parses "1280x800".
/// @throws UsageError  naming `option`; each side 1..16384
void parseSize(const std::string& option, const std::string& text, int& width, int& height);
/// Parses "x,y,z", finite numbers.
void parseVector(const std::string& option, const std::string& text, float* xyz);

}  // namespace prt::tools
