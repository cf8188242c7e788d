// Projection of a block [IwanickiSloan2012, Sec. 3], plain or by least squares of what irradiance sees, and
// what it may be wrong by: every second direction of a spherical Fibonacci set is a set of its own.
#include "precompute/visibility/block_projection.h"

#include <algorithm>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation.h"

namespace prt {
namespace {

constexpr size_t kChunk = 512;  // directions whose rows of the table stay in cache
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
      weights_(kChunk / 2) {}

void BlockProjection::listVisible(const LevelMasks& masks, size_t start, size_t end) {
    for (auto& counts : counts_) counts.fill(0);
    for (size_t k = start; k < end; ++k) {
        const auto row = uint16_t(k - start);
        const size_t half = row % 2;
        masks.visible[k].forEach(
            [&](size_t i) { lists_[(i * 2 + half) * kListStride + counts_[half][i]++] = row; });
    }
}

void BlockProjection::addChunk(const DirectionLevel& level, size_t i, size_t start, size_t count) {
    const std::array<CosineSum, 2> open = cosinesAbout({&set_->x[start], &set_->y[start], &set_->z[start]},
                                                       count, normals_[i].data(), cosines_.data());
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

void BlockProjection::project(const DirectionLevel& level, int orientation, const LevelMasks& masks,
                              std::span<const Vec3f> normals) {
    PRT_CHECK_EQ(level.stride, stride_);
    PRT_CHECK_LE(normals.size(), kMostBlockPoints);
    set_ = &level.turned[size_t(orientation)];
    worldFromSet_ = setOrientations()[size_t(orientation)];
    turned_ = orientation != 0;
    normals_.assign(normals.begin(), normals.end());
    setNormals_ = normals_;
    if (turned_)
        for (Vec3f& normal : setNormals_)
            normal = (worldFromSet_.transpose() * normal.cast<double>()).cast<float>();
    directions_ = level.size();
    std::fill(sums_.begin(), sums_.end(), 0.0f);
    for (size_t half = 0; half < 2; ++half) {
        seen_[half].fill({});
        open_[half].fill({});
    }
    for (size_t start = 0; start < level.size(); start += kChunk) {
        throwIfInterrupted();
        const size_t end = std::min(start + kChunk, level.size());
        listVisible(masks, start, end);
        for (size_t i = 0; i < normals.size(); ++i) addChunk(level, i, start, end - start);
    }
}

void BlockProjection::expansion(size_t i, std::span<float> out) const {
    const float sampleSr = float(4 * std::numbers::pi / double(directions_));
    for (size_t c = 0; c < out.size(); ++c) out[c] = (sums(0, i)[c] + sums(1, i)[c]) * sampleSr;
    if (tables_.weighting && normals_[i] != Vec3f::Zero())
        tables_.weighting->projection.solve(setNormals_[i], out, openness(i) * float(std::numbers::pi), out);
    if (turned_) rotateSh(worldFromSet_, tables_.shOrder, std::span<const float>(out), out);
}

double BlockProjection::halfSetDifference(size_t i) const {
    if (normals_[i] == Vec3f::Zero() || directions_ < 2) return 0;
    const double evenSr = 4 * std::numbers::pi / double((directions_ + 1) / 2),
                 allSr = 4 * std::numbers::pi / double(directions_);
    std::array<float, size_t(shCount(kMaxBundleShOrder))> storage;
    const std::span difference(storage.data(), size_t(shCount(tables_.shOrder)));
    for (size_t c = 0; c < difference.size(); ++c)
        difference[c] = float((allSr - evenSr) * double(sums(0, i)[c]) + allSr * double(sums(1, i)[c]));
    // Expansions are linear in the sums and the irradiance, and so is their difference.
    if (tables_.weighting)
        tables_.weighting->projection.solve(
            setNormals_[i], difference,
            (openness(i) - seenShare(seen_[0][i], open_[0][i])) * float(std::numbers::pi), difference);
    return tables_.norm.evaluate(setNormals_[i], difference);
}

}  // namespace prt
