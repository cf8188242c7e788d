// Tangent frames from texture coordinates, in the way of M. Mikkelsen, "Simulation of Wrinkled Surfaces
// Revisited", 2008 (MikkTSpace): per corner, projected into the plane of the normal, weighted by angle.
// glTF's v points down in the image and its normal maps' green up, so the bitangent w · cross(n, t) is
// −∂p/∂v.
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/mesh/corner_mesh.h"
#include "precompute/mesh/interrupt.h"

namespace prt {
namespace {

/// Area of a triangle in the image, seen with v upwards.
double imageArea(const Vec2f& a, const Vec2f& b, const Vec2f& c) {
    const double u1 = double(b.x()) - a.x(), v1 = double(a.y()) - b.y();
    const double u2 = double(c.x()) - a.x(), v2 = double(a.y()) - c.y();
    return u1 * v2 - u2 * v1;
}

Vec3f anyOrthogonal(const Vec3f& normal) {
    const Vec3f n = normal.cwiseAbs();
    const Vec3f axis = n.x() <= n.y() && n.x() <= n.z() ? Vec3f(1, 0, 0)
                       : n.y() <= n.z()                 ? Vec3f(0, 1, 0)
                                                        : Vec3f(0, 0, 1);
    return (axis - normal * normal.dot(axis)).normalized();
}

/// ∂p/∂u of a triangle times a positive factor; zero where uv0 is degenerate.
Vec3d tangentDirection(const Scene& scene, const uint32_t* triangle) {
    const auto uv = [&](size_t k) -> const Vec2f& { return scene.uv0[triangle[k]]; };
    const double area = imageArea(uv(0), uv(1), uv(2));
    if (area == 0) return {0, 0, 0};
    const Vec3d a = scene.positions[triangle[0]].cast<double>();
    const Vec3d e1 = scene.positions[triangle[1]].cast<double>() - a;
    const Vec3d e2 = scene.positions[triangle[2]].cast<double>() - a;
    const double v1 = double(uv(0).y()) - uv(1).y(), v2 = double(uv(0).y()) - uv(2).y();
    const Vec3d direction = (e1 * v2 - e2 * v1) * (area < 0 ? -1.0 : 1.0);
    const double length = direction.norm();
    return length > 0 ? Vec3d(direction / length) : Vec3d(0, 0, 0);
}

}  // namespace

int cornerHandedness(const Vec3f& normal, const Vec3f& faceNormal, const Vec2f& uvA, const Vec2f& uvB,
                     const Vec2f& uvC) {
    const double area = imageArea(uvA, uvB, uvC);
    if (area == 0) return 0;
    return (area > 0) == (normal.dot(faceNormal) >= 0) ? 1 : -1;
}

void makeTangents(Scene& scene, const std::vector<uint8_t>& keep) {
    PRT_CHECK_EQ(scene.normals.size(), scene.positions.size());
    PRT_CHECK_EQ(scene.uv0.size(), scene.positions.size());
    std::vector<Vec3d> sum(scene.vertexCount(), Vec3d(0, 0, 0));
    std::vector<float> side(scene.vertexCount(), 0);
    for (size_t t = 0; t < scene.triangleCount(); ++t) {
        throwIfInterruptedAt(t);
        const uint32_t* triangle = scene.indices.data() + 3 * t;
        const Vec3d direction = tangentDirection(scene, triangle);
        if (direction.squaredNorm() == 0) continue;
        const auto at = [&](size_t k) -> const Vec3f& { return scene.positions[triangle[k]]; };
        const Vec3f faceNormal = triangleCross(at(0), at(1), at(2)).normalized().cast<float>();
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t v = triangle[k];
            const Vec3d normal = scene.normals[v].cast<double>();
            const Vec3d inPlane = direction - normal * normal.dot(direction);
            const double length = inPlane.norm();
            if (length < 1e-9) continue;
            const double angle = cornerAngle(at(k), at((k + 1) % 3), at((k + 2) % 3));
            sum[v] += inPlane * (angle / length);
            side[v] +=
                float(angle) * float(cornerHandedness(scene.normals[v], faceNormal, scene.uv0[triangle[0]],
                                                      scene.uv0[triangle[1]], scene.uv0[triangle[2]]));
        }
    }
    scene.tangents.resize(scene.vertexCount());
    for (size_t v = 0; v < scene.vertexCount(); ++v) {
        if (!keep.empty() && keep[v]) continue;
        const Vec3f& normal = scene.normals[v];
        const double length = sum[v].norm();
        Vec3f tangent = length > 1e-6 ? Vec3f((sum[v] / length).cast<float>()) : anyOrthogonal(normal);
        tangent = (tangent - normal * normal.dot(tangent)).normalized();
        scene.tangents[v] = Vec4f(tangent.x(), tangent.y(), tangent.z(), side[v] < 0 ? -1.0f : 1.0f);
    }
}

void makeTangents(Scene& scene) { makeTangents(scene, {}); }

}  // namespace prt
