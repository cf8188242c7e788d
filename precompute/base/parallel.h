// Loops over all cores, and code for several instruction sets from one source.
#pragma once

#include <cstddef>
#include <functional>

// One source, three machine codes, chosen when the program starts. Only for kernels on raw spans whose result
// does not have to be the same bits on every machine. Clang 14 and sanitizers get the baseline.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define PRT_TARGET_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define PRT_TARGET_CLONES
#endif

namespace prt {

/// Threads that parallelFor uses; 0 means all cores. Not while parallel work runs.
void setThreadCount(int threads);
int threadCount();

/// Another number of threads while the object lives, then what was set before. Not while parallel work runs.
class ScopedThreadCount {
  public:
    explicit ScopedThreadCount(int threads);
    ~ScopedThreadCount();
    ScopedThreadCount(const ScopedThreadCount&) = delete;
    ScopedThreadCount& operator=(const ScopedThreadCount&) = delete;

  private:
    int before_;  // as set: 0 for all cores
};

/// Calls body(begin, end) over consecutive blocks of [0, count) of `block` items each (the last may be
/// shorter). Block boundaries do not depend on the number of threads. Exceptions (Interrupted too) reach the
/// caller.
void parallelFor(size_t count, size_t block, const std::function<void(size_t begin, size_t end)>& body);

/// Largest resident set of this process so far, bytes.
size_t peakResidentBytes();

}  // namespace prt
