// Dealing a few turned copies of one point set to neighbouring samples: interleaved sampling
// [KellerHeidrich2001].
#include "precompute/visibility/orientations.h"

#include "precompute/math/directions.h"

namespace prt {
namespace {

// Takes the spiral's pole to a direction far from the poles of the others, and to none along an axis: faces
// of boxes would lie in rings of directions.
Mat3d poleTo(const Vec3d& pole) {
    const Frame frame = frameAround(pole.normalized().cast<float>());
    Mat3d rotation;
    rotation.col(0) = frame.tangent.cast<double>();
    rotation.col(1) = frame.normal.cast<double>();
    // Exact where the frame is good to float alone.
    rotation.col(1).normalize();
    rotation.col(0) = (rotation.col(0) - rotation.col(0).dot(rotation.col(1)) * rotation.col(1)).normalized();
    rotation.col(2) = rotation.col(0).cross(rotation.col(1));
    return rotation;
}

}  // namespace

const std::array<Mat3d, kOrientations>& setOrientations() {
    static const std::array<Mat3d, kOrientations> orientations = {
        Mat3d(Mat3d::Identity()), poleTo({0.93, 0.31, 0.19}), poleTo({-0.23, 0.37, 0.90}),
        poleTo({0.57, -0.58, -0.58})};
    return orientations;
}

uint8_t vertexOrientation(uint32_t vertex) {
    return uint8_t((vertex * 0x9e3779b9u) >> 30);  // the golden ratio: runs of indices take all in turn
}

}  // namespace prt
