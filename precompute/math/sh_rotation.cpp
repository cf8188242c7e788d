// Rotation of spherical-harmonic expansions by Z·X₋₉₀·Z·X₊₉₀·Z [Kautz2002] "Fast, arbitrary BRDF shading...",
// [Krivanek2006, Sec. 2.2]. Rotations about z act on pairs (m, −m); those by ±90° about x are constant
// matrices, a quarter of whose entries are not zero. They are computed by a quadrature that is exact for
// them.
#include "precompute/math/sh_rotation.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <vector>

#include "precompute/base/check.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

/// Sparse square matrix of one band by rows.
struct BandMatrix {
    std::vector<int32_t> rowStart;
    std::vector<int16_t> column;
    std::vector<double> value;

    void append(int c, double v) {
        column.push_back(int16_t(c));
        value.push_back(v);
    }
    void multiply(const double* in, double* out) const {
        for (size_t r = 0; r + 1 < rowStart.size(); ++r) {
            double sum = 0;
            for (int32_t e = rowStart[r]; e < rowStart[r + 1]; ++e)
                sum += value[size_t(e)] * in[column[size_t(e)]];
            out[r] = sum;
        }
    }
};

struct QuarterTurns {
    BandMatrix plus, minus;  ///< about x by +90° and −90°: transposes of each other
};

/// D_ij = ∫ Y_i(ω) Y_j(Rᵀω) for R = +90° about x, which takes (x, y, z) to (x, −z, y).
std::vector<double> denseQuarterTurn(int band) {
    const int size = 2 * band + 1;
    const size_t first = size_t(shIndex(band, -band));
    std::vector<double> matrix(size_t(size) * size_t(size), 0.0);
    std::vector<double> here(size_t(shCount(band + 1))), source(here.size());
    for (const SphereNode& node : sphereQuadrature(2 * band)) {
        const Vec3d& d = node.direction;
        evalSh(band + 1, d, std::span<double>(here));
        evalSh(band + 1, Vec3d(d.x(), d.z(), -d.y()), std::span<double>(source));
        for (int r = 0; r < size; ++r) {
            const double weighted = node.weightSr * here[first + size_t(r)];
            for (int c = 0; c < size; ++c)
                matrix[size_t(r * size + c)] += weighted * source[first + size_t(c)];
        }
    }
    return matrix;
}

const QuarterTurns& quarterTurns(int band) {
    static std::array<QuarterTurns, kMaxShOrder> matrices;
    static std::array<std::once_flag, kMaxShOrder> flags;
    QuarterTurns& result = matrices[size_t(band)];
    std::call_once(flags[size_t(band)], [&] {
        const std::vector<double> dense = denseQuarterTurn(band);
        const int size = 2 * band + 1;
        // Exact zeros come out as rounding, 1e-15; the smallest entry of band 23 that is not zero is 2^-23.
        constexpr double kZero = 1e-11;
        for (int r = 0; r < size; ++r) {
            result.plus.rowStart.push_back(int32_t(result.plus.value.size()));
            result.minus.rowStart.push_back(int32_t(result.minus.value.size()));
            for (int c = 0; c < size; ++c) {
                const double forth = dense[size_t(r * size + c)], back = dense[size_t(c * size + r)];
                if (std::abs(forth) > kZero) result.plus.append(c, forth);
                if (std::abs(back) > kZero) result.minus.append(c, back);
            }
        }
        result.plus.rowStart.push_back(int32_t(result.plus.value.size()));
        result.minus.rowStart.push_back(int32_t(result.minus.value.size()));
    });
    return result;
}

/// cos(m a) and sin(m a) for m < kMaxShOrder.
struct Multiples {
    std::array<double, kMaxShOrder> cosine, sine;
    Multiples(int shOrder, double c, double s) {
        cosine[0] = 1;
        sine[0] = 0;
        for (size_t m = 1; m < size_t(shOrder); ++m) {
            cosine[m] = c * cosine[m - 1] - s * sine[m - 1];
            sine[m] = s * cosine[m - 1] + c * sine[m - 1];
        }
    }
};

/// Turns one band about z; v points at its m = 0.
void turnAboutZ(const Multiples& angle, int band, double* v) {
    for (int m = 1; m <= band; ++m) {
        const double c = angle.cosine[size_t(m)], s = angle.sine[size_t(m)];
        const double even = v[m], odd = v[-m];
        v[m] = c * even - s * odd;
        v[-m] = s * even + c * odd;
    }
}

void checkIsRotation(const Mat3d& r) {
    const double deviation = (r.transpose() * r - Mat3d::Identity()).cwiseAbs().maxCoeff();
    PRT_CHECK_LT(deviation, 1e-3);
    PRT_CHECK_LT(0.0, r.determinant());
}

template <typename T>
void rotate(const Mat3d& r, int shOrder, std::span<const T> in, std::span<T> out) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxShOrder);
    PRT_CHECK_EQ(in.size(), size_t(shCount(shOrder)));
    PRT_CHECK_EQ(out.size(), in.size());
    checkIsRotation(r);
    // R = Rz(α) Ry(β) Rz(γ). The third angle follows from the matrix turned back by the first, which stays
    // exact where β is near 0 or π and α is arbitrary.
    const double sinBeta = std::hypot(r(0, 2), r(1, 2)), length = std::hypot(sinBeta, r(2, 2));
    const double cosAlpha = sinBeta > 0 ? r(0, 2) / sinBeta : 1,
                 sinAlpha = sinBeta > 0 ? r(1, 2) / sinBeta : 0;
    const double sinGamma = cosAlpha * r(1, 0) - sinAlpha * r(0, 0);
    const double cosGamma = cosAlpha * r(1, 1) - sinAlpha * r(0, 1);
    const double gammaLength = std::hypot(sinGamma, cosGamma);
    const Multiples alpha(shOrder, cosAlpha, sinAlpha), beta(shOrder, r(2, 2) / length, sinBeta / length),
        gamma(shOrder, cosGamma / gammaLength, sinGamma / gammaLength);

    double a[2 * kMaxShOrder - 1], b[2 * kMaxShOrder - 1];
    for (int l = 0; l < shOrder; ++l) {
        const QuarterTurns& turns = quarterTurns(l);
        const size_t first = size_t(shIndex(l, -l));
        for (size_t i = 0; i < size_t(2 * l + 1); ++i) a[i] = double(in[first + i]);
        turnAboutZ(gamma, l, a + l);
        turns.plus.multiply(a, b);
        turnAboutZ(beta, l, b + l);
        turns.minus.multiply(b, a);
        turnAboutZ(alpha, l, a + l);
        for (size_t i = 0; i < size_t(2 * l + 1); ++i) out[first + i] = T(a[i]);
    }
}

}  // namespace

void rotateSh(const Mat3d& targetFromSource, int shOrder, std::span<const float> in, std::span<float> out) {
    rotate<float>(targetFromSource, shOrder, in, out);
}

void rotateSh(const Mat3d& targetFromSource, int shOrder, std::span<const double> in, std::span<double> out) {
    rotate<double>(targetFromSource, shOrder, in, out);
}

Mat3d rotationAboutUp(double angleRad) {
    const double c = std::cos(angleRad), s = std::sin(angleRad);
    Mat3d r;
    r << c, 0, s, 0, 1, 0, -s, 0, c;
    return r;
}

}  // namespace prt
