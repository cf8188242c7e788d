// Rotation matrices: whether they are, and what their Euler angles need, on one value or on many lanes.
// Internal.
#pragma once

#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/vec.h"

namespace prt::detail {

/// Divides (c, s) by its length where that is 1 to 1e-3, by the series of 1/√(1 + e) to e³: 1e-11 of it, and
/// to rounding where the length is 1 to float precision.
template <typename A>
[[gnu::always_inline]] inline void normaliseTurn(A& c, A& s) {
    const A e = c * c + (s * s - 1);
    const A scale = 1 + e * (-0.5f + e * (0.375f - e * 0.3125f));
    c *= scale;
    s *= scale;
}

/// β from halfTangent = sinβ/(1 + |cosβ|), which is tan(β/2) or, where β > π/2, its inverse; to 5e-8.
/// @source [AbramowitzStegun1964, 4.4.49]: arctan on 0..1 to 2e-8
template <typename A>
[[gnu::always_inline]] inline void turnAngle(const A& cosBeta, const A& halfTangent, A& angle) {
    constexpr float kSeries[8] = {-.3333314528f, .1999355085f, -.1420889944f, .1065626393f,
                                  -.0752896400f, .0429096138f, -.0161657367f, .0028662257f};
    const A z = halfTangent * halfTangent;
    A sum = A{} + kSeries[7];
    for (int k = 6; k >= 0; --k) sum = kSeries[k] + z * sum;
    angle = 2 * halfTangent * (1 + z * sum);
    angle = cosBeta < A{} ? std::numbers::pi_v<float> - angle : angle;
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

/// The entries of a 3×3 matrix by rows.
struct MatrixRows {
    double r[9];
    /// @param columns  [9] by columns
    [[gnu::always_inline]] explicit MatrixRows(const double* columns)
        : r{columns[0], columns[3], columns[6], columns[1], columns[4],
            columns[7], columns[2], columns[5], columns[8]} {}
};

/// The same after a check that they are a rotation.
struct CheckedRows : MatrixRows {
    explicit CheckedRows(const Mat3d& m) : MatrixRows(m.data()) {
        double deviationFromRotation;
        rotationDeviation(r, deviationFromRotation);
        PRT_CHECK_LT(deviationFromRotation, kMaxRotationDeviation);
    }
};

}  // namespace prt::detail
