// Tables over the normal for live light: [IwanickiSloan2012, Sec. 3.3].
//
// R(n) = Pᵀ h(n) as in normal_tables.cpp. Negating a coordinate of n changes no function of the cosine h but
// for its sign. So the functions fall into classes by parity in x, y and z; the sum of each class is computed
// for the normals of one octant, and all eight mirror images of a normal follow from the sums by additions
// and subtractions (a Walsh-Hadamard transform): an eighth of the multiplications, as many as the paper's
// hemisphere and quarter turns save. The product matrix is a sum over the few tripling coefficients that are
// not zero, three colours at a time.
#include "compress/tables/fast_tables.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_lanes.h"
#include "precompute/math/sh_product.h"

namespace prt {
namespace {

using detail::kLanes;
using detail::MirrorRun;
using detail::Quad;
using detail::quadAt;

// Normals that are worked on together: their cosines stay in the first-level cache over several columns.
constexpr size_t kBlock = 4 * kLanes;
// Columns that go through all blocks together: what is written to meanwhile stays in the second-level cache
// (all columns of 64² texels at once took 1.5 to 2.5 times as long).
constexpr size_t kColumns = 4;

size_t roundUp(size_t count, size_t multiple) { return (count + multiple - 1) / multiple * multiple; }

/// Axes of which Y_lm is an odd function: bits 1, 2, 4 for x, y, z.
int oddAxes(int band, int m) {
    const int order = std::abs(m);
    const bool oddX = m >= 0 ? order % 2 == 1 : order % 2 == 0, oddY = m < 0;
    return int(oddX) + 2 * int(oddY) + 4 * ((band + order) % 2);
}

/// Sums of two columns at a time: sums[p][lane] = Σ_{rows of class p} matrix[row] cosines[row][lane]. Vectors
/// of four, which every machine and compiler keeps in registers.
template <int kClasses>
[[gnu::always_inline]] inline void sumClasses(const float* first, const float* second, const float* cosines,
                                              const uint32_t* classBegin, float* sumsFirst,
                                              float* sumsSecond) {
    constexpr size_t kWidth = 4, kStep = 4 * kWidth;
    for (size_t p = 0; p < kClasses; ++p)
        for (size_t lane = 0; lane < kBlock; lane += kStep) {
            Quad a[4] = {}, b[4] = {};
            for (uint32_t r = classBegin[p]; r < classBegin[p + 1]; ++r) {
                const float* row = cosines + r * kBlock + lane;
                for (size_t q = 0; q < 4; ++q) {
                    const Quad h = quadAt(row + q * kWidth).value;
                    a[q] += first[r] * h;
                    b[q] += second[r] * h;
                }
            }
            for (size_t q = 0; q < 4; ++q) {
                quadAt(sumsFirst + p * kBlock + lane + q * kWidth) = a[q];
                quadAt(sumsSecond + p * kBlock + lane + q * kWidth) = b[q];
            }
        }
}

/// From sums of classes to values at mirror images: v_σ = Σ_p ±s_p, minus where σ mirrors an odd number of
/// the odd axes of p.
template <int kClasses>
[[gnu::always_inline]] inline void combineClasses(float* sums) {
    for (size_t lane = 0; lane < kBlock; lane += 4) {
        Quad v[kClasses];
        for (size_t p = 0; p < kClasses; ++p) v[p] = quadAt(sums + p * kBlock + lane).value;
        for (size_t bit = 1; bit < kClasses; bit *= 2)
            for (size_t p = 0; p < kClasses; ++p) {
                if (p & bit) continue;
                const Quad even = v[p], odd = v[p + bit];
                v[p] = even + odd;
                v[p + bit] = even - odd;
            }
        for (size_t p = 0; p < kClasses; ++p) quadAt(sums + p * kBlock + lane) = v[p];
    }
}

/// Copies `length` floats, the other way round where asked for.
[[gnu::always_inline]] inline void copyRun(const float* from, float* to, size_t length, bool reversed) {
    if (reversed) {
        PRT_INDEPENDENT_LOOP
        for (size_t i = 0; i < length; ++i) to[i] = from[length - 1 - i];
    } else {
        PRT_INDEPENDENT_LOOP
        for (size_t i = 0; i < length; ++i) to[i] = from[i];
    }
}

/// Writes the values of a run to where its mirror images lie.
/// @param values  [kImages][kBlock]
template <int kImages>
[[gnu::always_inline]] inline void placeRun(const MirrorRun& run, const float* values, float* table) {
    for (size_t sigma = 0; sigma < kImages; ++sigma) {
        const float* from = values + sigma * kBlock + run.lane;
        float* to = table + run.texel[sigma];
        const bool reversed = run.reversed >> sigma & 1;
        // Lengths of common sizes become straight-line code.
        switch (run.length) {
            case 16:
                copyRun(from, to, 16, reversed);
                break;
            case 8:
                copyRun(from, to, 8, reversed);
                break;
            case 4:
                copyRun(from, to, 4, reversed);
                break;
            default:
                copyRun(from, to, run.length, reversed);
        }
    }
}

/// All columns over one block.
template <int kImages>
[[gnu::always_inline]] inline void evaluateColumns(const float* matrix, size_t stride, size_t columns,
                                                   const float* cosines, const uint32_t* classBegin,
                                                   const MirrorRun* runs, const MirrorRun* runsEnd,
                                                   float* table, size_t texels) {
    alignas(64) float values[2][kImages * kBlock];
    for (size_t column = 0; column < columns; column += 2) {
        const size_t count = std::min(size_t(2), columns - column);
        sumClasses<kImages>(matrix, matrix + (count - 1) * stride, cosines, classBegin, values[0], values[1]);
        for (size_t c = 0; c < count; ++c) {
            combineClasses<kImages>(values[c]);
            for (const MirrorRun* run = runs; run < runsEnd; ++run)
                placeRun<kImages>(*run, values[c], table + c * texels);
        }
        matrix += count * stride;
        table += count * texels;
    }
}

/// All columns over one block, for 4 or 8 mirror images.
/// @param matrix   [columns][stride]   @param cosines  [rows][kBlock]
/// @param table    [columns][texels]
PRT_TARGET_CLONES void evaluateBlock(int images, const float* matrix, size_t stride, size_t columns,
                                     const float* cosines, const uint32_t* classBegin, const MirrorRun* runs,
                                     const MirrorRun* runsEnd, float* table, size_t texels) {
    if (images == 8)
        evaluateColumns<8>(matrix, stride, columns, cosines, classBegin, runs, runsEnd, table, texels);
    else
        evaluateColumns<4>(matrix, stride, columns, cosines, classBegin, runs, runsEnd, table, texels);
}

/// out = Σ_i factors[i] rows[i], rows of `stride` floats, a multiple of 16.
PRT_TARGET_CLONES void combineRows(const float* factors, const float* rows, size_t count, size_t stride,
                                   float* out) {
    for (size_t k = 0; k < stride; k += kLanes) {
        Quad sum[4] = {};
        for (size_t i = 0; i < count; ++i)
            for (size_t q = 0; q < 4; ++q) sum[q] += factors[i] * quadAt(rows + i * stride + k + 4 * q).value;
        for (size_t q = 0; q < 4; ++q) quadAt(out + k + 4 * q) = sum[q];
    }
}

}  // namespace

LightTableBuilder::LightTableBuilder(const TableLayout& layout, int shOrder, int cosineBands)
    : layout_(layout), shOrder_(shOrder), cosineBands_(cosineBands) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(1, cosineBands);
    PRT_CHECK_LE(tableEnvironmentShOrder(shOrder, cosineBands), kMaxShOrder);
    mirrors_ = layout.mirrored(0, MirrorAxis::Z) >= 0 ? 3 : 2;
    planRows();
    planTexels();
    planProduct();
    const size_t n2 = size_t(shCount(shOrder));
    light_.resize(size_t(4) * size_t(shCount(environmentShOrder())));
    product_.resize(3 * n2 * paddedRows_);
    combined_.resize(3 * (n2 + 1) * paddedRows_);
}

