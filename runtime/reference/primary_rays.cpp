// What a pinhole camera sees, by ray casting: an independent check of the rasteriser.
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "runtime/reference/reference.h"

namespace prt {

SurfaceImage castPrimaryRays(const RayCaster& caster, const Scene& scene, const Camera& camera, int width,
                             int height) {
    PRT_CHECK(width > 0 && height > 0);
    PRT_CHECK_EQ(caster.triangleCount(), scene.triangleCount());
    const Vec3d forward = (camera.target - camera.eye).cast<double>().normalized();
    const Vec3d right = forward.cross(camera.up.cast<double>()).normalized();
    const Vec3d up = right.cross(forward);
    const double halfHeight = std::tan(double(camera.verticalFovDeg) * std::numbers::pi / 360);
    const double halfWidth = halfHeight * width / height;

    SurfaceImage image;
    image.width = width;
    image.height = height;
    const size_t pixels = size_t(width) * size_t(height);
    image.triangle.assign(pixels, kNoTriangle);
    image.position.assign(pixels, Vec3f::Zero());
    image.geometricNormal.assign(pixels, Vec3f::Zero());
    image.shadingNormal.assign(pixels, Vec3f::Zero());
    image.albedo.assign(pixels, Vec3f::Zero());
    parallelFor(pixels, 1024, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const double x = (double(i % size_t(width)) + 0.5) / width * 2 - 1;
            const double y = 1 - (double(i / size_t(width)) + 0.5) / height * 2;
            const Vec3d ray = (forward + x * halfWidth * right + y * halfHeight * up).normalized();
            const RayHit hit = caster.firstHit(camera.eye, ray.cast<float>());
            if (hit.triangle == RayHit{}.triangle) continue;
            const uint32_t* corner = &scene.indices[3 * size_t(hit.triangle)];
            const double w[3] = {1.0 - double(hit.u) - double(hit.v), double(hit.u), double(hit.v)};
            Vec3d position = Vec3d::Zero(), normal = Vec3d::Zero();
            for (size_t k = 0; k < 3; ++k) {
                position += w[k] * scene.positions[corner[k]].cast<double>();
                if (!scene.normals.empty()) normal += w[k] * scene.normals[corner[k]].cast<double>();
            }
            image.triangle[i] = hit.triangle;
            image.position[i] = position.cast<float>();
            image.geometricNormal[i] = triangleNormal(scene, hit.triangle);
            const bool interpolated = normal.norm() > 1e-9;
            image.shadingNormal[i] = image.geometricNormal[i];
            if (interpolated) image.shadingNormal[i] = normal.normalized().cast<float>();
            image.albedo[i] = Vec3f(1, 1, 1);
        }
    });
    return image;
}

}  // namespace prt
