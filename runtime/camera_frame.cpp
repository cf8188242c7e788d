// Sources: [UpchurchDesbrun2012, "Tightening the Precision of Perspective Rendering"] for the reversed,
// infinite projection: with float depth its precision is the same at all distances, so that only the near
// plane has to be chosen.
#include "runtime/camera_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/error.h"

namespace prt {
namespace {

// A near plane just before everything there is to see, or a small part of the scene if the eye is inside.
double nearDistance(const Vec3d& eye, const Vec3d& forward, const Bounds& bounds) {
    const Vec3d low = bounds.low.cast<double>(), high = bounds.high.cast<double>();
    double nearest = INFINITY;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d at((corner & 1) ? high.x() : low.x(), (corner & 2) ? high.y() : low.y(),
                       (corner & 4) ? high.z() : low.z());
        nearest = std::min(nearest, forward.dot(at - eye));
    }
    const double size = (high - low).norm();
    return std::max({0.9 * nearest, 1e-5 * size, 1e-30});
}

}  // namespace

CameraFrame makeCameraFrame(const Camera& camera, int width, int height, const Bounds& bounds) {
    const Vec3d eye = camera.eye.cast<double>();
    Vec3d forward = camera.target.cast<double>() - eye;
    if (!(forward.norm() > 0) || !forward.allFinite())
        throw InputError("camera", "eye and target are the same point", "move one of them");
    forward.normalize();
    const double fov = camera.verticalFovDeg;
    if (!(fov > 0 && fov < 180))
        throw InputError("camera", fmt::format("field of view is {} degrees", fov), "choose one in (0, 180)");
    Vec3d right = forward.cross(camera.up.cast<double>());
    // Looking along "up": any other axis will do.
    if (!(right.norm() > 1e-6 * camera.up.cast<double>().norm()))
        right = forward.cross(std::abs(forward.z()) < 0.9 ? Vec3d(0, 0, -1) : Vec3d(1, 0, 0));
    right.normalize();
    const Vec3d up = right.cross(forward);

    const double halfHeight = std::tan(fov * std::numbers::pi / 360);
    const double halfWidth = halfHeight * width / height;
    CameraFrame frame;
    frame.eye = camera.eye;
    Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
    clip.block<1, 3>(0, 0) = (right / halfWidth).transpose();
    clip.block<1, 3>(1, 0) = (up / halfHeight).transpose();
    clip(2, 3) = nearDistance(eye, forward, bounds);
    clip.block<1, 3>(3, 0) = forward.transpose();
    frame.clipFromEyeOffset = clip.cast<float>();
    frame.rayCorner = forward - halfWidth * right + halfHeight * up;
    frame.rayPerPixelX = right * (2 * halfWidth / width);
    frame.rayPerPixelY = up * (-2 * halfHeight / height);
    return frame;
}

}  // namespace prt
