// Random numbers of one word of state, and the hash they are made with.
#pragma once

#include <cstdint>

namespace prt {

/// @source [Steele2014, Fig. 13], with the finaliser of its reference implementation
struct SplitMix64 {
    uint64_t state;
    uint64_t next() {
        uint64_t v = state += 0x9e3779b97f4a7c15u;
        v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
        v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
        return v ^ (v >> 31);
    }
    /// In [0, 1).
    double uniform() { return double(next() >> 11) * 0x1p-53; }
};

}  // namespace prt
