// Matrices of rotations on spherical-harmonic expansions: a block per band, by the recurrence of Ivanic and
// Ruedenberg; their derivatives.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "precompute/math/vec.h"

namespace prt {

/// A matrix on expansions that keeps bands apart: (2l + 1)×(2l + 1) for every band l.
class ShBandMatrix {
  public:
    /// All entries 0.
    /// @param shOrder  n, 1..kMaxShOrder
    explicit ShBandMatrix(int shOrder);
    static ShBandMatrix identity(int shOrder);

    int shOrder() const { return shOrder_; }
    /// The block of a band by rows: entry (m, m') at (m + l)·(2l + 1) + m' + l.
    /// @param band  l, 0..shOrder − 1
    std::span<const double> block(int band) const;
    std::span<double> block(int band);
    /// Entries of all blocks: n(4n² − 1)/3.
    size_t entryCount() const { return entries_.size(); }

    /// out = M in.
    /// @param in, out  [n²]; the same memory, or apart
    void apply(std::span<const double> in, std::span<double> out) const;
    void apply(std::span<const float> in, std::span<float> out) const;
    /// The same for many vectors, in float, sixteen at a time: coefficient i of vector k at data[i·stride +
    /// k]. Allocates nothing.
    /// @param count    vectors; the rest of every row is left alone
    /// @param stride   >= count
    /// @param in, out  at least (n² − 1)·stride + count floats; the same memory, or apart
    void applySoa(size_t count, size_t stride, std::span<const float> in, std::span<float> out) const;

    /// this += scale · other, entry by entry; of the same shOrder.
    void add(double scale, const ShBandMatrix& other);

  private:
    int shOrder_;
    std::vector<double> entries_;
};

/// The matrix of a rotation, (Rf)(ω) = f(Rᵀω): exact to 1e-13 for orders up to kMaxShOrder.
/// @source [IvanicRuedenberg1996, Eq. 8.1, Tables 1 and 2] with the corrections of [IvanicRuedenberg1998]
class ShRotationMatrix : public ShBandMatrix {
  public:
    /// @param targetFromSource  rotation matrix R, checked to 1e-3
    /// @param shOrder           n, 1..kMaxShOrder
    ShRotationMatrix(const Mat3d& targetFromSource, int shOrder);
};

/// Derivatives of the rotation about y (+Z turns towards +X) with respect to its angle: d^k R_y/dβ^k for k =
/// 0 … maxDerivative. At β = 0 the k-th is the k-th power of the first.
/// @param shOrder        n, 1..kMaxShOrder
/// @param betaRad        any angle
/// @param maxDerivative  >= 0
/// @return [maxDerivative + 1]
/// @source [Krivanek2006, App. A] at any angle and in our orientation: theirs is the inverse rotation
std::vector<ShBandMatrix> shYRotationDerivatives(int shOrder, double betaRad, int maxDerivative);

/// Multiplications of applying a rotation matrix: one for every entry of its blocks, n(4n² − 1)/3.
/// @source [Krivanek2006, Sec. 3.2]: N_nz
constexpr int ivanicMultiplications(int shOrder) { return shOrder * (4 * shOrder * shOrder - 1) / 3; }

}  // namespace prt
