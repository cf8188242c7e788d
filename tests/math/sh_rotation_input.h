// Rotations, references and matrices that the tests of rotations share.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation.h"
#include "precompute/math/sh_rotation_matrix.h"
#include "tests/math/random_input.h"

namespace prt::test {

inline constexpr double kPi = std::numbers::pi;

inline Mat3d about(const Vec3d& axis, double angle) {
    return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

/// Rotations at and near the poles of the Euler angles, and plain ones.
inline std::vector<Mat3d> awkwardRotations() {
    std::vector<Mat3d> result = {Mat3d::Identity()};
    const Vec3d axes[] = {Vec3d::UnitX(), Vec3d::UnitY(), Vec3d::UnitZ(), Vec3d(1, 1, 0).normalized()};
    for (const Vec3d& axis : axes)
        for (const double angle : {kPi / 2, -kPi / 2, kPi, 1e-3, 1e-8, 1e-15, kPi - 1e-8, kPi - 1e-15, 2.0})
            for (const double twist : {0.0, 0.7, kPi})
                result.push_back(about(Vec3d::UnitZ(), twist) * about(axis, angle));
    RandomInput random(51);
    for (int k = 0; k < 10; ++k) result.push_back(random.rotation());
    return result;
}

template <typename A, typename B>
double largestDifference(const A& a, const B& b) {
    EXPECT_EQ(std::size(a), std::size(b));
    double worst = 0;
    for (size_t i = 0; i < std::size(a); ++i) worst = std::max(worst, std::abs(double(a[i]) - double(b[i])));
    return worst;
}

inline std::vector<double> rotated(const Mat3d& r, int shOrder, const std::vector<double>& c) {
    std::vector<double> out(c.size());
    rotateSh(r, shOrder, std::span<const double>(c), std::span<double>(out));
    return out;
}

/// Coefficients of ω ↦ f(Rᵀω), by a quadrature that is exact for them: what every rotation has to give.
inline std::vector<double> projectRotated(const Mat3d& r, int shOrder, const std::vector<double>& c) {
    const size_t count = c.size();
    std::vector<double> result(count, 0.0), y(count);
    for (const SphereNode& node : sphereQuadrature(2 * (shOrder - 1))) {
        evalSh(shOrder, Vec3d(r.transpose() * node.direction), std::span<double>(y));
        double value = 0;
        for (size_t i = 0; i < count; ++i) value += c[i] * y[i];
        evalSh(shOrder, node.direction, std::span<double>(y));
        for (size_t i = 0; i < count; ++i) result[i] += node.weightSr * value * y[i];
    }
    return result;
}

inline std::vector<double> applied(const ShBandMatrix& matrix, const std::vector<double>& c) {
    std::vector<double> out(c.size());
    matrix.apply(std::span<const double>(c), std::span<double>(out));
    return out;
}

inline double largestEntryDifference(const ShBandMatrix& a, const ShBandMatrix& b) {
    double worst = 0;
    for (int l = 0; l < a.shOrder(); ++l) worst = std::max(worst, largestDifference(a.block(l), b.block(l)));
    return worst;
}

/// The largest singular value over all bands, by iterating the power of DᵀD.
inline double largestSingularValue(const ShBandMatrix& d) {
    double worst = 0;
    RandomInput random(58);
    for (int l = 0; l < d.shOrder(); ++l) {
        const size_t size = size_t(2 * l + 1);
        const std::span<const double> m = d.block(l);
        std::vector<double> v = random.coefficients<double>(int(size)), w(size);
        double value = 0;
        for (int round = 0; round < 300; ++round) {
            std::fill(w.begin(), w.end(), 0.0);
            for (size_t r = 0; r < size; ++r)
                for (size_t c = 0; c < size; ++c) w[r] += m[r * size + c] * v[c];
            std::fill(v.begin(), v.end(), 0.0);
            for (size_t r = 0; r < size; ++r)
                for (size_t c = 0; c < size; ++c) v[c] += m[r * size + c] * w[r];
            double length = 0;
            for (const double x : v) length += x * x;
            length = std::sqrt(length);
            if (length == 0) break;
            value = std::sqrt(length);
            for (double& x : v) x /= length;
        }
        worst = std::max(worst, value);
    }
    return worst;
}

/// Rotations and vectors as structures of arrays, and the vectors one by one.
struct SoaInput {
    size_t count, stride;
    std::vector<Mat3d> rotations;
    std::vector<float> soaRotations, soaVectors;

    SoaInput(int shOrder, size_t countIn, size_t strideIn, uint64_t seed, double maxBeta = kPi)
        : count(countIn),
          stride(strideIn),
          soaRotations(9 * strideIn, kUntouched),
          soaVectors(size_t(shCount(shOrder)) * strideIn, kUntouched) {
        RandomInput random(seed);
        for (size_t k = 0; k < count; ++k) {
            const Mat3d r = rotationFromZyz(
                {random.uniform(-kPi, kPi), random.uniform(0, maxBeta), random.uniform(-kPi, kPi)});
            rotations.push_back(r.cast<float>().cast<double>());
            for (size_t i = 0; i < 9; ++i)
                soaRotations[i * stride + k] = float(r(Eigen::Index(i / 3), Eigen::Index(i % 3)));
            for (size_t i = 0; i < size_t(shCount(shOrder)); ++i)
                soaVectors[i * stride + k] = float(random.uniform(-1, 1));
        }
    }
    std::vector<double> vector(const std::vector<float>& soa, size_t k) const {
        std::vector<double> result;
        for (size_t i = 0; i < soa.size() / stride; ++i) result.push_back(double(soa[i * stride + k]));
        return result;
    }
    /// Whether everything between the rows is as it was.
    bool gapsUntouched(const std::vector<float>& soa) const {
        for (size_t i = 0; i < soa.size(); ++i)
            if (i % stride >= count && soa[i] != kUntouched) return false;
        return true;
    }
    static constexpr float kUntouched = 1e30f;
};

}  // namespace prt::test
