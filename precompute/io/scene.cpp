// The plain mesh between the stages, and the check of its promises.
// Sources: glTF 2.0 specification, section 3.7 (attribute meanings, winding).
#include "precompute/io/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "precompute/base/error.h"

namespace prt {
namespace {

// Rounding leaves 1e-6; gltf-validator refuses 6.7e-3.
constexpr float kUnitTolerance = 5e-3f;

template <class Vector>
void checkAttribute(const std::vector<Vector>& values, size_t vertexCount, const char* name,
                    const std::string& where) {
    if (!values.empty() && values.size() != vertexCount)
        throw InputError(where, fmt::format("{} {} for {} vertices", values.size(), name, vertexCount));
    for (size_t i = 0; i < values.size(); ++i)
        if (!values[i].allFinite())
            throw InputError(where, fmt::format("vertex {} has a {} that is not a finite number", i, name),
                             "remove the vertex or export the mesh again");
}

void checkUnit(const Scene& scene, const std::string& where) {
    for (size_t i = 0; i < scene.normals.size(); ++i) {
        const float length = scene.normals[i].norm();
        if (std::abs(length - 1) > kUnitTolerance)
            throw InputError(where, fmt::format("the normal of vertex {} has length {}", i, length));
    }
    for (size_t i = 0; i < scene.tangents.size(); ++i) {
        const float length = scene.tangents[i].head<3>().norm();
        if (std::abs(length - 1) > kUnitTolerance || std::abs(scene.tangents[i].w()) != 1)
            throw InputError(where, fmt::format("the tangent of vertex {} has length {} and sign {}", i,
                                                length, scene.tangents[i].w()));
    }
}

void checkMaterials(const Scene& scene, const std::string& where) {
    const int textureCount = int(scene.textures.size());
    for (size_t i = 0; i < scene.materials.size(); ++i) {
        const SceneMaterial& material = scene.materials[i];
        for (int texture : {material.baseColorTexture, material.normalTexture})
            if (texture < -1 || texture >= textureCount)
                throw InputError(where,
                                 fmt::format("material {} uses texture {} of {}", i, texture, textureCount));
        if (!material.baseColor.allFinite() || !std::isfinite(material.normalScale))
            throw InputError(where, fmt::format("material {} has a value that is not a finite number", i));
    }
}

void checkPrimitives(const Scene& scene, const std::string& where) {
    uint64_t nextVertex = 0, nextIndex = 0;
    for (size_t p = 0; p < scene.primitives.size(); ++p) {
        const ScenePrimitive& primitive = scene.primitives[p];
        if (primitive.firstVertex != nextVertex || primitive.firstIndex != nextIndex)
            throw InputError(
                where, fmt::format("primitive {} does not start where the one before it ends "
                                   "(vertex {} against {}, index {} against {})",
                                   p, primitive.firstVertex, nextVertex, primitive.firstIndex, nextIndex));
        nextVertex += primitive.vertexCount;
        nextIndex += primitive.indexCount;
        if (nextVertex > scene.positions.size() || nextIndex > scene.indices.size())
            throw InputError(where, fmt::format("primitive {} reaches beyond the vertices or indices", p));
        if (primitive.indexCount % 3 != 0)
            throw InputError(where, fmt::format("primitive {} has {} indices, not a multiple of 3", p,
                                                primitive.indexCount));
        if (primitive.material < 0 || size_t(primitive.material) >= scene.materials.size())
            throw InputError(where, fmt::format("primitive {} uses material {} of {}", p, primitive.material,
                                                scene.materials.size()));
        for (uint64_t i = primitive.firstIndex; i < nextIndex; ++i)
            if (scene.indices[i] < primitive.firstVertex || scene.indices[i] >= nextVertex)
                throw InputError(where,
                                 fmt::format("triangle {} of primitive {} uses vertex {}, outside {} to {}",
                                             (i - primitive.firstIndex) / 3, p, scene.indices[i],
                                             primitive.firstVertex, nextVertex),
                                 "export the mesh again");
    }
    if (nextVertex != scene.positions.size() || nextIndex != scene.indices.size())
        throw InputError(
            where, fmt::format("the primitives cover {} of {} vertices and {} of {} indices", nextVertex,
                               scene.positions.size(), nextIndex, scene.indices.size()));
}

}  // namespace

std::vector<uint8_t> doubleSidedTriangles(const Scene& scene) {
    std::vector<uint8_t> result(scene.triangleCount(), 0);
    for (const ScenePrimitive& primitive : scene.primitives) {
        if (primitive.material < 0 || size_t(primitive.material) >= scene.materials.size()) continue;
        if (!scene.materials[size_t(primitive.material)].doubleSided) continue;
        std::fill_n(result.begin() + primitive.firstIndex / 3, primitive.indexCount / 3, uint8_t(1));
    }
    return result;
}

Bounds sceneBounds(const Scene& scene) {
    if (scene.positions.empty()) return {Vec3f::Zero(), Vec3f::Zero()};
    Bounds bounds{scene.positions[0], scene.positions[0]};
    for (const Vec3f& position : scene.positions) {
        bounds.low = bounds.low.cwiseMin(position);
        bounds.high = bounds.high.cwiseMax(position);
    }
    return bounds;
}

Vec3f triangleNormal(const Scene& scene, size_t triangle) {
    const Vec3d a = scene.positions[scene.indices[triangle * 3]].cast<double>();
    const Vec3d b = scene.positions[scene.indices[triangle * 3 + 1]].cast<double>();
    const Vec3d c = scene.positions[scene.indices[triangle * 3 + 2]].cast<double>();
    const Vec3d normal = Vec3d(b - a).cross(Vec3d(c - a));
    // Scaled first: the squares of very small or large coordinates leave the range of double otherwise.
    const double scale = normal.cwiseAbs().maxCoeff();
    if (!(scale > 0) || !std::isfinite(scale)) return Vec3f::Zero();
    return Vec3d(normal / scale).normalized().cast<float>();
}

void validateScene(const Scene& scene, const std::string& where) {
    const size_t count = scene.positions.size();
    if (count > std::numeric_limits<uint32_t>::max() ||
        scene.indices.size() > std::numeric_limits<uint32_t>::max())
        throw InputError(where, fmt::format("{} vertices are more than 32-bit indices reach", count));
    checkAttribute(scene.positions, count, "position", where);
    checkAttribute(scene.normals, count, "normal", where);
    checkAttribute(scene.tangents, count, "tangent", where);
    checkAttribute(scene.uv0, count, "texture coordinate", where);
    checkAttribute(scene.uv1, count, "atlas coordinate", where);
    checkUnit(scene, where);
    checkMaterials(scene, where);
    checkPrimitives(scene, where);
}

}  // namespace prt
