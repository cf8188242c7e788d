// Times of short functions, taken so that ratios between methods hold on a machine that others use too.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace prt::tools {

struct TimedMethod {
    std::string name;
    size_t items;                ///< what one call of body works off
    std::function<void()> body;  ///< on the calling thread; keep what it computes with keepResult
};

/// Nanoseconds per item of each method: median over the rounds; every round runs every method for at least
/// `secondsPerRun`, one after another.
std::vector<double> timeMethods(const std::vector<TimedMethod>& methods, int rounds = 15,
                                double secondsPerRun = 5e-4);

/// Keeps the compiler from leaving out the computation of what is at `data`.
inline void keepResult(const void* data) { asm volatile("" : : "r"(data) : "memory"); }

/// The processor's name as the system gives it; "unknown" where it does not.
std::string cpuName();

}  // namespace prt::tools
