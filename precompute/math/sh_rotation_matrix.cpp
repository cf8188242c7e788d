// Rotation matrices by recurrence over the bands: [IvanicRuedenberg1996] "Rotation matrices for real
// spherical harmonics. Direct determination by recursion" with the corrections of [IvanicRuedenberg1998];
// their derivatives by Leibniz's rule [Krivanek2006, App. A].
#include "precompute/math/sh_rotation_matrix.h"

#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation_lanes.h"

namespace prt {
namespace {

using namespace detail;

/// Entries of the bands below this one.
constexpr size_t blockStart(int band) { return size_t(band * (4 * band * band - 1) / 3); }

constexpr size_t kMaxBandSize = 2 * kMaxShOrder - 1;

/// out = block in, for lanes. Four rows at a time, so that four sums run side by side.
[[gnu::always_inline]] inline void applyBlock(const float* block, int size, const ConstLaneRows& in,
                                              const LaneRows& out) {
    Lanes v[kMaxBandSize], sums[kMaxBandSize + 3];
    for (int c = 0; c < size; ++c) in(size_t(c), v[c]);
    for (int r = 0; r < size; r += 4) {
        const float* rows[4];
        for (int i = 0; i < 4; ++i) rows[i] = block + std::min(r + i, size - 1) * size;
        Lanes a{}, b{}, c{}, d{};
        for (int k = 0; k < size; ++k) {
            a += rows[0][k] * v[k];
            b += rows[1][k] * v[k];
            c += rows[2][k] * v[k];
            d += rows[3][k] * v[k];
        }
        sums[r] = a;
        sums[r + 1] = b;
        sums[r + 2] = c;
        sums[r + 3] = d;
    }
    for (int r = 0; r < size; ++r) out(size_t(r), sums[r]);
}

PRT_TARGET_CLONES void applyLanes(int shOrder, const float* entries, const ConstLaneRows& in,
                                  const LaneRows& out) {
    for (int l = 0; l < shOrder; ++l) {
        const size_t first = size_t(l * l);
        applyBlock(entries + blockStart(l), 2 * l + 1, {in.data + first * in.stride, in.stride},
                   {out.data + first * out.stride, out.stride});
    }
}

template <typename T>
void applyTo(int shOrder, const double* entries, std::span<const T> in, std::span<T> out) {
    PRT_CHECK_EQ(in.size(), size_t(shCount(shOrder)));
    PRT_CHECK_EQ(out.size(), in.size());
    double v[kMaxBandSize];
    for (int l = 0; l < shOrder; ++l) {
        const size_t size = size_t(2 * l + 1), first = size_t(l * l);
        for (size_t c = 0; c < size; ++c) v[c] = double(in[first + c]);
        for (size_t r = 0; r < size; ++r) {
            double sum = 0;
            for (size_t c = 0; c < size; ++c) sum += *entries++ * v[c];
            out[first + r] = T(sum);
        }
    }
}

/// out's band += weight · (band 1 of `one` times the band below of `below`).
void addBand(const ShBandMatrix& one, const ShBandMatrix& below, int band, double weight, ShBandMatrix& out) {
    addNextBand({one.block(1).data(), 1}, {below.block(band - 1).data(), band - 1}, weight,
                {out.block(band).data(), band});
}

/// Bands 0 and 1: the matrix itself, in the order and with the signs of (−y, z, −x).
void setFirstBands(const Mat3d& r, ShBandMatrix& m) {
    constexpr int kAxis[3] = {1, 2, 0}, kSign[3] = {-1, 1, -1};
    m.block(0)[0] = 1;
    if (m.shOrder() == 1) return;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            m.block(1)[size_t(3 * i + j)] = kSign[i] * kSign[j] * r(kAxis[i], kAxis[j]);
}

double binomial(int n, int k) {
    double result = 1;
    for (int i = 0; i < k; ++i) result *= double(n - i) / (i + 1);
    return std::round(result);
}

}  // namespace

ShBandMatrix::ShBandMatrix(int shOrder) : shOrder_(shOrder) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxShOrder);
    entries_.resize(blockStart(shOrder));
}

ShBandMatrix ShBandMatrix::identity(int shOrder) {
    ShBandMatrix result(shOrder);
    for (int l = 0; l < shOrder; ++l)
        for (size_t i = 0; i < size_t(2 * l + 1); ++i) result.block(l)[i * size_t(2 * l + 2)] = 1;
    return result;
}

std::span<const double> ShBandMatrix::block(int band) const {
    PRT_CHECK_LE(0, band);
    PRT_CHECK_LT(band, shOrder_);
    return {entries_.data() + blockStart(band), size_t((2 * band + 1) * (2 * band + 1))};
}

std::span<double> ShBandMatrix::block(int band) {
    PRT_CHECK_LE(0, band);
    PRT_CHECK_LT(band, shOrder_);
    return {entries_.data() + blockStart(band), size_t((2 * band + 1) * (2 * band + 1))};
}

void ShBandMatrix::apply(std::span<const double> in, std::span<double> out) const {
    applyTo(shOrder_, entries_.data(), in, out);
}

void ShBandMatrix::apply(std::span<const float> in, std::span<float> out) const {
    applyTo(shOrder_, entries_.data(), in, out);
}

void ShBandMatrix::applySoa(size_t count, size_t stride, std::span<const float> in,
                            std::span<float> out) const {
    float entries[blockStart(kMaxShOrder)];
    for (size_t i = 0; i < entries_.size(); ++i) entries[i] = float(entries_[i]);
    forEachLanes({}, shOrder_, count, stride, in, out,
                 [&](const ConstLaneRows&, const ConstLaneRows& from, const LaneRows& to) {
                     applyLanes(shOrder_, entries, from, to);
                 });
}

void ShBandMatrix::add(double scale, const ShBandMatrix& other) {
    PRT_CHECK_EQ(shOrder_, other.shOrder_);
    for (size_t i = 0; i < entries_.size(); ++i) entries_[i] += scale * other.entries_[i];
}

ShRotationMatrix::ShRotationMatrix(const Mat3d& targetFromSource, int shOrder) : ShBandMatrix(shOrder) {
    const CheckedRows checked(targetFromSource);
    setFirstBands(targetFromSource, *this);
    for (int l = 2; l < shOrder; ++l) addBand(*this, *this, l, 1, *this);
}

std::vector<ShBandMatrix> shYRotationDerivatives(int shOrder, double betaRad, int maxDerivative) {
    PRT_CHECK_LE(0, maxDerivative);
    std::vector<ShBandMatrix> result(size_t(maxDerivative) + 1, ShBandMatrix(shOrder));
    for (int k = 0; k <= maxDerivative; ++k) {
        // d^k cos = cos(β + kπ/2), without the rounding of kπ/2
        const double c = std::cos(betaRad), s = std::sin(betaRad);
        const double cosine[4] = {c, -s, -c, s}, sine[4] = {s, c, -s, -c};
        Mat3d r = Mat3d::Zero();
        r(0, 0) = r(2, 2) = cosine[k % 4];
        r(0, 2) = sine[k % 4];
        r(2, 0) = -sine[k % 4];
        r(1, 1) = k == 0;
        setFirstBands(r, result[size_t(k)]);
        if (k > 0) result[size_t(k)].block(0)[0] = 0;
        for (int l = 2; l < shOrder; ++l)
            for (int i = 0; i <= k; ++i)
                addBand(result[size_t(i)], result[size_t(k - i)], l, binomial(k, i), result[size_t(k)]);
    }
    return result;
}

}  // namespace prt
