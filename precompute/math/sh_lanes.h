// Sixteen numbers at once, by the compilers' vector extension: AVX-512 holds them in one register, AVX2 in
// two, SSE in four. Internal to prt_math.
#pragma once

#include <cstddef>

// Before a loop whose iterations touch no memory of each other, which the compiler cannot know. Clang would
// warn of every build in which it does not vectorise such a loop, sanitizers among them: it gets no promise.
#if defined(__clang__)
#define PRT_INDEPENDENT_LOOP
#else
#define PRT_INDEPENDENT_LOOP _Pragma("GCC ivdep")
#endif

namespace prt::detail {

inline constexpr size_t kLanes = 16;
typedef float Lanes __attribute__((vector_size(sizeof(float) * kLanes)));
/// Four numbers at once.
typedef float Quad __attribute__((vector_size(16)));

/// A vector anywhere in an array of floats. A struct, not a typedef with an attribute: clang takes references
/// to such a typedef for aligned ones.
template <typename Vector>
struct [[gnu::packed, gnu::may_alias]] InArray {
    Vector value;
    [[gnu::always_inline]] InArray& operator=(const Vector& v) {
        value = v;
        return *this;
    }
};

/// The vector that begins at p.
[[gnu::always_inline]] inline InArray<Lanes>& lanesAt(float* p) {
    return *reinterpret_cast<InArray<Lanes>*>(p);
}
[[gnu::always_inline]] inline const InArray<Lanes>& lanesAt(const float* p) {
    return *reinterpret_cast<const InArray<Lanes>*>(p);
}
[[gnu::always_inline]] inline InArray<Quad>& quadAt(float* p) { return *reinterpret_cast<InArray<Quad>*>(p); }
[[gnu::always_inline]] inline const InArray<Quad>& quadAt(const float* p) {
    return *reinterpret_cast<const InArray<Quad>*>(p);
}

}  // namespace prt::detail
