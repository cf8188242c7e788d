// Rotation of hemispherical harmonics, three ways [Gautron2004] "A Novel Hemispherical Basis for Accurate and
// Efficient Rendering", Sec. 4.
#include "precompute/math/hsh_rotation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/basis_conversion.h"
#include "precompute/math/hsh_rotation_matrices.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation.h"
#include "precompute/math/sh_rotation_single.h"

namespace prt {
namespace {

using namespace detail;

/// Both blocks in their places of the whole matrix, by rows.
std::vector<double> wholeMatrix(int order, const std::vector<double>* blocks) {
    const size_t count = size_t(shCount(order));
    std::vector<double> result(count * count, 0.0);
    for (int p = 0; p < 2; ++p) {
        const std::vector<int> indices = hshParityIndices(order, p == 0);
        for (size_t c = 0; c < indices.size(); ++c)
            for (size_t r = 0; r < indices.size(); ++r)
                result[size_t(indices[r]) * count + size_t(indices[c])] = blocks[p][c * indices.size() + r];
    }
    return result;
}

/// Turns about z by an angle, in place: as spherical harmonics.
void turnAboutZ(double angle, int order, float* v) {
    for (int m = 1; m < order; ++m) {
        const float c = float(std::cos(m * angle)), s = float(std::sin(m * angle));
        for (int l = m; l < order; ++l) turnPair(c, s, v[shIndex(l, m)], v[shIndex(l, -m)]);
    }
}

/// out += (a A + b B) in, both by columns.
PRT_TARGET_CLONES void addProduct(const float* aMatrix, float a, const float* bMatrix, float b, size_t size,
                                  const float* in, float* __restrict out) {
    for (size_t c = 0; c < size; ++c) {
        const float fromA = a * in[c], fromB = b * in[c];
        for (size_t r = 0; r < size; ++r)
            out[r] += fromA * aMatrix[c * size + r] + fromB * bMatrix[c * size + r];
    }
}

size_t parityCount(int order, int p) {
    return size_t(p == 0 ? order * (order + 1) / 2 : order * (order - 1) / 2);
}

/// Floats of both blocks.
size_t tableSize(int order) {
    return parityCount(order, 0) * parityCount(order, 0) + parityCount(order, 1) * parityCount(order, 1);
}

}  // namespace

std::vector<double> hshDigonRemoval(int hshOrder, double betaRad) {
    return wholeMatrix(hshOrder, hshTurnMatrices(hshOrder, betaRad, hshNodeCount(hshOrder)).removal);
}

std::vector<double> hshYRotation(int hshOrder, double betaRad) {
    return wholeMatrix(hshOrder, hshTurnMatrices(hshOrder, betaRad, hshNodeCount(hshOrder)).rotation);
}

double hshShAngle(double betaRad) {
    PRT_CHECK_LE(0.0, betaRad);
    PRT_CHECK_LE(betaRad, std::numbers::pi);
    // arccos(2cosβ − 1) = 2 arcsin(√2 sin(β/2)), which is exact for small angles too
    return 2 * std::asin(std::min(1.0, std::numbers::sqrt2 * std::sin(0.5 * betaRad)));
}

HshRotationThroughSh::HshRotationThroughSh(int hshOrder, int shOrder)
    : hshOrder_(hshOrder), shOrder_(shOrder) {
    const std::vector<double> dense = shToHshMatrix(hshOrder, shOrder);
    const size_t columns = size_t(shCount(shOrder));
    for (int m = 1 - hshOrder; m < hshOrder; ++m) {
        start_.push_back(conversion_.size());
        for (int l = std::abs(m); l < hshOrder; ++l)
            for (int k = std::abs(m); k < shOrder; ++k)
                conversion_.push_back(float(dense[size_t(shIndex(l, m)) * columns + size_t(shIndex(k, m))]));
    }
}

void HshRotationThroughSh::rotate(const Mat3d& targetFromSource, std::span<const float> in,
                                  std::span<float> out) const {
    checkRotationSizes(hshOrder_, in.size(), out.size());
    float sh[shCount(kMaxShOrder)] = {};
    for (int m = 1 - hshOrder_; m < hshOrder_; ++m) {
        const float* entry = conversion_.data() + start_[size_t(m + hshOrder_ - 1)];
        for (int l = std::abs(m); l < hshOrder_; ++l)
            for (int k = std::abs(m); k < shOrder_; ++k)
                sh[shIndex(k, m)] += *entry++ * in[size_t(shIndex(l, m))];
    }
    const std::span<float> coefficients(sh, size_t(shCount(shOrder_)));
    rotateSh(targetFromSource, shOrder_, std::span<const float>(coefficients), coefficients);
    for (int m = 1 - hshOrder_; m < hshOrder_; ++m) {
        const float* entry = conversion_.data() + start_[size_t(m + hshOrder_ - 1)];
        for (int l = std::abs(m); l < hshOrder_; ++l) {
            float sum = 0;
            for (int k = std::abs(m); k < shOrder_; ++k) sum += *entry++ * sh[shIndex(k, m)];
            out[size_t(shIndex(l, m))] = sum;
        }
    }
}

HshRotationTable::HshRotationTable(int hshOrder, int angleCount)
    : hshOrder_(hshOrder), angleCount_(angleCount) {
    PRT_CHECK_LE(1, hshOrder);
    PRT_CHECK_LE(hshOrder, kMaxShOrder);
    PRT_CHECK_LE(2, angleCount);
    const size_t size = tableSize(hshOrder);
    removal_.resize(size * size_t(angleCount));
    rotation_.resize(removal_.size());
    parallelFor(size_t(angleCount), 1, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            const double beta = std::numbers::pi * double(k) / double(angleCount - 1);
            const HshTurnMatrices m = hshTurnMatrices(hshOrder, beta, hshNodeCount(hshOrder));
            const auto store = [&](const std::vector<double>* blocks, float* to) {
                for (int p = 0; p < 2; ++p)
                    to = std::transform(blocks[p].begin(), blocks[p].end(), to,
                                        [](double v) { return float(v); });
            };
            store(m.removal, &removal_[k * size]);
            store(m.rotation, &rotation_[k * size]);
        }
    });
}

