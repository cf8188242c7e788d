// Projection of a block [IwanickiSloan2012, Sec. 3], plain or by least squares of what irradiance sees, and
// what it may be wrong by: every second direction of a spherical Fibonacci set is a set of its own.
#include "precompute/visibility/block_projection.h"

#include <algorithm>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation_soa.h"
#include "precompute/visibility/orientations.h"

namespace prt {
namespace {

constexpr size_t kChunk = 512;  // directions whose rows of the table stay in cache
constexpr uint64_t kEvenBits = 0x5555555555555555u;
static_assert(kChunk % 64 == 0, "halves are told by bits of a word");
// A row of the lists, by halves; not a power of two, so that rows do not share cache sets.
constexpr size_t kListStride = kChunk / 2 + 32;

}  // namespace

ProjectionTables::ProjectionTables(int order, const Projection& projection) : shOrder(order), norm(order) {
    if (projection.kind == ProjectionKind::Irradiance)
        weighting.emplace(Weighting{irradianceWeightTable(projection.weight),
                                    IrradianceProjection(order, projection.weight)});
}

BlockProjection::BlockProjection(const ProjectionTables& tables, size_t stride)
    : tables_(tables),
      stride_(stride),
      lists_(kMostBlockPoints * 2 * kListStride),
      sums_(kMostBlockPoints * 2 * stride),
      cosines_(kChunk),
      weights_(kChunk / 2),
      expansions_(columns() * kSoaStride),
      differences_(columns() * kSoaStride) {}

void BlockProjection::listVisible(const LevelMasks& masks, size_t start, size_t end) {
    for (auto& counts : counts_) counts.fill(0);
    std::array<uint64_t, 64> bits;
    for (size_t first = start; first < end; first += 64) {
        for (size_t w = 0; w * 64 < count_; ++w) {
            for (size_t k = 0; k < 64; ++k) bits[k] = first + k < end ? masks.visible[first + k].words[w] : 0;
            transposeBits(bits);  // now by items
            for (size_t j = 0; j < 64; ++j) {
                const size_t i = w * 64 + j;
                for (size_t half = 0; half < 2; ++half) {
                    uint64_t left = bits[j] & kEvenBits << half;
                    uint16_t* list = &lists_[(i * 2 + half) * kListStride];
                    size_t count = counts_[half][i];
                    for (; left != 0; left &= left - 1)
                        list[count++] = uint16_t(first - start + size_t(std::countr_zero(left)));
                    counts_[half][i] = uint16_t(count);
                }
            }
        }
    }
}

void BlockProjection::addChunk(const DirectionLevel& level, size_t i, size_t start, size_t count) {
    const std::array<CosineSum, 2> open = cosinesAbout({&level.x[start], &level.y[start], &level.z[start]},
                                                       count, setNormals_[i].data(), cosines_.data());
    const float* basis = &level.basis[start * stride_];
    for (size_t half = 0; half < 2; ++half) {
        const uint16_t* rows = &lists_[(i * 2 + half) * kListStride];
        const size_t rowCount = counts_[half][i];
        open_[half][i] += open[half];
        seen_[half][i] += sumOfCosines(cosines_.data(), rows, rowCount);
        if (tables_.weighting) {
            weighRows(tables_.weighting->weight, cosines_.data(), rows, rowCount, weights_.data());
            addWeightedTableRows(basis, stride_, rows, weights_.data(), rowCount, sums(half, i));
        } else {
            addTableRows(basis, stride_, rows, rowCount, sums(half, i));
        }
    }
}

void BlockProjection::project(const DirectionLevel& level, std::span<const uint8_t> orientations,
                              const LevelMasks& masks, std::span<const Vec3f> normals,
                              const PointMask& shared, std::span<const float> openShares) {
    PRT_CHECK_EQ(level.stride, stride_);
    PRT_CHECK_LE(normals.size(), kMostBlockPoints);
    PRT_CHECK(orientations.empty() || orientations.size() == normals.size());
    count_ = normals.size();
    const auto orUp = [](const Vec3f& normal) { return normal == Vec3f::Zero() ? Vec3f(0, 0, 1) : normal; };
    setNormals_.clear();
    unitSetNormals_.clear();
    unitNormals_.clear();
    for (size_t i = 0; i < count_; ++i) {
        setNormals_.push_back(turnedBack(orientations.empty() ? 0 : orientations[i], normals[i]));
        unitSetNormals_.push_back(orUp(setNormals_.back()));
        unitNormals_.push_back(orUp(normals[i]));
    }
    sumRows(level, masks);
    findOpenness(level, masks, shared, openShares);
    findExpansions(level.size());
    findHalfSetDifferences(level.size());
    if (!orientations.empty()) turnIntoWorld(orientations);
}

void BlockProjection::sumRows(const DirectionLevel& level, const LevelMasks& masks) {
    std::fill(sums_.begin(), sums_.end(), 0.0f);
    for (size_t half = 0; half < 2; ++half) {
        seen_[half].fill({});
        open_[half].fill({});
    }
    for (size_t start = 0; start < level.size(); start += kChunk) {
        throwIfInterrupted();
        const size_t end = std::min(start + kChunk, level.size());
        listVisible(masks, start, end);
        for (size_t i = 0; i < count_; ++i) addChunk(level, i, start, end - start);
    }
}

void BlockProjection::findOpenness(const DirectionLevel& level, const LevelMasks& masks,
                                   const PointMask& shared, std::span<const float> openShares) {
    PRT_CHECK_EQ(openShares.size(), count_);
    for (size_t i = 0; i < count_; ++i)
        openness_[i] = seenShare(seen_[0][i] + seen_[1][i], open_[0][i] + open_[1][i]);
    if (!shared.any()) return;
    // Sub-points have horizons of their own: which directions these take from an item is a sample, whose
    // error the ratio to what is above them does not have.
    std::array<CosineSum, kMostBlockPoints> above{};
    for (size_t k = 0; k < level.size(); ++k)
        (masks.above[k] & shared).forEach([&](size_t i) {
            const Vec3f& n = setNormals_[i];
            const float cosine = n.x() * level.x[k] + n.y() * level.y[k] + n.z() * level.z[k];
            above[i] += {double(std::max(0.0f, cosine)), cosine > 0};
        });
    shared.forEach(
        [&](size_t i) { openness_[i] = openShares[i] * seenShare(seen_[0][i] + seen_[1][i], above[i]); });
}

void BlockProjection::findExpansions(size_t directions) {
    const float sampleSr = float(4 * std::numbers::pi / double(directions));
    for (size_t i = 0; i < count_; ++i)
        for (size_t c = 0; c < columns(); ++c)
            expansions_[c * kSoaStride + i] = (sums(0, i)[c] + sums(1, i)[c]) * sampleSr;
    solve(std::span(openness_.data(), count_), expansions_);
}

void BlockProjection::findHalfSetDifferences(size_t directions) {
    halfSetDifferences_.assign(count_, 0.0f);
    if (directions < 2) return;
    const double evenSr = 4 * std::numbers::pi / double((directions + 1) / 2),
                 allSr = 4 * std::numbers::pi / double(directions);
    std::array<float, kMostBlockPoints> seen;
    for (size_t i = 0; i < count_; ++i) {
        seen[i] = seenShare(seen_[0][i] + seen_[1][i], open_[0][i] + open_[1][i]) -
                  seenShare(seen_[0][i], open_[0][i]);
        for (size_t c = 0; c < columns(); ++c)
            differences_[c * kSoaStride + i] =
                float((allSr - evenSr) * double(sums(0, i)[c]) + allSr * double(sums(1, i)[c]));
    }
    // Expansions are linear in the sums and the irradiance, and so is their difference.
    solve(std::span(seen.data(), count_), differences_);
    tables_.norm.evaluateSoa(unitSetNormals_, kSoaStride, differences_, halfSetDifferences_);
}

void BlockProjection::solve(std::span<const float> openness, std::vector<float>& values) const {
    if (!tables_.weighting) return;
    std::array<float, kMostBlockPoints> irradiance;
    for (size_t i = 0; i < count_; ++i) irradiance[i] = openness[i] * float(std::numbers::pi);
    tables_.weighting->projection.solveSoa(unitSetNormals_, kSoaStride, values,
                                           std::span(irradiance.data(), count_), values);
}

void BlockProjection::turnIntoWorld(std::span<const uint8_t> orientations) {
    std::vector<float> rotations(9 * kSoaStride);
    for (size_t i = 0; i < count_; ++i) {
        const Mat3d& rotation = setOrientations()[orientations[i]];
        for (size_t row = 0; row < 3; ++row)
            for (size_t column = 0; column < 3; ++column)
                rotations[(3 * row + column) * kSoaStride + i] =
                    float(rotation(Eigen::Index(row), Eigen::Index(column)));
    }
    rotateShSoa(rotations, tables_.shOrder, count_, kSoaStride, expansions_, differences_);
    for (size_t c = 0; c < columns(); ++c)
        for (size_t i = 0; i < count_; ++i)  // the first stays exactly as it is
            if (orientations[i] != 0) expansions_[c * kSoaStride + i] = differences_[c * kSoaStride + i];
}

void BlockProjection::expansion(size_t i, std::span<float> out) const {
    for (size_t c = 0; c < out.size(); ++c) out[c] = expansions_[c * kSoaStride + i];
}

void BlockProjection::compare(std::span<const uint32_t> items, std::span<const float> coefficients,
                              std::span<float> out) const {
    PRT_CHECK_EQ(items.size(), count_);
    std::vector<float> differences(columns() * kSoaStride);
    for (size_t i = 0; i < count_; ++i)
        for (size_t c = 0; c < columns(); ++c)
            differences[c * kSoaStride + i] =
                expansions_[c * kSoaStride + i] - coefficients[size_t(items[i]) * columns() + c];
    tables_.norm.evaluateSoa(unitNormals_, kSoaStride, differences, out);
}

}  // namespace prt
