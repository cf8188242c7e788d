// Sources: glTF 2.0 specification, sections 3.8.4 and 3.9.2; IEC 61966-2-1 (sRGB).
#include "precompute/io/surface_albedo.h"

#include <algorithm>
#include <cmath>

#include "precompute/base/check.h"

namespace prt {

SurfaceAlbedo::SurfaceAlbedo(const Scene& scene)
    : scene_(scene), materialOf_(scene.triangleCount(), 0), textures_(scene.textures.size()) {
    for (const ScenePrimitive& primitive : scene.primitives)
        std::fill_n(materialOf_.begin() + primitive.firstIndex / 3, primitive.indexCount / 3,
                    primitive.material);
    if (scene.triangleCount() > 0) PRT_CHECK(!scene.materials.empty());
    for (size_t i = 0; i < linear_.size(); ++i) {
        const double display = double(i) / 255;
        linear_[i] = float(display <= 0.04045 ? display / 12.92 : std::pow((display + 0.055) / 1.055, 2.4));
    }
    if (scene.uv0.empty()) return;
    for (const SceneMaterial& material : scene.materials) {
        if (material.baseColorTexture < 0) continue;
        ByteImage& image = textures_[size_t(material.baseColorTexture)];
        const SceneTexture& source = scene.textures[size_t(material.baseColorTexture)];
        if (image.pixels.empty()) image = decodeImage(source.encoded, "texture " + source.name);
    }
}

Vec3f SurfaceAlbedo::texel(const ByteImage& image, int x, int y) const {
    const uint8_t* rgba = &image.pixels[(size_t(y) * size_t(image.width) + size_t(x)) * 4];
    return {linear_[rgba[0]], linear_[rgba[1]], linear_[rgba[2]]};
}

Vec3f SurfaceAlbedo::textureAt(const ByteImage& image, const Vec2f& uv) const {
    const auto wrapped = [](float coordinate, int size) {
        return (double(coordinate) - std::floor(double(coordinate))) * size - 0.5;
    };
    const double x = wrapped(uv.x(), image.width), y = wrapped(uv.y(), image.height);
    const int left = int(std::floor(x)), top = int(std::floor(y));
    const auto fx = float(x - left), fy = float(y - top);
    const auto repeated = [](int i, int size) { return (i + size) % size; };
    const int x0 = repeated(left, image.width), x1 = repeated(left + 1, image.width);
    const int y0 = repeated(top, image.height), y1 = repeated(top + 1, image.height);
    return (1 - fy) * ((1 - fx) * texel(image, x0, y0) + fx * texel(image, x1, y0)) +
           fy * ((1 - fx) * texel(image, x0, y1) + fx * texel(image, x1, y1));
}

Vec3f SurfaceAlbedo::at(uint32_t triangle, float u, float v) const {
    const SceneMaterial& material = scene_.materials[size_t(materialOf_[triangle])];
    Vec3f albedo = material.baseColor;
    if (material.baseColorTexture >= 0 && !scene_.uv0.empty()) {
        const uint32_t* corner = &scene_.indices[3 * size_t(triangle)];
        const Vec2f uv =
            (1 - u - v) * scene_.uv0[corner[0]] + u * scene_.uv0[corner[1]] + v * scene_.uv0[corner[2]];
        albedo = albedo.cwiseProduct(textureAt(textures_[size_t(material.baseColorTexture)], uv));
    }
    return albedo.cwiseMax(0.0f).cwiseMin(1.0f);
}

}  // namespace prt
