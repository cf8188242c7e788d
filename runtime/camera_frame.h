// A camera worked out for an image size. Internal.
#pragma once

#include "precompute/io/scene.h"
#include "precompute/io/surface_image.h"

namespace prt {

struct CameraFrame {
    Vec3f eye;
    /// Clip space from world positions less the eye: depth 1 at the near plane, falling to 0 at infinity.
    Mat4f clipFromEyeOffset;
    /// Direction through image point (x, y), pixels from the top left corner: corner + x·perX + y·perY.
    Vec3d rayCorner, rayPerPixelX, rayPerPixelY;
};

/// @param bounds  of the scene, from which the near plane is taken
/// @throws InputError  eye and target coincide, or the field of view is not in (0, 180)
CameraFrame makeCameraFrame(const Camera& camera, int width, int height, const Bounds& bounds);

}  // namespace prt
