// A scene with everything a scene can have: two primitives, two materials, two textures, all attributes.
#pragma once

#include "precompute/io/image.h"
#include "precompute/io/scene.h"

namespace prt {

inline ByteImage gradientImage(int width, int height, int channels) {
    ByteImage image{width, height, channels, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < channels; ++c)
                image.pixels.push_back(uint8_t(c == 3 ? 255 - x : (x * 37 + y * 11 + c * 85) % 256));
    return image;
}

inline SceneTexture pngTexture(const std::string& name, int width, int height) {
    return {name, "image/png", encodePng(gradientImage(width, height, 3))};
}

/// A unit square of two triangles in z = 0 and a triangle beside it.
inline Scene smallScene() {
    Scene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0.1f}, {3, 0, 0.1f}, {2, 1, 0.1f}};
    scene.normals.assign(7, Vec3f(0, 0, 1));
    scene.normals[4] = Vec3f(0.6f, 0, 0.8f);
    scene.tangents.assign(7, Vec4f(1, 0, 0, 1));
    scene.tangents[5].w() = -1;
    scene.uv0 = {{0, 1}, {1, 1}, {1, 0}, {0, 0}, {2.5f, -1}, {3.25f, -1}, {2.5f, 0.3f}};
    scene.uv1 = {{0.1f, 0.4f}, {0.4f, 0.4f}, {0.4f, 0.1f}, {0.1f, 0.1f},
                 {0.6f, 0.4f}, {0.9f, 0.4f}, {0.6f, 0.1f}};
    scene.indices = {0, 1, 2, 0, 2, 3, 4, 5, 6};
    ScenePrimitive square, triangle;
    square.vertexCount = 4;
    square.indexCount = 6;
    triangle.firstVertex = 4;
    triangle.vertexCount = 3;
    triangle.firstIndex = 6;
    triangle.indexCount = 3;
    triangle.material = 1;
    scene.primitives = {square, triangle};
    SceneMaterial brick, plain;
    brick.name = "brick";
    brick.baseColor = Vec3f(0.9f, 0.123456789f, 0.25f);
    brick.baseColorTexture = 0;
    brick.normalTexture = 1;
    brick.normalScale = 0.7f;
    plain.name = "plain";
    plain.doubleSided = true;
    scene.materials = {brick, plain};
    scene.textures = {pngTexture("brick_colour", 5, 3), pngTexture("brick_normal", 4, 4)};
    return scene;
}

}  // namespace prt
