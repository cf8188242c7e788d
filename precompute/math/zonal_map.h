// Linear maps of expansions that turn with the surface: one block per m in the frame of the normal.
// Internal: Eigen shows here.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "precompute/math/directions.h"
#include "precompute/math/sh.h"
#include "precompute/math/vec.h"

namespace prt {

/// A linear map of expansions that couples functions of equal m and treats ±m alike.
class ZonalMap {
  public:
    /// @param blocks  for m = 0..n−1, each (n−m)×(n−m) over bands m..n−1
    explicit ZonalMap(const std::vector<Eigen::MatrixXd>& blocks) : shOrder_(int(blocks.size())) {
        for (const Eigen::MatrixXd& block : blocks)  // by rows
            for (Eigen::Index a = 0; a < block.rows(); ++a)
                for (Eigen::Index b = 0; b < block.cols(); ++b) values_.push_back(block(a, b));
    }

    /// @param in, out  [n²], apart; in the frame of the normal
    template <class Value>
    void apply(const Value* in, Value* out) const {
        const double* block = values_.data();
        for (int m = 0; m < shOrder_; ++m) {
            const int size = shOrder_ - m;
            for (const int k : {m, -m}) {
                for (int a = 0; a < size; ++a) {
                    double sum = 0;
                    for (int b = 0; b < size; ++b) sum += block[a * size + b] * double(in[shIndex(m + b, k)]);
                    out[shIndex(m + a, k)] = Value(sum);
                }
                if (m == 0) break;
            }
            block += size * size;
        }
    }

    /// The same of many vectors: coefficient i of vector k lies at [i·stride + k].
    /// @param count  rounded up to a multiple of 16; stride is not less
    void applySoa(size_t count, size_t stride, const float* in, float* out) const;

  private:
    int shOrder_;
    std::vector<double> values_;
};

/// A vector's length rounded up to what applySoa takes at once.
constexpr size_t paddedSoaCount(size_t count) { return (count + 15) / 16 * 16; }

/// Rotation into the frame of a unit normal (frameAround), where the normal is +Z.
inline Mat3d localFromWorld(const Vec3f& normal) {
    const Frame frame = frameAround(normal);
    Mat3d rotation;
    rotation.row(0) = frame.tangent.cast<double>();
    rotation.row(1) = frame.bitangent.cast<double>();
    rotation.row(2) = frame.normal.cast<double>();
    return rotation;
}

/// The same of many normals, as rotateShSoa takes them: entry (row, column) of rotation k at
/// [(3·row + column)·stride + k].
struct LocalRotations {
    std::vector<float> fromWorld, toWorld;

    LocalRotations(std::span<const Vec3f> normals, size_t stride);
};

}  // namespace prt
