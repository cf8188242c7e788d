// Rotation of spherical-harmonic expansions.
#pragma once

#include <span>

#include "precompute/math/vec.h"

namespace prt {

/// Rotates an expansion: (Rf)(ω) = f(Rᵀω), by zxzxz: R = Rz(α)·X₋₉₀·Rz(β)·X₊₉₀·Rz(γ). Exact to rounding:
/// float calls compute bands below 10 in float and err by 1e-6 of the band's length, double calls by 1e-13.
/// @param targetFromSource  rotation matrix R; checked to 1e-3
/// @param shOrder           1..kMaxShOrder
/// @param in, out           [n²], index shIndex; the same memory, or apart
/// @source [Kautz2002], [Krivanek2006, Sec. 2.2] in our own orientation (see the errata in
/// tools/docs/papers.md)
void rotateSh(const Mat3d& targetFromSource, int shOrder, std::span<const float> in, std::span<float> out);
void rotateSh(const Mat3d& targetFromSource, int shOrder, std::span<const double> in, std::span<double> out);

/// Multiplications of one zxzxz rotation by the paper's count: three turns about z of 2n(n − 1) and two about
/// x of n(n² + 2)/3. Ours has fewer, because many constants of the turns about x are 0 or ±1.
/// @source [Krivanek2006, Sec. 3.2]
constexpr int zxzxzMultiplications(int shOrder) {
    return shOrder * (2 * shOrder * shOrder + 18 * shOrder - 14) / 3;
}

/// Angles of R = Rz(alphaRad)·Ry(betaRad)·Rz(gammaRad).
struct ZyzAngles {
    double alphaRad;  ///< −π..π
    double betaRad;   ///< 0..π
    double gammaRad;  ///< −π..π
};

/// Decomposes a rotation. Where β is 0 or π (to 1e-15), α is 0 and γ carries the whole turn about z.
/// @param rotation  rotation matrix; checked to 1e-3
/// @source [Krivanek2006, Sec. 3]: zyz Euler angles
ZyzAngles zyzFromRotation(const Mat3d& rotation);
/// The matrix that belongs to the angles, any three.
Mat3d rotationFromZyz(const ZyzAngles& angles);

/// Rotation about the up axis (+Y) by angleRad, counter-clockwise seen from above: +Z turns towards +X.
Mat3d rotationAboutUp(double angleRad);

}  // namespace prt
