// Dealing a few turned copies of one point set to neighbouring samples: interleaved sampling
// [KellerHeidrich2001].
#include "precompute/visibility/orientations.h"

#include <Eigen/Geometry>

namespace prt {
namespace {

// Errors of sets of 256 directions and more differ as much as those of random rotations, and streams of rays
// are little slower than of parallel ones (tools/docs/performance.md).
constexpr double kTiltRad = 0.04;

Mat3d tilt(double x, double y, double z) {
    return Eigen::AngleAxisd(kTiltRad, Vec3d(x, y, z).normalized()).toRotationMatrix();
}

}  // namespace

const std::array<Mat3d, kOrientations>& setOrientations() {
    // About the corners of a tetrahedron, relative to the first: no direction stays where it was under more
    // than two of them.
    static const std::array<Mat3d, kOrientations> orientations = {
        Mat3d(Mat3d::Identity()), Mat3d(tilt(1, -1, -1) * tilt(1, 1, 1).transpose()),
        Mat3d(tilt(-1, 1, -1) * tilt(1, 1, 1).transpose()),
        Mat3d(tilt(-1, -1, 1) * tilt(1, 1, 1).transpose())};
    return orientations;
}

Vec3f turnedIntoWorld(int orientation, const Vec3f& direction) {
    if (orientation == 0) return direction;
    return (setOrientations()[size_t(orientation)] * direction.cast<double>()).cast<float>();
}

Vec3f turnedBack(int orientation, const Vec3f& vector) {
    if (orientation == 0) return vector;
    return (setOrientations()[size_t(orientation)].transpose() * vector.cast<double>()).cast<float>();
}

uint8_t vertexOrientation(uint32_t vertex) {
    return uint8_t((vertex * 0x9e3779b9u) >> 30);  // the golden ratio: runs of indices take all in turn
}

}  // namespace prt
