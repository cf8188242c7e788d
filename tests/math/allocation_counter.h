// Counts what the test binary allocates, to show that a function allocates nothing.
#pragma once

#include <cstddef>

namespace prt::test {

/// Calls of operator new by this thread so far.
size_t allocationCount();

/// Calls of operator new during action().
template <typename Action>
size_t allocationsOf(const Action& action) {
    const size_t before = allocationCount();
    action();
    return allocationCount() - before;
}

}  // namespace prt::test
