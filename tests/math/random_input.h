// Reproducible random numbers, vectors and rotations for the tests of this folder.
#pragma once

#include <random>
#include <vector>

#include "precompute/math/vec.h"

namespace prt::test {

class RandomInput {
  public:
    explicit RandomInput(uint64_t seed) : engine_(seed) {}
    /// In [low, high).
    double uniform(double low, double high) { return low + (high - low) * double(engine_() >> 11) * 0x1p-53; }
    Vec3d direction() {
        for (;;) {
            const Vec3d v(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
            const double length = v.norm();
            if (length > 0.01 && length < 1) return v / length;
        }
    }
    Mat3d rotation() { return Eigen::AngleAxisd(uniform(-4, 4), direction()).toRotationMatrix(); }
    template <typename T>
    std::vector<T> coefficients(int count) {
        std::vector<T> v(static_cast<size_t>(count));
        for (T& x : v) x = T(uniform(-1, 1));
        return v;
    }

  private:
    std::mt19937_64 engine_;
};

}  // namespace prt::test
