// Euler angles of rotation matrices as cosines and sines, without trigonometry, on one value or on many
// lanes. Internal.
#pragma once

#include <cmath>

namespace prt {

/// What each kind of number brings: one double, or lanes of float in sh_rotation_lanes.h.
template <typename A>
struct AngleTraits;
template <>
struct AngleTraits<double> {
    /// Below it sin²β counts as 0: the angles then differ by 1e-15.
    static constexpr double kTinySquare = 1e-30;
    static bool less(double a, double b) { return a < b; }
    static double inverseSqrt(double x) { return 1 / std::sqrt(x); }
    static double choose(bool condition, double a, double b) { return condition ? a : b; }
};

/// Cosines and sines of R = Rz(α) Ry(β) Rz(γ), 0 <= β <= π.
template <typename A>
struct ZyzTurns {
    A cosAlpha, sinAlpha, cosBeta, sinBeta, cosGamma, sinGamma;
};

/// Divides (c, s) by its length where that is 1 to 1e-3, by the series of 1/√(1 + e) to e⁴: 1e-14 of it.
template <typename A>
[[gnu::always_inline]] inline void normaliseTurn(A& c, A& s) {
    const A e = c * c + (s * s - 1);
    const A scale = 1 + e * (-0.5f + e * (0.375f + e * (-0.3125f + e * 0.2734375f)));
    c *= scale;
    s *= scale;
}

/// Decomposes a matrix that is a rotation by rotationDeviation. γ follows from the matrix turned back by α,
/// so that the product is right where β is near 0 or π and α is arbitrary.
/// @param r  [9] by rows
template <typename A>
[[gnu::always_inline]] inline ZyzTurns<A> zyzTurns(const A* r) {
    using Traits = AngleTraits<A>;
    const A square = r[2] * r[2] + r[5] * r[5];
    const auto atPole = Traits::less(square, A{} + Traits::kTinySquare);
    const A inverse = Traits::inverseSqrt(square);
    ZyzTurns<A> t;
    t.cosAlpha = Traits::choose(atPole, A{} + 1, r[2] * inverse);
    t.sinAlpha = Traits::choose(atPole, A{}, r[5] * inverse);
    t.cosBeta = r[8];
    t.sinBeta = t.cosAlpha * r[2] + t.sinAlpha * r[5];
    t.sinGamma = t.cosAlpha * r[3] - t.sinAlpha * r[0];
    t.cosGamma = t.cosAlpha * r[4] - t.sinAlpha * r[1];
    normaliseTurn(t.cosBeta, t.sinBeta);
    normaliseTurn(t.cosGamma, t.sinGamma);
    return t;
}

/// The same with γ read from the last row where β is far from 0 and π, and 1/√x = √x · (1/x), whose factors
/// do not wait for each other: half the latency.
inline ZyzTurns<double> zyzTurnsSoon(const double* r) {
    const double square = r[2] * r[2] + r[5] * r[5], squareOfRow = r[6] * r[6] + r[7] * r[7];
    if (square < 1.0 / 64) return zyzTurns(r);
    const double root = std::sqrt(square), inverse = 1 / square;
    const double rootOfRow = std::sqrt(squareOfRow), inverseOfRow = 1 / squareOfRow;
    ZyzTurns<double> t{
        r[2] * inverse * root,          r[5] * inverse * root, r[8], root, -r[6] * inverseOfRow * rootOfRow,
        r[7] * inverseOfRow * rootOfRow};
    normaliseTurn(t.cosBeta, t.sinBeta);
    return t;
}

/// Largest deviation from a rotation that is taken for rounding: of the sum of squares below.
inline constexpr double kMaxRotationDeviation = 1e-6;

/// Sum of squares of what keeps a matrix from being a rotation: two columns off unit length and off a right
/// angle, and the third off their cross product.
template <typename A>
[[gnu::always_inline]] inline A rotationDeviation(const A* r) {
    const A a = r[0] * r[0] + r[3] * r[3] + r[6] * r[6] - 1;
    const A b = r[1] * r[1] + r[4] * r[4] + r[7] * r[7] - 1;
    const A c = r[0] * r[1] + r[3] * r[4] + r[6] * r[7];
    const A x = r[3] * r[7] - r[6] * r[4] - r[2];
    const A y = r[6] * r[1] - r[0] * r[7] - r[5];
    const A z = r[0] * r[4] - r[3] * r[1] - r[8];
    return a * a + b * b + c * c + x * x + y * y + z * z;
}

}  // namespace prt
