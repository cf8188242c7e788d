// Bottom-k sampling [CohenKaplan2007] by multiples of the golden ratio in place of random numbers: the
// smallest of them belong to evenly spaced rows.
#include "compress/row_sample.h"

#include <algorithm>

#include "precompute/base/check.h"

namespace prt {
namespace {

// Of 2^64. Odd: the products of different numbers differ.
constexpr uint64_t kGoldenRatio = 0x9e3779b97f4a7c15u;

void appendRow(SampledRows& to, const SampledRows& from, size_t point, size_t dimension) {
    const auto row = from.rows.begin() + ptrdiff_t(point * dimension);
    to.rows.insert(to.rows.end(), row, row + ptrdiff_t(dimension));
    to.normals.push_back(from.normals[point]);
    if (!from.rowWeights.empty()) to.rowWeights.push_back(from.rowWeights[point]);
}

}  // namespace

SampledRows thinned(const SampledRows& sample, size_t dimension, size_t count) {
    const size_t size = sample.normals.size();
    if (size <= count) return sample;
    SampledRows result;
    for (size_t k = 0; k < count; ++k) appendRow(result, sample, k * size / count, dimension);
    return result;
}

RowSampler::RowSampler(size_t capacity, size_t dimension) : capacity_(capacity), dimension_(dimension) {
    PRT_CHECK_LE(size_t(1), capacity);
    PRT_CHECK_LE(size_t(1), dimension);
}

void RowSampler::add(std::span<const float> rows, std::span<const Vec3f> normals,
                     std::span<const uint8_t> use, std::span<const float> rowWeights) {
    PRT_CHECK_EQ(rows.size(), normals.size() * dimension_);
    if (!use.empty()) PRT_CHECK_EQ(use.size(), normals.size());
    if (!rowWeights.empty()) PRT_CHECK_EQ(rowWeights.size(), normals.size());
    for (size_t i = 0; i < normals.size(); ++i) {
        if (!use.empty() && !use[i]) continue;
        const uint64_t number = seen_++, hash = number * kGoldenRatio;
        if (hash > bound_) continue;
        const size_t slot = freeSlots_.empty() ? entries_.size() : freeSlots_.back();
        if (!freeSlots_.empty()) freeSlots_.pop_back();
        if (slot == slots_.normals.size()) {
            slots_.normals.emplace_back();
            slots_.rows.resize((slot + 1) * dimension_);
            if (!rowWeights.empty()) slots_.rowWeights.emplace_back();
        }
        std::copy_n(&rows[i * dimension_], dimension_, &slots_.rows[slot * dimension_]);
        slots_.normals[slot] = normals[i];
        if (!rowWeights.empty()) slots_.rowWeights[slot] = rowWeights[i];
        entries_.push_back({hash, number, slot});
        if (entries_.size() >= 2 * capacity_) prune();
    }
}

void RowSampler::prune() {
    const auto last = entries_.begin() + ptrdiff_t(capacity_ - 1);
    std::nth_element(entries_.begin(), last, entries_.end(),
                     [](const Entry& a, const Entry& b) { return a.hash < b.hash; });
    bound_ = last->hash;
    for (size_t k = capacity_; k < entries_.size(); ++k) freeSlots_.push_back(entries_[k].slot);
    entries_.resize(capacity_);
}

SampledRows RowSampler::sample() const {
    std::vector<Entry> taken = entries_;
    const auto byHash = [](const Entry& a, const Entry& b) { return a.hash < b.hash; };
    if (taken.size() > capacity_) {
        std::nth_element(taken.begin(), taken.begin() + ptrdiff_t(capacity_), taken.end(), byHash);
        taken.resize(capacity_);
    }
    std::sort(taken.begin(), taken.end(), [](const Entry& a, const Entry& b) { return a.number < b.number; });
    SampledRows result;
    for (const Entry& entry : taken) appendRow(result, slots_, entry.slot, dimension_);
    return result;
}

}  // namespace prt