void LightTableBuilder::planRows() {
    const int classes = 1 << mirrors_;
    for (int p = 0; p < classes; ++p) {
        classBegin_[size_t(p)] = uint32_t(rows_.size());
        for (int band = 0; band < cosineBands_; ++band) {
            if (clampedCosineBand(band) == 0) continue;
            for (int m = -band; m <= band; ++m)
                if (oddAxes(band, m) % classes == p) rows_.push_back(shIndex(band, m));
        }
    }
    classBegin_[size_t(classes)] = uint32_t(rows_.size());
    paddedRows_ = roundUp(rows_.size(), kLanes);
}

void LightTableBuilder::planTexels() {
    const uint32_t images = 1u << mirrors_;
    std::vector<int> octant;
    std::array<int, 8> last{};  // images of the texel before
    for (int texel = 0; texel < layout_.texelCount(); ++texel) {
        std::array<int, 8> image{texel};
        for (uint32_t sigma = 1; sigma < images; ++sigma) {
            const int axis = sigma & 4 ? 2 : sigma & 2 ? 1 : 0;
            image[sigma] = layout_.mirrored(image[sigma & ~(1u << axis)], MirrorAxis(axis));
        }
        if (*std::min_element(image.begin(), image.begin() + images) < texel) continue;
        const size_t lane = octant.size() % kBlock;
        if (lane == 0) blockRuns_.push_back(uint32_t(runs_.size()));
        uint8_t reversed = 0;
        bool joins = lane > 0 && texel % layout_.width() > 0;
        for (uint32_t sigma = 0; sigma < images; ++sigma) {
            const int step = image[sigma] - last[sigma];
            joins = joins && std::abs(step) == 1;
            reversed |= uint8_t((step < 0) << sigma);
        }
        if (joins) {
            MirrorRun& run = runs_.back();
            joins = run.length < kLanes && (run.length == 1 || run.reversed == reversed);
            if (joins) {
                run.reversed = reversed;
                ++run.length;
                for (uint32_t sigma = 0; sigma < images; ++sigma)
                    run.texel[sigma] = std::min(run.texel[sigma], uint32_t(image[sigma]));
            }
        }
        if (!joins) {
            MirrorRun run{uint32_t(lane), 1, {}, 0};
            std::copy(image.begin(), image.end(), run.texel.begin());
            runs_.push_back(run);
        }
        octant.push_back(texel);
        last = image;
    }
    blockRuns_.push_back(uint32_t(runs_.size()));
    fillCosines(octant);
}

