// Replaces the global operator new by one that counts. Aligned allocations go through the other operators and
// are not counted; nothing here asks for more than the default alignment.
#include "tests/math/allocation_counter.h"

#include <cstdlib>
#include <new>

namespace {
thread_local size_t count = 0;

void* allocate(size_t size) {
    ++count;
    if (void* p = std::malloc(size > 0 ? size : 1)) return p;
    throw std::bad_alloc();
}
}  // namespace

void* operator new(size_t size) { return allocate(size); }
void* operator new[](size_t size) { return allocate(size); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, size_t) noexcept { std::free(p); }
void operator delete[](void* p, size_t) noexcept { std::free(p); }

namespace prt::test {
size_t allocationCount() { return count; }
}  // namespace prt::test
