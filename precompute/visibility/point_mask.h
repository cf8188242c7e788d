// Sets of the points of a block, as bits.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace prt {

/// Most points of a block: they take one direction at a time.
inline constexpr size_t kMostBlockPoints = 256;

/// A set of points of a block.
struct PointMask {
    std::array<uint64_t, kMostBlockPoints / 64> words{};

    void set(size_t i) { words[i / 64] |= uint64_t(1) << i % 64; }
    bool test(size_t i) const { return words[i / 64] >> i % 64 & 1; }
    bool any() const { return (words[0] | words[1] | words[2] | words[3]) != 0; }
    size_t count() const {
        size_t sum = 0;
        for (const uint64_t word : words) sum += size_t(std::popcount(word));
        return sum;
    }
    /// Calls body(i) for every point, rising.
    template <class Body>
    void forEach(const Body& body) const {
        for (size_t w = 0; w < words.size(); ++w)
            for (uint64_t word = words[w]; word != 0; word &= word - 1)
                body(w * 64 + size_t(std::countr_zero(word)));
    }
    bool operator==(const PointMask&) const = default;
};

inline PointMask operator&(const PointMask& a, const PointMask& b) {
    PointMask result;
    for (size_t w = 0; w < a.words.size(); ++w) result.words[w] = a.words[w] & b.words[w];
    return result;
}
inline PointMask operator|(const PointMask& a, const PointMask& b) {
    PointMask result;
    for (size_t w = 0; w < a.words.size(); ++w) result.words[w] = a.words[w] | b.words[w];
    return result;
}
inline PointMask operator^(const PointMask& a, const PointMask& b) {
    PointMask result;
    for (size_t w = 0; w < a.words.size(); ++w) result.words[w] = a.words[w] ^ b.words[w];
    return result;
}
/// The points of a that are not in b.
inline PointMask without(const PointMask& a, const PointMask& b) {
    PointMask result;
    for (size_t w = 0; w < a.words.size(); ++w) result.words[w] = a.words[w] & ~b.words[w];
    return result;
}

/// Bit j of word i becomes bit i of word j.
/// @source [Warren2012, Sec. 7-3]: blocks of half the size swap places, step by step
inline void transposeBits(std::array<uint64_t, 64>& words) {
    uint64_t mask = 0x00000000ffffffffu;
    for (size_t size = 32; size > 0; size /= 2, mask ^= mask << size)
        for (size_t i = 0; i < 64; i = (i + size + 1) & ~size) {
            const uint64_t moved = (words[i] >> size ^ words[i + size]) & mask;
            words[i] ^= moved << size;
            words[i + size] ^= moved;
        }
}

/// Moves the chosen bits of a word together, to the low end, in their order.
/// @source [Warren2012, Sec. 7-4]: the moves by powers of two depend on the choice alone
class BitCompressor {
  public:
    explicit BitCompressor(uint64_t chosen) : chosen_(chosen) {
        uint64_t left = chosen, zeros = ~chosen << 1;  // zeros to the right of each bit: parity by steps
        for (size_t step = 0; step < moves_.size(); ++step) {
            uint64_t parity = zeros ^ zeros << 1;
            for (int shift = 2; shift < 64; shift *= 2) parity ^= parity << shift;
            const uint64_t move = parity & left;
            left = (left ^ move) | move >> (1u << step);
            moves_[step] = move;
            zeros &= ~parity;
        }
    }
    uint64_t operator()(uint64_t word) const {
        word &= chosen_;
        for (size_t step = 0; step < moves_.size(); ++step) {
            const uint64_t moved = word & moves_[step];
            word = (word ^ moved) | moved >> (1u << step);
        }
        return word;
    }
    int count() const { return std::popcount(chosen_); }

  private:
    uint64_t chosen_;
    std::array<uint64_t, 6> moves_{};
};

}  // namespace prt