void LightTableBuilder::fillCosines(std::span<const int> texels) {
    const size_t blocks = roundUp(texels.size(), kBlock) / kBlock;
    cosines_.assign(blocks * rows_.size() * kBlock, 0.0f);
    std::vector<float> all(size_t(shCount(cosineBands_)));
    for (size_t k = 0; k < texels.size(); ++k) {
        evalClampedCosineSh(cosineBands_, layout_.normal(texels[k]).cast<float>(), all);
        float* block = &cosines_[k / kBlock * rows_.size() * kBlock + k % kBlock];
        for (size_t r = 0; r < rows_.size(); ++r) block[r * kBlock] = all[size_t(rows_[r])];
    }
}

void LightTableBuilder::planProduct() {
    const size_t n2 = size_t(shCount(shOrder_));
    std::vector<int> rowOf(size_t(shCount(cosineBands_)), -1);
    for (size_t r = 0; r < rows_.size(); ++r) rowOf[size_t(rows_[r])] = int(r);
    const auto& all = triplingCoefficients(cosineBands_, shOrder_, environmentShOrder());
    const auto entryOf = [&](const TriplingCoefficient& t) {
        return size_t(t.j) * rows_.size() + size_t(rowOf[t.i]);
    };
    termBegin_.assign(n2 * rows_.size() + 1, 0);
    for (const TriplingCoefficient& t : all)
        if (rowOf[t.i] >= 0) ++termBegin_[entryOf(t) + 1];
    for (size_t e = 1; e < termBegin_.size(); ++e) termBegin_[e] += termBegin_[e - 1];
    terms_.resize(termBegin_.back());
    std::vector<uint32_t> next(termBegin_.begin(), termBegin_.end() - 1);
    for (const TriplingCoefficient& t : all)
        if (rowOf[t.i] >= 0) terms_[next[entryOf(t)]++] = {uint32_t(t.k), t.value};
}

void LightTableBuilder::fillProduct(const EnvironmentSh& environment) {
    PRT_CHECK_LE(environmentShOrder(), environment.shOrder);
    const size_t n2 = size_t(shCount(shOrder_));
    for (size_t i = 0; i < light_.size() / 4; ++i)
        quadAt(&light_[4 * i]) = Quad{environment.rgb[0][i], environment.rgb[1][i], environment.rgb[2][i], 0};
    const Term* term = terms_.data();
    for (size_t i = 0; i < n2; ++i)
        for (size_t r = 0; r < rows_.size(); ++r) {
            const Term* end = terms_.data() + termBegin_[i * rows_.size() + r + 1];
            Quad sum{};
            for (; term < end; ++term) sum += term->tripling * quadAt(&light_[4 * term->light]).value;
            for (size_t colour = 0; colour < 3; ++colour)
                product_[(colour * n2 + i) * paddedRows_ + r] = sum[colour];
        }
}

void LightTableBuilder::evaluate(const float* matrix, size_t columns, float* out) const {
    for (size_t first = 0; first < columns; first += kColumns)
        for (size_t block = 0; block + 1 < blockRuns_.size(); ++block)
            evaluateBlock(1 << mirrors_, matrix + first * paddedRows_, paddedRows_,
                          std::min(kColumns, columns - first), &cosines_[block * rows_.size() * kBlock],
                          classBegin_.data(), runs_.data() + blockRuns_[block],
                          runs_.data() + blockRuns_[block + 1], out + first * texelCount(), texelCount());
}

void LightTableBuilder::buildLightCosine(const EnvironmentSh& environment, std::span<float> out) {
    const size_t columns = size_t(3) * size_t(shCount(shOrder_));
    PRT_CHECK_EQ(out.size(), columns * texelCount());
    fillProduct(environment);
    evaluate(product_.data(), columns, out.data());
}

void LightTableBuilder::buildTripleProduct(const EnvironmentSh& environment, std::span<const float> mean,
                                           std::span<const float> basis, std::span<float> out) {
    const size_t n2 = size_t(shCount(shOrder_)), components = basis.size() / n2;
    PRT_CHECK_EQ(mean.size(), n2);
    PRT_CHECK_EQ(basis.size(), components * n2);
    PRT_CHECK_LE(components, n2);
    PRT_CHECK_EQ(out.size(), 3 * (components + 1) * texelCount());
    fillProduct(environment);
    for (size_t colour = 0; colour < 3; ++colour)
        for (size_t m = 0; m <= components; ++m)
            combineRows(m < components ? &basis[m * n2] : mean.data(), &product_[colour * n2 * paddedRows_],
                        n2, paddedRows_, &combined_[(colour * (components + 1) + m) * paddedRows_]);
    evaluate(combined_.data(), 3 * (components + 1), out.data());
}

}  // namespace prt
