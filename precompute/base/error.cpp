#include "precompute/base/error.h"

#include <atomic>

namespace prt {
namespace {

std::atomic<bool> gInterrupt{false};

std::string oneLine(const std::string& where, const std::string& problem, const std::string& remedy) {
    std::string line = where.empty() ? problem : where + ": " + problem;
    if (!remedy.empty()) line += "; " + remedy;
    // Third-party messages may hold line breaks; the contract is one line.
    for (char& c : line)
        if (c == '\n' || c == '\r') c = ' ';
    while (!line.empty() && line.back() == ' ') line.pop_back();
    return line;
}

}  // namespace

Error::Error(std::string where, std::string problem, std::string remedy)
    : std::runtime_error(oneLine(where, problem, remedy)),
      where_(std::move(where)),
      problem_(std::move(problem)),
      remedy_(std::move(remedy)) {}

void requestInterrupt() noexcept { gInterrupt.store(true, std::memory_order_relaxed); }
void clearInterrupt() noexcept { gInterrupt.store(false, std::memory_order_relaxed); }
bool interruptRequested() noexcept { return gInterrupt.load(std::memory_order_relaxed); }
void throwIfInterrupted() {
    if (interruptRequested()) throw Interrupted();
}

}  // namespace prt
