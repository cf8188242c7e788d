// Euler angles of rotation matrices as cosines and sines, without trigonometry, on one value or on many
// lanes. Internal.
#pragma once

#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/vec.h"

namespace prt::detail {

/// What each kind of number brings: one double, or lanes of float in sh_rotation_lanes.h.
template <typename A>
struct AngleTraits;
template <>
struct AngleTraits<double> {
    using Condition = bool;
    /// Below it sin²β counts as 0: the angles then differ by 1e-15.
    static constexpr double kTinySquare = 1e-30;
    /// As √x · (1/x), whose factors do not wait for each other.
    [[gnu::always_inline]] static void inverseSqrt(double x, double& y) { y = std::sqrt(x) * (1 / x); }
};

/// Cosines and sines of R = Rz(α) Ry(β) Rz(γ), 0 <= β <= π.
template <typename A>
struct ZyzTurns {
    A cosAlpha, sinAlpha, cosBeta, sinBeta, cosGamma, sinGamma;
    A halfTangent;  ///< tan(β/2), or its inverse where β > π/2
};

/// Divides (c, s) by its length where that is 1 to 1e-3, by the series of 1/√(1 + e) to e³: 1e-11 of it, and
/// to rounding where the length is 1 to float precision.
template <typename A>
[[gnu::always_inline]] inline void normaliseTurn(A& c, A& s) {
    const A e = c * c + (s * s - 1);
    const A scale = 1 + e * (-0.5f + e * (0.375f - e * 0.3125f));
    c *= scale;
    s *= scale;
}

/// Decomposes a matrix that is a rotation by rotationDeviation. γ follows from α and from α + γ or α − γ,
/// whichever the matrix knows well, so that the product is right where β is near 0 or π and α is arbitrary:
/// the upper left 2×2 block is (1 + cosβ)/2 times a turn by α + γ, plus (1 − cosβ)/2 times a mirrored turn by
/// α − γ.
/// @param r  [9] by rows
template <typename A>
[[gnu::always_inline]] inline void zyzTurns(const A* r, ZyzTurns<A>& t) {
    using Condition = typename AngleTraits<A>::Condition;
    const A square = r[2] * r[2] + r[5] * r[5];
    const Condition atPole = square < A{} + AngleTraits<A>::kTinySquare;
    A inverse;
    AngleTraits<A>::inverseSqrt(square, inverse);
    t.cosAlpha = atPole ? A{} + 1 : r[2] * inverse;
    t.sinAlpha = atPole ? A{} : r[5] * inverse;
    t.cosBeta = r[8];
    t.sinBeta = t.cosAlpha * r[2] + t.sinAlpha * r[5];

    const Condition upper = r[8] < A{};
    A cosSum = upper ? r[4] - r[0] : r[0] + r[4], sinSum = upper ? -r[3] - r[1] : r[3] - r[1];
    A inverseOfSum;  // 1/(1 + |cosβ|)
    AngleTraits<A>::inverseSqrt(cosSum * cosSum + sinSum * sinSum, inverseOfSum);
    cosSum *= inverseOfSum;
    sinSum *= inverseOfSum;
    // γ = (α + γ) − α, or α − (α − γ)
    t.cosGamma = cosSum * t.cosAlpha + sinSum * t.sinAlpha;
    const A sine = sinSum * t.cosAlpha - cosSum * t.sinAlpha;
    t.sinGamma = upper ? -sine : sine;
    t.halfTangent = t.sinBeta * inverseOfSum;
    normaliseTurn(t.cosBeta, t.sinBeta);
}

/// β of the turns, to 5e-8.
/// @source [AbramowitzStegun1964, 4.4.49]: arctan on 0..1 to 2e-8
template <typename A>
[[gnu::always_inline]] inline void turnAngle(const ZyzTurns<A>& t, A& angle) {
    constexpr float kSeries[8] = {-.3333314528f, .1999355085f, -.1420889944f, .1065626393f,
                                  -.0752896400f, .0429096138f, -.0161657367f, .0028662257f};
    const A z = t.halfTangent * t.halfTangent;
    A sum = A{} + kSeries[7];
    for (int k = 6; k >= 0; --k) sum = kSeries[k] + z * sum;
    angle = 2 * t.halfTangent * (1 + z * sum);
    angle = t.cosBeta < A{} ? std::numbers::pi_v<float> - angle : angle;
}

/// Largest deviation from a rotation that is taken for rounding: of the sum of squares below.
inline constexpr double kMaxRotationDeviation = 1e-6;

/// Sum of squares of what keeps a matrix from being a rotation: two columns off unit length and off a right
/// angle, and the third off their cross product.
template <typename A>
[[gnu::always_inline]] inline void rotationDeviation(const A* r, A& deviation) {
    const A a = r[0] * r[0] + r[3] * r[3] + r[6] * r[6] - 1;
    const A b = r[1] * r[1] + r[4] * r[4] + r[7] * r[7] - 1;
    const A c = r[0] * r[1] + r[3] * r[4] + r[6] * r[7];
    const A x = r[3] * r[7] - r[6] * r[4] - r[2];
    const A y = r[6] * r[1] - r[0] * r[7] - r[5];
    const A z = r[0] * r[4] - r[3] * r[1] - r[8];
    deviation = a * a + b * b + c * c + x * x + y * y + z * z;
}

/// The entries by rows, after a check that they are a rotation.
struct CheckedRows {
    double r[9];
    explicit CheckedRows(const Mat3d& m)
        : r{m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)} {
        double deviationFromRotation;
        rotationDeviation(r, deviationFromRotation);
        PRT_CHECK_LT(deviationFromRotation, kMaxRotationDeviation);
    }
};

}  // namespace prt::detail