void HshRotationTable::multiply(const std::vector<float>& tables, double betaRad, const float* in,
                                float* out) const {
    const double at = betaRad / std::numbers::pi * (angleCount_ - 1);
    const size_t below = size_t(std::clamp(int(at), 0, angleCount_ - 2));
    const float share = float(std::clamp(at - double(below), 0.0, 1.0));
    const float* table = tables.data() + below * tableSize(hshOrder_);
    float sorted[shCount(kMaxShOrder)], product[shCount(kMaxShOrder)];
    for (int p = 0; p < 2; ++p) {
        const size_t size = parityCount(hshOrder_, p);
        size_t k = 0;
        const auto forAll = [&](const auto& visit) {
            k = 0;
            for (int l = 0; l < hshOrder_; ++l)
                for (int m = p == 0 ? 0 : -l; m <= (p == 0 ? l : -1); ++m) visit(shIndex(l, m));
        };
        forAll([&](int i) { sorted[k++] = in[i]; });
        std::fill_n(product, size, 0.0f);
        addProduct(table, 1 - share, table + tableSize(hshOrder_), share, size, sorted, product);
        forAll([&](int i) { out[i] = product[k++]; });
        table += size * size;
    }
}

void HshRotationTable::rotateByDigonRemoval(const Mat3d& targetFromSource, std::span<const float> in,
                                            std::span<float> out) const {
    checkRotationSizes(hshOrder_, in.size(), out.size());
    const ZyzAngles angles = zyzFromRotation(targetFromSource);
    float v[shCount(kMaxShOrder)];
    std::copy(in.begin(), in.end(), v);
    turnAboutZ(angles.gammaRad, hshOrder_, v);
    multiply(removal_, angles.betaRad, v, v);
    const Mat3d turn = rotationFromZyz({angles.alphaRad, hshShAngle(angles.betaRad), 0});
    rotateSh(turn, hshOrder_, std::span<const float>(v, in.size()), out);
}

void HshRotationTable::rotateByTable(const Mat3d& targetFromSource, std::span<const float> in,
                                     std::span<float> out) const {
    checkRotationSizes(hshOrder_, in.size(), out.size());
    const ZyzAngles angles = zyzFromRotation(targetFromSource);
    float v[shCount(kMaxShOrder)];
    std::copy(in.begin(), in.end(), v);
    turnAboutZ(angles.gammaRad, hshOrder_, v);
    multiply(rotation_, angles.betaRad, v, v);
    turnAboutZ(angles.alphaRad, hshOrder_, v);
    std::copy_n(v, in.size(), out.begin());
}

}  // namespace prt
