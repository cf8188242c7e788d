// What the program says on stderr: warnings, notes and progress. Results go to stdout, and are the tools'
// business.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace prt {

/// Silences notes and progress (not warnings).
void setQuiet(bool quiet);
bool isQuiet();
/// The prefix of warnings, e.g. "prt precompute".
void setProgramName(std::string name);
const std::string& programName();

void logNote(std::string_view line);
void logWarning(std::string_view line);

/// Progress of one long job: a bar with rate and time left on a terminal, a plain line every few seconds
/// otherwise. advance() may be called from any thread.
class Progress {
  public:
    /// @param label  e.g. "tracing"
    /// @param total  units of work
    /// @param unit   e.g. "texels"
    Progress(std::string label, uint64_t total, std::string unit);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    /// @throws Interrupted  if an interrupt was requested
    void advance(uint64_t units);

  private:
    struct State;
    State* state_;
};

/// Seconds since construction.
class Stopwatch {
  public:
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace prt
