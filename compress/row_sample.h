// A fixed number of rows, taken evenly from however many arrive.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "precompute/math/vec.h"

namespace prt {

/// Some points of a bundle with all that bases and errors are made of.
struct SampledRows {
    std::vector<float> rows;        ///< [P×n²]
    std::vector<Vec3f> normals;     ///< [P]
    std::vector<float> rowWeights;  ///< [P] what each counts, or empty = all the same
};

/// At most `count` of the sample's points, evenly spaced.
SampledRows thinned(const SampledRows& sample, size_t dimension, size_t count);

/// Of the rows in use the `capacity` whose numbers k (0, 1, … in order of arrival) have the smallest
/// fractional parts of k times the golden ratio: a sample without replacement that is spread evenly over them
/// (gaps of three lengths at most, nearer to the population than a random one) and does not line up with rows
/// of texels, the same however rows are cut into parts. All of them where they are no more. Memory: twice the
/// capacity.
/// @source bottom-k sampling [CohenKaplan2007]
class RowSampler {
  public:
    RowSampler(size_t capacity, size_t dimension);

    /// @param rows        [N×d]   @param normals  [N]
    /// @param use         [N] non-zero for rows that may be taken; empty = all
    /// @param rowWeights  [N] or empty, as in every other call
    void add(std::span<const float> rows, std::span<const Vec3f> normals, std::span<const uint8_t> use,
             std::span<const float> rowWeights);
    /// In the order of arrival.
    SampledRows sample() const;

  private:
    struct Entry {
        uint64_t hash, number;
        size_t slot;
    };
    void prune();

    size_t capacity_, dimension_;
    uint64_t seen_ = 0, bound_ = UINT64_MAX;
    std::vector<Entry> entries_;
    std::vector<size_t> freeSlots_;
    SampledRows slots_;
};

}  // namespace prt
