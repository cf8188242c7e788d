// The small vectors of public interfaces: fixed size, unaligned, so that they lie densely in arrays.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace prt {

using Vec2f = Eigen::Matrix<float, 2, 1, Eigen::DontAlign>;
using Vec3f = Eigen::Matrix<float, 3, 1, Eigen::DontAlign>;
using Vec4f = Eigen::Matrix<float, 4, 1, Eigen::DontAlign>;
using Vec3d = Eigen::Matrix<double, 3, 1, Eigen::DontAlign>;
using Mat3f = Eigen::Matrix<float, 3, 3, Eigen::DontAlign>;
using Mat3d = Eigen::Matrix<double, 3, 3, Eigen::DontAlign>;
using Mat4f = Eigen::Matrix<float, 4, 4, Eigen::DontAlign>;

static_assert(sizeof(Vec3f) == 12 && alignof(Vec3f) == 4);
static_assert(sizeof(Vec4f) == 16 && alignof(Vec4f) == 4);

}  // namespace prt
