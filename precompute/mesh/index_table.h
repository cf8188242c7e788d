// Open-addressing hash table from keys held elsewhere to their indices. Internal to the mesh stage.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

namespace prt {

inline uint64_t mixHash(uint64_t h, uint64_t value) {
    h ^= value + 0x9e3779b97f4a7c15ull + (h << 6) + (h >> 2);
    h ^= h >> 32;
    h *= 0xd6e8feb86659fd93ull;
    return h ^ (h >> 32);
}

/// Bits of a float with -0 folded into 0, so that equal numbers have equal bits.
inline uint32_t floatKey(float value) {
    const float folded = value == 0 ? 0.0f : value;
    uint32_t bits;
    std::memcpy(&bits, &folded, sizeof bits);
    return bits;
}

class IndexTable {
  public:
    explicit IndexTable(size_t expected) { resize(expected * 2); }

    /// @param equal  bool(uint32_t index): whether the entry of that index is the key
    /// @return the index of the equal entry, or `candidate`, which is then inserted
    template <class Equal>
    uint32_t findOrInsert(uint64_t hash64, uint32_t candidate, const Equal& equal) {
        if (used_ * 5 > slots_.size() * 3) resize(slots_.size() * 2);
        const auto hash = uint32_t(hash64 ^ (hash64 >> 32));
        for (size_t i = hash & mask_;; i = (i + 1) & mask_) {
            Slot& slot = slots_[i];
            if (slot.index == kFree) {
                slot = {hash, candidate};
                ++used_;
                return candidate;
            }
            if (slot.hash == hash && equal(slot.index)) return slot.index;
        }
    }

  private:
    static constexpr uint32_t kFree = 0xffffffffu;
    struct Slot {
        uint32_t hash = 0, index = kFree;
    };

    void resize(size_t atLeast) {
        size_t size = 64;
        while (size < atLeast) size *= 2;
        std::vector<Slot> old(size);
        old.swap(slots_);
        mask_ = size - 1;
        for (const Slot& slot : old) {
            if (slot.index == kFree) continue;
            size_t i = slot.hash & mask_;
            while (slots_[i].index != kFree) i = (i + 1) & mask_;
            slots_[i] = slot;
        }
    }

    std::vector<Slot> slots_;
    size_t mask_ = 0, used_ = 0;
};

}  // namespace prt
