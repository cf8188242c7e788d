// Little-endian words of binary files. Internal.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "precompute/base/error.h"

namespace prt {

/// Bytes of a file that is being laid out.
struct LittleEndianWriter {
    std::string bytes;
    template <class Word>
    void put(Word word) {
        for (size_t i = 0; i < sizeof(Word); ++i) bytes.push_back(char(uint64_t(word) >> (8 * i) & 0xff));
    }
    /// Zeros up to a multiple of `alignment`.
    void align(size_t alignment) { bytes.resize((bytes.size() + alignment - 1) / alignment * alignment); }
};

/// Words of a file at a growing offset.
class LittleEndianReader {
  public:
    LittleEndianReader(std::string_view bytes, std::string where) : bytes_(bytes), where_(std::move(where)) {}
    /// @throws InputError  the file ends before
    template <class Word>
    Word get() {
        if (bytes_.size() - offset_ < sizeof(Word))
            throw InputError(where_, fmt::format("ends after {} bytes, within its header", bytes_.size()),
                             "the file is damaged; make it again");
        uint64_t word = 0;
        for (size_t i = 0; i < sizeof(Word); ++i) word |= uint64_t(uint8_t(bytes_[offset_ + i])) << (8 * i);
        offset_ += sizeof(Word);
        return Word(word);
    }
    /// @throws InputError  the word is another one
    template <class Word>
    void expect(Word expected, const char* name) {
        const Word found = get<Word>();
        if (found != expected)
            throw InputError(where_, fmt::format("has {} {}, expected {}", name, found, expected),
                             "the file is damaged, or of a kind that prt does not write");
    }
    size_t offset() const { return offset_; }

  private:
    std::string_view bytes_;
    std::string where_;
    size_t offset_ = 0;
};

}  // namespace prt
